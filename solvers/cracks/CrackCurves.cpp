#include "cracks/CrackCurves.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace lamella::cracks
{
namespace
{

Place operator-(const Place& a, const Place& b)
{
  return { a[0] - b[0], a[1] - b[1] };
}

double dot(const Place& a, const Place& b)
{
  return a[0] * b[0] + a[1] * b[1];
}

/// Where a curve comes to an end, and the way it goes there; seen from its last points.
struct Tail
{
  Place at{};
  Place direction{}; ///< of length one
};

Tail tailOf(const std::vector<Place>& points, bool last, const Place& corner)
{
  const std::size_t n = points.size();
  Tail tail;
  tail.at = last ? points[n - 1] : points[0];
  const std::size_t back = std::min<std::size_t>(n - 1, 2);
  const Place from = last ? points[n - 1 - back] : points[back];
  Place way = back > 0 ? tail.at - from : corner - tail.at;
  double length = std::sqrt(dot(way, way));
  if (length < 1e-9)
  {
    way = corner - tail.at;
    length = std::max(1e-9, std::sqrt(dot(way, way)));
  }
  tail.direction = { way[0] / length, way[1] / length };
  return tail;
}

/// The end of a line that goes on straight: on the picture's side, or beside the corner.
Place endOf(const Tail& tail, const Place& corner, ChainEnd kind, const Lattice& lattice)
{
  double further = std::clamp(dot(corner - tail.at, tail.direction), 0.0, 1.0);
  if (kind == ChainEnd::Border)
    for (std::size_t a = 0; a < 2; ++a)
    {
      const bool side = corner[a] == -0.5 || corner[a] == static_cast<double>(lattice.size[a]) - 0.5;
      if (side && std::abs(tail.direction[a]) > 0.3)
      {
        further = std::clamp((corner[a] - tail.at[a]) / tail.direction[a], 0.0, 2.0);
        break;
      }
    }
  return { tail.at[0] + further * tail.direction[0], tail.at[1] + further * tail.direction[1] };
}

/// The place that is nearest to all lines, least squares, and not far from the corner.
Place meeting(const std::vector<Tail>& tails, const Place& corner)
{
  constexpr double hold = 0.1;
  double xx = hold;
  double xy = 0;
  double yy = hold;
  Place right{ 0, 0 };
  for (const Tail& t : tails)
  {
    const Place normal{ -t.direction[1], t.direction[0] };
    const double height = dot(normal, t.at - corner);
    xx += normal[0] * normal[0];
    xy += normal[0] * normal[1];
    yy += normal[1] * normal[1];
    right[0] += normal[0] * height;
    right[1] += normal[1] * height;
  }
  const double det = xx * yy - xy * xy;
  Place move{ (yy * right[0] - xy * right[1]) / det, (xx * right[1] - xy * right[0]) / det };
  const double size = std::sqrt(dot(move, move));
  const double most = std::min(1.0, 1 / std::max(size, 1e-9));
  return { corner[0] + most * move[0], corner[1] + most * move[1] };
}

} // namespace

std::vector<CrackCurve> crackCurves(const Lattice& lattice, std::span<const CrackEdge> edges, const CrackGraph& graph)
{
  std::vector<StairCase> stairs;
  std::vector<CrackCurve> curves;
  std::map<std::int64_t, std::vector<Tail>> tails; // by junction
  const auto smoothed = [&](const StairCase& s)
  {
    std::vector<Place> points = smooth(s);
    return points;
  };
  for (const CrackChain& chain : graph.chains)
  {
    StairCase s;
    s.closed = chain.closed();
    for (const std::size_t e : chain.edges)
    {
      const CrackEdge& edge = edges[e];
      s.middles.push_back({ static_cast<double>(edge.x) + (edge.axis == 0 ? 0.5 : 0.0),
        static_cast<double>(edge.y) + (edge.axis == 1 ? 0.5 : 0.0) });
      s.axes.push_back(edge.axis);
    }
    curves.push_back({ smoothed(s) });
    for (std::size_t end = 0; end < 2; ++end)
      if (chain.ends[end] == ChainEnd::Junction)
        tails[chain.corners[end]].push_back(
          tailOf(curves.back().points, end == 1, cornerPlace(lattice, chain.corners[end])));
    stairs.push_back(std::move(s));
  }
  std::map<std::int64_t, Place> junctions;
  for (const auto& [corner, list] : tails)
    junctions[corner] = meeting(list, cornerPlace(lattice, corner));
  for (std::size_t c = 0; c < curves.size(); ++c)
  {
    const CrackChain& chain = graph.chains[c];
    std::vector<Place>& points = curves[c].points;
    if (chain.closed())
    {
      // begins between its last point and its first
      const Place a = points.front();
      const Place b = points.back();
      const Place seam{ (a[0] + b[0]) / 2, (a[1] + b[1]) / 2 };
      points.insert(points.begin(), seam);
      points.push_back(seam);
      continue;
    }
    for (std::size_t end = 0; end < 2; ++end)
      if (chain.ends[end] == ChainEnd::Junction)
        stairs[c].anchors[end] = junctions.at(chain.corners[end]);
    if (stairs[c].anchors[0] || stairs[c].anchors[1])
      points = smoothed(stairs[c]);
    std::array<Place, 2> ends;
    for (std::size_t end = 0; end < 2; ++end)
    {
      const Place corner = cornerPlace(lattice, chain.corners[end]);
      ends[end] = stairs[c].anchors[end] ? *stairs[c].anchors[end]
                                         : endOf(tailOf(points, end == 1, corner), corner, chain.ends[end], lattice);
    }
    points.insert(points.begin(), ends[0]);
    points.push_back(ends[1]);
  }
  return curves;
}

} // namespace lamella::cracks
