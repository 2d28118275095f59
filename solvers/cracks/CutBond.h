#pragma once

#include <array>
#include <cstdint>

/// Cracks from the bonds that broke. Lengths below are in lattice spacings and places in node numbers, (0, 0) being the
/// first node, unless a unit is given.
namespace lamella::cracks
{

/// A broken bond, from its first node to the one `step` further.
struct CutBond
{
  std::array<std::int64_t, 3> node{ 0, 0, 0 };
  std::array<int, 3> step{ 0, 0, 0 };   ///< not zero; either of the two directions
  std::int64_t event = 0;               ///< order of breaking
  double when = 0;                      ///< strain, or time [s]
  std::array<std::uint8_t, 2> phases{}; ///< of both ends, the lesser first
  bool betweenGrains = false;
};

} // namespace lamella::cracks
