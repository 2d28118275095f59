// Polygons cut by a picture's border.
#include "core/Error.h"
#include "outlines/ContourBorder.h"
#include "outlines/ContourEdit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

/// Which part of a segment lies inside (Liang and Barsky, ACM Trans. Graphics 3, 1984, 1–22).
struct Part
{
  bool any = false;
  Point from, to;
  bool enters = false; ///< `from` lies on the border, the segment's begin outside
  bool leaves = false; ///< likewise at the end
};

/// Inside and not on the border.
[[nodiscard]] bool inside(const Point& p, const Point& size)
{
  return p[0] > 0 && p[1] > 0 && p[0] < size[0] && p[1] < size[1];
}

[[nodiscard]] Part partInside(const Point& a, const Point& b, const Point& size)
{
  double from = 0;
  double to = 1;
  int fromSide = -1; // 2 · axis + (0 low, 1 high)
  int toSide = -1;
  for (int axis = 0; axis < 2; ++axis)
  {
    const auto k = static_cast<std::size_t>(axis);
    const double d = b[k] - a[k];
    for (int high = 0; high < 2; ++high)
    {
      const double limit = high != 0 ? size[k] : 0.0;
      const double room = high != 0 ? limit - a[k] : a[k] - limit; // inside: > 0
      const double way = high != 0 ? d : -d;                       // outwards: > 0
      if (way == 0)
      {
        if (room <= 0)
          return {};
      }
      else if (way < 0 && room <= 0 && room / way >= from)
      {
        from = room / way;
        fromSide = 2 * axis + high;
      }
      else if (way > 0 && room / way <= to)
      {
        to = room / way;
        toSide = 2 * axis + high;
      }
    }
  }
  if (!(from < to))
    return {};
  const auto at = [&](double t, int side)
  {
    Point p{ a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) };
    for (std::size_t k = 0; k < 2; ++k)
      p[k] = std::clamp(p[k], 0.0, size[k]);
    const auto k = static_cast<std::size_t>(side / 2);
    p[k] = side % 2 != 0 ? size[k] : 0.0;
    return p;
  };
  Part part;
  part.any = true;
  part.enters = fromSide >= 0;
  part.leaves = toSide >= 0;
  part.from = part.enters ? at(from, fromSide) : a;
  part.to = part.leaves ? at(to, toSide) : b;
  return part;
}

} // namespace

ContourSet clipToWindow(
  const std::vector<std::vector<Point>>& polygons, const Point& low, const Point& high, Covering covering)
{
  const Point size{ high[0] - low[0], high[1] - low[1] };
  ContourSet set{ size, {} };
  for (const std::vector<Point>& polygon : polygons)
  {
    std::vector<Point> p(polygon.size());
    std::transform(
      polygon.begin(), polygon.end(), p.begin(),
      [&](const Point& q) {
        return Point{ q[0] - low[0], q[1] - low[1] };
      });
    const bool whole = std::all_of(
      p.begin(), p.end(), [&](const Point& q) { return q[0] >= 0 && q[1] >= 0 && q[0] <= size[0] && q[1] <= size[1]; });
    if (whole)
    {
      set.contours.push_back({ std::move(p), true, 0 });
      continue;
    }
    // From a point outside, or on the border, all around; every chain begins and ends on the border.
    const auto start = static_cast<std::size_t>(
      std::find_if(p.begin(), p.end(), [&](const Point& q) { return !inside(q, size); }) - p.begin());
    Contour chain{ {}, false, 0 };
    const std::size_t before = set.contours.size();
    bool met = false;
    for (std::size_t i = 0; i < p.size(); ++i)
    {
      const Point& a = p[(start + i) % p.size()];
      const Point& b = p[(start + i + 1) % p.size()];
      const Part part = partInside(a, b, size);
      if (!part.any)
        continue;
      met = true;
      if (part.enters || chain.points.empty())
      {
        chain.points = { part.from };
        if (set.contours.size() > before && set.contours.back().points.back() == part.from)
        {
          chain = std::move(set.contours.back()); // the polygon only touches the border there
          set.contours.pop_back();
        }
      }
      if (part.to != chain.points.back())
        chain.points.push_back(part.to);
      if (part.leaves)
      {
        if (chain.points.size() > 1)
          set.contours.push_back(chain);
        chain.points.clear();
      }
    }
    if (set.contours.size() > before + 1 && set.contours.back().points.back() == set.contours[before].points.front())
    {
      std::vector<Point>& first = set.contours[before].points; // it touches where the way around began
      std::vector<Point> joined = std::move(set.contours.back().points);
      joined.insert(joined.end(), first.begin() + 1, first.end());
      first = std::move(joined);
      set.contours.pop_back();
    }
    if (covering == Covering::Refused && !met && holds(p, { size[0] / 2, size[1] / 2 }))
      throw InputError("one lumen covers the whole window", "give a window with walls in it");
  }
  numberLumens(set);
  return set;
}

ContourSet cropContours(const ContourSet& set, const Point& low, const Point& high)
{
  Point from = low;
  Point to = high;
  for (std::size_t k = 0; k < 2; ++k)
  {
    const double slack = 1e-9 * set.size[k]; // round-off of a window that ends where the picture does
    if (!(from[k] < to[k]) || !(from[k] >= -slack) || !(to[k] <= set.size[k] + slack))
    {
      throw ParameterError(fmt::format("the window {:g}, {:g} to {:g}, {:g} m does not lie in the picture of {:g} by "
                                       "{:g} m",
                             low[0], low[1], high[0], high[1], set.size[0], set.size[1]),
        "give a part of it, of some width and height");
    }
    from[k] = std::max(from[k], 0.0);
    to[k] = std::min(to[k], set.size[k]);
  }
  std::vector<std::vector<Point>> polygons;
  for (Outline& outline : outlines(set))
    polygons.push_back(std::move(outline.points));
  ContourSet part = clipToWindow(polygons, from, to);
  if (part.contours.empty())
    throw InputError("no outline lies in the window", "give a window with lumens in it");
  return part;
}

} // namespace lamella::micrograph
