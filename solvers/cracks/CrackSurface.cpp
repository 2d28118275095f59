#include "cracks/CrackSurface.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <unordered_map>

namespace lamella::cracks
{
namespace
{

struct Edge
{
  std::int64_t low;
  std::int64_t high;
  std::size_t face;
};

/// The sets that are joined, each known by its least member.
class Joined
{
public:
  explicit Joined(std::size_t count)
    : root_(count)
  {
    std::iota(root_.begin(), root_.end(), std::size_t{ 0 });
  }
  std::size_t of(std::size_t i)
  {
    while (root_[i] != i)
      i = root_[i] = root_[root_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b)
  {
    a = of(a);
    b = of(b);
    root_[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<std::size_t> root_;
};

/// Corners of voxels, numbered along x, then y, then z; the corner (0, 0, 0) lies half a spacing before the first node.
class Corners
{
public:
  explicit Corners(const Lattice& lattice)
    : size_{ lattice.size[0] + 1, lattice.size[1] + 1, lattice.size[2] + 1 }
  {
  }
  [[nodiscard]] std::array<std::int64_t, 4> of(const CrackEdge& pair) const
  {
    std::array<std::int64_t, 3> at{ pair.x, pair.y, pair.z };
    const auto normal = static_cast<std::size_t>(pair.axis);
    const std::size_t one = (normal + 1) % 3;
    const std::size_t two = (normal + 2) % 3;
    ++at[normal];
    std::array<std::int64_t, 4> corners{};
    constexpr int around[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
    for (std::size_t k = 0; k < 4; ++k)
    {
      std::array<std::int64_t, 3> corner = at;
      corner[one] += around[k][0];
      corner[two] += around[k][1];
      corners[k] = corner[0] + size_[0] * (corner[1] + size_[1] * corner[2]);
    }
    return corners;
  }
  [[nodiscard]] std::array<double, 3> place(std::int64_t corner) const
  {
    return { static_cast<double>(corner % size_[0]) - 0.5, static_cast<double>(corner / size_[0] % size_[1]) - 0.5,
      static_cast<double>(corner / size_[0] / size_[1]) - 0.5 };
  }

private:
  std::array<std::int64_t, 3> size_;
};

std::vector<Edge> edgesOf(const std::vector<CrackFace>& faces)
{
  std::vector<Edge> edges;
  edges.reserve(4 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 4; ++k)
    {
      const std::int64_t a = faces[f].corners[k];
      const std::int64_t b = faces[f].corners[(k + 1) % 4];
      edges.push_back({ std::min(a, b), std::max(a, b), f });
    }
  std::sort(edges.begin(), edges.end(),
    [](const Edge& a, const Edge& b) { return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face); });
  return edges;
}

/// Calls f(first, last) for the runs of edges that are one and the same.
template <class F>
void forEachEdge(const std::vector<Edge>& edges, F&& f)
{
  for (std::size_t i = 0; i < edges.size();)
  {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high)
      ++end;
    f(i, end);
    i = end;
  }
}

/// Numbers the cracks, and takes out those that are too small.
void part(CrackSurface& surface, double leastFaces)
{
  Joined joined(surface.faces.size());
  const std::vector<Edge> edges = edgesOf(surface.faces);
  forEachEdge(edges,
    [&](std::size_t first, std::size_t last)
    {
      for (std::size_t i = first + 1; i < last; ++i)
        joined.join(edges[first].face, edges[i].face);
    });
  std::map<std::size_t, std::int64_t> size; // by the least face
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    ++size[joined.of(f)];
  std::vector<std::pair<std::size_t, std::int64_t>> order(size.begin(), size.end());
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::map<std::size_t, std::size_t> number;
  for (const auto& [root, count] : order)
    if (static_cast<double>(count) >= leastFaces)
      number.emplace(root, number.size());
    else
    {
      ++surface.leftOutCracks;
      surface.leftOutFaces += count;
    }
  surface.cracks = number.size();
  std::vector<CrackFace> kept;
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    if (const auto found = number.find(joined.of(f)); found != number.end())
    {
      kept.push_back(surface.faces[f]);
      kept.back().crack = found->second;
    }
  std::stable_sort(kept.begin(), kept.end(), [](const CrackFace& a, const CrackFace& b) { return a.crack < b.crack; });
  surface.faces = std::move(kept);
}

/// Corners get their numbers among the points in the order in which faces name them.
void numberPoints(CrackSurface& surface, const Corners& corners)
{
  std::unordered_map<std::int64_t, std::int64_t> number;
  for (CrackFace& face : surface.faces)
    for (std::int64_t& corner : face.corners)
    {
      const auto [found, isNew] = number.try_emplace(corner, static_cast<std::int64_t>(number.size()));
      if (isNew)
        surface.points.push_back(corners.place(corner));
      corner = found->second;
    }
}

/// The axes across whose sides a point lies on one.
std::uint8_t sidesOf(const std::array<double, 3>& point, const Lattice& lattice)
{
  unsigned sides = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (point[a] < 0 || point[a] > static_cast<double>(lattice.size[a]) - 1)
      sides |= 1U << a;
  return static_cast<std::uint8_t>(sides);
}

void findNeighbours(CrackSurface& surface, const Lattice& lattice)
{
  struct Ends
  {
    std::vector<std::int64_t> inside;
    std::vector<std::int64_t> rim;
  };
  std::vector<Ends> ends(surface.points.size());
  const std::vector<Edge> edges = edgesOf(surface.faces);
  forEachEdge(edges,
    [&](std::size_t first, std::size_t last)
    {
      const auto low = static_cast<std::size_t>(edges[first].low);
      const auto high = static_cast<std::size_t>(edges[first].high);
      const bool inside = last - first == 2;
      (inside ? ends[low].inside : ends[low].rim).push_back(edges[first].high);
      (inside ? ends[high].inside : ends[high].rim).push_back(edges[first].low);
    });
  for (const auto& point : surface.points)
    surface.onSides.push_back(sidesOf(point, lattice));
  surface.first.push_back(0);
  for (const Ends& e : ends)
  {
    surface.onRim.push_back(e.rim.empty() ? 0 : 1);
    if (e.rim.empty())
      surface.neighbours.insert(surface.neighbours.end(), e.inside.begin(), e.inside.end());
    else if (e.rim.size() == 2)
    {
      const auto sides = [&](std::int64_t p) -> unsigned { return surface.onSides[static_cast<std::size_t>(p)]; };
      const unsigned mine = sides(static_cast<std::int64_t>(surface.first.size()) - 1);
      const bool straight =
        std::popcount(mine) < 2 && (sides(e.rim[0]) & mine) == mine && (sides(e.rim[1]) & mine) == mine;
      if (straight)
        surface.neighbours.insert(surface.neighbours.end(), e.rim.begin(), e.rim.end());
    }
    surface.first.push_back(static_cast<std::int64_t>(surface.neighbours.size()));
  }
}

/// What the bonds of the two nodes that lead to the other's side say.
void describe(
  CrackSurface& surface, const Lattice& lattice, std::span<const CutBond> bonds, std::span<const std::uint8_t> phase)
{
  std::unordered_map<std::int64_t, std::vector<std::size_t>> at; // by node
  const auto inside = [&](const CutBond& bond)
  {
    for (std::size_t a = 0; a < 3; ++a)
      for (const std::int64_t n : { bond.node[a], bond.node[a] + bond.step[a] })
        if (n < 0 || n >= lattice.size[a])
          return false;
    return true;
  };
  for (std::size_t b = 0; b < bonds.size(); ++b)
  {
    const CutBond& bond = bonds[b];
    if (!inside(bond))
      continue;
    at[lattice.index(bond.node[0], bond.node[1], bond.node[2])].push_back(b);
    at[lattice.index(bond.node[0] + bond.step[0], bond.node[1] + bond.step[1], bond.node[2] + bond.step[2])].push_back(
      b);
  }
  std::vector<std::size_t> there;
  for (CrackFace& face : surface.faces)
  {
    const CrackEdge& p = face.pair;
    const auto axis = static_cast<std::size_t>(p.axis);
    std::array<std::int64_t, 3> second{ p.x, p.y, p.z };
    ++second[axis];
    const std::array<std::int64_t, 2> nodes{ lattice.index(p.x, p.y, p.z),
      lattice.index(second[0], second[1], second[2]) };
    there.clear();
    std::optional<std::size_t> direct;
    for (const std::size_t side : { 0, 1 })
      if (const auto found = at.find(nodes[side]); found != at.end())
        for (const std::size_t b : found->second)
        {
          const CutBond& bond = bonds[b];
          const bool fromHere = lattice.index(bond.node[0], bond.node[1], bond.node[2]) == nodes[side];
          const int along = fromHere ? bond.step[axis] : -bond.step[axis];
          if (side == 0 ? along > 0 : along < 0)
            there.push_back(b);
          const int length = std::abs(bond.step[0]) + std::abs(bond.step[1]) + std::abs(bond.step[2]);
          if (length == 1 && along == (side == 0 ? 1 : -1))
            direct = b;
        }
    if (!there.empty())
    {
      const auto middle = there.begin() + static_cast<std::ptrdiff_t>((there.size() - 1) / 2);
      std::nth_element(there.begin(), middle, there.end(),
        [&](std::size_t a, std::size_t b) { return std::tie(bonds[a].event, a) < std::tie(bonds[b].event, b); });
      face.event = bonds[*middle].event;
      face.when = bonds[*middle].when;
      const CutBond& told = bonds[direct.value_or(*middle)];
      face.phases = told.phases;
      face.betweenGrains = told.betweenGrains;
    }
    if (!phase.empty())
    {
      const std::uint8_t a = phase[static_cast<std::size_t>(nodes[0])];
      const std::uint8_t b = phase[static_cast<std::size_t>(nodes[1])];
      face.phases = { std::min(a, b), std::max(a, b) };
    }
  }
}

} // namespace

CrackSurface findCrackSurface(const Lattice& lattice, double horizon, std::span<const CutBond> bonds,
  std::span<const std::uint8_t> phase, std::span<const std::uint8_t> solid, double leastFaces)
{
  if (lattice.dimension != 3)
    throw ParameterError("surfaces of cracks in a picture", "cracks in pictures are lines");
  const auto nodes = static_cast<std::size_t>(lattice.count());
  if ((!phase.empty() && phase.size() != nodes) || (!solid.empty() && solid.size() != nodes))
    throw InputError(fmt::format("{} phases and {} solid nodes for {} nodes", phase.size(), solid.size(), nodes),
      "give one a node, or none");
  CrackSurface surface;
  const Corners corners(lattice);
  for (const CrackEdge& pair : crackEdges(lattice, horizon, bonds, solid))
  {
    CrackFace face;
    face.pair = pair;
    face.corners = corners.of(pair);
    surface.faces.push_back(face);
  }
  part(surface, leastFaces);
  numberPoints(surface, corners);
  findNeighbours(surface, lattice);
  describe(surface, lattice, bonds, phase);
  return surface;
}

} // namespace lamella::cracks
