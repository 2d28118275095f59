#include "io/RunCheckpoint.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "core/Together.h"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <new>
#include <span>
#include <utility>
#include <variant>
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

/// Rank 0's to all, array by array.
class Sent
{
public:
  explicit Sent(const Communicator& comm)
    : comm_(comm)
  {
  }
  void number(std::uint64_t& n) const { comm_.broadcast(std::as_writable_bytes(std::span(&n, 1))); }
  void operator()(double& value) const { comm_.broadcast(std::as_writable_bytes(std::span(&value, 1))); }
  void operator()(std::string& text) const { values(text); }
  /// A string or a vector.
  template <class Values>
  void values(Values& v) const
  {
    std::uint64_t count = v.size();
    number(count);
    v.resize(count);
    comm_.broadcast(std::as_writable_bytes(std::span(v)));
  }
  void operator()(CheckpointArray& array) const
  {
    std::uint64_t kind = array.values.index();
    number(kind);
    if (kind != array.values.index())
      array.values = std::vector<std::int64_t>();
    values(array.shape);
    std::visit([this](auto& v) { values(v); }, array.values);
    (*this)(array.unit);
    (*this)(array.description);
  }
  template <class T>
  void operator()(std::map<std::string, T>& all) const
  {
    std::uint64_t count = all.size();
    number(count);
    auto mine = all.begin();
    for (std::uint64_t i = 0; i < count; ++i)
    {
      std::string name = mine != all.end() ? mine->first : std::string();
      (*this)(name);
      if (comm_.rank() != 0)
        mine = all.try_emplace(all.end(), name);
      (*this)(mine->second);
      ++mine;
    }
  }

private:
  const Communicator& comm_;
};

void broadcast(Checkpoint& checkpoint, const Communicator& comm)
{
  const Sent sent(comm);
  sent(checkpoint.kind);
  sent(checkpoint.scene);
  sent(checkpoint.provenance);
  sent(checkpoint.numbers);
  sent(checkpoint.arrays);
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
  Checkpoint checkpoint;
  onFirst(comm, [&] { checkpoint = readFile(path); });
  if (comm.parallel())
    broadcast(checkpoint, comm);
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
