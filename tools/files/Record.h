#pragma once

#include "session/Session.h"

#include "io/Provenance.h"
#include "lattice/Phases.h"

#include <nlohmann/json_fwd.hpp>

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
namespace lamella::cli
{

struct Record
{
  std::string provenance;            ///< JSON text (io/Provenance.h)
  std::map<int, std::string> phases; ///< grey value → name
  std::optional<double> pixelSize;   ///< [m], exact where the picture format rounds
  std::optional<std::array<std::int64_t, 3>> size;
  int bits = 8;
};

[[nodiscard]] std::string toJson(const Record& record);

/// Nothing for text that is not such a record.
[[nodiscard]] std::optional<Record> parseRecord(std::string_view text);

/// The file beside a raw volume, and what it says.
[[nodiscard]] std::filesystem::path recordBeside(const std::filesystem::path& raw);
[[nodiscard]] std::optional<Record> readRecordBeside(const std::filesystem::path& raw);

/// The record of a run: the command line, the input with its size and hash, and what the input itself was made from.
/// @param before provenance that the input carries, or empty
/// @param file   the input; a pattern such as slice_*.png stays a name. Empty: none is recorded
/// @param scene that the run is part of, or null
[[nodiscard]] io::Provenance recordRun(
  const SceneWishes* scene, const std::string& commandLine, const std::string& file, const std::string& before);

[[nodiscard]] inline io::Provenance recordRun(
  const Session& session, const std::string& commandLine, const std::string& file, const std::string& before)
{
  return recordRun(session.scene(), commandLine, file, before);
}

/// The keys that end a report: `version`, `commit`, `provenance`.
void addRecord(nlohmann::ordered_json& json, const io::Provenance& run);

/// Grey value that stands for each phase: spread evenly from 0 to 255.
[[nodiscard]] std::vector<std::uint8_t> greysOfPhases(const PhaseTable& phases);

} // namespace lamella::cli
