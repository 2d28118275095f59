#pragma once

#include "lattice/Lattice.h"

#include <array>
#include <cstdint>
#include <limits>
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

/// The same in parts, for lattices that ranks share.
inline constexpr std::int32_t noRun = std::numeric_limits<std::int32_t>::max();

/// Shortens what `least` holds to the length of the straight run of solid along one axis through each solid node of a
/// box, where that is shorter. Along this axis the box is as long as the lattice.
/// @param size of the box; phase and least: as many values, x fastest; least: at first noRun
void shortenRuns(const std::array<std::int64_t, 3>& size, std::span<const std::uint8_t> phase, std::uint8_t empty,
  int axis, std::span<std::int32_t> least);

/// @param nodes by the length of their shortest run [nodes], those without one left out
/// @param solid nodes in all
/// @param each cells of the grid a node
[[nodiscard]] WallCells wallCells(std::span<const std::int64_t> nodes, std::int64_t solid, double each);

/// One line with its numbers where the median, or a quarter of the material, has fewer than leastWallCells; else
/// nothing.
[[nodiscard]] std::string wallWarning(const WallCells& cells);

} // namespace lamella::mpm
