#pragma once

#include "lattice/Lattice.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lamella::elasticity
{

/// How a picture goes on where it is made to begin again.
struct SideMatch
{
  double across = 0; ///< share of the pairs of nodes across the seam that differ in phase
  double inside = 0; ///< the largest such share between two neighbouring layers within the picture
};

/// By axis, of a whole picture on this rank.
[[nodiscard]] std::array<SideMatch, 3> sideMatch(const Lattice& lattice, std::span<const std::uint8_t> phase);

/// A sentence for each axis along which opposite sides fit together worse than any two layers within.
[[nodiscard]] std::vector<std::string> sideWarnings(const std::array<SideMatch, 3>& match, int dimension);

} // namespace lamella::elasticity
