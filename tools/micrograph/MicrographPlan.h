#pragma once

#include "micrograph/MicrographOptions.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"

#include <string>

namespace lamella::cli
{

/// The words of `lamella micrograph`.
struct MicrographCommandOptions
{
  CommonOptions common;
  MicrographOptions input;
  SettingOptions settings; ///< of the lattice, and of diffusion
  std::string output;
  std::string contours;
  std::string overlay;
  int overlayWidth = 0;
};

} // namespace lamella::cli
