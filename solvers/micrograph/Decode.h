#pragma once

#include "micrograph/Probe.h"

#include <array>
#include <cstdint>

namespace lamella::micrograph
{

/// What was seen while pixels were turned into greys.
struct Decoded
{
  bool colour = false;                   ///< somewhere red, green and blue differ
  std::int64_t colourX = 0, colourY = 0; ///< the first such pixel, from the top left
  std::array<int, 3> firstColour{ 0, 0, 0 };
  bool transparent = false;
};

/// Decodes all slices of a probed file.
/// @param flip   2D: the picture's last row comes first in memory
/// @param grey   width × height × slices values
/// @param colour three times as many values, or null
/// @throws InputError when the pixels cannot be decoded or are other than the probe said
Decoded decode(FileBytes& file, const Probe& probe, bool flip, std::uint16_t* grey, std::uint16_t* colour);

} // namespace lamella::micrograph
