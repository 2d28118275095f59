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
          if (Distance(p, other) < distance)
            return false;
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

/// Lines that grow beside each other.
class Growing
{
public:
  Growing(const PlaneField& field, double separation, double weakest)
    : Field(field)
    , Separation(separation)
    , Weakest(weakest)
    , Step(std::clamp(separation / 8, 0.2, 0.7))
    , Closest(0.5 * separation)
    , Values(field)
    , Taken(field.nx, field.ny, separation)
  {
  }

  /// A line through here, if there is room for it; then those that grow beside it.
  void GrowFrom(const Point2& seed)
  {
    this->Grow(seed);
    for (std::size_t i = 0; i < this->Seeds.size(); ++i) // grows while it runs
      this->Grow(Point2(this->Seeds[i]));
    this->Seeds.clear();
  }

  std::vector<Polyline> Lines;

private:
  bool Direction(const Point2& p, Point2& unit) const
  {
    const Point2 q = this->Values.At(p);
    const double size = std::hypot(q[0], q[1]);
    if (!(size > this->Weakest))
      return false;
    unit = { q[0] / size, q[1] / size };
    return true;
  }

  bool Outside(const Point2& p) const { return p[0] < 0 || p[1] < 0 || p[0] > this->Field.nx || p[1] > this->Field.ny; }

  /// One way, by the midpoint rule.
  Polyline Trace(Point2 p, double sign) const
  {
    Polyline half;
    const double step = this->Step;
    const int longest = static_cast<int>(4.0 * (this->Field.nx + this->Field.ny) / step);
    const int lag = static_cast<int>(2 * this->Separation / step); // points of its own past that do not count as near
    Buckets own(this->Field.nx, this->Field.ny, this->Separation);
    for (int k = 0; k < longest; ++k)
    {
      Point2 first;
      Point2 second;
      if (!this->Direction(p, first) ||
        !this->Direction({ p[0] + 0.5 * sign * step * first[0], p[1] + 0.5 * sign * step * first[1] }, second))
        break;
      p = { p[0] + sign * step * second[0], p[1] + sign * step * second[1] };
      if (this->Outside(p) || !this->Taken.IsFree(p, this->Closest) || !own.IsFree(p, this->Closest))
        break;
      half.push_back(p);
      if (k >= lag)
        own.Add(half[static_cast<std::size_t>(k - lag)]);
    }
    return half;
  }

  void Grow(const Point2& seed)
  {
    Point2 unit;
    if (this->Outside(seed) || !this->Taken.IsFree(seed, this->Separation) || !this->Direction(seed, unit))
      return;
    Polyline line = this->Trace(seed, -1);
    std::reverse(line.begin(), line.end());
    line.push_back(seed);
    const Polyline forward = this->Trace(seed, 1);
    line.insert(line.end(), forward.begin(), forward.end());
    if (static_cast<double>(line.size()) * this->Step < 2 * this->Separation)
      return;
    for (std::size_t i = 0; i < line.size(); ++i)
    {
      this->Taken.Add(line[i]);
      Point2 along;
      if (i % 8 == 0 && this->Direction(line[i], along))
      {
        const double d = 1.01 * this->Separation;
        this->Seeds.push_back({ line[i][0] - d * along[1], line[i][1] + d * along[0] });
        this->Seeds.push_back({ line[i][0] + d * along[1], line[i][1] - d * along[0] });
      }
    }
    this->Lines.push_back(std::move(line));
  }

  const PlaneField& Field;
  double Separation;
  double Weakest;
  double Step;
  double Closest;
  Sampler Values;
  Buckets Taken;
  std::vector<Point2> Seeds;
};

} // namespace

std::vector<Polyline> EvenlySpacedLines(const PlaneField& field, double separation)
{
  const double weakest = 0.01 * MeanMagnitude(field);
  if (!(weakest > 0) || field.nx < 2 || field.ny < 2)
    return {};
  Growing growing(field, separation, weakest);
  // Every empty corner gets a line of its own; beside it the next ones grow.
  for (double y = 0.5 * separation; y < field.ny; y += separation)
    for (double x = 0.5 * separation; x < field.nx; x += separation)
      growing.GrowFrom({ x, y });
  return std::move(growing.Lines);
}

} // namespace lamella::rendering
