#include "outlines/ContourEdges.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

/// Where a point lies along the border, counter-clockwise from the lower left corner, and how far from it.
struct Place
{
  double along = 0;
  double away = 0;
};

Place borderPlace(const Point& point, const std::array<double, 2>& size)
{
  const double x = std::clamp(point[0], 0.0, size[0]);
  const double y = std::clamp(point[1], 0.0, size[1]);
  const std::array<Place, 4> sides{ { { x, std::abs(point[1]) }, { size[0] + y, std::abs(point[0] - size[0]) },
    { 2 * size[0] + size[1] - x, std::abs(point[1] - size[1]) },
    { 2 * (size[0] + size[1]) - y, std::abs(point[0]) } } };
  Place best =
    *std::min_element(sides.begin(), sides.end(), [](const Place& a, const Place& b) { return a.away < b.away; });
  best.away = std::max({ best.away, std::abs(point[0] - x), std::abs(point[1] - y) });
  return best;
}

struct ChainEnd
{
  double along = 0;
  bool begins = false;
  std::size_t chain = 0;
};

[[noreturn]] void wrongChain(std::size_t chain, const std::string& what)
{
  throw InputError(fmt::format("contour {} {}", chain + 1, what),
    "closed chains have three points or more; open ones begin and end on the border, with the lumen on their left");
}

void checkChain(const Contour& contour, std::size_t number)
{
  if (contour.points.size() < (contour.closed ? 3U : 2U))
  {
    wrongChain(
      number, fmt::format("is {} and has {} points", contour.closed ? "closed" : "open", contour.points.size()));
  }
  if (contour.lumen < 1)
    wrongChain(number, fmt::format("belongs to lumen {}; lumens are numbered from 1", contour.lumen));
  for (const Point& point : contour.points)
    if (!std::isfinite(point[0]) || !std::isfinite(point[1]))
      wrongChain(number, fmt::format("has a point at ({}, {})", point[0], point[1]));
}

/// Ends and begins of the open chains along the border, checked to alternate.
std::vector<ChainEnd> borderOrder(const ContourSet& set)
{
  const double tolerance = 1e-6 * std::max(set.size[0], set.size[1]);
  std::vector<ChainEnd> ends;
  for (std::size_t chain = 0; chain < set.contours.size(); ++chain)
  {
    const Contour& contour = set.contours[chain];
    checkChain(contour, chain);
    if (contour.closed)
      continue;
    for (const bool begins : { false, true })
    {
      const Point& point = begins ? contour.points.front() : contour.points.back();
      const Place place = borderPlace(point, set.size);
      if (place.away > tolerance)
      {
        wrongChain(chain,
          fmt::format("is open and {} at ({:.6g}, {:.6g}) m, {:.3g} m from the border", begins ? "begins" : "ends",
            point[0], point[1], place.away));
      }
      // Rounded, so that chains that meet on the border to within round-off meet in this order: one ends, one begins.
      ends.push_back({ std::round(place.along / tolerance) * tolerance, begins, chain });
    }
  }
  std::stable_sort(ends.begin(), ends.end(),
    [](const ChainEnd& a, const ChainEnd& b)
    { return a.along < b.along || (a.along == b.along && b.begins && !a.begins); });
  return ends;
}

/// Next after `from` along the border, around its corner.
std::size_t next(const std::vector<ChainEnd>& ends, std::size_t from)
{
  return (from + 1) % ends.size();
}

void closeAlongBorder(const ContourSet& set, const std::vector<ChainEnd>& ends, std::vector<ContourEdge>& edges)
{
  const double width = set.size[0];
  const double height = set.size[1];
  const double around = 2 * (width + height);
  const std::array<double, 4> cornerAt{ width, width + height, 2 * width + height, around };
  const std::array<Point, 4> corner{ { { width, 0 }, { width, height }, { 0, height }, { 0, 0 } } };
  for (std::size_t i = 0; i < ends.size(); ++i)
  {
    if (ends[i].begins)
      continue;
    const ChainEnd& begin = ends[next(ends, i)];
    const Contour& from = set.contours[ends[i].chain];
    const Contour& to = set.contours[begin.chain];
    if (!begin.begins || from.lumen != to.lumen)
    {
      const Point& point = from.points.back();
      wrongChain(ends[i].chain,
        fmt::format("ends at ({:.6g}, {:.6g}) m, from where the border leads to {} of contour {}, "
                    "lumen {} instead of {}",
          point[0], point[1], begin.begins ? "the begin" : "the end", begin.chain + 1, to.lumen, from.lumen));
    }
    Point last = from.points.back();
    const double target = begin.along < ends[i].along ? begin.along + around : begin.along;
    for (int turn = 0; turn < 2; ++turn)
    {
      for (std::size_t c = 0; c < corner.size(); ++c)
      {
        const double at = cornerAt[c] + turn * around;
        if (at > ends[i].along && at < target)
        {
          edges.push_back({ last, corner[c], from.lumen, true });
          last = corner[c];
        }
      }
    }
    edges.push_back({ last, to.points.front(), from.lumen, true });
  }
}

} // namespace

std::vector<ContourEdge> closedEdges(const ContourSet& set, double scale)
{
  if (!(set.size[0] > 0) || !(set.size[1] > 0) || !std::isfinite(set.size[0] + set.size[1]))
  {
    throw ParameterError(fmt::format("contours of a picture of {} by {} m", set.size[0], set.size[1]),
      "give the picture's size in metres");
  }
  const std::vector<ChainEnd> ends = borderOrder(set);
  std::size_t count = 0;
  for (const Contour& contour : set.contours)
    count += contour.points.size();
  std::vector<ContourEdge> edges;
  edges.reserve(count + 3 * ends.size());
  for (const Contour& contour : set.contours)
  {
    const std::size_t n = contour.points.size();
    for (std::size_t i = 0; i + (contour.closed ? 0 : 1) < n; ++i)
      edges.push_back({ contour.points[i], contour.points[(i + 1) % n], contour.lumen, false });
  }
  closeAlongBorder(set, ends, edges);
  std::erase_if(edges, [](const ContourEdge& edge) { return edge.from == edge.to; });
  for (ContourEdge& edge : edges)
  {
    edge.from = { edge.from[0] * scale, edge.from[1] * scale };
    edge.to = { edge.to[0] * scale, edge.to[1] * scale };
  }
  return edges;
}

void checkContours(const ContourSet& set)
{
  static_cast<void>(closedEdges(set));
}

} // namespace lamella::micrograph
