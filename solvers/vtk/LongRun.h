#pragma once

#include "vtkPieces.h"
#include "vtkSampleAlgorithm.h"

#include "io/RunCheckpoint.h"

#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkSmartPointer.h"
#include "vtkTimeStamp.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

/// What algorithms share that run long: how often observers are told, the states that they keep, and checkpoints to go
/// on from. Not installed.
namespace lamella
{

/// Lets observers be told at most some twenty times a second.
class Pace
{
public:
  /// Whether they are to be told now.
  [[nodiscard]] bool due()
  {
    const auto now = std::chrono::steady_clock::now();
    if (now - told_ < std::chrono::milliseconds(50))
    {
      return false;
    }
    told_ = now;
    return true;
  }
  /// The next time is due whatever the clock.
  void next() { told_ = {}; }

private:
  std::chrono::steady_clock::time_point told_{};
};

/// The states of a run, kept so that another one can be shown without running again.
template <class Data>
class KeptStates
{
public:
  [[nodiscard]] int count() const { return static_cast<int>(states_.size()); }
  /// Null where there is none such.
  [[nodiscard]] Data* at(int state) const
  {
    return state >= 0 && state < count() ? states_[static_cast<std::size_t>(state)].Get() : nullptr;
  }
  [[nodiscard]] const std::vector<vtkSmartPointer<Data>>& all() const { return states_; }
  /// A new state, empty. Where only the last one is to be kept, those before it go.
  Data* add(bool keepAll)
  {
    if (!keepAll)
    {
      states_.clear();
    }
    return states_.emplace_back(vtkSmartPointer<Data>::New());
  }

  /// Which one is shown, from 0; below 0, and beyond the last one: the last.
  void choose(int state)
  {
    if (const int chosen = std::max(state, -1); chosen != chosen_)
    {
      chosen_ = chosen;
      changed_.Modified(); // not the algorithm's Modified(): that would run all again
    }
  }
  [[nodiscard]] int chosen() const { return chosen_; }
  /// Of an algorithm that shows them, whose own settings changed at this time.
  [[nodiscard]] vtkMTimeType changed(vtkMTimeType settings) const { return std::max(settings, changed_.GetMTime()); }
  /// Gives the output the chosen state and its time. There is one at least.
  void show(vtkDataObject* output) const
  {
    Data* const state = at(chosen_ < 0 ? count() - 1 : std::min(chosen_, count() - 1));
    output->ShallowCopy(state);
    output->GetInformation()->Set(
      vtkDataObject::DATA_TIME_STEP(), state->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
  }

  /// Runs, unless the last run was of the same input, settings and ranks. Collective.
  /// @param settings when they changed last
  /// @param forget what there is besides the states; called before a run, and where it fails
  template <class Run, class Forget>
  void renew(vtkDataObject* input, vtkMTimeType settings, const Team& team, const Run& run, const Forget& forget)
  {
    if (!team.any(states_.empty() || input_ != input->GetMTime() || settings_ != settings || ranks_ != team.size()))
    {
      return;
    }
    const auto forgetAll = [&]
    {
      states_.clear();
      forget();
    };
    forgetAll();
    try
    {
      run();
    }
    catch (...)
    {
      forgetAll();
      throw;
    }
    input_ = input->GetMTime();
    settings_ = settings;
    ranks_ = team.size();
  }

private:
  std::vector<vtkSmartPointer<Data>> states_;
  int chosen_ = -1;
  vtkTimeStamp changed_;
  // of the last run
  vtkMTimeType input_ = 0;
  vtkMTimeType settings_ = 0;
  int ranks_ = 0;
};

/// Hands a state to those who observe an algorithm's steps.
inline void tellStep(vtkObject* algorithm, vtkDataObject* state)
{
  algorithm->InvokeEvent(vtkSampleAlgorithm::STEP_EVENT, state);
}

/// Where a run begins.
struct RunStart
{
  std::string from;    ///< the checkpoint to go on from; empty: the beginning
  std::string warning; ///< or empty
};
/// Tells the run where its checkpoints go and what its input is made from. It begins anew, with a warning, where the
/// checkpoint to go on from is the one that this very run is to make, and not there yet. Collective.
/// @param beginning what it begins with, as the warning calls it
[[nodiscard]] RunStart startOf(const std::string& continueFile, const std::string& checkpointFile,
  const char* beginning, vtkDataObject* input, const Team& team, io::CheckpointOptions& options);

} // namespace lamella
