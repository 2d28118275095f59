#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// Pixels of a JPEG from the top row, `channels` (1 grey, 3 red, green, blue) values each.
struct JpegPixels
{
  std::int64_t width = 0;
  std::int64_t height = 0;
  int channels = 1;
  std::vector<std::uint8_t> values;
  std::string complaint; ///< what the decoder found wrong; empty for a sound file. The pixels may be wrong then.
};

/// Decodes with libjpeg itself: OpenCV takes damaged data for good ones and lets the library write to standard error.
[[nodiscard]] JpegPixels decodeJpeg(std::span<const std::uint8_t> file);

} // namespace lamella::micrograph
