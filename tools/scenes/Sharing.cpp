#include "scenes/Sharing.h"

#include "session/OutputFile.h"
#include "session/Watchdog.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <map>
#include <new>
#include <stdexcept>
#include <thread>

namespace lamella::cli
{

namespace
{

constexpr int mostJobs = 256;
constexpr auto pause = std::chrono::milliseconds(20);

std::string inAll(std::size_t done, std::size_t count)
{
  return fmt::format("{} of {} samples", done, count);
}

// --- processes -------------------------------------------------------------------------------------------------------

/// What processes have in common.
struct Common
{
  std::atomic<std::uint64_t> next{ 0 };
  std::atomic<std::uint64_t> done{ 0 };
  std::atomic<int> failed{ 0 };                            ///< 0, or the exit code of the first that failed
  std::array<std::atomic<std::uint64_t>, mostJobs> task{}; ///< of each process, counted from 1; 0: none
  std::array<char, 4096> message{};
  std::array<char, 1024> hint{};

  void fail(const std::exception& error)
  {
    int none = 0;
    if (failed.compare_exchange_strong(none, std::max(1, exitCode(error))))
    {
      const auto* const known = dynamic_cast<const Error*>(&error);
      std::strncpy(message.data(), error.what(), message.size() - 1);
      std::strncpy(hint.data(), known != nullptr ? known->hint().c_str() : "", hint.size() - 1);
    }
  }
  /// As the one that failed.
  [[noreturn]] void rethrow() const
  {
    switch (failed.load())
    {
      case exitUsage:
        throw ParameterError(message.data(), hint.data());
      case exitInput:
        throw InputError(message.data(), hint.data());
      case exitOutput:
        throw OutputError(message.data(), hint.data());
      case exitMemory:
        throw MemoryError(message.data(), hint.data());
      default:
        throw std::runtime_error(message.data());
    }
  }
};

class CommonMemory
{
public:
  CommonMemory()
    : memory_(::mmap(nullptr, sizeof(Common), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))
  {
    if (memory_ == MAP_FAILED)
      throw std::bad_alloc();
    common_ = new (memory_) Common;
  }
  ~CommonMemory() { ::munmap(memory_, sizeof(Common)); }
  CommonMemory(const CommonMemory&) = delete;
  CommonMemory& operator=(const CommonMemory&) = delete;
  Common* operator->() const { return common_; }

private:
  void* memory_;
  Common* common_ = nullptr;
};

/// The life of a process that works.
void workUntilDone(const Sharing& sharing, const CommonMemory& common, std::size_t slot, std::size_t count)
{
  try
  {
    for (std::size_t task = common->next++; task < count && common->failed.load() == 0; task = common->next++)
    {
      common->task[slot] = task + 1;
      sharing.work(task, [](double, const std::string&) { return !Session::interrupted(); });
      common->task[slot] = 0;
      ++common->done;
    }
  }
  catch (const Cancelled&)
  {
    common->task[slot] = 0;
  }
  catch (const std::exception& error)
  {
    common->task[slot] = 0;
    common->fail(error);
  }
}

pid_t start(const Sharing& sharing, const CommonMemory& common, std::size_t slot, std::size_t count)
{
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0)
    throw std::runtime_error(std::string("cannot start a process: ") + std::strerror(errno));
  if (child == 0)
  {
    ::setpgid(0, 0); // Ctrl-C is for the parent, which passes it on
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    watchProcess();
    if (::getppid() == parent)
      workUntilDone(sharing, common, slot, count);
    ::_exit(0);
  }
  return child;
}

void onProcesses(Session& session, const Sharing& sharing, std::size_t count)
{
  const CommonMemory common;
  std::map<pid_t, std::size_t> running;
  const auto jobs = std::min<std::size_t>({ static_cast<std::size_t>(sharing.jobs), count, mostJobs });
  for (std::size_t slot = 0; slot < jobs; ++slot)
    running[start(sharing, common, slot, count)] = slot;
  bool told = false;
  while (!running.empty())
  {
    const bool stop = !session.progress(
      static_cast<double>(common->done.load()) / static_cast<double>(count), inAll(common->done.load(), count));
    if ((stop || common->failed.load() != 0) && !told)
    {
      told = true;
      for (const auto& [process, slot] : running)
        ::kill(process, SIGTERM);
    }
    int status = 0;
    const pid_t ended = ::waitpid(-1, &status, WNOHANG);
    const auto found = ended > 0 ? running.find(ended) : running.end();
    if (found == running.end())
    {
      std::this_thread::sleep_for(pause);
      continue;
    }
    const std::size_t slot = found->second;
    running.erase(found);
    const std::uint64_t task = common->task[slot].exchange(0);
    if (task > 0 && !told) // in the middle of it
    {
      sharing.died(task - 1,
        WIFSIGNALED(status) ? fmt::format("its process was killed by signal {}", WTERMSIG(status))
                            : fmt::format("its process ended with code {}", WEXITSTATUS(status)));
      ++common->done;
      running[start(sharing, common, slot, count)] = slot;
    }
  }
  session.endProgress();
  Session::checkInterrupt();
  if (common->failed.load() != 0)
    common->rethrow();
}

// --- ranks -----------------------------------------------------------------------------------------------------------

/// A counter of all ranks, which lies on rank 0.
class RankCounter
{
public:
  explicit RankCounter(MPI_Comm comm)
  {
    int rank = 0;
    MPI_Comm_rank(comm, &rank);
    MPI_Win_allocate(
      rank == 0 ? sizeof(std::int64_t) : 0, sizeof(std::int64_t), MPI_INFO_NULL, comm, &value_, &window_);
    if (rank == 0)
    {
      MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, window_);
      *value_ = 0;
      MPI_Win_unlock(0, window_);
    }
    MPI_Barrier(comm);
  }
  /// Collective. Not in a destructor: where one rank failed the others do not come here.
  void free() { MPI_Win_free(&window_); }
  RankCounter(const RankCounter&) = delete;
  RankCounter& operator=(const RankCounter&) = delete;

