#pragma once

#include "commands/FractureReport.h"

#include <string>

/// What `lamella dynamics` tells of an output of vtkBondDynamics.
namespace lamella::cli
{

[[nodiscard]] std::string dynamicsJson(const FractureReport& report);
[[nodiscard]] std::string dynamicsTable(const FractureReport& report);

} // namespace lamella::cli
