#include "VectorLayer.h"

#include "Surface.h"
#include "vtkActor.h"
#include "vtkCellArray.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::rendering
{

void VectorLayer::Triangle(const Point2& a, const Point2& b, const Point2& c)
{
  this->Points.insert(this->Points.end(), { a, b, c });
}

void VectorLayer::Line(const Polyline& line, double width)
{
  const std::size_t count = line.size();
  if (count < 2)
    return;
  std::vector<Point2> left(count);
  std::vector<Point2> right(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    // Across the bisector of the two segments that meet, longer there as a mitre, but not without bound.
    const Point2& before = line[i > 0 ? i - 1 : i];
    const Point2& after = line[i + 1 < count ? i + 1 : i];
    const auto unit = [](const Point2& from, const Point2& to)
    {
      const double length = Distance(from, to);
      return length > 0 ? Point2{ (to[0] - from[0]) / length, (to[1] - from[1]) / length } : Point2{ 0, 0 };
    };
    const Point2 in = unit(before, line[i]);
    const Point2 out = unit(line[i], after);
    Point2 along{ in[0] + out[0], in[1] + out[1] };
    const double size = std::hypot(along[0], along[1]);
    if (size < 1e-9)
      along = in;
    else
      along = { along[0] / size, along[1] / size };
    const Point2& segment = i > 0 ? in : out;
    const double cosine = std::max(0.5, along[0] * segment[0] + along[1] * segment[1]);
    const double half = 0.5 * width / cosine;
    left[i] = { line[i][0] - half * along[1], line[i][1] + half * along[0] };
    right[i] = { line[i][0] + half * along[1], line[i][1] - half * along[0] };
  }
  for (std::size_t i = 1; i < count; ++i)
  {
    this->Triangle(left[i - 1], right[i - 1], right[i]);
    this->Triangle(left[i - 1], right[i], left[i]);
  }
}

void VectorLayer::Head(const Point2& tip, const Point2& direction, double size)
{
  const double length = std::hypot(direction[0], direction[1]);
  if (!(length > 0))
    return;
  const Point2 along{ direction[0] / length, direction[1] / length };
  const Point2 across{ -along[1], along[0] };
  const auto place = [&](double back, double aside) {
    return Point2{ tip[0] - back * along[0] + aside * across[0], tip[1] - back * along[1] + aside * across[1] };
  };
  const Point2 notch = place(0.72 * size, 0);
  this->Triangle(tip, place(size, 0.42 * size), notch);
  this->Triangle(tip, notch, place(size, -0.42 * size));
}

bool DrawLayers(const std::vector<VectorLayer>& layers, Canvas& canvas, const PixelRect& inside, std::string& whyNot)
{
  // Each layer in a primary colour of its own, the later ones nearer: what is read back is the share of each pixel that
  // each layer covers and no later one hides.
  vtkNew<vtkFloatArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  vtkNew<vtkCellArray> cells;
  for (std::size_t k = 0; k < layers.size(); ++k)
  {
    std::array<unsigned char, 3> primary{ 0, 0, 0 };
    primary.at(k) = 255;
    for (std::size_t i = 0; i < layers[k].Corners().size(); ++i)
    {
      const Point2& corner = layers[k].Corners()[i];
      coordinates->InsertNextTuple3(corner[0] - inside.x, corner[1] - inside.y, 0.1 * static_cast<double>(k));
      const vtkIdType id = coordinates->GetNumberOfTuples() - 1;
      colors->InsertNextTypedTuple(primary.data());
      if (i % 3 == 2)
        cells->InsertNextCell({ id - 2, id - 1, id });
    }
  }
  if (cells->GetNumberOfCells() == 0 || inside.width < 1 || inside.height < 1)
    return true;
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);
  vtkNew<vtkPolyData> shapes;
  shapes->SetPoints(points);
  shapes->SetPolys(cells);
  shapes->GetPointData()->SetScalars(colors);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(shapes);
  mapper->SetColorModeToDirectScalars();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(actor);
  renderer->SetBackground(0, 0, 0);
  std::vector<std::uint8_t> pixels;
  if (!DrawFlat(renderer, inside.width, inside.height, pixels, whyNot))
    return false;
  for (std::size_t k = 0; k < layers.size(); ++k)
  {
    std::vector<std::uint8_t> coverage(pixels.size() / 4);
    for (std::size_t i = 0; i < coverage.size(); ++i)
      coverage[i] = pixels[4 * i + k];
    canvas.Cover(inside, coverage, layers[k].GetColor());
  }
  return true;
}

} // namespace lamella::rendering
