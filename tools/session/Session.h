#pragma once

#include "core/Error.h"

#include <mpi.h>

#include <chrono>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

class vtkDataObject;

namespace lamella::cli
{

/// What the program returns to the shell; documented in docs/commands/README.md.
enum ExitCode : int
{
  exitOk = 0,
  exitInternal = 1, ///< a fault of ours
  exitUsage = 2,    ///< options that are unknown, contradict each other or are out of range
  exitInput = 3,    ///< an input that cannot be used
  exitNoPath = 4,   ///< nothing conducts from face to face
  exitMemory = 5,
  exitDiverged = 6,
  exitOutput = 7, ///< the result cannot be written
  exitShort = 8,  ///< done, but the accuracy asked for was not reached
  exitInterrupted = 130
};

[[nodiscard]] int exitCode(const std::exception& error) noexcept;

/// "error: ..." and "hint: ..." on standard error.
void printError(const std::exception& error);

/// Thrown on the ranks other than the one that tells the user what went wrong.
struct FailedElsewhere
{
  int code;
};

/// What a scene wants of a command that it runs.
struct SceneWishes
{
  /// Keep no state but the last.
  bool lastStateOnly = false;
  /// Arrays of states that somebody wants besides phases; nothing: all that there are.
  std::optional<std::set<std::string>> arrays;
  [[nodiscard]] bool wants(const std::string& array) const { return !arrays || arrays->contains(array); }
  /// Wall time between two checkpoints [s].
  double checkpointSeconds = 0;
  /// JSON text that goes into the provenance of all that is made, or empty.
  std::string record;
};

/// One run of the program: its ranks, its terminal, its interruption. There is one, made by main().
class Session
{
public:
  /// Starts MPI when an MPI launcher started the program, and only then: alone the solvers do not need it, and starting
  /// it costs 0.4 s.
  Session(int& argc, char**& argv);
  /// One process on its own within a run: what it prints and warns of is kept, its progress goes to `progress`, and
  /// signals stop it as they stop the run. There may be one at a time.
  explicit Session(std::function<bool(double share, const std::string& what)> progress);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// All ranks; MPI_COMM_SELF, which no MPI call may be made with, when there is no MPI.
  [[nodiscard]] MPI_Comm communicator() const noexcept { return mpi_ ? world_ : MPI_COMM_SELF; }
  [[nodiscard]] int rank() const noexcept { return rank_; }
  [[nodiscard]] int ranks() const noexcept { return ranks_; }
  [[nodiscard]] bool root() const noexcept { return rank_ == 0; }
  /// Ranks that share this machine's memory with this one, itself included. Collective.
  [[nodiscard]] int ranksOnMachine() const;

  void setQuiet(bool quiet) noexcept { quiet_ = quiet; }

  /// "note: ..." on standard error, from rank 0 only: what is about to be done. Not where all is quiet.
  void note(const std::string& text);

  /// "warning: ..." on standard error, from rank 0 only.
  void warn(const std::string& text);

  /// Something asked for was not reached, though all there is is printed and written: "error: ..." and "hint: ...", and
  /// the run ends with exitShort. Within a run of samples it is a warning. Every rank calls it.
  void fallShort(const std::string& message, const std::string& hint);
  /// What a run ends with that no error ended.
  [[nodiscard]] int code() const noexcept { return code_; }

  /// Does `work` on rank 0. When it fails there, the other ranks stop as well, without a word.
  void onRoot(const std::function<void()>& work);

  /// The value of rank 0 on every rank.
  template <typename T>
  void broadcast(T& value) const
  {
    static_assert(std::is_trivially_copyable_v<T>);
    if (ranks_ > 1)
      MPI_Bcast(&value, sizeof value, MPI_BYTE, 0, world_);
  }

  /// Ends a run that failed on this rank: waits a moment for the others to fail as well (they do when all see the same
  /// mistake, and rank 0 tells it); when they do not, tells what went wrong here and stops them.
  /// @returns the exit code
  int fail(const std::exception& error);
  /// The same where another rank tells what went wrong.
  int fail(const FailedElsewhere& error);

  /// Text calls the file that keeps standard input "-".
  static void callInput(const std::string& path);
  [[nodiscard]] static std::string named(std::string text);

  /// Standard output, rank 0 only, or standard error where standard output has a result; whole or an error. @throws
  /// OutputError when it cannot be written (a full disk)
  void print(const std::string& text) const;

  /// Progress: a bar on a terminal, nothing in a pipe. Draws at most ten times a second.
  /// @returns false after Ctrl-C or SIGTERM: stop
  bool progress(double share, const std::string& what);
  /// From here on the shares done are guesses, for how much there is to do is what the run finds out: how long it still
  /// takes is not said.
  void sharesAreGuesses() noexcept { guesses_ = true; }
  void endProgress();

  /// Who sees the states of a run as they come (vtkSampleAlgorithm::STEP_EVENT); none: nobody.
  void setOnStep(std::function<void(vtkDataObject*)> onStep) { onStep_ = std::move(onStep); }
  [[nodiscard]] const std::function<void(vtkDataObject*)>& onStep() const noexcept { return onStep_; }

  /// A command that a scene runs.
  void setScene(SceneWishes wishes) { scene_ = std::move(wishes); }
  /// Null outside of scenes.
  [[nodiscard]] const SceneWishes* scene() const noexcept { return scene_ ? &*scene_ : nullptr; }
  [[nodiscard]] bool keepsAllStates() const noexcept { return !scene_ || !scene_->lastStateOnly; }

  /// Of a session within a run.
  [[nodiscard]] const std::string& printed() const noexcept { return printed_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const noexcept { return warnings_; }

  /// True after Ctrl-C or SIGTERM.
  [[nodiscard]] static bool interrupted() noexcept;
  /// @throws Cancelled after Ctrl-C or SIGTERM
  static void checkInterrupt();
  /// 130 after Ctrl-C, 143 after SIGTERM.
  [[nodiscard]] static int interruptCode() noexcept;

private:
  bool waitForAll();

  std::function<void(vtkDataObject*)> onStep_;
  std::optional<SceneWishes> scene_;
  std::function<bool(double, const std::string&)> outside_; ///< of a session within a run
  int code_ = exitOk;
  mutable std::string printed_;
  std::vector<std::string> warnings_;
  bool mpi_ = false;
  int rank_ = 0;
  int ranks_ = 1;
  MPI_Comm world_ = MPI_COMM_NULL;
  bool quiet_ = false;
  bool terminal_ = false;
  bool barShown_ = false;
  bool guesses_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point drawn_;
};

} // namespace lamella::cli
