#pragma once

#include "outlines/ContourLattice.h"
#include "outlines/WallDirection.h"

#include <cstdint>
#include <span>

/// Internal: where growing outlines leave middle lamella; MiddleLamella.h says how.
namespace lamella::micrograph
{

/// Marks what outlines that keep a gap, and stop at a radius of curvature, do not reach.
/// @param gap, radius [m]; radius 0: corners stay sharp
/// @param phase #nodes: lumen or wall, of which some becomes lamella
void growLamella(const ContourLattice& lattice, const WallDirections& directions, double gap, double radius,
  std::span<std::uint8_t> phase);

} // namespace lamella::micrograph
