#pragma once

#include "BondReport.h"

#include <string>
#include <vector>

class vtkPolyData;

/// What `lamella fracture` tells of an output of vtkBondFracture.
namespace lamella::cli
{

struct FractureReport
{
  BondRun run; ///< its image is the end
  vtkPolyData* broken = nullptr;
  std::vector<vtkImageData*> states;   ///< the end is the last
  std::vector<std::string> stateFiles; ///< of the states, where they were written
  bool statistics = false;             ///< in the table too
};

[[nodiscard]] std::string fractureJson(const FractureReport& report);
[[nodiscard]] std::string fractureTable(const FractureReport& report);

} // namespace lamella::cli
