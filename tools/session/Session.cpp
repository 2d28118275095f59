#include "session/Session.h"

#include "session/OutputFile.h"
#include "session/TimeLeft.h"
#include "session/Watchdog.h"

#include "core/Communicator.h"
#include "core/PartFile.h"

#include <fmt/format.h>

#include <pthread.h>
#include <sys/ioctl.h>
#include <time.h> // NOLINT: timer_create is declared here and not in <ctime>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

namespace lamella::cli
{

namespace
{

volatile std::sig_atomic_t caught = 0;

std::string& inputPath()
{
  static std::string path;
  return path;
}

/// How far the one run of this process is, as progress() was told last.
struct Progress
{
  double share = 0;
  std::string doing; ///< empty where it was told nothing
  TimeLeft left;
};
Progress& progressed()
{
  static Progress progress;
  return progress;
}

/// A check saw the signal: the run stops by itself, and may take the time that its checkpoint needs.
std::atomic<bool> heard{ false };

/// Ends the process where no check comes along for too long after a signal: libraries that set up or solve (hypre), or
/// write, cannot be asked to stop. Files of ours are whole or gone then as ever.
struct Watchdog
{
  timer_t timer{};
  bool there = false;
  bool tells = true; ///< what happened; a process of a scene does not
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();

  /// Of processor time of the thread that calls make(): waiting for a disk or for other ranks is not counted.
  static constexpr double most = 1.5;

  void make(bool telling) noexcept;
  void begin() const noexcept // safe in a signal handler, as all below
  {
    itimerspec time{};
    time.it_value.tv_sec = static_cast<time_t>(most);
    time.it_value.tv_nsec = static_cast<long>(1e9 * (most - static_cast<double>(time.it_value.tv_sec)));
    if (there)
      (void)::timer_settime(timer, 0, &time, nullptr);
  }
};
Watchdog watchdog;

extern "C" void onTooLong(int)
{
  if (heard.load())
    return;
  OutputFile::removeAll();
  if (!PartFile::removedAll()) // results take their places, a moment
  {
    watchdog.begin();
    return;
  }
  if (watchdog.tells)
  {
    const Progress& at = progressed(); // not changed any more: progress() sees that there was a signal
    std::array<char, 512> text{};
    int length = 0;
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - watchdog.start).count();
    const char* const hint =
      "hint: it was in the midst of what cannot be stopped: nothing of it was written; a checkpoint "
      "stands as it was written last\n";
    length = at.doing.empty()
      ? std::snprintf(text.data(), text.size(), "error: interrupted\n%s", hint)
      : std::snprintf(text.data(), text.size(), "error: interrupted at %.2g %%, after %.3g s: %.100s\n%s",
          100 * std::clamp(at.share, 0.0, 1.0), elapsed, at.doing.c_str(), hint);
    (void)!::write(STDERR_FILENO, text.data(), static_cast<std::size_t>(std::max(length, 0)));
  }
  ::_exit(Session::interruptCode());
}

void Watchdog::make(bool telling) noexcept
{
  tells = telling;
  clockid_t clock{};
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGPROF;
  struct sigaction action = {};
  action.sa_handler = onTooLong;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  there = ::pthread_getcpuclockid(::pthread_self(), &clock) == 0 && ::sigaction(SIGPROF, &action, nullptr) == 0 &&
    ::timer_create(clock, &event, &timer) == 0;
}

extern "C" void onSignal(int signal)
{
  OutputFile::removeAll();
  if (caught != 0) // the second time: at once
    _exit(128 + signal);
  caught = signal;
  watchdog.begin();
}

/// What nobody caught, in a thread or beneath a library: one line, as everything else.
[[noreturn]] void onTerminate()
{
  static std::atomic_flag told = ATOMIC_FLAG_INIT;
  while (told.test_and_set()) // another thread tells, and ends the program
    ::pause();
  OutputFile::removeAll();
  if (const std::exception_ptr thrown = std::current_exception())
  {
    try
    {
      std::rethrow_exception(thrown);
    }
    catch (const std::exception& error)
    {
      printError(error);
      ::_exit(exitCode(error));
    }
    catch (...) // NOLINT(bugprone-empty-catch): no error of ours; it ends as it would
    {
    }
  }
  std::abort();
}

/// No memory is what a thread that cannot be made lacks, too.
bool lacksMemory(const std::exception& error)
{
  const auto* const system = dynamic_cast<const std::system_error*>(&error);
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
    (system != nullptr &&
      (system->code() == std::errc::resource_unavailable_try_again || system->code() == std::errc::not_enough_memory));
}

void install(int signal, void (*handler)(int))
{
  struct sigaction before = {};
  if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN)
    return; // under nohup, or in the background of a script: stays ignored
  struct sigaction action = {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  ::sigaction(signal, &action, nullptr);
}

/// An MPI launcher tells its processes who they are through the environment (Open MPI and PRRTE; MPICH, Intel and
/// Slurm's PMI; Slurm's and others' PMIx).
bool startedByLauncher()
{
  for (const char* name : { "OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE" })
    if (std::getenv(name) != nullptr)
      return true;
  return false;
}

} // namespace

