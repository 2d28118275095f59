#include "FlowLines.h"

#include "PlaneField.h"

#include "vtkCellArray.h"
#include "vtkFloatArray.h"
#include "vtkFlyingEdges2D.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStripper.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lamella::rendering
{
namespace
{

PlaneField Transpose(const PlaneField& field)
{
  PlaneField turned{ field.ny, field.nx, std::vector<float>(field.x.size()), std::vector<float>(field.y.size()) };
  for (int j = 0; j < field.ny; ++j)
  {
    for (int i = 0; i < field.nx; ++i)
    {
      turned.x[turned.Index(j, i)] = field.y[field.Index(i, j)];
      turned.y[turned.Index(j, i)] = field.x[field.Index(i, j)];
    }
  }
  return turned;
}

/// Fits ends that stop half a pixel before the picture's edge to the edge.
void ReachEdges(Polyline& line, int nx, int ny)
{
  const auto extend = [&](Point2& end, const Point2& before)
  {
    const std::array<double, 2> size{ static_cast<double>(nx), static_cast<double>(ny) };
    const double length = std::max(1e-9, Distance(end, before));
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      const double gap = std::min(end.at(axis), size.at(axis) - end.at(axis));
      const double slope = (end.at(axis) - before.at(axis)) / length;
      const bool outwards = end.at(axis) < size.at(axis) / 2 ? slope < -0.2 : slope > 0.2;
      if (gap > 0 && gap <= 0.51 && outwards)
      {
        const double way = gap / std::abs(slope) / length;
        end = { end[0] + way * (end[0] - before[0]), end[1] + way * (end[1] - before[1]) };
        return;
      }
    }
  };
  if (line.size() > 1)
  {
    extend(line.back(), line[line.size() - 2]);
    extend(line.front(), line[1]);
  }
}

} // namespace

std::vector<Polyline> Contours(
  std::span<const float> values, int nx, int ny, Point2 origin, std::span<const double> levels)
{
  if (nx < 2 || ny < 2)
    return {};
  vtkNew<vtkImageData> image;
  image->SetDimensions(nx, ny, 1);
  image->SetOrigin(origin[0], origin[1], 0);
  vtkNew<vtkFloatArray> scalars;
  scalars->SetArray(const_cast<float*>(values.data()), static_cast<vtkIdType>(values.size()), 1); // only read
  image->GetPointData()->SetScalars(scalars);
  vtkNew<vtkFlyingEdges2D> edges;
  edges->SetInputData(image);
  edges->ComputeScalarsOff();
  edges->SetNumberOfContours(static_cast<int>(levels.size()));
  for (std::size_t i = 0; i < levels.size(); ++i)
    edges->SetValue(static_cast<int>(i), levels[i]);
  vtkNew<vtkStripper> stripper;
  stripper->SetInputConnection(edges->GetOutputPort());
  stripper->SetMaximumLength(1000000);
  stripper->JoinContiguousSegmentsOn();
  stripper->Update();

  std::vector<Polyline> result;
  vtkPolyData* output = stripper->GetOutput();
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < output->GetLines()->GetNumberOfCells(); ++cell)
  {
    output->GetLines()->GetCellAtId(cell, ids);
    Polyline line;
    for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i)
    {
      const double* p = output->GetPoint(ids->GetId(i));
      line.push_back({ p[0], p[1] });
    }
    if (line.size() > 1)
      result.push_back(std::move(line));
  }
  return result;
}

