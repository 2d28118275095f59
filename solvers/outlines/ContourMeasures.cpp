#include "outlines/ContourMeasures.h"

#include "outlines/ContourBorder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamella::micrograph
{
namespace
{

[[nodiscard]] double cross(const Point& o, const Point& a, const Point& b)
{
  return (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]);
}

[[nodiscard]] double distance(const Point& a, const Point& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

[[nodiscard]] LumenMeasures measure(const Outline& outline, const ContourSet& set)
{
  LumenMeasures m;
  m.lumen = outline.lumen;
  m.open = outline.open;
  const std::vector<Point>& p = outline.points;
  // Moments about the first point, then moved to the centroid.
  const Point& origin = p.front();
  double twice = 0;
  double sx = 0;
  double sy = 0;
  double sxx = 0;
  double syy = 0;
  double sxy = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
  {
    const Point& next = p[i + 1 < p.size() ? i + 1 : 0];
    m.perimeter += distance(p[i], next);
    const double ax = p[i][0] - origin[0];
    const double ay = p[i][1] - origin[1];
    const double bx = next[0] - origin[0];
    const double by = next[1] - origin[1];
    const double c = ax * by - bx * ay;
    twice += c;
    sx += c * (ax + bx);
    sy += c * (ay + by);
    sxx += c * (ax * ax + ax * bx + bx * bx);
    syy += c * (ay * ay + ay * by + by * by);
    sxy += c * (ax * by + 2 * ax * ay + 2 * bx * by + bx * ay);
  }
  for (const std::size_t k : outline.chains)
  {
    const Contour& chain = set.contours[k];
    for (std::size_t i = 1; i < chain.points.size(); ++i)
      m.wallLength += distance(chain.points[i - 1], chain.points[i]);
    m.wallLength += chain.closed ? distance(chain.points.back(), chain.points.front()) : 0.0;
  }
  m.area = twice / 2;
  if (m.area == 0)
  {
    m.centroid = origin;
    return m;
  }
  const double cx = sx / (3 * twice);
  const double cy = sy / (3 * twice);
  m.centroid = { origin[0] + cx, origin[1] + cy };
  m.equivalentDiameter = 2 * std::sqrt(std::abs(m.area) / std::numbers::pi);
  const double xx = sxx / (6 * twice) - cx * cx;
  const double yy = syy / (6 * twice) - cy * cy;
  const double xy = sxy / (12 * twice) - cx * cy;
  const double mean = (xx + yy) / 2;
  const double apart = std::hypot((xx - yy) / 2, xy);
  m.major = 4 * std::sqrt(std::max(mean + apart, 0.0));
  m.minor = 4 * std::sqrt(std::max(mean - apart, 0.0));
  m.angle = std::atan2(2 * xy, xx - yy) / 2;
  const double hull = polygonArea(convexHull(p));
  m.solidity = hull > 0 ? std::clamp(m.area / hull, 0.0, 1.0) : 0.0;
  return m;
}

} // namespace

double leastWidth(const ContourSet& set)
{
  double length = 0;
  for (const LumenMeasures& lumen : measureLumens(set))
    length += lumen.wallLength;
  const double wall = wallFraction(set);
  return 2 * std::min(wall, 1 - wall) * set.size[0] * set.size[1] / length;
}

std::vector<Point> convexHull(std::vector<Point> points)
{
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3)
    return points;
  std::vector<Point> hull;
  const auto half = [&](auto from, auto to)
  {
    const std::size_t first = hull.size();
    for (auto p = from; p != to; ++p)
    {
      while (hull.size() >= first + 2 && cross(hull[hull.size() - 2], hull.back(), *p) <= 0)
        hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back(); // the other half begins with it
  };
  half(points.begin(), points.end());
  half(points.rbegin(), points.rend());
  return hull;
}

std::vector<LumenMeasures> measureLumens(const ContourSet& set)
{
  std::vector<LumenMeasures> all;
  for (const Outline& outline : outlines(set))
    all.push_back(measure(outline, set));
  return all;
}

double wallFraction(const ContourSet& set)
{
  double lumen = 0;
  for (const Outline& outline : outlines(set))
    lumen += polygonArea(outline.points);
  return 1 - lumen / (set.size[0] * set.size[1]);
}

} // namespace lamella::micrograph