int exitCode(const std::exception& error) noexcept
{
  if (dynamic_cast<const Cancelled*>(&error) != nullptr)
    return Session::interruptCode();
  if (dynamic_cast<const ParameterError*>(&error) != nullptr)
    return exitUsage;
  if (dynamic_cast<const InputError*>(&error) != nullptr)
    return exitInput;
  if (dynamic_cast<const NoPathError*>(&error) != nullptr)
    return exitNoPath;
  if (dynamic_cast<const MemoryError*>(&error) != nullptr || lacksMemory(error))
    return exitMemory;
  if (dynamic_cast<const DivergenceError*>(&error) != nullptr)
    return exitDiverged;
  if (dynamic_cast<const OutputError*>(&error) != nullptr)
    return exitOutput;
  return exitInternal;
}

void printError(const std::exception& error)
{
  std::string message = error.what();
  std::string hint;
  if (const auto* known = dynamic_cast<const Error*>(&error))
  {
    hint = known->hint();
  }
  else if (lacksMemory(error))
  {
    message = "there is not enough memory";
    hint = "take a smaller --window or --refine, or share the work out: mpirun -n N lamella ...";
  }
  else
  {
    message = "internal error: " + message;
    hint = "this is a fault of lamella: please report it with the command line and the input";
  }
  std::string text = "error: " + message + "\n";
  if (!hint.empty())
    text += "hint: " + hint + "\n";
  std::fputs(Session::named(text).c_str(), stderr);
}

namespace
{

/// printError(), and of an interruption how far the run was.
void tell(const std::exception& error, std::chrono::steady_clock::time_point start)
{
  const auto* const cancelled = dynamic_cast<const Cancelled*>(&error);
  const Progress& at = progressed();
  if (cancelled == nullptr || at.doing.empty())
  {
    printError(error);
    return;
  }
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  printError(Error(fmt::format("{} at {:.2g} %, after {:.3g} s: {}", error.what(), 100 * std::clamp(at.share, 0.0, 1.0),
                     elapsed, at.doing),
    cancelled->hint()));
}

} // namespace

Session::Session(int& argc, char**& argv)
  : terminal_(::isatty(STDERR_FILENO) == 1)
  , start_(std::chrono::steady_clock::now())
{
  std::set_terminate(onTerminate);
  install(SIGINT, onSignal);
  install(SIGTERM, onSignal);
  install(SIGHUP, onSignal);
  install(SIGXFSZ, SIG_IGN); // a file at the size limit then fails with a message instead of ending the program
  if (startedByLauncher())
  {
    MPI_Init(&argc, &argv);
    // A communicator of our own: messages of libraries cannot be taken for ours.
    MPI_Comm_dup(MPI_COMM_WORLD, &world_);
    MPI_Comm_rank(world_, &rank_);
    MPI_Comm_size(world_, &ranks_);
    mpi_ = true;
  }
  watchdog.make(rank_ == 0);
}

Session::Session(std::function<bool(double share, const std::string& what)> progress)
  : outside_(std::move(progress))
  , start_(std::chrono::steady_clock::now())
{
}

Session::~Session()
{
  if (mpi_)
  {
    MPI_Comm_free(&world_);
    MPI_Finalize();
  }
}

int Session::ranksOnMachine() const
{
  return Communicator(communicator()).sizeOnMachine();
}

void Session::note(const std::string& text)
{
  if (!outside_ && root() && !quiet_)
  {
    endProgress();
    std::fputs(named("note: " + text + "\n").c_str(), stderr);
  }
}

void Session::warn(const std::string& text)
{
  if (outside_)
  {
    warnings_.push_back(text);
  }
  else if (root())
  {
    endProgress();
    std::fputs(named("warning: " + text + "\n").c_str(), stderr);
  }
}

