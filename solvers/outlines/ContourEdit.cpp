#include "outlines/ContourEdit.h"

#include "core/Error.h"
#include "outlines/ContourBorder.h"
#include "outlines/ContourCheck.h"
#include "outlines/ContourMeasures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lamella::micrograph
{
namespace
{

[[nodiscard]] double squaredDistance(const Point& p, const Point& a, const Point& b)
{
  const double dx = b[0] - a[0];
  const double dy = b[1] - a[1];
  const double length = dx * dx + dy * dy;
  const double t = length > 0 ? std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length, 0.0, 1.0) : 0.0;
  const double ex = p[0] - a[0] - t * dx;
  const double ey = p[1] - a[1] - t * dy;
  return ex * ex + ey * ey;
}

/// Marks the points to keep between two that are kept; `last` may be points.size(), which is the first again.
void mark(
  const std::vector<Point>& points, std::size_t first, std::size_t last, double tolerance, std::vector<bool>& keep)
{
  std::vector<std::pair<std::size_t, std::size_t>> open{ { first, last } };
  while (!open.empty())
  {
    const auto [from, to] = open.back();
    open.pop_back();
    double farthest = tolerance * tolerance;
    std::size_t at = from;
    const Point& end = points[to % points.size()];
    for (std::size_t i = from + 1; i < to; ++i)
    {
      const double d = squaredDistance(points[i], points[from], end);
      if (d > farthest)
      {
        farthest = d;
        at = i;
      }
    }
    if (at != from)
    {
      keep[at] = true;
      open.emplace_back(from, at);
      open.emplace_back(at, to);
    }
  }
}

/// Area left of a chain; of an open one with the chord from its end to its begin.
[[nodiscard]] double chainArea(const Contour& c)
{
  return polygonArea(c.points);
}

/// Moves points along the normals at them until the area is the target's: a quadratic equation in the distance.
/// @returns whether that was no farther than `most`
[[nodiscard]] bool moveToArea(Contour& c, double target, double most)
{
  const std::size_t n = c.points.size();
  std::vector<Point> way(n, Point{ 0, 0 });
  for (std::size_t i = c.closed ? 0 : 1; i < (c.closed ? n : n - 1); ++i)
  {
    const Point& a = c.points[i == 0 ? n - 1 : i - 1];
    const Point& b = c.points[i + 1 < n ? i + 1 : 0];
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    if (length > 0)
      way[i] = { (b[1] - a[1]) / length, -(b[0] - a[0]) / length }; // to the right: away from the lumen
  }
  for (int round = 0; round < 3; ++round)
  {
    const double missing = target - chainArea(c);
    double linear = 0; // twice the area's first and second derivative
    double square = 0;
    for (std::size_t i = 0; i < n; ++i)
    {
      const std::size_t k = i + 1 < n ? i + 1 : 0;
      const Point& p = c.points[i];
      const Point& q = c.points[k];
      linear += way[i][0] * (q[1] - c.points[0][1]) - (q[0] - c.points[0][0]) * way[i][1] +
        (p[0] - c.points[0][0]) * way[k][1] - way[k][0] * (p[1] - c.points[0][1]);
      square += way[i][0] * way[k][1] - way[k][0] * way[i][1];
    }
    // square d² + linear d = 2 missing, the root near 0.
    const double inner = linear * linear + 8 * square * missing;
    if (linear == 0 || inner < 0)
      return missing == 0;
    const double d = 4 * missing / (linear + std::copysign(std::sqrt(inner), linear));
    if (!(std::abs(d) <= most))
      return false;
    for (std::size_t i = 0; i < n; ++i)
    {
      c.points[i][0] += d * way[i][0];
      c.points[i][1] += d * way[i][1];
    }
  }
  return true;
}

[[nodiscard]] Contour simplified(const Contour& c, const Point& size, double tolerance)
{
  const std::size_t n = c.points.size();
  const std::size_t least = c.closed ? 4 : 2;
  if (n <= least)
    return c;
  std::vector<bool> keep(n, false);
  keep[0] = true;
  if (c.closed)
  {
    const auto far = std::max_element(c.points.begin(), c.points.end(),
      [&](const Point& a, const Point& b)
      {
        return std::hypot(a[0] - c.points[0][0], a[1] - c.points[0][1]) <
          std::hypot(b[0] - c.points[0][0], b[1] - c.points[0][1]);
      });
    const auto middle = static_cast<std::size_t>(far - c.points.begin());
    keep[middle] = true;
    mark(c.points, 0, middle, tolerance, keep);
    mark(c.points, middle, n, tolerance, keep);
  }
  else
  {
    keep[n - 1] = true;
    keep[n / 2] = true; // one to move for the area's sake
    mark(c.points, 0, n / 2, tolerance, keep);
    mark(c.points, n / 2, n - 1, tolerance, keep);
  }
  Contour result{ {}, c.closed, c.lumen };
  for (std::size_t i = 0; i < n; ++i)
    if (keep[i])
      result.points.push_back(c.points[i]);
  if (result.points.size() < least)
    return c;
  // Where the area cannot be had again nearby, or only outside the picture, the chain stays as it was.
  const bool inside = moveToArea(result, chainArea(c), 2 * tolerance) &&
    std::all_of(result.points.begin(), result.points.end(),
      [&](const Point& p) { return p[0] >= 0 && p[1] >= 0 && p[0] <= size[0] && p[1] <= size[1]; });
  return inside ? result : c;
}

} // namespace

