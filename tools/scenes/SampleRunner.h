#pragma once

#include "scenes/Plan.h"

#include "session/Session.h"
#include "session/Workspace.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

class vtkDataObject;

namespace lamella::cli
{

class StageCheckpoint;

/// Runs the stages of samples, one sample after the other. What two samples in a row have in common is computed once.
class SampleRunner
{
public:
  using Progress = std::function<bool(double share, const std::string& what)>;

  /// @param commandLine for the record
  SampleRunner(const Scene& scene, const std::string& commandLine, Progress progress);

  /// @param folder for pictures and files; made where something is to be written
  /// @returns the record: settings, what each stage reported, what ran on steps, times, memory, warnings
  /// @throws Error as the commands do, with the place in the scene where that is known; Cancelled
  [[nodiscard]] Json run(const SamplePlan& plan, const std::filesystem::path& folder);

  /// Starts one stage on data that are there, to see what it refuses; its progress ends it.
  void rehearse(const PlannedStage& planned);

private:
  struct Done
  {
    std::string key; ///< of words and of what they were applied to
    Json report;
    std::vector<std::string> warnings;
  };
  class Steps;

  /// Runs a stage that was not reused. @param kept or null @param steps takes what ran on its steps
  Done perform(const PlannedStage& planned, const std::filesystem::path& folder, StageCheckpoint* kept, Json& steps);
  /// The same from its checkpoint, where there is one that fits.
  Done performLong(const PlannedStage& planned, const std::filesystem::path& folder, Json& steps);
  Json runStage(const PlannedStage& planned, Steps* steps, std::vector<std::string>& warnings);
  Json runCommand(const std::vector<std::string>& words, std::vector<std::string>& warnings);
  void write(const PlannedStage& planned, const std::filesystem::path& folder);
  /// The number of what the present sample has done so far, for the progress.
  bool tell(double share, const std::string& what) const;

  const Scene& scene_;
  std::string commandLine_;
  Progress progress_;
  Workspace workspace_;
  SceneWishes wishes_; ///< of the command that runs
  std::function<void(vtkDataObject*)> onStep_;
  std::map<std::string, Done> done_;
  double before_ = 0; ///< share of the sample's stages that are done
  double part_ = 1;   ///< share of the stage that runs
};

/// The same error with the place in the scene of the key that it is about, or of the section.
template <class Kind>
[[noreturn]] void throwAt(const Kind& error, const SceneStage& stage)
{
  const std::string message = error.what();
  if (message.starts_with(stage.where.substr(0, stage.where.find(':') + 1))) // it is told already
    throw Kind(error);
  const std::string line = lineOf(stage, message);
  throw Kind((line.empty() ? stage.where : line) + ": [" + stage.name + "] " + message, error.hint());
}

/// The first bonds of those that broke, in order.
[[nodiscard]] vtkSmartPointer<vtkDataObject> firstBonds(vtkDataObject* broken, std::int64_t count);

} // namespace lamella::cli
