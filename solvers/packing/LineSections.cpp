// Lines along x through disks, spheres, trapezoids and truncated cones: all are convex, so each gives one interval.
#include "packing/LineSections.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lamella::packing
{
namespace
{

using Point = std::array<double, 3>;

struct Range
{
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double x)
  {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  void cut(double from, double to)
  {
    low = std::max(low, from);
    high = std::min(high, to);
  }
  [[nodiscard]] bool empty() const { return !(low < high); }
};

struct Shape
{
  Point first{};
  Point second{};         // bridges
  double firstRadius = 0; // of a bridge: half its width there
  double secondRadius = 0;
  std::int32_t grain = -1; // −1: a bridge
  Range planes;            // its extent along the last axis
  Range rows;              // 3D: along y
};

Range ofGrain(const Shape& s, int dimension, double y, double z)
{
  const double dy = y - s.first[1];
  const double dz = dimension == 3 ? z - s.first[2] : 0.0;
  const double square = s.firstRadius * s.firstRadius - dy * dy - dz * dz;
  if (square <= 0)
    return {};
  const double half = std::sqrt(square);
  return { s.first[0] - half, s.first[0] + half };
}

Range ofTrapezoid(const Shape& s, double y)
{
  const double dx = s.second[0] - s.first[0];
  const double dy = s.second[1] - s.first[1];
  const double length = std::hypot(dx, dy);
  const double nx = -dy / length;
  const double ny = dx / length;
  const std::array<std::array<double, 2>, 4> corner{
    { { s.first[0] + s.firstRadius * nx, s.first[1] + s.firstRadius * ny },
      { s.second[0] + s.secondRadius * nx, s.second[1] + s.secondRadius * ny },
      { s.second[0] - s.secondRadius * nx, s.second[1] - s.secondRadius * ny },
      { s.first[0] - s.firstRadius * nx, s.first[1] - s.firstRadius * ny } }
  };
  Range range;
  for (std::size_t i = 0; i < 4; ++i)
  {
    const auto& a = corner[i];
    const auto& b = corner[(i + 1) % 4];
    if ((a[1] <= y) == (b[1] <= y))
      continue;
    range.add(a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]));
  }
  return range;
}

// |p − c|² − s² ≤ (a + b s)² with s the distance along the axis, between the caps at s = 0 and s = L
Range ofCone(const Shape& s, double y, double z)
{
  Point axis{};
  double length = 0;
  for (std::size_t k = 0; k < 3; ++k)
  {
    axis[k] = s.second[k] - s.first[k];
    length += axis[k] * axis[k];
  }
  length = std::sqrt(length);
  for (double& value : axis)
    value /= length;
  const double a = s.firstRadius;
  const double b = (s.secondRadius - s.firstRadius) / length;
  // with x from the first centre: s = s0 + axis_x x
  const double dy = y - s.first[1];
  const double dz = z - s.first[2];
  const double s0 = axis[1] * dy + axis[2] * dz;
  Range slab{ -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity() };
  if (std::abs(axis[0]) > 1e-14)
    slab = { std::min(-s0 / axis[0], (length - s0) / axis[0]), std::max(-s0 / axis[0], (length - s0) / axis[0]) };
  else if (s0 < 0 || s0 > length)
    return {};
  // A x² + 2 B x + C ≤ 0
  const double quadratic = 1 - (1 + b * b) * axis[0] * axis[0];
  const double linear = -(1 + b * b) * s0 * axis[0] - a * b * axis[0];
  const double constant = dy * dy + dz * dz - (1 + b * b) * s0 * s0 - 2 * a * b * s0 - a * a;
  Range range = slab;
  if (std::abs(quadratic) < 1e-12)
  {
    if (std::abs(linear) > 1e-300)
    {
      const double at = -constant / (2 * linear);
      range.cut(linear > 0 ? -std::numeric_limits<double>::infinity() : at,
        linear > 0 ? at : std::numeric_limits<double>::infinity());
    }
    else if (constant > 0)
      return {};
  }
  else
  {
    const double discriminant = linear * linear - quadratic * constant;
    if (discriminant <= 0)
    {
      if (quadratic > 0)
        return {};
    }
    else
    {
      const double root = std::sqrt(discriminant);
      const double low = std::min((-linear - root) / quadratic, (-linear + root) / quadratic);
      const double high = std::max((-linear - root) / quadratic, (-linear + root) / quadratic);
      if (quadratic > 0)
        range.cut(low, high);
      else
      {
        // outside of both: between the caps only one of the two parts is left
        Range before = slab;
        before.cut(-std::numeric_limits<double>::infinity(), low);
        Range after = slab;
        after.cut(high, std::numeric_limits<double>::infinity());
        range = before.empty() ? after : before;
      }
    }
  }
  return { range.low + s.first[0], range.high + s.first[0] };
}