  [[nodiscard]] std::size_t next()
  {
    const std::int64_t one = 1;
    std::int64_t before = 0;
    MPI_Win_lock(MPI_LOCK_SHARED, 0, 0, window_);
    MPI_Fetch_and_op(&one, &before, MPI_INT64_T, 0, 0, MPI_SUM, window_);
    MPI_Win_unlock(0, window_);
    return static_cast<std::size_t>(before);
  }

private:
  MPI_Win window_ = MPI_WIN_NULL;
  std::int64_t* value_ = nullptr;
};

/// Waits for all ranks without keeping a core busy.
void waitForRanks(MPI_Comm comm)
{
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibarrier(comm, &request);
  int all = 0;
  while (all == 0)
  {
    MPI_Test(&request, &all, MPI_STATUS_IGNORE);
    Session::checkInterrupt();
    std::this_thread::sleep_for(pause);
  }
}

void onRanks(Session& session, const Sharing& sharing, std::size_t count)
{
  const MPI_Comm comm = session.communicator();
  RankCounter counter(comm);
  for (std::size_t task = counter.next(); task < count; task = counter.next())
  {
    sharing.work(task,
      [&](double share, const std::string& what)
      {
        int waiting = 0; // where ranks sit on several machines, the counter is served when MPI is called
        MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm, &waiting, MPI_STATUS_IGNORE);
        return session.progress((static_cast<double>(task) + share) / static_cast<double>(count),
          fmt::format("{}: {}", inAll(task + 1, count), what));
      });
    Session::checkInterrupt();
  }
  session.endProgress();
  waitForRanks(comm);
  counter.free();
}

} // namespace

void shareOut(Session& session, const Sharing& sharing, std::size_t count)
{
  constexpr std::size_t few = 8; // samples; within one its stages count alike, whatever they take
  if (count < few)
    session.sharesAreGuesses();
  if (session.ranks() > 1)
  {
    onRanks(session, sharing, count);
    return;
  }
  if (sharing.jobs > 1 && count > 1)
  {
    onProcesses(session, sharing, count);
    return;
  }
  for (std::size_t task = 0; task < count; ++task)
  {
    sharing.work(task,
      [&](double share, const std::string& what)
      {
        return session.progress((static_cast<double>(task) + share) / static_cast<double>(count),
          count == 1 ? what : fmt::format("{}: {}", inAll(task + 1, count), what));
      });
    Session::checkInterrupt();
  }
  session.endProgress();
}

} // namespace lamella::cli
