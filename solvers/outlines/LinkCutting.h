#pragma once

#include "outlines/ContourEdges.h"
#include "outlines/ContourLattice.h"

#include <span>

/// Internal: where outlines cut the links of a lattice.
namespace lamella::micrograph
{

/// The links along one axis, with what LinkCuts tells of them.
/// @param edges in units of the spacing  @param image phases of the nodes, of the same outlines
[[nodiscard]] LinkCuts cutLinks(
  std::span<const ContourEdge> edges, const PhaseImage& image, const ContourLatticeOptions& options, int axis);

} // namespace lamella::micrograph
