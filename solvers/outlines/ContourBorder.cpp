#include "outlines/ContourBorder.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

struct End
{
  double at;
  std::size_t chain;
  bool begin;
};

/// The picture's corners between two places on its border, counter-clockwise; going once around where `from` is not
/// before `to`.
void addCorners(const std::array<double, 2>& size, double from, double to, std::vector<Point>& points)
{
  const double w = size[0];
  const double h = size[1];
  const double around = 2 * (w + h);
  if (to < from)
    to += around;
  const std::array<std::pair<double, Point>, 4> corner{ { { w, { w, 0 } }, { w + h, { w, h } }, { 2 * w + h, { 0, h } },
    { around, { 0, 0 } } } };
  for (const double turn : { 0.0, around })
  {
    for (const auto& [at, point] : corner)
      if (at + turn > from && at + turn < to)
        points.push_back(point);
  }
}

} // namespace

std::optional<double> borderPosition(const std::array<double, 2>& size, const Point& point)
{
  const double near = 1e-9 * (size[0] + size[1]);
  const auto [x, y] = point;
  if (!(x >= -near && x <= size[0] + near && y >= -near && y <= size[1] + near))
    return {};
  if (std::abs(y) <= near)
    return std::clamp(x, 0.0, size[0]);
  if (std::abs(x - size[0]) <= near)
    return size[0] + std::clamp(y, 0.0, size[1]);
  if (std::abs(y - size[1]) <= near)
    return size[0] + size[1] + std::clamp(size[0] - x, 0.0, size[0]);
  if (std::abs(x) <= near)
    return 2 * size[0] + size[1] + std::clamp(size[1] - y, 0.0, size[1]);
  return {};
}

double polygonArea(const std::vector<Point>& points)
{
  if (points.size() < 3)
    return 0;
  const Point& origin = points.front(); // near the polygon: less round-off
  double twice = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
  {
    twice += (points[i][0] - origin[0]) * (points[i + 1][1] - origin[1]) -
      (points[i + 1][0] - origin[0]) * (points[i][1] - origin[1]);
  }
  return twice / 2;
}

bool holds(const std::vector<Point>& polygon, const Point& point)
{
  bool inside = false;
  const Point* last = &polygon.back();
  for (const Point& p : polygon)
  {
    if ((p[1] > point[1]) != ((*last)[1] > point[1]) &&
      point[0] < p[0] + (point[1] - p[1]) * ((*last)[0] - p[0]) / ((*last)[1] - p[1]))
      inside = !inside;
    last = &p;
  }
  return inside;
}

std::vector<Outline> outlines(const ContourSet& set)
{
  std::vector<End> ends;
  for (std::size_t i = 0; i < set.contours.size(); ++i)
  {
    const Contour& c = set.contours[i];
    if (c.closed)
      continue;
    if (c.points.size() < 2)
      throw InputError(fmt::format("open contour {} has {} points", i + 1, c.points.size()), "it needs two or more");
    for (const bool begin : { true, false })
    {
      const Point& p = begin ? c.points.front() : c.points.back();
      const std::optional<double> at = borderPosition(set.size, p);
      if (!at)
      {
        throw InputError(fmt::format("open contour {} ends at ({:g}, {:g}) m, inside a picture of {:g} × {:g} m", i + 1,
                           p[0], p[1], set.size[0], set.size[1]),
          "open contours begin and end on the picture's border; close those that do not");
      }
      ends.push_back({ *at, i, begin });
    }
  }
  // Where an end and a begin share a place, the lumen has no border between them.
  std::sort(ends.begin(), ends.end(),
    [](const End& a, const End& b) { return a.at != b.at ? a.at < b.at : a.begin < b.begin; });
  std::vector<std::size_t> next(set.contours.size());
  std::vector<double> beginAt(set.contours.size());
  std::vector<double> endAt(set.contours.size());
  for (std::size_t k = 0; k < ends.size(); ++k)
  {
    const End& a = ends[k];
    const End& b = ends[(k + 1) % ends.size()];
    if (a.begin == b.begin)
    {
      throw InputError(fmt::format("along the border contours {} and {} both {} with no other between them",
                         a.chain + 1, b.chain + 1, a.begin ? "begin" : "end"),
        "open contours have their lumen on the left: turn those that do not, and look for some that cross");
    }
    (a.begin ? beginAt : endAt)[a.chain] = a.at;
    if (!a.begin)
      next[a.chain] = b.chain;
  }
  std::vector<Outline> all;
  std::vector<bool> done(set.contours.size(), false);
  for (std::size_t i = 0; i < set.contours.size(); ++i)
  {
    if (done[i])
      continue;
    Outline outline;
    outline.lumen = set.contours[i].lumen;
    outline.open = !set.contours[i].closed;
    for (std::size_t k = i; !done[k];)
    {
      done[k] = true;
      outline.chains.push_back(k);
      const Contour& c = set.contours[k];
      outline.points.insert(outline.points.end(), c.points.begin(), c.points.end());
      if (outline.open)
      {
        addCorners(set.size, endAt[k], beginAt[next[k]], outline.points);
        k = next[k];
      }
    }
    all.push_back(std::move(outline));
  }
  return all;
}

void numberLumens(ContourSet& set)
{
  std::int32_t number = 0;
  for (const Outline& outline : outlines(set))
  {
    ++number;
    for (const std::size_t k : outline.chains)
      set.contours[k].lumen = number;
  }
}

} // namespace lamella::micrograph
