#pragma once

#include "lattice/Lattice.h"
#include "pores/PoreLabelling.h"
#include "statistics/WindowError.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::pores
{

/// How far an image speaks for its material, from the pores of the windows that it is cut into, halves and thirds of it
/// along each axis: `porosity`, `pore_density`, pores over the box [1/m², 1/m³], and `pore_mean`, their mean size
/// [nodes]. A pore that a side cuts counts with what is left of it, in windows as in the image.
/// @param phase the whole box, on one rank  @param options of the image; windows do not repeat
/// @return empty: the box is too small to be cut, or has no pore
[[nodiscard]] std::vector<statistics::WindowError> poreWindows(
  const Lattice& lattice, std::span<const std::uint8_t> phase, std::uint8_t wanted, const LabelOptions& options);

} // namespace lamella::pores
