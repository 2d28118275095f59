#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

/// The numbers of a TIFF directory as they stand in the file, for what libtiff does not tell: it keeps resolutions to
/// 24 bits, and reads no Exif block, which is such a directory with no picture.
namespace lamella::micrograph
{

/// Bytes in which directories lie: a file, or the Exif block of a JPEG.
struct TiffSource
{
  /// Nothing where these reach beyond the end.
  std::function<std::optional<std::vector<std::uint8_t>>(std::uint64_t at, std::uint64_t count)> read;
  bool bigEndian = false;
  bool big = false; ///< BigTIFF: 64-bit offsets

  /// Reads the byte order and version; gives the place of the first directory, or nothing where this is no TIFF.
  [[nodiscard]] std::optional<std::uint64_t> open();
};

/// What tells the size of a pixel, and how the picture is turned.
struct TiffEntries
{
  static constexpr int orientation = 274;
  static constexpr int xResolution = 282;
  static constexpr int yResolution = 283;
  static constexpr int resolutionUnit = 296;

  std::map<int, std::uint64_t> numbers; ///< SHORT and LONG, one each
  std::map<int, double> ratios;         ///< RATIONAL

  [[nodiscard]] std::uint64_t number(int tag, std::uint64_t otherwise) const;
  [[nodiscard]] double ratio(int tag) const; ///< 0 where there is none
};

/// Nothing for a directory that is not whole.
[[nodiscard]] std::optional<TiffEntries> tiffEntries(const TiffSource& source, std::uint64_t at);

/// Metres of a pixel along x and y; nothing where the unit is no length, or a number makes no sense.
[[nodiscard]] std::optional<std::array<double, 2>> resolution(const TiffEntries& entries);

} // namespace lamella::micrograph
