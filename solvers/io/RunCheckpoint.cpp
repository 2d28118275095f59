#include "io/RunCheckpoint.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "core/Together.h"

#include <fmt/format.h>

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace lamella::io
{
namespace
{

/// An error of rank 0 is thrown by all.
void onFirst(const Communicator& comm, const std::function<void()>& f)
{
  together(
    comm,
    [&]
    {
      if (comm.rank() == 0)
        f();
    });
}

void warnNotWritten(const CheckpointOptions& options, const std::string& what, const std::string& hint)
{
  if (options.warn)
    options.warn(what + "; the last good checkpoint stays, the run goes on (" + hint + ")");
}

constexpr const char* forMemory = "free memory, or run without checkpoints";

} // namespace

bool roomFor(std::uint64_t bytes, const CheckpointOptions& options, const Communicator& comm)
{
  const std::uint64_t available = availableMemory();
  const bool missing = comm.rank() == 0 && bytes > available;
  if (missing)
    warnNotWritten(options,
      fmt::format("a checkpoint needs about {} of memory to be put together, and {} are available",
        bytesText(static_cast<double>(bytes)), bytesText(static_cast<double>(available))),
      forMemory);
  return !comm.any(missing);
}

bool write(Checkpoint checkpoint, const CheckpointOptions& options, const Communicator& comm)
{
  bool failed = false;
  if (comm.rank() == 0)
    try
    {
      replaceFile(options.path, std::move(checkpoint));
    }
    catch (const Error& e)
    {
      failed = true;
      warnNotWritten(options, e.what(), e.hint());
    }
    catch (const std::bad_alloc&)
    {
      failed = true;
      warnNotWritten(options, "there is not memory enough to write a checkpoint", forMemory);
    }
  return !comm.any(failed);
}

Checkpoint readCheckpoint(
  const std::filesystem::path& path, const std::string& kind, const std::string& scene, const Communicator& comm)
{
  std::vector<std::byte> bytes;
  onFirst(comm, [&] { bytes = readBytes(path); });
  comm.broadcast(bytes);
  Checkpoint checkpoint = decode(bytes, path.string());
  expectScene(checkpoint, kind, scene, path.string());
  return checkpoint;
}

bool CheckpointPace::due(const CheckpointOptions& options, const Communicator& comm) const
{
  return !(options.seconds > 0) || comm.any(secondsSince(last_) >= options.seconds);
}

void checkPlace(const CheckpointOptions& options, const Communicator& comm)
{
  if (options.path.empty())
    return;
  if (options.every < 0)
    throw ParameterError(
      fmt::format("a checkpoint every {} events or steps", options.every), "give a number above 0, or leave it out");
  onFirst(comm, [&] { checkPlace(options.path); });
}

} // namespace lamella::io
