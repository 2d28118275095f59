#pragma once

#include "lattice/Phases.h"
#include "outlines/Contour.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lamella::micrograph
{

struct ExtractOptions
{
  bool smooth = true;       ///< the steps of pixels are smoothed away; only where there is no level
  double wavelength = 20;   ///< waves along a contour shorter than this are damped [pixels]; from 4 to 200
  double tolerance = 0.02;  ///< points that far from the line through their neighbours go [pixels]; 0: all stay
  double smallestArea = 0;  ///< smaller lumens become wall [m²]
  double leastSolidity = 0; ///< closed lumens of a smaller share of their convex hull become wall, 0 … 1
};

/// What extractContours() did.
struct ExtractReport
{
  std::int64_t lumens = 0;
  std::int64_t openLumens = 0;   ///< of these, cut by the picture's border
  std::int64_t islands = 0;      ///< pieces of wall inside lumens, taken out
  double islandArea = 0;         ///< of these, with all that is in them [m²]
  std::int64_t nestedLumens = 0; ///< lumens in such islands, taken out
  std::int64_t small = 0;        ///< lumens below the smallest area
  std::int64_t ragged = 0;       ///< lumens below the least solidity
  std::int64_t crossings = 0;    ///< points of the outlines before simplification
  std::int64_t points = 0;       ///< after it
  double areaMissing = 0;        ///< largest difference between a chain's area and that of its pixels [pixels²]
  double wallFraction = 0;       ///< of the contours

  /// A line for each step, for people.
  [[nodiscard]] std::vector<std::string> lines() const;
};

struct Extraction
{
  ContourSet contours;
  ExtractReport report;
  std::vector<std::string> warnings;
};

/// Outlines of lumens in a picture of phases, at a resolution finer than its pixels.
///
/// 1. Marching squares between the pixels' centres; lumens hang together through sides (4), walls through sides and
///    corners (8). At the picture's edge, half a pixel outside the outermost centres, chains are open. Wall inside
///    lumens is taken out.
/// 2. With a level: crossings by linear interpolation of it; areas of smooth shapes, with what a
///    smooth curve holds beyond its chords, are exact to second order in the pixel. Without: crossings move between
///    their two nodes to where the contour varies its curvature least, then along the normals until each chain has
///    exactly the area of its pixels (the wall fraction is therefore the mask's). A mask's own area of a disk of R
///    pixels scatters by 0.7 √R pixels² with the place of its centre, without bias; directions come within 1 to 2°
///    (rms), positions within 0.2 to 0.4 pixels at most. No two chains can cross, since each stays on its side of every
///    node.
/// 3. Filters by area and solidity; simplification, each chain's area kept to round-off.
///
/// Time: about 0.1 µs a pixel and 0.5 µs a pixel of outline.
/// @param image 2D; @param lumen the lumens' phase
/// @param level empty, or #nodes: a smooth field, above 0 in lumens; where it contradicts the phases, they hold
/// @throws ParameterError for a volume, a lumen id that is no phase, a level of another size or with NaN, options
///   outside their range; InputError when there is no lumen, no wall, or one lumen along the whole border
[[nodiscard]] Extraction extractContours(
  const PhaseImage& image, std::uint8_t lumen, std::span<const float> level = {}, const ExtractOptions& options = {});

} // namespace lamella::micrograph
