#pragma once

#include "Commands.h"
#include "MicrographOptions.h"
#include "SettingOptions.h"

#include "micrograph/MiddleLamella.h"

#include <CLI/App.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

/// The words of `lamella micrograph`.
struct MicrographCommandOptions
{
  CommonOptions common;
  MicrographOptions input;
  std::string spacing;
  std::string lamella = "growth";
  std::string thickness;
  std::string radius;
  std::string lamellaPhase;
  double horizon = 0;
  SettingOptions diffusion; ///< vtkOutlineDiffusion's
  std::string output;
  std::string contours;
  std::string overlay;
  int overlayWidth = 0;
  CLI::Option* lamellaOption = nullptr;
};

/// What can be said without the file, in numbers.
struct Plan
{
  std::string lamella;
  micrograph::LamellaOptions how;
  std::optional<double> spacing;
};

/// @throws ParameterError
[[nodiscard]] Plan planOf(const MicrographCommandOptions& options);

} // namespace lamella::cli
