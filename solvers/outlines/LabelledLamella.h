#pragma once

#include "outlines/ContourLattice.h"

#include <cstdint>

namespace lamella::micrograph
{

/// The phases of a lattice from outlines, "lumen" 0, "wall" 1 and "middle lamella" 2, where a picture says what of the
/// walls is the middle lamella: a wall node is that where its centre lies in a pixel of that phase.
/// @param labels of the picture that the outlines are of, whose lower left corner is the outlines' (0, 0)
/// @param lamella the phase in it
/// @param stretch of the outlines along y (FittedContours)
[[nodiscard]] PhaseImage labelledLamella(
  const ContourLattice& lattice, const PhaseImage& labels, std::uint8_t lamella, double stretch = 1);

/// Share of the wall's nodes that are middle lamella; 0 without walls.
[[nodiscard]] double lamellaShare(const PhaseImage& image);

} // namespace lamella::micrograph
