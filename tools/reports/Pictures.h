#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace lamella::reports
{

/// A picture as a page holds it.
struct EmbeddedPicture
{
  std::string source;     ///< data:image/png;base64,...
  std::int64_t width = 0; ///< pixels that are shown; 0 where the file does not say (SVG)
  std::int64_t height = 0;
  std::int64_t fullWidth = 0; ///< pixels of the file
  std::int64_t fullHeight = 0;
  std::string provenance; ///< JSON text, or empty
  [[nodiscard]] bool scaled() const noexcept { return width != fullWidth; }
};

/// PNG, JPEG, TIFF, PGM, PPM, BMP or SVG, told by the ending of the name.
[[nodiscard]] bool isPicture(const std::filesystem::path& path);

/// Reads a picture. PNG and JPEG go into the page byte for byte unless they are wider than `mostWide`; those, and all
/// other kinds, are drawn anew.
/// @param mostBytes of its source; one that has more is drawn smaller, as PNG or JPEG, whichever is shorter. 0: any
/// @throws InputError: missing, empty, damaged, another format, more pixels than anybody looks at in a page; no room
///         for even a small one
[[nodiscard]] EmbeddedPicture embed(const std::filesystem::path& path, int mostWide, std::size_t mostBytes = 0);

} // namespace lamella::reports
