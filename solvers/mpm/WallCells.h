#pragma once

#include "lattice/Lattice.h"

#include <cstdint>
#include <span>
#include <string>

namespace lamella::mpm
{

/// How many cells of the grid lie across the walls of a lattice, by the shortest of the straight runs of solid along
/// the axes through each solid node; runs that reach the lattice's edge do not count.
struct WallCells
{
  double median = 0;    ///< cells across; 0 where no run is seen whole
  double thinShare = 0; ///< share of the solid nodes that have fewer than leastWallCells
};

/// Fewer cells across a bending wall make it too stiff, or too soft, by more than a few per cent.
inline constexpr double leastWallCells = 2;

/// @param phase lattice.count() phases
/// @param empty phase of the voids
/// @param spacing of the grid [m]
/// @throws InputError for another number of phases; ParameterError for a spacing that is not positive
[[nodiscard]] WallCells wallCells(
  const Lattice& lattice, std::span<const std::uint8_t> phase, std::uint8_t empty, double spacing);

/// One line with its numbers where the median, or a quarter of the material, has fewer than leastWallCells; else
/// nothing.
[[nodiscard]] std::string wallWarning(const WallCells& cells);

} // namespace lamella::mpm
