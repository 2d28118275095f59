#pragma once

#include "cracks/CrackEdges.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::cracks
{

/// Where a chain ends.
enum class ChainEnd : std::uint8_t
{
  Tip,      ///< in solid
  Junction, ///< where other chains end too
  Border,   ///< at a side of the picture
  Void,     ///< at a node that is not solid
  None      ///< closed
};

/// Edges one after the other. Corners of pixels are numbered x + (nx + 1) y; the pixel of node (0, 0) has the corners
/// (0, 0) to (1, 1), which lie at −½ and ½ in node numbers.
struct CrackChain
{
  std::vector<std::size_t> edges; ///< by their places in the list given
  std::array<std::int64_t, 2> corners{ -1, -1 };
  std::array<ChainEnd, 2> ends{ ChainEnd::None, ChainEnd::None };

  [[nodiscard]] bool closed() const noexcept { return ends[0] == ChainEnd::None; }
};

struct CrackGraph
{
  std::vector<CrackChain> chains; ///< in the order of their first edges in memory
  std::int64_t spurs = 0;         ///< taken away
  std::int64_t islands = 0;       ///< pieces that were joined to what is beside them
};

/// Chains between tips, junctions, borders and voids. Taken away are spurs, that is chains from a junction to a tip of
/// at most `spur` edges, the shortest first; and the weakest chain around a piece of at most `island` nodes, so that
/// what is crushed within a crack becomes part of one of its sides.
/// @param edges in the order of memory
[[nodiscard]] CrackGraph crackGraph(const Lattice& lattice, std::span<const CrackEdge> edges,
  std::span<const std::uint8_t> solid, std::int64_t spur, std::int64_t island);

/// The corners at both ends of an edge.
[[nodiscard]] std::array<std::int64_t, 2> cornersOf(const Lattice& lattice, const CrackEdge& edge) noexcept;
/// A corner's place in node numbers.
[[nodiscard]] std::array<double, 2> cornerPlace(const Lattice& lattice, std::int64_t corner) noexcept;

} // namespace lamella::cracks
