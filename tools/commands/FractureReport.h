#pragma once

#include "commands/BondReport.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

class vtkPolyData;

/// What `lamella fracture` and `lamella dynamics` tell of an output of vtkBondBreakAlgorithm.
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

/// How many bonds of each pair broke, the most first; "grain-grain" for two different grains.
[[nodiscard]] std::vector<std::pair<std::string, std::int64_t>> brokenByPair(const FractureReport& report);
/// The same as an object, and as a line of a table.
[[nodiscard]] Json brokenByPairJson(const FractureReport& report);
[[nodiscard]] std::string brokenByPairText(const FractureReport& report);

[[nodiscard]] std::string fractureJson(const FractureReport& report);
[[nodiscard]] std::string fractureTable(const FractureReport& report);

} // namespace lamella::cli
