#pragma once

#include "files/Input.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"

#include <CLI/App.hpp>

#include <array>
#include <string>

namespace lamella::cli
{

/// What `lamella micrograph` takes and how its outlines are found.
struct MicrographOptions
{
  PictureOptions picture; ///< its settings, and those of vtkMicrographContours and vtkMicrographPolygonReader
  bool shares = false;    ///< outlines from lumen's shares of the pixels

  [[nodiscard]] const SettingOptions& settings() const { return picture.settings; }
  /// Outlines at a level, or from shares.
  [[nodiscard]] bool grey() const { return shares || settings().given("level"); }
};

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

void addMicrographInput(CLI::App& command, MicrographOptions& options);

/// As readPhases() would take what was said of the picture, which is a scan or not. @throws ParameterError
[[nodiscard]] lamella::PictureOptions pictureOptions(const MicrographOptions& options, bool scan);
/// Low x, low y, high x, high y of a window of polygons.
[[nodiscard]] std::array<double, 4> polygonWindow(const std::string& text);

} // namespace lamella::cli
