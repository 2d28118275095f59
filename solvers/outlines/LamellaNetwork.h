#pragma once

#include "outlines/ContourLattice.h"
#include "outlines/MiddleLamella.h"
#include "outlines/WallDirection.h"

#include <cstdint>
#include <span>

/// Internal: how the middle lamella hangs together on the lattice.
namespace lamella::micrograph
{

/// Makes lamella of the nodes without which it would tear: of the two wall nodes at each link between two cells the one
/// nearer to the middle; where one node is lumen, the other. Lines between cells pass from square to square of four
/// nodes, and a square's nodes are neighbours over sides or corners: so what is marked hangs together, over corners
/// too, as far as the lines between cells do.
/// @param phase #nodes  @returns nodes added
std::int64_t joinLamella(
  const ContourLattice& lattice, const WallDirections& directions, std::span<std::uint8_t> phase);

/// Links that lead from one lumen straight into another: a wall thinner than a node that the lattice lost.
[[nodiscard]] std::int64_t lostWalls(const ContourLattice& lattice, const WallDirections& directions);

/// Fills in what hangs together and which cells it touches.
void countNetworks(const ContourLattice& lattice, const WallDirections& directions, MiddleLamella& result);

} // namespace lamella::micrograph
