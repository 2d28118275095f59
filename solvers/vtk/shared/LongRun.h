#pragma once

#include "vtkPieces.h"
#include "vtkSampleAlgorithm.h"

#include "io/RunCheckpoint.h"

#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkSmartPointer.h"
#include "vtkTimeStamp.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

class vtkAbstractArray;

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
      return false;
    told_ = now;
    return true;
  }
  /// The next time is due whatever the clock.
  void next() { told_ = {}; }

private:
  std::chrono::steady_clock::time_point told_{};
};

/// What an image was made of at a time: its lattice and its arrays. ParaView puts filters of its own before every other
/// one, which hand the same arrays on in an image that is always new: the image's own time tells nothing.
/// A source has none: null.
class InputMark
{
public:
  void take(vtkImageData* image);
  /// Whether it has the same lattice and arrays, unchanged since. False before take().
  [[nodiscard]] bool same(vtkImageData* image) const;

private:
  struct Content
  {
    std::array<int, 6> extent{};
    std::array<double, 3> origin{};
    std::array<double, 3> spacing{};
    std::array<double, 9> direction{};
    std::vector<std::pair<vtkAbstractArray*, vtkMTimeType>> arrays{};
    bool operator==(const Content&) const = default;
  };
  static Content contentOf(vtkImageData* image);

  vtkSmartPointer<vtkImageData> kept_; ///< keeps the arrays, so that no others come to lie where they were
  Content content_;
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
      states_.clear();
    return states_.emplace_back(vtkSmartPointer<Data>::New());
  }

  void clear() { states_.clear(); }

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
  /// Something of them is to be shown, or no more, for which nothing runs again.
  void toggle(bool& setting, bool on)
  {
    if (setting != on)
    {
      setting = on;
      changed_.Modified();
    }
  }
  /// The one that is shown. There is one at least.
  [[nodiscard]] Data* shown() const { return at(chosen_ < 0 ? count() - 1 : std::min(chosen_, count() - 1)); }
  /// Gives the output that state and its time.
  void show(vtkDataObject* output) const
  {
    Data* const state = shown();
    output->ShallowCopy(state);
    if (state->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()) != 0)
    {
      output->GetInformation()->Set(
        vtkDataObject::DATA_TIME_STEP(), state->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
    }
  }

  /// Runs, unless the last run was of the same input, settings and ranks. Collective.
  /// @param settings when they changed last
  /// @param forget what there is besides the states; called before a run, and where it fails
  /// @param lacking the states lack something that is asked for now
  template <class Run, class Forget>
  void renew(vtkImageData* input, vtkMTimeType settings, const Team& team, const Run& run, const Forget& forget,
    bool lacking = false)
  {
    if (!team.any(lacking || states_.empty() || !input_.same(input) || settings_ != settings || ranks_ != team.size()))
      return;
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
    input_.take(input);
    settings_ = settings;
    ranks_ = team.size();
  }

private:
  std::vector<vtkSmartPointer<Data>> states_;
  int chosen_ = -1;
  vtkTimeStamp changed_;
  // of the last run
  InputMark input_;
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
