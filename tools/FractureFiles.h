#pragma once

#include "OutputFile.h"

#include <string>
#include <vector>

class vtkBondBreakAlgorithm;
class vtkImageData;

namespace lamella::cli
{

/// The states of a fracture as files: NAME.vti, or where several are asked for NAME_000.vti, NAME_001.vti, … and
/// NAME.pvd, which tells their strains, or times, as times. A run that goes on from a checkpoint counts the states
/// before it too.
class StateFiles
{
public:
  StateFiles() = default;
  /// Opens as many files as there may be states.
  /// @param name of the option -o; empty: no file
  /// @throws ParameterError for another ending than .vti; OutputError
  StateFiles(const std::string& name, std::size_t states, bool overwrite);

  /// @param bytes of one state @throws OutputError when the disk has less room
  void needs(std::uint64_t bytes) const;

  /// Writes the states of the filter's last run. @returns the names, those of the states first
  /// @throws OutputError; Cancelled
  [[nodiscard]] std::vector<std::string> write(vtkBondBreakAlgorithm* filter, const std::string& provenance);
  /// Gives what was written its names. @throws OutputError; Cancelled
  void commit();

private:
  std::vector<OutputFile> files_;
  std::vector<OutputFile> collection_; ///< one or none
  std::size_t first_ = 0;              ///< of the files that are written
  std::size_t written_ = 0;            ///< how many
};

/// What the command line says of checkpoints.
struct CheckpointWords
{
  std::string file;         ///< --checkpoint
  std::string every;        ///< --checkpoint-every
  std::string continueFrom; ///< --continue
};

/// Gives the filter what the words say. @throws ParameterError
void applyCheckpoint(const CheckpointWords& words, vtkBondBreakAlgorithm* filter);

/// Refuses to replace a checkpoint that is there already, unless it is the one to go on from. On rank 0.
/// @throws OutputError
void checkCheckpoint(const CheckpointWords& words, bool overwrite);

/// What is left of a run that ended before its time, and how to go on from it; empty where no checkpoint was asked for.
/// @param commandLine of the run
/// @param unit that checkpoints count: "events"
/// @param ranks that ran it: the words of the launcher before the program's are not known
[[nodiscard]] std::string howToContinue(const CheckpointWords& words, vtkBondBreakAlgorithm* filter,
  const std::string& commandLine, int ranks, const char* unit);

/// What ParaView reads as a time series.
/// @param times of the files, made to rise by 1e-9 of themselves where they do not
[[nodiscard]] std::string collectionText(const std::vector<std::string>& files, std::vector<double> times);

} // namespace lamella::cli