void setExtent(Shape& s, int dimension)
{
  for (int axis = 1; axis < dimension; ++axis)
  {
    const auto a = static_cast<std::size_t>(axis);
    Range& range = axis == dimension - 1 ? s.planes : s.rows;
    range.add(s.first[a] - s.firstRadius);
    range.add(s.first[a] + s.firstRadius);
    if (s.grain < 0)
    {
      range.add(s.second[a] - s.secondRadius);
      range.add(s.second[a] + s.secondRadius);
    }
  }
}

std::vector<Shape> shapesOf(const Packing& packing, std::span<const Bridge> bridges, double width)
{
  const int dimension = packing.dimension;
  std::vector<Shape> shapes;
  const auto addImages = [&](const Shape& original)
  {
    std::array<int, 3> reach{ 0, 0, 0 };
    for (int a = 0; a < dimension; ++a)
      reach[static_cast<std::size_t>(a)] = packing.periodic[static_cast<std::size_t>(a)] ? 1 : 0;
    for (int k = -reach[2]; k <= reach[2]; ++k)
      for (int j = -reach[1]; j <= reach[1]; ++j)
        for (int i = -reach[0]; i <= reach[0]; ++i)
        {
          Shape s = original;
          const std::array<int, 3> image{ i, j, k };
          bool inside = true;
          const double radius = std::max(s.firstRadius, s.secondRadius);
          for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
          {
            s.first[a] += image[a] * packing.size[a];
            s.second[a] += image[a] * packing.size[a];
            const double low = s.grain < 0 ? std::min(s.first[a], s.second[a]) : s.first[a];
            const double high = s.grain < 0 ? std::max(s.first[a], s.second[a]) : s.first[a];
            inside = inside && high + radius > 0 && low - radius < packing.size[a];
          }
          if (!inside)
            continue;
          setExtent(s, dimension);
          shapes.push_back(s);
        }
  };
  for (std::size_t i = 0; i < packing.count(); ++i)
  {
    Shape s;
    s.first = packing.centre[i];
    s.firstRadius = packing.radius[i];
    s.grain = static_cast<std::int32_t>(i);
    addImages(s);
  }
  if (width > 0)
    for (const Bridge& b : bridges)
    {
      Shape s;
      s.first = packing.centre[static_cast<std::size_t>(b.first)];
      s.second = packing.centre[static_cast<std::size_t>(b.second)];
      for (std::size_t a = 0; a < 3; ++a)
        s.second[a] += b.shift[a];
      if (s.first == s.second) // grains at one place: a bridge of no length
        continue;
      s.firstRadius = width * packing.radius[static_cast<std::size_t>(b.first)];
      s.secondRadius = width * packing.radius[static_cast<std::size_t>(b.second)];
      addImages(s);
    }
  std::sort(shapes.begin(), shapes.end(), [](const Shape& a, const Shape& b) { return a.planes.low < b.planes.low; });
  return shapes;
}

} // namespace

void forEachLine(const Packing& packing, std::span<const Bridge> bridges, double width, std::span<const double> rows,
  std::span<const double> planes,
  const std::function<void(std::size_t row, std::size_t plane, const LineSections&)>& visit)
{
  const int dimension = packing.dimension;
  const std::vector<Shape> shapes = shapesOf(packing, bridges, width);
  const std::size_t count = dimension == 3 ? rows.size() : 1;
  std::vector<LineSections> lines(count);
  std::vector<const Shape*> active;
  std::size_t next = 0;
  for (std::size_t plane = 0; plane < planes.size(); ++plane)
  {
    const double at = planes[plane];
    for (; next < shapes.size() && shapes[next].planes.low <= at; ++next)
      active.push_back(&shapes[next]);
    std::erase_if(active, [&](const Shape* s) { return s->planes.high < at; });
    for (LineSections& line : lines)
    {
      line.grains.clear();
      line.bridges.clear();
    }
    const auto add = [&](const Shape& s, std::size_t row, Range range)
    {
      range.cut(0, packing.size[0]);
      if (!range.empty())
        (s.grain < 0 ? lines[row].bridges : lines[row].grains).push_back({ range.low, range.high, s.grain });
    };
    for (const Shape* s : active)
    {
      if (dimension == 2)
      {
        add(*s, 0, s->grain < 0 ? ofTrapezoid(*s, at) : ofGrain(*s, 2, at, 0));
        continue;
      }
      auto row = static_cast<std::size_t>(std::lower_bound(rows.begin(), rows.end(), s->rows.low) - rows.begin());
      for (; row < count && rows[row] <= s->rows.high; ++row)
        add(*s, row, s->grain < 0 ? ofCone(*s, rows[row], at) : ofGrain(*s, 3, rows[row], at));
    }
    const auto byLow = [](const Section& a, const Section& b) { return a.low < b.low; };
    for (std::size_t row = 0; row < count; ++row)
    {
      std::sort(lines[row].grains.begin(), lines[row].grains.end(), byLow);
      std::sort(lines[row].bridges.begin(), lines[row].bridges.end(), byLow);
      visit(row, plane, lines[row]);
    }
  }
}

} // namespace lamella::packing
