#pragma once

#include "commands/BondReport.h"
#include "commands/SampleRun.h"
#include "files/Input.h"
#include "program/SettingOptions.h"
#include "session/Session.h"

#include <string>
#include <vector>

class vtkBondAlgorithm;

/// What the commands share that bond the nodes of a sample.
namespace lamella::cli
{

struct BondOptions
{
  SettingOptions settings; ///< of the command's class
  std::vector<std::string> notches;
  int refine = 1;
};

/// Declares the settings of a class, but for some, and the options above.
void addBondOptions(
  CLI::App& command, BondOptions& options, const std::string& className, const std::vector<std::string>& leave = {});

/// Gives the filter what the options say. @throws ParameterError for what can be said without the sample
void applyBonds(const BondOptions& options, vtkBondAlgorithm* filter);

/// @throws as loadSample(); ParameterError for a pair or a phase that the sample does not have
[[nodiscard]] ImageSample loadBondSample(
  Session& session, const PictureOptions& picture, const BondOptions& options, vtkBondAlgorithm* filter);

/// Runs the filter on the sample that rank 0 holds, on all ranks, with a progress bar of the filter's words, or `what`;
/// rank 0 then holds its output.
/// @throws the kind of Error that the filter met; Cancelled
void runBonds(Session& session, vtkBondAlgorithm* filter, const ImageSample& sample, const char* what);

/// What a report needs of a run on rank 0, whose filter's warnings are said with it.
[[nodiscard]] BondRun bondRun(Session& session, vtkBondAlgorithm* filter, const PictureOptions& picture,
  const BondOptions& options, const ImageSample& sample, const std::string& commandLine);

} // namespace lamella::cli
