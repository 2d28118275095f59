#pragma once

#include "cracks/CutBond.h"
#include "lattice/Lattice.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::cracks
{

/// Two neighbouring nodes that a crack parts: (x, y, z) and the next one along `axis`. Between them lies an edge of the
/// dual lattice, from one corner of their pixels to another; in space a face.
struct CrackEdge
{
  std::int64_t x = 0;
  std::int64_t y = 0;
  int axis = 0;        ///< 0: the neighbour is (x + 1, y, z), 1: (x, y + 1, z), 2: (x, y, z + 1)
  double strength = 1; ///< 0 … 1: share of the nodes beside them that hold to one of the two only, less those to both
  std::int64_t z = 0;

  bool operator==(const CrackEdge& other) const noexcept
  {
    return x == other.x && y == other.y && z == other.z && axis == other.axis;
  }
};

/// The pairs of neighbours that cracks part. Two neighbours i and j are parted when, of all nodes that had
/// a bond to both of them, i and j included, more still hold to one of the two than to both: where a crack runs between
/// i and j through bonds that all broke, none holds to both; beside it, none holds to one only; at its tip it is half
/// of them. A broken bond here and there parts nothing, and one that survived within a crack joins nothing.
/// @param bonds broken bonds; one named twice counts once. Those that leave the lattice are not looked at
/// @param solid one a node, 0 where there is none; empty: all are
/// @throws ParameterError for a bond longer than the horizon
/// Visits only nodes that broken bonds end in. In the order of memory, axis 0 first.
[[nodiscard]] std::vector<CrackEdge> crackEdges(
  const Lattice& lattice, double horizon, std::span<const CutBond> bonds, std::span<const std::uint8_t> solid = {});

} // namespace lamella::cracks
