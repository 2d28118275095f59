#pragma once

#include "outlines/Contour.h"

namespace lamella::micrograph
{

/// Distances from lumen to lumen through the wall, measured from points spread evenly over all outlines.
struct WallThickness
{
  double low = 0;    ///< 5 % of the outlines' length has thinner walls [m]; 0 with fewer than two lumens
  double median = 0; ///< [m]
};

/// @param samples points that are spread over the outlines
[[nodiscard]] WallThickness wallThickness(const ContourSet& contours, int samples = 4000);

} // namespace lamella::micrograph
