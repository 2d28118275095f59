#pragma once

#include "commands/BondReport.h"

#include <string>
#include <vector>

class vtkDataObject;
class vtkTable;

/// What `lamella compression` prints.
namespace lamella::cli
{

struct CompressionReport
{
  BondRun run; ///< its image: the sample, with the filter's numbers as field data
  vtkTable* curve = nullptr;
  std::vector<vtkDataObject*> states;
  std::vector<std::string> stateFiles;
};

[[nodiscard]] std::string compressionJson(const CompressionReport& report);
[[nodiscard]] std::string compressionTable(const CompressionReport& report);

/// Of --stiffness-only.
[[nodiscard]] std::string pointStiffnessJson(const BondRun& run);
[[nodiscard]] std::string pointStiffnessTable(const BondRun& run);

} // namespace lamella::cli
