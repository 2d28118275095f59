#pragma once

#include "vtkPieces.h"

#include "statistics/StressMeasure.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

class vtkDataSet;
class vtkInformation;

/// Helpers of vtkStressPDF; not installed.
namespace lamella
{

/// What vtkStressPDF finds in its input; but for values and groups the same on every rank, whatever the pieces hold.
struct StressInput
{
  std::string array;               ///< its name
  int components = 0;              ///< 1, 6 or 9
  std::vector<double> values;      ///< one a point or cell of the piece [Pa]
  std::vector<std::uint8_t> group; ///< of each value: the position in `phases`, or statistics::noGroup
  std::vector<std::string> phases; ///< names of those that are counted; one without a name where there are no phases
  bool hasPhases = false;
};

/// Collective. Checks in the order present, at points or cells, components; whether values are finite is checked by
/// who counts them.
/// @param stress,phase what SetInputArrayToProcess chose
/// @param wanted phases by name or value; empty: all but the void
/// @param leaveOutPlatens points of an image that platens hold do not count
/// @throws Error on every rank
[[nodiscard]] StressInput stressInput(vtkDataSet* piece, vtkInformation* stress, vtkInformation* phase,
  std::span<const std::string> wanted, bool leaveOutPlatens, statistics::StressMeasure measure, const Team& team);

} // namespace lamella
