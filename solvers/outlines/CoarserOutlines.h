#pragma once

#include "outlines/ContourExtraction.h"

#include <vector>

namespace lamella::micrograph
{

/// Outlines from the pictures that every stride-th pixel of a picture makes.
struct CoarserOutlines
{
  int stride = 2;
  std::vector<ContourSet> sets; ///< of the picture's size to within stride − 1 of its pixels
};

/// Outlines from the pictures that every second and every third pixel of a picture make (lattice/Subsample.h): the same
/// material, seen with larger pixels, from four places and from five. How what they conduct differs from what the
/// picture's own outlines do tells what pixels do to outlines (lbm/ContourDiffusion.h). Pictures without lumen, without
/// wall or with one lumen all around are left out.
/// @param image, lumen, level, options as for extractContours(); lengths in pixels are in the larger ones
[[nodiscard]] std::vector<CoarserOutlines> coarserOutlines(
  const PhaseImage& image, std::uint8_t lumen, std::span<const float> level = {}, const ExtractOptions& options = {});

/// Outlines with every lumen's boundary moved into the wall by a distance, for what a doubt about where walls begin
/// does. Points move along the mean of their segments' normals, ends of open chains stay on the border; the distance is
/// to be small beside segments and walls, nothing is checked.
/// @param distance [m]; below 0 into the lumen
[[nodiscard]] ContourSet movedOutlines(const ContourSet& set, double distance);

/// Outlines with wall along the border, half a pixel thick, wherever a lumen may end there. A picture tells by the
/// middle of its last pixels whether a lumen ends before the border; whether one does that ends within half a pixel of
/// it, within or beyond, cannot be seen, and such a strip of wall may carry all, or cut all off. A lumen may end there
/// where the border cuts it along no more than a circle of its area would be cut by, half a pixel within its edge, and
/// half a pixel more for what a mask tells of that: along √(8 r p) for a radius r and pixels p.
/// @param pixel of the picture [m]
/// @return empty where no lumen does
/// @throws InputError as outlines()
[[nodiscard]] ContourSet sealedOutlines(const ContourSet& set, double pixel);

} // namespace lamella::micrograph
