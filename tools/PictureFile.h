#pragma once

#include "lattice/Phases.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

/// Label pictures that carry what they mean: which grey is which phase, how large a pixel is, where they come from.
///
/// The record is one JSON object { "provenance": {...}, "phases": {"0": "lumen", ...}, "pixel_size": 1e-6,
/// "size": [nx, ny, nz], "bits": 8 }. A PNG holds it in an iTXt chunk with the keyword "lamella" (and the pixel size in
/// pHYs as well), a TIFF in ImageDescription (and XResolution), a raw volume in a file beside it, NAME.raw.json.
namespace lamella::cli
{

struct Record
{
  std::string provenance;            ///< JSON text (io/Provenance.h)
  std::map<int, std::string> phases; ///< grey value → name
  std::optional<double> pixelSize;   ///< [m]
  std::optional<std::array<std::int64_t, 3>> size;
  int bits = 8;
};

[[nodiscard]] std::string toJson(const Record& record);

/// The record of a picture that lamella wrote; nothing for other files and for files that cannot be read.
[[nodiscard]] std::optional<Record> readRecord(const std::filesystem::path& path);

/// Grey value that stands for each phase: spread evenly from 0 to 255.
[[nodiscard]] std::map<int, std::string> greysOfPhases(const PhaseTable& phases);

/// Files in memory. 2D pictures are turned upright, volumes keep their order.
/// @throws ParameterError for a volume as PNG
[[nodiscard]] std::string encodePng(const PhaseImage& image, const Record& record);
/// @throws ParameterError above 4 GB
[[nodiscard]] std::string encodeTiff(const PhaseImage& image, const Record& record);
/// The phase ids as bytes.
[[nodiscard]] std::string_view encodeRaw(const PhaseImage& image) noexcept;

/// Adds a record to a PNG file in memory, and the pixel size where there is one.
[[nodiscard]] std::string addRecordToPng(std::string_view png, const Record& record);

/// The file beside a raw volume.
[[nodiscard]] std::filesystem::path recordBeside(const std::filesystem::path& raw);

} // namespace lamella::cli
