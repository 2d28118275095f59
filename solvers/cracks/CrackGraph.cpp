#include "cracks/CrackGraph.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

namespace lamella::cracks
{
namespace
{

/// Edges at a corner: at most four.
struct Corner
{
  std::array<std::size_t, 4> edges{};
  int count = 0;
};

class Tracer
{
public:
  Tracer(const Lattice& lattice, std::span<const CrackEdge> edges, std::span<const std::uint8_t> solid)
    : lattice_(lattice)
    , edges_(edges)
    , solid_(solid)
    , there_(edges.size(), true)
  {
  }

  std::vector<CrackChain> chains()
  {
    corners_.clear();
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (there_[e])
        for (const std::int64_t c : cornersOf(lattice_, edges_[e]))
        {
          Corner& corner = corners_[c];
          corner.edges[static_cast<std::size_t>(corner.count++)] = e;
        }
    std::vector<CrackChain> found;
    std::vector<bool> done(edges_.size(), false);
    for (const bool loops : { false, true }) // what is left when all that end are found goes round
      for (std::size_t e = 0; e < edges_.size(); ++e)
        if (there_[e] && !done[e])
          for (const std::int64_t c : cornersOf(lattice_, edges_[e]))
            if (!done[e] && (loops || corners_.at(c).count != 2))
              found.push_back(trace(e, c, done));
    std::sort(found.begin(), found.end(),
      [](const CrackChain& a, const CrackChain& b) {
        return *std::min_element(a.edges.begin(), a.edges.end()) < *std::min_element(b.edges.begin(), b.edges.end());
      });
    return found;
  }

  void remove(const CrackChain& chain)
  {
    for (const std::size_t e : chain.edges)
      there_[e] = false;
  }

  /// The part of a chain that lies around a piece.
  void remove(const CrackChain& chain, const std::vector<std::int64_t>& piece)
  {
    const std::set<std::int64_t> inside(piece.begin(), piece.end());
    for (const std::size_t e : chain.edges)
    {
      const std::int64_t node = lattice_.index(edges_[e].x, edges_[e].y);
      if (inside.contains(node) || inside.contains(node + (edges_[e].axis == 0 ? 1 : lattice_.size[0])))
        there_[e] = false;
    }
  }

  [[nodiscard]] double strength(const CrackChain& chain) const
  {
    double sum = 0;
    for (const std::size_t e : chain.edges)
      sum += edges_[e].strength;
    return sum / static_cast<double>(chain.edges.size());
  }

  /// Pieces of at most so many nodes that edges part from all else, and the chains around each of them.
  struct Piece
  {
    std::vector<std::int64_t> nodes;
    std::set<std::size_t> chains;
  };
  [[nodiscard]] std::vector<Piece> pieces(const std::vector<CrackChain>& chains, std::int64_t most) const
  {
    Borders borders;
    for (std::size_t c = 0; c < chains.size(); ++c)
      for (const std::size_t e : chains[c].edges)
        borders[2 * lattice_.index(edges_[e].x, edges_[e].y) + edges_[e].axis] = c;
    std::vector<Piece> found;
    std::unordered_map<std::int64_t, bool> seen; // nodes, and whether their part is too large
    for (const CrackChain& chain : chains)
      for (const std::size_t e : chain.edges)
      {
        const std::int64_t node = lattice_.index(edges_[e].x, edges_[e].y);
        for (const std::int64_t start : { node, node + (edges_[e].axis == 0 ? 1 : lattice_.size[0]) })
          if (!seen.contains(start))
          {
            Piece piece = flood(start, most, borders, seen);
            if (!piece.nodes.empty())
              found.push_back(std::move(piece));
          }
      }
    std::stable_sort(
      found.begin(), found.end(), [](const Piece& a, const Piece& b) { return a.nodes.size() < b.nodes.size(); });
    return found;
  }

private:
  using Borders = std::unordered_map<std::int64_t, std::size_t>; ///< chain between a node and its neighbour: 2 i + axis

  CrackChain trace(std::size_t edge, std::int64_t from, std::vector<bool>& done)
  {
    CrackChain chain;
    chain.corners[0] = from;
    std::int64_t at = from;
    for (;;)
    {
      done[edge] = true;
      chain.edges.push_back(edge);
      const auto ends = cornersOf(lattice_, edges_[edge]);
      at = ends[0] == at ? ends[1] : ends[0];
      const Corner& corner = corners_.at(at);
      if (corner.count != 2 || at == from)
        break;
      edge = corner.edges[corner.edges[0] == edge ? 1 : 0];
    }
    chain.corners[1] = at;
    if (at != from || corners_.at(at).count != 2)
      chain.ends = { endAt(from), endAt(at) };
    return chain;
  }

  [[nodiscard]] ChainEnd endAt(std::int64_t corner) const
  {
    if (corners_.at(corner).count > 1)
      return ChainEnd::Junction;
    const std::int64_t x = corner % (lattice_.size[0] + 1);
    const std::int64_t y = corner / (lattice_.size[0] + 1);
    if (x == 0 || y == 0 || x == lattice_.size[0] || y == lattice_.size[1])
      return ChainEnd::Border;
    for (std::int64_t n = y - 1; !solid_.empty() && n <= y; ++n)
      for (std::int64_t m = x - 1; m <= x; ++m)
        if (solid_[static_cast<std::size_t>(lattice_.index(m, n))] == 0)
          return ChainEnd::Void;
    return ChainEnd::Tip;
  }

