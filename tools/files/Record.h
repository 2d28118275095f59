#pragma once

#include "session/Session.h"

#include "io/Provenance.h"
#include "lattice/Phases.h"
#include "pictures/PictureRecord.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace lamella::cli
{

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
