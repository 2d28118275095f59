#pragma once

#include "pictures/Pixels.h"
#include "pictures/Probe.h"

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

/// Pixels, rows from the top, as greys: 0.299 R + 0.587 G + 0.114 B where they are coloured, and as colours.
/// @param flip   the last row comes first in memory
/// @param grey   width × height values
/// @param colour three times as many values, or null
void convert(const Pixels& pixels, bool flip, std::uint16_t* grey, std::uint16_t* colour, Decoded& seen);

/// The pixels of a file of any format but TIFF, which may hold many pages.
/// @param probe gets texts and warnings of what stands behind the pixels
/// @throws InputError
[[nodiscard]] Pixels onlyPixels(FileBytes& file, Probe& probe);

/// Decodes all slices of a probed file.
/// @param probe  gets texts and warnings of what stands behind the pixels
/// @param flip   2D: the picture's last row comes first in memory
/// @param grey   width × height × slices values
/// @param colour three times as many values, or null
/// @throws InputError when the pixels cannot be decoded, or are other than the probe said
Decoded decode(FileBytes& file, Probe& probe, bool flip, std::uint16_t* grey, std::uint16_t* colour);

} // namespace lamella::micrograph
