#pragma once

#include "lattice/Phases.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// Grey values of a picture or volume in lattice order (2D: first row in memory = bottom row of the picture).
struct Picture
{
  Lattice lattice;                    ///< spacing from the metadata or the option
  std::vector<std::uint16_t> grey;    ///< 8-bit values stay 0 … 255
  int bits = 8;                       ///< 8 or 16
  std::string pixelSizeSource;        ///< "option", "TIFF resolution", "PNG pHYs", ... or "none"
};

/// How a file is read. Pixel size is never guessed: without metadata or option the lattice has spacing 1 and
/// `pixelSizeSource` is "none"; effective conductivities do not depend on it, pictures then show pixels, not µm.
struct ReadOptions
{
  std::optional<double> pixelSize;                         ///< [m]; wins over metadata
  std::optional<std::array<std::int64_t, 3>> rawSize;      ///< raw volumes: nx, ny, nz
  int rawBits = 8;                                         ///< raw volumes: 8 or 16
  std::uint64_t rawHeader = 0;                             ///< raw volumes: bytes before the data
};

/// Reads PNG, JPEG, TIFF, multi-page TIFF (a volume), a folder or printf-like/glob pattern of numbered pictures (a volume),
/// or a raw volume (.raw, .bin; size from `rawSize` or from a name such as berea_200x200x200_u8.raw).
/// Palette and RGB pictures whose channels are all equal become grey; other colour pictures are refused with the
/// remedy (convert to grey, or segment with `--segment`).
/// @throws InputError for a missing, empty, truncated, unreadable or colour file, CMYK included
[[nodiscard]] Picture readPicture(const std::filesystem::path& path, const ReadOptions& options = {});

} // namespace lamella::micrograph
