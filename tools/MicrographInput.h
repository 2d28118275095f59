#pragma once

#include "Input.h"

#include "micrograph/Contour.h"
#include "micrograph/ContourExtraction.h"
#include "micrograph/Picture.h"
#include "micrograph/Segmentation.h"

#include <CLI/App.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

/// What `lamella micrograph` takes and how its outlines are found.
struct MicrographOptions
{
  PictureOptions picture;
  std::string lumenPhase; ///< of labels; empty: "lumen", "void" or "pore"
  // scans
  std::string channel = "auto";
  bool keepGraphics = false;
  std::string background, smoothing, opening, rim, smallestLumen, smallestWall;
  double raySlenderness = micrograph::SegmentOptions().raySlenderness;
  double grow = 0;
  // outlines
  bool noSmooth = false;
  double wavelength = micrograph::ExtractOptions().wavelength;
  double tolerance = micrograph::ExtractOptions().tolerance;
  std::string leastDiameter; ///< of a lumen, of the circle of the same area
  std::string leastSolidity;
  // polygons
  std::string unit;
  bool yDown = false;

  std::vector<CLI::Option*> forScans, forLabels, forPictures, forPolygons;
};

void addMicrographInput(CLI::App& command, MicrographOptions& options);

enum class MicrographKind
{
  Scan,
  Labels,
  Polygons
};

/// A file as outlines, with what they were made from.
struct Micrograph
{
  MicrographKind kind = MicrographKind::Scan;
  micrograph::ContourSet contours;
  double pixel = 0; ///< [m]; 0: there are no pixels
  std::string pixelSizeSource;
  std::array<std::int64_t, 3> size{}; ///< pixels, after the window
  double unit = 0;                    ///< of polygons [m]
  std::optional<micrograph::Picture> scan;
  std::optional<PhaseImage> labels;
  std::optional<micrograph::SegmentReport> segmentation;
  std::vector<micrograph::Mark> marks; ///< in pixels of the window
  std::optional<micrograph::ExtractReport> extraction;
  std::string provenance; ///< of the file
  std::vector<std::string> warnings;
};

/// @throws ParameterError, InputError, MemoryError
[[nodiscard]] Micrograph loadMicrograph(const MicrographOptions& options);

/// .json, .json.gz or .vtp
[[nodiscard]] bool isOutlineFile(const std::string& path);

} // namespace lamella::cli
