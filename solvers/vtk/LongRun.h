#pragma once

#include "vtkPieces.h"

#include <chrono>
#include <string>

/// What algorithms share that run long: how often observers are told, and checkpoints to go on from. Not installed.
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

/// Collective. Whether the checkpoint to go on from is the one that this very run is to make, and not there yet.
[[nodiscard]] bool beginsAnew(const std::string& continueFile, const std::string& checkpointFile, const Team& team);

/// A warning that says so.
/// @param from what the run began with
[[nodiscard]] std::string anewWarning(const std::string& continueFile, const char* from);

} // namespace lamella
