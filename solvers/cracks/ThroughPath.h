#pragma once

#include "cracks/CrackPaths.h"

namespace lamella::cracks
{

/// The shortest way from one side of the picture to the other over paths, between ends of paths at one void straight
/// across it and, where that is short, from an end straight through what still holds: solid counts ten times.
struct ThroughPath
{
  bool found = false;
  std::vector<std::size_t> paths; ///< in order
  double length = 0;              ///< of all of it [spacings]
  double inVoids = 0;             ///< of which across voids
  double inSolid = 0;             ///< and through solid
  double chord = 0;               ///< between its ends

  [[nodiscard]] double tortuosity() const noexcept { return chord > 0 ? length / chord : 0; }
};

/// @param solid as findCrackPaths() had it
/// @param axis 0: from low to high x, 1: y
/// @param reach how far the way may go through solid at once [spacings]
/// A void that reaches a side leads there straight; a way through voids alone is none. Visits the voids in which paths
/// end.
[[nodiscard]] ThroughPath throughPath(
  const CrackPaths& paths, const Lattice& lattice, std::span<const std::uint8_t> solid, int axis, double reach = 0);

} // namespace lamella::cracks
