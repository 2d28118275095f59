#pragma once

#include "files/Input.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"

#include "segmentation/Segmentation.h"

#include <CLI/App.hpp>

#include <array>
#include <string>
#include <vector>

namespace lamella::cli
{

/// What `lamella micrograph` takes and how its outlines are found.
struct MicrographOptions
{
  PictureOptions picture;
  std::string lumenPhase; ///< of labels; empty: "lumen", "void", "pore" or "air"
  // scans
  std::string channel = "auto";
  bool keepGraphics = false;
  std::string background, smoothing, opening, rim, smallestLumen, smallestWall;
  double raySlenderness = micrograph::SegmentOptions().raySlenderness;
  double grow = 0;
  // grey pictures that are not segmented
  std::string level; ///< --level; empty: not given
  bool shares = false;
  SettingOptions outlines; ///< of vtkMicrographContours and vtkMicrographPolygonReader

  std::vector<CLI::Option*> forScans, forLabels, forMasks, forPictures, forPolygons, forGreys;
  CLI::Option* lumenOption = nullptr; ///< --lumen
  CLI::Option* arrayOption = nullptr; ///< --array

  /// Outlines at a level, or from shares.
  [[nodiscard]] bool grey() const { return shares || !level.empty(); }
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

/// The options in numbers. @throws ParameterError
[[nodiscard]] micrograph::SegmentOptions segmentOptions(const MicrographOptions& options);
/// A part of full scale between 0 and 1; one half if not given.
[[nodiscard]] double greyLevel(const MicrographOptions& options);
/// Low x, low y, high x, high y of a window of polygons.
[[nodiscard]] std::array<double, 4> polygonWindow(const std::string& text);

} // namespace lamella::cli
