#pragma once

#include "statistics/StressDistribution.h"

#include <span>
#include <string>

class vtkTable;

/// Helpers of vtkStressPDF; not installed.
namespace lamella
{

/// One row a bin.
/// @param phases names of the groups; empty where there are no phases
void fillDensity(vtkTable* table, const statistics::StressDistribution& d, std::span<const std::string> phases);

/// One row for all, one a phase.
void fillPhases(vtkTable* table, const statistics::StressDistribution& d, std::span<const std::string> phases);

/// One row a threshold.
void fillThresholds(vtkTable* table, const statistics::StressDistribution& d);

} // namespace lamella
