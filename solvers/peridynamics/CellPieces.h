#pragma once

#include "peridynamics/BondLattice.h"

#include <array>
#include <cstdint>

namespace lamella::peridynamics
{

/// The parts of a periodic cell that bonds hold together. A part that bonds lead along into its own image in the next
/// cell goes on for ever and can carry a mean stress; one that they do not is loose: nothing pulls at it.
struct CellPieces
{
  std::int64_t pieces = 0; ///< all of them; solid nodes without a bond are pieces too
  std::int64_t loosePieces = 0;
  std::int64_t looseNodes = 0;
  /// Whether some piece leads into its image in a cell that is shifted along this axis (and perhaps along others).
  std::array<bool, 3> crosses{ false, false, false };
  AlignedArray<std::uint8_t> loose; ///< 1 for every node of a loose piece, by position, rim included; else 0
};

/// Every part of the rank's layout gets its place in the endless medium; where two lists of a node's images disagree by
/// whole cells, the piece has gone around. Collective; the same on every rank and for any number of them.
/// @param bonds periodic along every axis
[[nodiscard]] CellPieces findCellPieces(const BondLattice& bonds);

} // namespace lamella::peridynamics
