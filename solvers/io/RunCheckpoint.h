#pragma once

#include "core/Clock.h"
#include "core/Communicator.h"
#include "io/Checkpoint.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

/// Checkpoints of a run on any number of ranks: rank 0 writes and reads.
namespace lamella::io
{

struct CheckpointOptions
{
  std::filesystem::path path{}; ///< none: no checkpoints. Replaced whenever there is a newer state
  std::int64_t every = 0;       ///< events, or steps in time, between two files at least
  /// Wall time before the first file and between two at least. Above 0 there is none at the end, and none that the run
  /// would not go on from to the same bits.
  double seconds = 0;
  std::string provenance{}; ///< io::toJson(); goes into the file as it is
  /// Called on rank 0 when a file cannot be written (a full disk): the last good one stays, the run goes on.
  std::function<void(const std::string&)> warn{};
};

/// Whether rank 0 has so much memory, which it takes to put a checkpoint together; says there if not. Collective.
[[nodiscard]] bool roomFor(std::uint64_t bytes, const CheckpointOptions& options, const Communicator& comm);

/// Writes on rank 0; says there, by CheckpointOptions::warn, what stands in the way. Collective.
/// @param checkpoint given away
/// @return whether it was written
bool write(Checkpoint checkpoint, const CheckpointOptions& options, const Communicator& comm);
/// Read by rank 0 for all. @throws InputError on all ranks alike: see readFile(), expectScene()
[[nodiscard]] Checkpoint readCheckpoint(
  const std::filesystem::path& path, const std::string& kind, const std::string& scene, const Communicator& comm);
/// Tells when CheckpointOptions::seconds have passed.
class CheckpointPace
{
public:
  /// Whether they have since written(), or since this was made. The same on all ranks. Collective.
  [[nodiscard]] bool due(const CheckpointOptions& options, const Communicator& comm) const;
  void written() { last_ = Clock::now(); }

private:
  Clock::time_point last_ = Clock::now();
};

/// Refuses a place where no file can be written, before the run. @throws InputError on all ranks. Collective.
void checkPlace(const CheckpointOptions& options, const Communicator& comm);

} // namespace lamella::io
