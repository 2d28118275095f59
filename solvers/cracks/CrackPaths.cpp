#include "cracks/CrackPaths.h"

#include "core/Error.h"
#include "cracks/BondCrossings.h"
#include "cracks/CrackMeasures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

namespace lamella::cracks
{
namespace
{

/// Which chains hang together, by the least of them.
std::vector<std::size_t> groupsOf(const CrackGraph& graph)
{
  std::vector<std::size_t> group(graph.chains.size());
  std::iota(group.begin(), group.end(), std::size_t{ 0 });
  const auto find = [&](std::size_t i)
  {
    while (group[i] != i)
      i = group[i] = group[group[i]];
    return i;
  };
  std::map<std::int64_t, std::size_t> at; // by corner
  for (std::size_t c = 0; c < graph.chains.size(); ++c)
    for (std::size_t end = 0; end < 2; ++end)
      if (graph.chains[c].ends[end] == ChainEnd::Junction)
      {
        const std::size_t other = find(at.try_emplace(graph.chains[c].corners[end], c).first->second);
        const std::size_t mine = find(c);
        group[std::max(other, mine)] = std::min(other, mine);
      }
  for (std::size_t c = 0; c < group.size(); ++c)
    group[c] = find(c);
  return group;
}

double lengthOf(const CrackCurve& curve)
{
  double sum = 0;
  for (std::size_t i = 0; i + 1 < curve.points.size(); ++i)
    sum += std::hypot(curve.points[i + 1][0] - curve.points[i][0], curve.points[i + 1][1] - curve.points[i][1]);
  return sum;
}

/// What is known of a group before it is decided whether it stays.
struct Group
{
  double length = 0;
  std::vector<Place> outlets; ///< ends at voids and sides

