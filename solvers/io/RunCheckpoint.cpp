#include "io/RunCheckpoint.h"

#include "lattice/Error.h"
#include "lattice/Together.h"

#include <fmt/format.h>

#include <cstddef>
#include <vector>

namespace lamella::io
{
namespace
{

/// An error of rank 0 is thrown by all.
void onFirst(const Communicator& comm, const std::function<void()>& f)
{
  together(comm,
    [&]
    {
      if (comm.rank() == 0)
        f();
    });
}

} // namespace

bool write(const Checkpoint& checkpoint, const CheckpointOptions& options, const Communicator& comm)
{
  bool failed = false;
  if (comm.rank() == 0)
    try
    {
      replaceFile(options.path, encode(checkpoint));
    }
    catch (const Error& e)
    {
      failed = true;
      if (options.warn)
        options.warn(std::string(e.what()) + "; the last good checkpoint stays, the run goes on (" + e.hint() + ")");
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
