#include "FlowLines.h"

#include "PlaneField.h"

#include <algorithm>
#include <cmath>

namespace lamella::rendering
{
namespace
{

/// Which points of lines lie near: buckets as wide as the separation.
class Buckets
{
public:
  Buckets(int nx, int ny, double width)
    : Width(width)
    , Columns(static_cast<int>(nx / width) + 1)
    , Rows(static_cast<int>(ny / width) + 1)
    , Points(static_cast<std::size_t>(Columns) * static_cast<std::size_t>(Rows))
  {
  }
  void Add(const Point2& p) { this->Points[this->Index(this->Column(p), this->Row(p))].push_back(p); }
  [[nodiscard]] bool IsFree(const Point2& p, double distance) const
  {
    for (int row = std::max(0, this->Row(p) - 1); row <= std::min(this->Rows - 1, this->Row(p) + 1); ++row)
    {
      for (int column = std::max(0, this->Column(p) - 1); column <= std::min(this->Columns - 1, this->Column(p) + 1);
           ++column)
      {
        for (const Point2& other : this->Points[this->Index(column, row)])
        {
          if (Distance(p, other) < distance)
          {
            return false;
          }
        }
      }
    }
    return true;
  }

private:
  [[nodiscard]] int Column(const Point2& p) const
  {
    return std::clamp(static_cast<int>(p[0] / this->Width), 0, this->Columns - 1);
  }
  [[nodiscard]] int Row(const Point2& p) const
  {
    return std::clamp(static_cast<int>(p[1] / this->Width), 0, this->Rows - 1);
  }
  [[nodiscard]] std::size_t Index(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Columns) + static_cast<std::size_t>(column);
  }
  double Width;
  int Columns;
  int Rows;
  std::vector<std::vector<Point2>> Points;
};

} // namespace

std::vector<Polyline> EvenlySpacedLines(const PlaneField& field, double separation)
{
  const double weakest = 0.01 * MeanMagnitude(field);
  if (!(weakest > 0) || field.nx < 2 || field.ny < 2)
  {
    return {};
  }
  const Sampler sampler(field);
  const double step = std::clamp(separation / 8, 0.2, 0.7);
  const double closest = 0.5 * separation;
  Buckets buckets(field.nx, field.ny, separation);

  const auto direction = [&](const Point2& p, Point2& unit)
  {
    const Point2 q = sampler.At(p);
    const double size = std::hypot(q[0], q[1]);
    if (!(size > weakest))
    {
      return false;
    }
    unit = { q[0] / size, q[1] / size };
    return true;
  };
  const auto trace = [&](Point2 p, double sign)
  {
    Polyline half;
    const int longest = static_cast<int>(4.0 * (field.nx + field.ny) / step);
    const int lag = static_cast<int>(2 * separation / step); // points of the line's own past that do not count as near
    Buckets own(field.nx, field.ny, separation);
    for (int k = 0; k < longest; ++k)
    {
      Point2 first;
      Point2 second;
      if (!direction(p, first) ||
        !direction({ p[0] + 0.5 * sign * step * first[0], p[1] + 0.5 * sign * step * first[1] }, second))
      {
        break;
      }
      p = { p[0] + sign * step * second[0], p[1] + sign * step * second[1] };
      if (p[0] < 0 || p[1] < 0 || p[0] > field.nx || p[1] > field.ny || !buckets.IsFree(p, closest) ||
        !own.IsFree(p, closest))
      {
        break;
      }
      half.push_back(p);
      if (k >= lag)
      {
        own.Add(half[static_cast<std::size_t>(k - lag)]);
      }
    }
    return half;
  };

  std::vector<Polyline> lines;
  std::vector<Point2> seeds;
  const auto grow = [&](const Point2& seed)
  {
    Point2 unit;
    if (seed[0] < 0 || seed[1] < 0 || seed[0] > field.nx || seed[1] > field.ny || !buckets.IsFree(seed, separation) ||
      !direction(seed, unit))
    {
      return;
    }
    Polyline line = trace(seed, -1);
    std::reverse(line.begin(), line.end());
    line.push_back(seed);
    const Polyline forward = trace(seed, 1);
    line.insert(line.end(), forward.begin(), forward.end());
    if (static_cast<double>(line.size()) * step < 2 * separation)
    {
      return;
    }
    for (std::size_t i = 0; i < line.size(); ++i)
    {
      buckets.Add(line[i]);
      Point2 along;
      if (i % 8 == 0 && direction(line[i], along))
      {
        const double d = 1.01 * separation;
        seeds.push_back({ line[i][0] - d * along[1], line[i][1] + d * along[0] });
        seeds.push_back({ line[i][0] + d * along[1], line[i][1] - d * along[0] });
      }
    }
    lines.push_back(std::move(line));
  };
  // Every empty corner gets a line of its own; beside it the next ones grow.
  for (double y = 0.5 * separation; y < field.ny; y += separation)
  {
    for (double x = 0.5 * separation; x < field.nx; x += separation)
    {
      grow({ x, y });
      for (std::size_t i = 0; i < seeds.size(); ++i) // grows while it runs
      {
        grow(Point2(seeds[i]));
      }
      seeds.clear();
    }
  }
  return lines;
}

} // namespace lamella::rendering
