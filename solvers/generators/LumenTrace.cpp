#include "generators/LumenTrace.h"

#include <algorithm>
#include <cmath>

namespace lamella::generators
{

using micrograph::Point;

namespace
{

struct Ray
{
  double x, y; ///< direction
  double r;
};

Point at(double middleX, double middleY, const Ray& ray)
{
  return { middleX + ray.r * ray.x, middleY + ray.r * ray.y };
}

/// Adds the points between two directions, the first one's own included.
void refine(std::vector<Point>& points, double middleX, double middleY, const Radius& radius, const Ray& from,
  const Ray& to, double tolerance, int level)
{
  const double sumX = from.x + to.x;
  const double sumY = from.y + to.y;
  const double length = std::sqrt(sumX * sumX + sumY * sumY);
  Ray middle{ sumX / length, sumY / length, 0 };
  middle.r = radius(middle.x, middle.y);
  const Point a = at(middleX, middleY, from);
  const Point b = at(middleX, middleY, to);
  const Point m = at(middleX, middleY, middle);
  const double dx = b[0] - a[0];
  const double dy = b[1] - a[1];
  const double chord = std::sqrt(dx * dx + dy * dy);
  const double off = std::abs(dx * (m[1] - a[1]) - dy * (m[0] - a[0]));
  // A chord may cross the outline in its middle and yet miss it: the first levels are always divided.
  if ((off <= tolerance * chord && level > 1) || level > 14)
  {
    points.push_back(a);
    return;
  }
  refine(points, middleX, middleY, radius, from, middle, tolerance, level + 1);
  refine(points, middleX, middleY, radius, middle, to, tolerance, level + 1);
}

} // namespace

std::vector<Point> trace(double middleX, double middleY, const Radius& radius, double tolerance)
{
  constexpr int parts = 16;
  std::array<Ray, parts> rays;
  for (int i = 0; i < parts; ++i)
  {
    // Not along the axes, where the corners of rectangles are alike on both sides.
    const auto [x, y] = onCircle((i + 0.37) / parts);
    rays[static_cast<std::size_t>(i)] = { x, y, radius(x, y) };
    if (!(rays[static_cast<std::size_t>(i)].r > 0))
      return {};
  }
  std::vector<Point> points;
  for (std::size_t i = 0; i < parts; ++i)
    refine(points, middleX, middleY, radius, rays[i], rays[(i + 1) % parts], tolerance, 0);
  return points;
}

std::vector<Point> traceConvex(
  std::span<const CellSide> sides, double fillet, double depth, double middleX, double middleY, double tolerance)
{
  const auto radius = [&](double directionX, double directionY)
  {
    // With dᵢ(s) = dᵢ(0) + s vᵢ the sum is convex in s. It is below r² in the middle; Newton's method comes down from
    // where the first side has wall alone, beyond the outline.
    double s = 1e300;
    for (const CellSide& side : sides)
    {
      const double v = side.nx * directionX + side.ny * directionY;
      if (v < 0)
        s = std::min(s, (depth - side.distance(middleX, middleY)) / v);
    }
    if (!(s > 0) || fillet <= 0)
      return std::max(0.0, s);
    for (int step = 0; step < 60; ++step)
    {
      double excess = -fillet * fillet;
      double slope = 0;
      for (const CellSide& side : sides)
      {
        const double v = side.nx * directionX + side.ny * directionY;
        const double reach = depth + fillet - side.distance(middleX, middleY) - s * v;
        if (reach > 0)
        {
          excess += reach * reach;
          slope -= 2 * reach * v;
        }
      }
      if (excess <= 1e-12 * fillet * fillet || !(slope > 0))
        break;
      s -= excess / slope;
    }
    return std::max(0.0, s);
  };
  std::vector<double> distances;
  for (const CellSide& side : sides)
    distances.push_back(side.distance(middleX, middleY));
  if (wallDepth(distances, fillet) <= depth)
    return {};
  return trace(middleX, middleY, radius, tolerance);
}

bool addShown(micrograph::ContourSet& set, std::span<const Point> outline, std::int32_t lumen)
{
  const auto inside = [&](const Point& p) { return p[0] > 0 && p[1] > 0 && p[0] < set.size[0] && p[1] < set.size[1]; };
  if (outline.size() < 3)
    return false;
  if (std::all_of(outline.begin(), outline.end(), inside))
  {
    set.contours.push_back({ { outline.begin(), outline.end() }, true, lumen });
    return true;
  }
  // The part of every segment inside (Liang and Barsky 1984); parts that join make a chain. Starting at a point
  // outside no chain is cut in two.
  const std::size_t n = outline.size();
  const auto start =
    static_cast<std::size_t>(std::find_if_not(outline.begin(), outline.end(), inside) - outline.begin());
  bool open = false;
  bool any = false;
  for (std::size_t i = 0; i < n; ++i)
  {
    const Point& a = outline[(start + i) % n];
    const Point& b = outline[(start + i + 1) % n];
    double t0 = 0;
    double t1 = 1;
    int side0 = -1; // which border cuts
    int side1 = -1;
    for (int axis = 0; axis < 2; ++axis)
    {
      const double d = b[axis] - a[axis];
      for (int end = 0; end < 2; ++end)
      {
        const double border = end == 0 ? 0.0 : set.size[axis];
        const double into = end == 0 ? d : -d;                              // rising inwards
        const double away = end == 0 ? a[axis] - border : border - a[axis]; // positive inside
        if (into == 0)
        {
          t1 = away <= 0 ? -1 : t1;
        }
        else if (const double t = -away / into; into > 0 && t > t0)
        {
          t0 = t;
          side0 = 2 * axis + end;
        }
        else if (into < 0 && t < t1)
        {
          t1 = t;
          side1 = 2 * axis + end;
        }
      }
    }
    if (!(t0 < t1))
      continue;
    const auto point = [&](double t, int side)
    {
      Point p{ a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) };
      if (side >= 0)
        p[side / 2] = side % 2 == 0 ? 0.0 : set.size[static_cast<std::size_t>(side / 2)];
      return p;
    };
    if (!open || side0 >= 0)
    {
      set.contours.push_back({ { point(t0, side0) }, false, lumen });
      any = true;
    }
    set.contours.back().points.push_back(side1 >= 0 ? point(t1, side1) : b);
    open = side1 < 0;
  }
  return any;
}

double areaOf(std::span<const Point> polygon) noexcept
{
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Point& a = polygon[i];
    const Point& b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    area += a[0] * b[1] - b[0] * a[1];
  }
  return area / 2;
}

double areaShown(std::span<const Point> polygon, std::array<double, 2> size)
{
  const auto inside = [&](const Point& p) { return p[0] >= 0 && p[1] >= 0 && p[0] <= size[0] && p[1] <= size[1]; };
  if (std::all_of(polygon.begin(), polygon.end(), inside))
    return areaOf(polygon);
  std::vector<Corner> corners;
  for (const Point& p : polygon)
    corners.push_back({ p[0], p[1], -1 });
  std::vector<Corner> spare;
  clip(corners, spare, 1, 0, 0, 0);
  clip(corners, spare, -1, 0, size[0], 0);
  clip(corners, spare, 0, 1, 0, 0);
  clip(corners, spare, 0, -1, size[1], 0);
  std::vector<Point> shown;
  for (const Corner& corner : corners)
    shown.push_back({ corner.x, corner.y });
  return areaOf(shown);
}

} // namespace lamella::generators
