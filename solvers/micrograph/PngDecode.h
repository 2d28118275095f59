#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// Pixels of a PNG from the top row, `channels` values each: 1 grey, 2 grey and alpha, 3 red, green, blue, 4 with
/// alpha.
struct PngPixels
{
  std::int64_t width = 0;
  std::int64_t height = 0;
  int channels = 1;
  int bits = 8;                     ///< of a value: 8, or 16 in the byte order of this machine
  std::vector<std::uint8_t> values; ///< 1 or 2 bytes a value
  std::string complaint; ///< what the decoder found wrong; empty for a sound file. No pixels are to be used then.
};

/// Decodes with libpng itself, which would otherwise write what it finds wrong to standard error. Greys of fewer than 8
/// bits are stretched to 0 to 255, palettes turned into colours.
[[nodiscard]] PngPixels decodePng(std::span<const std::uint8_t> file);

} // namespace lamella::micrograph