  [[nodiscard]] bool parts() const ///< does it lead from one outlet to another?
  {
    constexpr double apart = 2;
    for (std::size_t i = 0; i < outlets.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (std::hypot(outlets[i][0] - outlets[j][0], outlets[i][1] - outlets[j][1]) > apart)
          return true;
    return false;
  }
};

std::map<std::size_t, Group> describeGroups(
  const CrackGraph& graph, std::span<const CrackCurve> curves, std::span<const std::size_t> group)
{
  std::map<std::size_t, Group> groups;
  for (std::size_t c = 0; c < curves.size(); ++c)
  {
    Group& g = groups[group[c]];
    g.length += lengthOf(curves[c]);
    for (std::size_t end = 0; end < 2; ++end)
      if (graph.chains[c].ends[end] == ChainEnd::Void || graph.chains[c].ends[end] == ChainEnd::Border)
        g.outlets.push_back(end == 0 ? curves[c].points.front() : curves[c].points.back());
  }
  return groups;
}

/// Numbers cracks and paths by length.
void arrange(CrackPaths& result, const Lattice& lattice)
{
  std::stable_sort(result.paths.begin(), result.paths.end(),
    [](const CrackPath& a, const CrackPath& b) { return a.length > b.length; });
  std::map<int, Crack> cracks;
  for (std::size_t p = 0; p < result.paths.size(); ++p)
  {
    const CrackPath& path = result.paths[p];
    Crack& crack = cracks[path.crack];
    crack.paths.push_back(p);
    crack.length += path.length;
    for (const CrackPoint& point : path.points)
      for (std::size_t a = 0; a < 2; ++a)
      {
        crack.extent[0][a] = std::min(crack.extent[0][a], point.place[a]);
        crack.extent[1][a] = std::max(crack.extent[1][a], point.place[a]);
      }
  }
  for (auto& [name, crack] : cracks)
  {
    // a path ends on the side itself
    constexpr double near = 1e-6;
    std::array<std::array<bool, 2>, 2> touches{};
    for (const std::size_t p : crack.paths)
      for (std::size_t end = 0; end < 2; ++end)
        if (const CrackPath& path = result.paths[p]; path.ends[end] == ChainEnd::Border)
        {
          const Place& at = end == 0 ? path.points.front().place : path.points.back().place;
          for (std::size_t a = 0; a < 2; ++a)
          {
            touches[a][0] = touches[a][0] || at[a] < -0.5 + near;
            touches[a][1] = touches[a][1] || at[a] > static_cast<double>(lattice.size[a]) - 0.5 - near;
          }
        }
    crack.through = { touches[0][0] && touches[0][1], touches[1][0] && touches[1][1] };
    result.cracks.push_back(crack);
  }
  std::stable_sort(result.cracks.begin(), result.cracks.end(),
    [](const Crack& a, const Crack& b)
    { return a.length != b.length ? a.length > b.length : a.paths.front() < b.paths.front(); });
  for (std::size_t c = 0; c < result.cracks.size(); ++c)
    for (const std::size_t p : result.cracks[c].paths)
      result.paths[p].crack = static_cast<int>(c);
}

CrackPath pathOf(const CrackChain& chain, const CrackCurve& curve, std::span<const CrackEdge> edges)
{
  CrackPath path;
  for (const Place& place : curve.points)
    path.points.push_back({ place });
  for (const std::size_t e : chain.edges)
    path.edges.push_back(edges[e]);
  path.ends = chain.ends;
  return path;
}

} // namespace

CrackPaths findCrackPaths(const Lattice& lattice, double horizon, std::span<const CutBond> bonds,
  std::span<const std::uint8_t> phase, std::span<const std::uint8_t> solid, CrackPathOptions options)
{
  if (lattice.dimension != 2)
    throw ParameterError("paths of cracks in a volume", "they are found in pictures; in a volume cracks are surfaces");
  const auto nodes = static_cast<std::size_t>(lattice.count());
  if ((!phase.empty() && phase.size() != nodes) || (!solid.empty() && solid.size() != nodes))
    throw InputError(fmt::format("{} phases and {} solid nodes for {} nodes", phase.size(), solid.size(), nodes),
      "give one a node, or none");
  const double minimum = options.minimumLength < 0 ? horizon : options.minimumLength;
  const double spur = options.spurLength < 0 ? 2 * horizon : options.spurLength;
  const std::vector<CrackEdge> edges = crackEdges(lattice, horizon, bonds, solid);
  // pieces of fewer nodes than a node has within its horizon are crushed
  const auto island = static_cast<std::int64_t>(std::numbers::pi * horizon * horizon);
  const CrackGraph graph = crackGraph(lattice, edges, solid, static_cast<std::int64_t>(spur), island);
  const std::vector<CrackCurve> all = crackCurves(lattice, edges, graph);
  const std::vector<std::size_t> group = groupsOf(graph);
  const std::map<std::size_t, Group> groups = describeGroups(graph, all, group);

  CrackPaths result;
  result.leftOut.spurs = graph.spurs;
  result.leftOut.islands = graph.islands;
  for (const auto& [name, g] : groups)
    if (g.length < minimum && !g.parts())
    {
      ++result.leftOut.cracks;
      result.leftOut.length += g.length;
    }
  std::vector<CrackCurve> curves;
  for (std::size_t c = 0; c < all.size(); ++c)
    if (const Group& g = groups.at(group[c]); g.length >= minimum || g.parts())
    {
      result.paths.push_back(pathOf(graph.chains[c], all[c], edges));
      result.paths.back().crack = static_cast<int>(group[c]);
      curves.push_back(all[c]);
    }
  std::vector<std::vector<OwnBond>> own(curves.size());
  const std::vector<Crossing> crossed = crossings(curves, bonds);
  for (std::size_t b = 0; b < bonds.size(); ++b)
    if (crossed[b].curve >= 0)
      own[static_cast<std::size_t>(crossed[b].curve)].push_back({ b, static_cast<std::size_t>(crossed[b].point) });
    else
      ++result.leftOut.bonds;
  const BondCount count(2, horizon);
  for (std::size_t p = 0; p < result.paths.size(); ++p)
    measure(result.paths[p], bonds, own[p], lattice, horizon, count, phase);
  arrange(result, lattice);
  for (const CrackPath& path : result.paths)
  {
    result.length += path.length;
    add(result.pairs, path.pairs);
  }
  result.orientation = orientationOf(result.paths);
  return result;
}

std::vector<CutBond> canonical(std::vector<CutBond> bonds)
{
  for (CutBond& b : bonds)
    if (std::tie(b.step[2], b.step[1], b.step[0]) < std::make_tuple(0, 0, 0))
      for (std::size_t a = 0; a < 3; ++a)
      {
        b.node[a] += b.step[a];
        b.step[a] = -b.step[a];
      }
  const auto place = [](const CutBond& b)
  { return std::tie(b.node[2], b.node[1], b.node[0], b.step[2], b.step[1], b.step[0]); };
  std::sort(
    bonds.begin(), bonds.end(),
    [&](const CutBond& a, const CutBond& b) { return place(a) != place(b) ? place(a) < place(b) : a.event < b.event; });
  bonds.erase(std::unique(
                bonds.begin(), bonds.end(), [&](const CutBond& a, const CutBond& b) { return place(a) == place(b); }),
    bonds.end());
  std::stable_sort(bonds.begin(), bonds.end(), [](const CutBond& a, const CutBond& b) { return a.event < b.event; });
  return bonds;
}

void openings(CrackPaths& paths, const Lattice& lattice, std::span<const double> displacement)
{
  if (displacement.size() != static_cast<std::size_t>(3 * lattice.count()))
    throw InputError(fmt::format("{} displacements for {} nodes", displacement.size() / 3, lattice.count()),
      "give three numbers a node");
  for (CrackPath& path : paths.paths)
  {
    const std::size_t n = path.points.size();
    for (std::size_t k = 0; k < path.edges.size(); ++k)
    {
      const CrackEdge& e = path.edges[k];
      const auto first = static_cast<std::size_t>(lattice.index(e.x, e.y));
      const std::size_t second = first + (e.axis == 0 ? 1 : static_cast<std::size_t>(lattice.size[0]));
      const Place& a = path.points[k].place;
      const Place& b = path.points[k + 2].place;
      const double length = std::max(1e-12, std::hypot(b[0] - a[0], b[1] - a[1]));
      Place normal{ (a[1] - b[1]) / length, (b[0] - a[0]) / length };
      if (normal[static_cast<std::size_t>(e.axis)] < 0) // from the first node to the second
        normal = { -normal[0], -normal[1] };
      const double x = displacement[3 * second] - displacement[3 * first];
      const double y = displacement[3 * second + 1] - displacement[3 * first + 1];
      path.points[1 + k].opening = normal[0] * x + normal[1] * y;
      path.points[1 + k].sliding = std::abs(normal[0] * y - normal[1] * x);
    }
    for (const auto& [to, from] : { std::pair<std::size_t, std::size_t>{ 0, 1 }, { n - 1, n - 2 } })
    {
      path.points[to].opening = path.points[from].opening;
      path.points[to].sliding = path.points[from].sliding;
    }
  }
}

std::vector<Growth> growth(const CrackPaths& paths, int crack, double reach)
{
  struct Piece
  {
    std::int64_t event;
    double when;
    double length;
  };
  std::vector<Piece> pieces;
  for (const CrackPath& path : paths.paths)
    if (crack < 0 || path.crack == crack)
      for (std::size_t i = 0; i + 1 < path.points.size(); ++i)
      {
        const CrackPoint& a = path.points[i];
        const CrackPoint& b = path.points[i + 1];
        const CrackPoint& later = a.event > b.event ? a : b;
        pieces.push_back({ later.event, later.when, std::hypot(b.place[0] - a.place[0], b.place[1] - a.place[1]) });
      }
  std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.event < b.event; });
  std::vector<Growth> rows;
  double length = 0;
  for (const Piece& p : pieces)
  {
    length += p.length;
    if (rows.empty() || rows.back().event != p.event)
      rows.push_back({ p.event, p.when, 0, 0 });
    rows.back().length = length;
  }
  std::size_t low = 0;
  std::size_t high = 0;
  for (Growth& row : rows)
  {
    while (row.length - rows[low].length > reach)
      ++low;
    while (high + 1 < rows.size() && rows[high + 1].length - row.length <= reach)
      ++high;
    const double time = rows[high].when - rows[low].when;
    row.rate = time > 0 ? (rows[high].length - rows[low].length) / time : std::numeric_limits<double>::quiet_NaN();
  }
  return rows;
}

} // namespace lamella::cracks
