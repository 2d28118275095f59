#pragma once

#include <cstdint>
#include <vector>

namespace lamella::micrograph
{

/// Pixels of a page from the top row, `channels` values each: 1 grey, 2 grey and alpha, 3 red, green, blue, 4 with
/// alpha.
struct Pixels
{
  std::int64_t width = 0;
  std::int64_t height = 0;
  int channels = 1;
  int bits = 8;                       ///< of a value: 8, or 16 in the byte order of this machine
  std::vector<std::uint8_t> values{}; ///< 1 or 2 bytes a value
};

} // namespace lamella::micrograph
