#pragma once

#include "scenes/SampleRunner.h"

#include <string>
#include <vector>

namespace lamella::cli
{

/// The first sample of a scene, made but not solved, and what a run would look at before its first solve.
class Rehearsal
{
public:
  /// Makes the sample. @throws as the commands that make it
  Rehearsal(const Scene& scene, const SamplePlan& first);

  /// Starts every stage up to where it would begin to work: files, options, names of phases against the sample, arrays
  /// that are drawn or counted, measures.
  /// @returns why this sample would fail where that is no slip of the scene's: no path, too little memory
  /// @throws ParameterError, InputError with the place in the scene
  [[nodiscard]] std::vector<std::string> operator()();

  [[nodiscard]] const SamplePlan& plan() const noexcept { return plan_; }
  /// Stages that make the sample; their data are in the workspace.
  [[nodiscard]] const std::vector<PlannedStage>& made() const noexcept { return made_.stages; }
  /// Bytes of the program before.
  [[nodiscard]] double bytesBefore() const noexcept { return bytesBefore_; }

private:
  /// Whether the stage that is rehearsed has begun to work, by what it tells of its progress.
  [[nodiscard]] bool works(double share);
  [[nodiscard]] bool isMade(const PlannedStage& stage) const;
  void checkPhasesOfMeasures() const;
  void checkArrays() const;
  void checkArray(const SceneStage& taker, const std::vector<std::string>& words, const PlannedStage& giver) const;
  void rehearse(const PlannedStage& stage, bool ready);

  const Scene& scene_;
  const SamplePlan& plan_;
  SamplePlan made_;
  double bytesBefore_;
  int looks_ = -1; ///< how often the stage that is rehearsed told of a share of 0; -1: the sample is made
  SampleRunner runner_;
  std::vector<std::string> failures_;
};

} // namespace lamella::cli
