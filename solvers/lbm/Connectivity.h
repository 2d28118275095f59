#pragma once

#include "lattice/NodeSet.h"
#include "lbm/Links.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// Which nodes can carry flux along an axis.
struct Percolation
{
  bool exists = false; ///< a conducting path leads across
  NodeSet carrying;    ///< members of the clusters that lead across, ghost rows included
  NodeSet reachesLow;  ///< conducting nodes connected to the face of value 1 (fixed faces only)
  NodeSet reachesHigh; ///< the same for the face of value 0
  /// Periodic: one global position in each carrying cluster, where the value is pinned (the constant is free there).
  std::vector<std::array<std::int64_t, 3>> pins;
};

/// Flood fill over the links of the lattice (diagonal ones included on D2Q9 and D3Q19).
///
/// With fixed faces every rank fills its own block and hands the front over until nothing changes. With periodic
/// sides a cluster carries flux along an axis when a closed loop in it winds around that axis; the winding numbers come
/// from a union-find with offsets that every rank does on the gathered set (1 bit a node).
///
/// @param phase  this block's phase ids, block.count() of them
[[nodiscard]] Percolation findPercolation(const Lattice& lattice, const Decomposition& parts, const Halo& halo,
  const Communicator& comm, const Links& links, int axis, std::span<const std::uint8_t> phase);

} // namespace lamella::lbm
