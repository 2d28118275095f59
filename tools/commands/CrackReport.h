#pragma once

#include "files/JsonReport.h"

class vtkCrackPath;

/// What `lamella crack-path` tells.
namespace lamella::cli
{

struct CrackReport
{
  std::string file;
  std::string phases;   ///< the image's file, or empty
  vtkCrackPath* filter; ///< updated
};

/// Without the keys of the run.
[[nodiscard]] Json reportOf(const CrackReport& report);
/// @param json reportOf() with the keys of the run
[[nodiscard]] std::string tableOf(const Json& json);

} // namespace lamella::cli
