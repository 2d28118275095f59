#include "io/RunCheckpoint.h"

#include "lattice/Error.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstring>
#include <vector>

namespace lamella::io
{
namespace
{

/// An Error of rank 0, thrown by all: by its message and hint.
void share(const Communicator& comm, const std::function<void()>& onFirst)
{
  std::string message;
  std::string hint;
  if (comm.rank() == 0)
    try
    {
      onFirst();
    }
    catch (const Error& e)
    {
      message = e.what();
      hint = e.hint();
    }
  if (!comm.any(!message.empty()))
    return;
  for (std::string* text : { &message, &hint })
  {
    std::vector<std::byte> bytes(text->size());
    std::memcpy(bytes.data(), text->data(), text->size());
    comm.broadcast(bytes);
    text->assign(reinterpret_cast<const char*>(bytes.data()), bytes.size()); // NOLINT: text
  }
  throw InputError(message, hint);
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
  share(comm, [&] { bytes = readBytes(path); });
  comm.broadcast(bytes);
  Checkpoint checkpoint = decode(bytes, path.string());
  expectScene(checkpoint, kind, scene, path.string());
  return checkpoint;
}

void checkPlace(const CheckpointOptions& options, const Communicator& comm)
{
  if (options.path.empty())
    return;
  if (options.every < 0)
    throw ParameterError(
      fmt::format("a checkpoint every {} events or steps", options.every), "give a number above 0, or leave it out");
  share(comm, [&] { checkPlace(options.path); });
}

} // namespace lamella::io
