#pragma once

#include "files/JsonReport.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace lamella::cli
{

/// What a stage that takes long keeps on the disk while it is not finished, in the folder of its sample: the checkpoint
/// of its solver, and what ran on the steps that it came to, a line each. A line is there before the solver goes on, so
/// no checkpoint stands after a step that is not told.
class StageCheckpoint
{
public:
  /// @param folder made where it is not there
  StageCheckpoint(const std::filesystem::path& folder, const std::string& stage);

  /// Where the solver keeps its checkpoint.
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  /// Whether there is one to go on from.
  [[nodiscard]] bool there() const;

  /// The steps that were told, up to the first line that is none: a run may have been killed as it wrote.
  [[nodiscard]] std::vector<Json> steps() const;
  /// The steps are these; those that come follow them. @throws OutputError
  void begin(const std::vector<Json>& steps);
  /// One more. @throws OutputError
  void add(const Json& step);

  /// A step that came was not looked at to its end: the checkpoint that stands now is the one to go on from, whatever
  /// the solver writes until it stops.
  void hold();
  /// It has stopped. One that was killed before that is put right by the constructor.
  void release();

  /// The run is to begin anew.
  void remove();
  /// Those of all stages of a sample go.
  static void removeAll(const std::filesystem::path& folder);
  [[nodiscard]] static bool any(const std::filesystem::path& folder);

private:
  std::filesystem::path file_;
  std::filesystem::path steps_;
  std::ofstream lines_;
};

} // namespace lamella::cli