void Session::fallShort(const std::string& message, const std::string& hint)
{
  if (outside_)
  {
    warn(message + ": " + hint);
    return;
  }
  code_ = exitShort;
  if (root())
  {
    endProgress();
    printError(ParameterError(message, hint));
  }
}

void Session::onRoot(const std::function<void()>& work)
{
  int code = 0;
  if (root())
  {
    try
    {
      work();
    }
    catch (const std::exception& error)
    {
      if (ranks_ > 1)
      {
        code = std::max(1, exitCode(error));
        MPI_Bcast(&code, 1, MPI_INT, 0, world_);
      }
      throw;
    }
  }
  if (ranks_ > 1)
  {
    MPI_Bcast(&code, 1, MPI_INT, 0, world_);
    if (code != 0)
      throw FailedElsewhere{ code };
  }
}

int Session::fail(const std::exception& error)
{
  const int code = exitCode(error);
  endProgress();
  if (root())
    tell(error, start_);
  if (ranks_ == 1)
    return code;
  if (!waitForAll())
  {
    if (!root())
    {
      std::fprintf(stderr, "on rank %d of %d:\n", rank_, ranks_);
      printError(error);
    }
    OutputFile::removeAll();
    MPI_Abort(world_, code);
  }
  return code;
}

int Session::fail(const FailedElsewhere& error)
{
  if (!waitForAll())
    MPI_Abort(world_, error.code);
  return error.code;
}

bool Session::waitForAll()
{
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibarrier(world_, &request);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  int all = 0;
  while (all == 0 && std::chrono::steady_clock::now() < end)
  {
    MPI_Test(&request, &all, MPI_STATUS_IGNORE);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return all != 0;
}

void Session::callInput(const std::string& path)
{
  inputPath() = path;
}

std::string Session::named(std::string text)
{
  const std::string& path = inputPath();
  for (std::size_t at = 0; !path.empty() && (at = text.find(path, at)) != std::string::npos; ++at)
    text.erase(at, path.size()).insert(at, 1, '-');
  return text;
}

void Session::print(const std::string& text) const
{
  if (outside_)
  {
    printed_ += text;
  }
  else if (FILE* const to = OutputFile::usesStandardOutput() ? stderr : stdout;
           root() && (std::fputs(named(text).c_str(), to) < 0 || std::fflush(to) != 0))
  {
    throw OutputError(std::string("cannot write the result to standard output: ") + std::strerror(errno),
      "make room on the disk, or send it elsewhere");
  }
}

bool Session::progress(double share, const std::string& what)
{
  if (interrupted()) // filters that stop say that they are done
    return false;
  progressed().share = share;
  progressed().doing = what;
  if (outside_)
    return outside_(share, what);
  if (!root() || !terminal_ || quiet_)
    return true;
  const auto now = std::chrono::steady_clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  // Nothing for what is done in the blink of an eye.
  if (elapsed < 0.5 || now - drawn_ < std::chrono::milliseconds(100))
    return true;
  drawn_ = now;
  share = std::clamp(share, 0.0, 1.0);
  struct winsize window = {};
  const int columns = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0 ? window.ws_col : 80;

  progressed().left.tell(elapsed, share);
  const auto left = guesses_ ? std::nullopt : progressed().left.seconds();
  const std::string numbers = fmt::format(" {:3d} %  {:.0f} s{}  ", static_cast<int>(share * 100), elapsed,
    left ? fmt::format(", {:.0f} s left", std::ceil(*left)) : "");
  const int width = std::clamp(columns - static_cast<int>(numbers.size() + what.size()) - 3, 0, 40);
  const int filled = static_cast<int>(share * width);
  std::string line = "\r[" + std::string(static_cast<std::size_t>(filled), '#') +
    std::string(static_cast<std::size_t>(width - filled), '.') + "]" + numbers + what;
  std::fputs((line + "\x1b[K").c_str(), stderr);
  std::fflush(stderr);
  barShown_ = true;
  return true;
}

void Session::endProgress()
{
  if (barShown_)
  {
    std::fputs("\r\x1b[K", stderr);
    std::fflush(stderr);
    barShown_ = false;
  }
}

bool Session::interrupted() noexcept
{
  if (caught != 0)
    heard.store(true);
  return caught != 0;
}

void watchProcess() noexcept
{
  watchdog.make(false);
}

void Session::checkInterrupt()
{
  if (interrupted())
    throw Cancelled();
}

int Session::interruptCode() noexcept
{
  return caught != 0 ? 128 + static_cast<int>(caught) : static_cast<int>(exitInterrupted);
}

} // namespace lamella::cli
