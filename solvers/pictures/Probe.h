#pragma once

#include "pictures/FileBytes.h"

#include <optional>
#include <string>
#include <vector>

/// What a picture file says about itself, found without decoding it: its size is checked before memory is taken for it.
namespace lamella::micrograph
{

enum class Format
{
  Png,
  Jpeg,
  Tiff,
  Pgm,
  Ppm,
  Bmp
};
[[nodiscard]] const char* name(Format format) noexcept;

/// A pixel size and which entry of the file says it. x and y may differ.
struct MetadataSize
{
  double x = 0;            ///< [m]
  double y = 0;            ///< [m]
  std::optional<double> z; ///< [m], distance between slices
  std::string source;
};

struct Probe
{
  Format format = Format::Png;
  std::int64_t width = 0;
  std::int64_t height = 0;
  int bits = 8;                    ///< of a channel
  int channels = 1;                ///< as decoded; a palette counts as 3
  int sampleFormat = 1;            ///< TIFF: 1 unsigned, 2 signed, 3 floating point
  std::vector<std::size_t> slices; ///< TIFF: which pages are slices, reduced copies left out
  std::size_t pages = 1;           ///< TIFF: how many there are in all
  std::optional<MetadataSize> size;
  std::string description;
  std::string provenance; ///< PNG only
  std::vector<std::string> warnings;
};

/// @param anyNumbers lets TIFF files of signed and real numbers and of more than 16 bits pass
/// @throws InputError for a file that is no PNG, JPEG, TIFF, PGM, PPM or BMP, is truncated or damaged, or holds what
///         cannot become greys (CMYK, floating point, more than 16 bits)
[[nodiscard]] Probe probe(FileBytes& file, bool anyNumbers = false);

[[nodiscard]] Probe probeTiff(FileBytes& file, bool anyNumbers = false);

/// The error for pixels that their library refuses.
[[noreturn]] void undecodable(const FileBytes& file, Format format, const std::string& why);

/// Metres in a unit's name, as ImageJ, OME and headers of volumes write it; 0 for pixels and what is not a length.
[[nodiscard]] double metresIn(std::string unit);

/// The pixel size, unless it is what printers' resolutions come to or no length at all: a warning says so then.
[[nodiscard]] std::optional<MetadataSize> trustedSize(
  const std::optional<MetadataSize>& size, const std::string& name, std::vector<std::string>& warnings);

/// Refuses a file that says it is much larger than its bytes can hold, before memory is taken for it.
/// @param ratio how many bytes of pixels one byte of the file can stand for at most
void checkBytes(const FileBytes& file, const Probe& probe, std::uint64_t bytes, double ratio);

} // namespace lamella::micrograph
