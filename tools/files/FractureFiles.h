#pragma once

#include "session/OutputFile.h"
#include "session/Session.h"
#include "session/Workspace.h"

#include <CLI/App.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

class vtkDataObject;

namespace lamella::cli
{

/// The states of a run as files: NAME.vti, or where several are asked for NAME_000.vti, NAME_001.vti, … and NAME.pvd,
/// which tells their strains, or times, as times. A run that goes on from a checkpoint counts the states before it too.
class StateWriter
{
public:
  StateWriter() = default;
  /// Opens as many files as there may be states; 0: as many as come, of which the first is opened.
  /// @param name of the option -o; empty: no file
  /// @param ending of such files: ".vti", ".vtp" @param what is written in them, and where the rest goes
  /// @throws ParameterError for another ending; OutputError
  StateWriter(const std::string& name, std::size_t states, bool overwrite, const char* ending,
    const std::array<const char*, 2>& what);

  /// @param bytes of one state @throws OutputError when the disk has less room
  void needs(std::uint64_t bytes) const;

  /// From now on states appear under their names as they come, and the list of them, so that a run that is stopped
  /// leaves what a checkpoint does not bring back. For runs of one process that keep checkpoints; write() does all
  /// anew.
  /// @param record provenance of the run's input
  void follow(Session& session, const std::string& record);
  [[nodiscard]] bool leaves() const { return leaves_; } ///< whether such files are there

  /// Writes the states of a run, each with its time and, where it went on from a checkpoint, `states_before` in the
  /// field data of the first.
  /// @returns the names, those of the states first
  /// @throws OutputError; Cancelled
  [[nodiscard]] std::vector<std::string> write(std::span<vtkDataObject* const> states, const std::string& provenance);
  /// Gives what was written its names. @throws OutputError; Cancelled
  void commit();

private:
  struct Listed
  {
    std::string file;
    double time = 0;
  };
  /// Of the list that is there, the first states, as many as are told and there.
  [[nodiscard]] std::vector<Listed> listed(std::size_t most) const;
  void writeNow(vtkDataObject* state, const std::string& provenance);
  void writeList(std::vector<Listed> states);
  /// In memory (Workspace.h): NAME_000 ..., and NAME for the last.
  [[nodiscard]] std::vector<std::string> keep(std::span<vtkDataObject* const> states, const std::string& provenance);

  std::vector<OutputFile> files_;
  std::vector<OutputFile> collection_; ///< one or none
  std::size_t first_ = 0;              ///< of the files that are written
  std::size_t written_ = 0;            ///< how many
  std::string name_;                   ///< where as many as come are written, else empty
  bool overwrite_ = false;
  bool leaves_ = false;
};

/// What the command line says of checkpoints.
struct CheckpointWords
{
  std::string file;         ///< --checkpoint
  std::string every;        ///< --checkpoint-every
  std::string continueFrom; ///< --continue
};

/// What --checkpoint-every says: "500", "10min", or both, "500,10min".
struct CheckpointPacing
{
  std::optional<std::int64_t> units; ///< events or steps between two
  std::optional<double> seconds;     ///< wall time between two
};
/// @throws ParameterError for these and a name that is none
[[nodiscard]] CheckpointPacing checkedPacing(const CheckpointWords& words);

/// Gives the filter what the words say.
/// @param looks whether CheckpointEvery says only when there may be one: a time alone then counts from unit to unit
/// @throws ParameterError
template <class Filter>
void applyCheckpoint(const Session& session, const CheckpointWords& words, Filter* filter, bool looks = true)
{
  const CheckpointPacing pacing = checkedPacing(words);
  if (pacing.units || (pacing.seconds && looks))
    filter->SetCheckpointEvery(pacing.units.value_or(1));
  if (pacing.seconds)
    filter->SetCheckpointSeconds(*pacing.seconds);
  if (session.scene() != nullptr)
    filter->SetCheckpointSeconds(session.scene()->checkpointSeconds);
  filter->SetCheckpointFile(words.file);
  filter->SetContinueFile(words.continueFrom);
}

/// Declares these words. @param every text of --checkpoint-every @param standard its default
void addCheckpointOptions(CLI::App& command, CheckpointWords& words, const char* every, const char* standard);

/// Refuses to replace a checkpoint that is there already, unless it is the one to go on from. On rank 0.
/// @throws OutputError
void checkCheckpoint(const CheckpointWords& words, bool overwrite);

/// A run that may be interrupted.
struct KeptRun
{
  std::string commandLine;
  int ranks = 1;                       ///< that run it: the words of the launcher before the program's are not known
  const char* unit = "events";         ///< that checkpoints count
  std::function<std::int64_t()> last;  ///< units in its last checkpoint; 0: none
  std::function<std::int64_t()> every; ///< units between two
  std::function<bool()> leaves;        ///< whether states are in their files already
};

/// Runs it. Where it ends before its time, an interruption's hint, or a warning before the error, tells how to go on
/// from the last checkpoint. @throws what `run` throws
void runKept(Session& session, const CheckpointWords& words, const KeptRun& kept, const std::function<void()>& run);

} // namespace lamella::cli
