#pragma once

#include "commands/BondReport.h"

#include <string>

/// What `lamella equilibrium` tells of an output of vtkBondEquilibrium.
namespace lamella::cli
{

[[nodiscard]] std::string equilibriumJson(const BondRun& report);
[[nodiscard]] std::string equilibriumTable(const BondRun& report);

} // namespace lamella::cli
