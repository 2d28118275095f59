#pragma once

#include "commands/BondInput.h"
#include "commands/FractureReport.h"
#include "files/FractureFiles.h"
#include "program/Commands.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

class vtkBondBreakAlgorithm;

/// What the commands share whose samples break: where they end, what they write, and the run itself.
namespace lamella::cli
{

struct BreakOptions
{
  CommonOptions common;
  PictureOptions picture;
  BondOptions bonds;
  std::string output;
  std::string broken;
  std::string curve;
  CheckpointWords checkpoint;
};

/// Words that differ between them.
struct BreakWords
{
  const char* fields;     ///< what -o writes
  const char* curve;      ///< what --curve writes
  const char* checkpoint; ///< what --checkpoint-every counts
  const char* every;      ///< its default
};

/// Declares what is written, and checkpoints.
void addFileOptions(CLI::App& command, BreakOptions& options, const BreakWords& words);

/// All numbers of options that take lists: "A,B".
[[nodiscard]] std::vector<std::string> listed(const std::vector<std::string>& lists);

/// Gives the filter what the options say. @param forStates an option that needs a file to write fields to, or null
/// @throws ParameterError for what can be said without the sample
void applyBreak(
  const Session& session, const BreakOptions& options, vtkBondBreakAlgorithm* filter, const char* forStates);

/// Loads the sample, runs the filter, writes its files and prints a report.
/// @param what the filter does: "fracture" @param unit that its checkpoints count: "events"
/// @param states that there may be besides those of --at-broken @param perNode bytes of a node's fields besides those
/// of fracture
void runBreak(Session& session, const BreakOptions& options, vtkBondBreakAlgorithm* filter,
  const std::string& commandLine, const char* what, const char* unit, std::size_t states, int perNode,
  const std::function<std::string(const FractureReport&)>& print);

} // namespace lamella::cli