Polyline Smooth(const Polyline& line, double step, double sigma)
{
  std::vector<double> along{ 0 };
  for (std::size_t i = 1; i < line.size(); ++i)
    along.push_back(along.back() + Distance(line[i - 1], line[i]));
  const double length = along.back();
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(length / step)));
  Polyline even;
  std::size_t at = 0;
  for (std::size_t k = 0; k <= count; ++k)
  {
    const double s = length * static_cast<double>(k) / static_cast<double>(count);
    while (at + 2 < along.size() && along[at + 1] < s)
      ++at;
    const double part = along[at + 1] > along[at] ? (s - along[at]) / (along[at + 1] - along[at]) : 0.0;
    even.push_back(
      { line[at][0] + part * (line[at + 1][0] - line[at][0]), line[at][1] + part * (line[at + 1][1] - line[at][1]) });
  }
  const bool closed = line.size() > 3 && Distance(line.front(), line.back()) < 1e-6;
  const double width = sigma / (length / static_cast<double>(count) + 1e-12); // in points
  const int reach = static_cast<int>(std::ceil(3 * width));
  if (sigma <= 0 || reach < 1 || even.size() < 3)
    return even;
  Polyline smooth(even.size());
  const int last = static_cast<int>(even.size()) - 1;
  for (int k = 0; k <= last; ++k)
  {
    // Near an open end the window shrinks with the distance to it, which keeps the end where it is.
    const int here = closed ? std::min(reach, last / 2) : std::min({ reach, k, last - k });
    double weights = 0;
    Point2 sum{ 0, 0 };
    for (int d = -here; d <= here; ++d)
    {
      const int index = closed ? (k + d + last) % last : k + d;
      const double weight = std::exp(-0.5 * d * d / (width * width));
      weights += weight;
      sum[0] += weight * even[static_cast<std::size_t>(index)][0];
      sum[1] += weight * even[static_cast<std::size_t>(index)][1];
    }
    smooth[static_cast<std::size_t>(k)] = { sum[0] / weights, sum[1] / weights };
  }
  return smooth;
}

std::vector<Polyline> EqualFluxLines(const PlaneField& field, int count)
{
  const int nx = field.nx;
  const int ny = field.ny;
  const double meanX = std::accumulate(field.x.begin(), field.x.end(), 0.0);
  const double meanY = std::accumulate(field.y.begin(), field.y.end(), 0.0);
  if (nx < 2 || ny < 2 || count < 1 || (meanX == 0 && meanY == 0))
    return {};
  if (std::abs(meanX) > std::abs(meanY))
  {
    auto lines = EqualFluxLines(Transpose(field), count);
    for (Polyline& line : lines)
    {
      for (Point2& point : line)
        std::swap(point[0], point[1]);
      // Mirroring does not turn a line's direction: it still follows the flux.
    }
    return lines;
  }

  // ψ with q = (∂ψ/∂y, −∂ψ/∂x), on the nx + 1 borders between the pixels of each row.
  const auto columns = static_cast<std::size_t>(nx) + 1;
  std::vector<double> psi(columns * static_cast<std::size_t>(ny), 0.0);
  for (int j = 0; j < ny; ++j)
  {
    for (int i = 0; i < nx; ++i)
    {
      const std::size_t k = static_cast<std::size_t>(j) * columns + static_cast<std::size_t>(i);
      psi[k + 1] = psi[k] - field.y[field.Index(i, j)];
    }
  }
  double shift = 0;
  double mismatch = 0;
  for (int j = 0; j + 1 < ny; ++j)
  {
    const std::size_t row = static_cast<std::size_t>(j) * columns;
    const auto across = [&](int i)
    {
      const double flux = 0.25 *
        (static_cast<double>(field.x[field.Index(i - 1, j)]) + field.x[field.Index(i, j)] +
          field.x[field.Index(i - 1, j + 1)] + field.x[field.Index(i, j + 1)]);
      const std::size_t k = row + static_cast<std::size_t>(i);
      // the row below has been shifted already
      return flux - (psi[k + columns] - (psi[k] - shift));
    };
    double mean = 0;
    for (int i = 1; i < nx; ++i)
      mean += across(i) / (nx - 1);
    for (int i = 1; i < nx; ++i)
      mismatch += std::abs(across(i) - mean);
    shift += mean;
    for (std::size_t i = 0; i < columns; ++i)
      psi[row + columns + i] += shift;
  }
  mismatch /= static_cast<double>(nx - 1) * (ny - 1);
  const auto [low, high] = std::minmax_element(psi.begin(), psi.end());
  const double range = *high - *low;
  if (!(range > 0) || mismatch > 0.25 * MeanMagnitude(field))
    return {};

  std::vector<double> levels;
  for (int k = 0; k < count; ++k)
    levels.push_back((k + 0.5) / count);
  std::vector<float> scaled(psi.size());
  const double lowest = *low;
  std::transform(
    psi.begin(), psi.end(), scaled.begin(), [&](double value) { return static_cast<float>((value - lowest) / range); });
  auto lines = Contours(scaled, nx + 1, ny, { 0.0, 0.5 }, levels);
  const Sampler sampler(field);
  for (Polyline& line : lines)
  {
    double along = 0;
    for (std::size_t i = 1; i < line.size(); ++i)
    {
      const Point2 q = sampler.At(line[i]);
      along += q[0] * (line[i][0] - line[i - 1][0]) + q[1] * (line[i][1] - line[i - 1][1]);
    }
    if (along < 0)
      std::reverse(line.begin(), line.end());
    ReachEdges(line, nx, ny);
  }
  return lines;
}

