#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

/// Label pictures that carry what they mean: which grey is which phase, how large a pixel is, where they come from.
///
/// One JSON object { "provenance": {...}, "phases": {"0": "lumen", ...}, "pixel_size": 1e-6, "size": [nx, ny, nz],
/// "bits": 8 }. PNG and TIFF hold it as their description, a raw volume in a file beside it, NAME.raw.json.
namespace lamella::micrograph
{

struct PictureRecord
{
  std::string provenance;            ///< JSON text (io/Provenance.h)
  std::map<int, std::string> phases; ///< grey value → name
  std::optional<double> pixelSize;   ///< [m], exact where the picture format rounds
  std::optional<std::array<std::int64_t, 3>> size;
  int bits = 8;
};

[[nodiscard]] std::string toJson(const PictureRecord& record);

/// Nothing for text that is not such a record.
[[nodiscard]] std::optional<PictureRecord> parseRecord(std::string_view text);

/// The file beside a raw volume, and what it says.
[[nodiscard]] std::filesystem::path recordBeside(const std::filesystem::path& raw);
[[nodiscard]] std::optional<PictureRecord> readRecordBeside(const std::filesystem::path& raw);

} // namespace lamella::micrograph