ContourSet simplify(const ContourSet& set, double tolerance, SimplifyReport* report)
{
  SimplifyReport seen;
  const auto points = [](const ContourSet& s)
  {
    std::int64_t sum = 0;
    for (const Contour& c : s.contours)
      sum += static_cast<std::int64_t>(c.points.size());
    return sum;
  };
  seen.before = points(set);
  ContourSet result{ set.size, {} };
  result.contours.reserve(set.contours.size());
  for (const Contour& c : set.contours)
    result.contours.push_back(tolerance > 0 ? simplified(c, set.size, tolerance) : c);
  if (tolerance > 0)
  {
    // A chain that was put back may meet one that was not: again, until nothing crosses. Each round puts some back.
    std::vector<bool> back(set.contours.size(), false);
    for (bool changed = true; changed;)
    {
      changed = false;
      for (const ContourFinding& f : findCrossings(result))
      {
        for (const std::size_t k : { f.contour, f.other })
        {
          if (!back[k])
          {
            back[k] = changed = true;
            result.contours[k] = set.contours[k];
            ++seen.kept;
          }
        }
      }
    }
  }
  seen.after = points(result);
  if (report != nullptr)
    *report = seen;
  return result;
}

ContourSet filterLumens(const ContourSet& set, const LumenFilter& filter, FilterReport* report)
{
  if (!(filter.smallestArea >= 0))
  {
    throw ParameterError(
      fmt::format("the smallest lumen's area is {:g} m²", filter.smallestArea), "give 0 (all) or a positive area");
  }
  if (!(filter.leastSolidity >= 0 && filter.leastSolidity <= 1))
    throw ParameterError(fmt::format("the least solidity is {:g}", filter.leastSolidity), "give one from 0 to 1");
  FilterReport seen;
  std::map<std::int32_t, bool> keep;
  for (const LumenMeasures& m : measureLumens(set))
  {
    bool kept = true;
    if (m.area < filter.smallestArea)
    {
      kept = false;
      ++seen.small;
      seen.smallArea += m.area;
    }
    else if (!m.open && m.solidity < filter.leastSolidity)
    {
      kept = false;
      ++seen.ragged;
      seen.raggedArea += m.area;
    }
    keep[m.lumen] = kept;
  }
  ContourSet result{ set.size, {} };
  std::map<std::int32_t, std::int32_t> number;
  for (const Contour& c : set.contours)
  {
    if (keep[c.lumen])
    {
      result.contours.push_back(c);
      const auto next = static_cast<std::int32_t>(number.size() + 1);
      result.contours.back().lumen = number.try_emplace(c.lumen, next).first->second;
    }
  }
  if (report != nullptr)
    *report = seen;
  return result;
}

} // namespace lamella::micrograph
