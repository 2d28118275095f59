#pragma once

#include "scenes/Sweep.h"

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace lamella::cli
{

/// What runs on the steps of a stage.
struct PlannedEach
{
  const SceneEach* each = nullptr;
  std::vector<std::string> options; ///< words
  bool broken = false;              ///< takes the bonds that are broken: runs at the end, on those of each step
};

/// A command as it runs for one sample.
struct PlannedStage
{
  const SceneStage* stage = nullptr;
  std::string file;                           ///< of the user; empty: none
  std::vector<std::string> words;             ///< "fracture", "memory:sample.vti", "--horizon=4", "--broken=memory:..."
  std::map<std::string, std::string> outputs; ///< names by option, of those that somebody wants
  std::vector<std::size_t> inputs;            ///< stages that it takes data from
  std::vector<PlannedEach> each;
  bool lastStateOnly = true;                                             ///< nobody wants all states at once
  std::optional<std::set<std::string>> arrays = std::set<std::string>(); ///< of states that are wanted; nothing: all
};

/// What runs for one sample and what does not: only what a measure, a picture, a step or a file needs.
struct SamplePlan
{
  std::vector<PlannedStage> stages;
  std::vector<std::string> skipped; ///< "fracture: stress, strain-energy"
  Json settings;                    ///< values of the swept keys, in the order of the file
  std::string key; ///< 16 hexadecimal digits, the hash of all that the sample's numbers and pictures depend on
};

/// Hashes of the files that samples are made from, each found once.
class FileHashes
{
public:
  /// @throws InputError where it cannot be read
  const std::string& of(const std::string& file);

private:
  std::map<std::string, std::string> known_;
};

/// @throws ParameterError for what does not fit together; InputError for a file that is not there
[[nodiscard]] SamplePlan makePlan(
  const Scene& scene, const Sweep& sweep, std::size_t sample, const CommandSet& commands, FileHashes& files);

} // namespace lamella::cli
