#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// Text as pixels, by VTK's FreeType. Raised characters of Unicode (⁰ … ⁹, ⁺, ⁻) are set as small raised figures, since
/// many fonts lack some of them.
///
/// The font is the first found of: the file that the environment variable LAMELLA_FONT names, Liberation Sans, DejaVu
/// Sans (which ParaView brings on Debian), VTK's own.
namespace lamella::rendering
{

/// In pixels.
struct TextMetrics
{
  double width = 0;     ///< how far the pen moves
  double capHeight = 0; ///< of a figure above the baseline
};

struct TextImage
{
  int width = 0;
  int height = 0;
  double originX = 0; ///< where the pen starts …
  double originY = 0; ///< … and the baseline is, from the lower left corner of the image
  std::vector<std::uint8_t> coverage;
};

/// @param text UTF-8, one line
/// @param size height of the font in pixels
[[nodiscard]] TextMetrics MeasureText(const std::string& text, double size);
[[nodiscard]] TextImage DrawText(const std::string& text, double size);

} // namespace lamella::rendering