  /// The nodes that hang together with one by sides without an edge; none where there are too many.
  Piece flood(
    std::int64_t start, std::int64_t most, const Borders& borders, std::unordered_map<std::int64_t, bool>& seen) const
  {
    Piece piece;
    piece.nodes.push_back(start);
    std::unordered_set<std::int64_t> inside{ start };
    bool large = false;
    for (std::size_t next = 0; next < piece.nodes.size() && !large; ++next)
    {
      const std::int64_t node = piece.nodes[next];
      const std::int64_t x = node % lattice_.size[0];
      const std::int64_t y = node / lattice_.size[0];
      const auto look = [&](std::int64_t other, bool there, int axis)
      {
        if (!there || (!solid_.empty() && solid_[static_cast<std::size_t>(other)] == 0))
          return;
        if (const auto border = borders.find(2 * std::min(node, other) + axis); border != borders.end())
          piece.chains.insert(border->second);
        else if (inside.insert(other).second)
        {
          piece.nodes.push_back(other);
          const auto known = seen.find(other);
          large = large || (known != seen.end() && known->second);
        }
      };
      look(node - 1, x > 0, 0);
      look(node + 1, x + 1 < lattice_.size[0], 0);
      look(node - lattice_.size[0], y > 0, 1);
      look(node + lattice_.size[0], y + 1 < lattice_.size[1], 1);
      large = large || static_cast<std::int64_t>(piece.nodes.size()) > most;
    }
    for (const std::int64_t node : piece.nodes)
      seen[node] = large;
    return large ? Piece{} : piece;
  }

  const Lattice& lattice_;
  std::span<const CrackEdge> edges_;
  std::span<const std::uint8_t> solid_;
  std::vector<bool> there_;
  std::unordered_map<std::int64_t, Corner> corners_;
};

/// The shortest spur of every junction. @return how many were taken away
std::int64_t removeSpurs(Tracer& tracer, const std::vector<CrackChain>& chains, std::int64_t longest)
{
  const auto isSpur = [&](const CrackChain& c)
  {
    const bool first = c.ends[0] == ChainEnd::Tip && c.ends[1] == ChainEnd::Junction;
    const bool second = c.ends[1] == ChainEnd::Tip && c.ends[0] == ChainEnd::Junction;
    return (first || second) && static_cast<std::int64_t>(c.edges.size()) <= longest;
  };
  std::map<std::int64_t, const CrackChain*> shortest; // by junction
  for (const CrackChain& c : chains)
    if (isSpur(c))
    {
      const CrackChain*& known = shortest[c.corners[c.ends[0] == ChainEnd::Junction ? 0 : 1]];
      if (known == nullptr || c.edges.size() < known->edges.size())
        known = &c;
    }
  for (const auto& [corner, chain] : shortest)
    tracer.remove(*chain);
  return static_cast<std::int64_t>(shortest.size());
}

/// What of the weakest chain lies around a piece of at most so many nodes, of every piece, as long as no two of them
/// touch.
std::int64_t removeIslands(Tracer& tracer, const std::vector<CrackChain>& chains, std::int64_t most)
{
  std::set<std::size_t> touched;
  std::int64_t removed = 0;
  for (const Tracer::Piece& piece : tracer.pieces(chains, most))
  {
    if (std::any_of(piece.chains.begin(), piece.chains.end(), [&](std::size_t c) { return touched.contains(c); }))
      continue;
    touched.insert(piece.chains.begin(), piece.chains.end());
    // of equals the longest, then the last
    const auto order = [&](std::size_t c)
    { return std::make_tuple(tracer.strength(chains[c]), -static_cast<std::int64_t>(chains[c].edges.size())); };
    std::size_t worst = *piece.chains.begin();
    for (const std::size_t c : piece.chains)
      worst = order(c) <= order(worst) ? c : worst;
    tracer.remove(chains[worst], piece.nodes);
    ++removed;
  }
  return removed;
}

} // namespace

std::array<std::int64_t, 2> cornersOf(const Lattice& lattice, const CrackEdge& edge) noexcept
{
  const std::int64_t pitch = lattice.size[0] + 1;
  return edge.axis == 0
    ? std::array<std::int64_t, 2>{ edge.x + 1 + pitch * edge.y, edge.x + 1 + pitch * (edge.y + 1) }
    : std::array<std::int64_t, 2>{ edge.x + pitch * (edge.y + 1), edge.x + 1 + pitch * (edge.y + 1) };
}

std::array<double, 2> cornerPlace(const Lattice& lattice, std::int64_t corner) noexcept
{
  const std::int64_t pitch = lattice.size[0] + 1;
  return { static_cast<double>(corner % pitch) - 0.5, static_cast<double>(corner / pitch) - 0.5 };
}

CrackGraph crackGraph(const Lattice& lattice, std::span<const CrackEdge> edges, std::span<const std::uint8_t> solid,
  std::int64_t spur, std::int64_t island)
{
  Tracer tracer(lattice, edges, solid);
  CrackGraph graph;
  for (;;)
  {
    graph.chains = tracer.chains();
    // islands first: their sides would look like spurs once one is gone
    if (const std::int64_t islands = removeIslands(tracer, graph.chains, island); islands > 0)
      graph.islands += islands;
    else if (const std::int64_t spurs = removeSpurs(tracer, graph.chains, spur); spurs > 0)
      graph.spurs += spurs;
    else
      return graph;
  }
}

} // namespace lamella::cracks