std::vector<Arrow> BlockArrows(const PlaneField& field, double separation)
{
  const int columns = std::max(1, static_cast<int>(std::lround(field.nx / separation)));
  const int rows = std::max(1, static_cast<int>(std::lround(field.ny / separation)));
  const double width = static_cast<double>(field.nx) / columns;
  const double height = static_cast<double>(field.ny) / rows;
  std::vector<std::array<double, 3>> sums(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int j = 0; j < field.ny; ++j)
  {
    for (int i = 0; i < field.nx; ++i)
    {
      const auto block = static_cast<std::size_t>(std::min(rows - 1, static_cast<int>((j + 0.5) / height))) *
          static_cast<std::size_t>(columns) +
        static_cast<std::size_t>(std::min(columns - 1, static_cast<int>((i + 0.5) / width)));
      sums[block][0] += field.x[field.Index(i, j)];
      sums[block][1] += field.y[field.Index(i, j)];
      sums[block][2] += 1;
    }
  }
  double largest = 0;
  for (auto& sum : sums)
  {
    sum = { sum[0] / std::max(1.0, sum[2]), sum[1] / std::max(1.0, sum[2]), 0 };
    largest = std::max(largest, std::hypot(sum[0], sum[1]));
  }
  std::vector<Arrow> arrows;
  const double scale = largest > 0 ? 0.9 * std::min(width, height) / largest : 0.0;
  for (int row = 0; row < rows; ++row)
  {
    for (int column = 0; column < columns; ++column)
    {
      const auto& mean =
        sums[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
      if (std::hypot(mean[0], mean[1]) < 0.12 * largest || largest == 0)
        continue;
      const Point2 centre{ (column + 0.5) * width, (row + 0.5) * height };
      const Point2 half{ 0.5 * scale * mean[0], 0.5 * scale * mean[1] };
      arrows.push_back({ { centre[0] - half[0], centre[1] - half[1] }, { centre[0] + half[0], centre[1] + half[1] } });
    }
  }
  return arrows;
}

std::vector<Polyline> Outline(const std::vector<bool>& inside, int nx, int ny)
{
  // Binomial smoothing turns the steps between pixels into slopes that a contour can follow.
  std::vector<float> values(inside.size());
  std::transform(inside.begin(), inside.end(), values.begin(), [](bool in) { return in ? 1.0F : 0.0F; });
  std::vector<float> other(values.size());
  const auto pass = [&](std::ptrdiff_t stride, int size, int place)
  {
    const bool first = place == 0;
    const bool last = place == size - 1;
    return std::array<std::ptrdiff_t, 2>{ first ? 0 : -stride, last ? 0 : stride };
  };
  for (int j = 0; j < ny; ++j)
  {
    for (int i = 0; i < nx; ++i)
    {
      const auto k = static_cast<std::ptrdiff_t>(j) * nx + i;
      const auto [before, after] = pass(1, nx, i);
      const auto at = [&](std::ptrdiff_t index) { return values[static_cast<std::size_t>(index)]; };
      other[static_cast<std::size_t>(k)] = 0.25F * at(k + before) + 0.5F * at(k) + 0.25F * at(k + after);
    }
  }
  for (int j = 0; j < ny; ++j)
  {
    for (int i = 0; i < nx; ++i)
    {
      const auto k = static_cast<std::ptrdiff_t>(j) * nx + i;
      const auto [before, after] = pass(nx, ny, j);
      const auto at = [&](std::ptrdiff_t index) { return other[static_cast<std::size_t>(index)]; };
      values[static_cast<std::size_t>(k)] = 0.25F * at(k + before) + 0.5F * at(k) + 0.25F * at(k + after);
    }
  }
  constexpr double level[] = { 0.5 };
  auto lines = Contours(values, nx, ny, { 0.5, 0.5 }, level);
  for (Polyline& line : lines)
    ReachEdges(line, nx, ny);
  return lines;
}

} // namespace lamella::rendering
