#pragma once

#include "commands/BondReport.h"

#include <string>

/// What `lamella stiffness` tells of an output of vtkBondStiffness.
namespace lamella::cli
{

[[nodiscard]] std::string stiffnessJson(const BondRun& report);
[[nodiscard]] std::string stiffnessTable(const BondRun& report);

} // namespace lamella::cli
