#pragma once

#include "pictures/Picture.h"

#include <opencv2/core.hpp>

#include <string>

namespace lamella::micrograph
{

/// How far every pixel outside a mask lies from its outline, and from which piece.
struct EdgeDistance
{
  cv::Mat away;  ///< CV_32F [pixels], of the pixel's centre from the outline; 0 inside the mask
  cv::Mat depth; ///< CV_32F [pixels], of a pixel inside from the nearest one outside; 0 outside the mask
  cv::Mat piece; ///< CV_32S, label of the nearest piece, 1 …
};

/// Distances from the outline of a mask, which lies between pixels, where the grey crosses the threshold.
/// @param bright CV_32F, inside the mask above the threshold
[[nodiscard]] EdgeDistance edgeDistance(const cv::Mat& mask, const cv::Mat& bright, double threshold);

/// A dark line between lumen and wall, darker than both.
struct Rim
{
  bool found = false;
  double shift = 0;    ///< of its darkest line from the lumens' outline, towards the wall [pixels]
  double depth = 0;    ///< below the wall's grey, less what sharpening would do, over the contrast of lumen and wall
  std::string channel; ///< where it is deepest
};

/// Looks for a rim along the outlines of all lumens together.
///
/// At an upright wall the light is refracted and, in stained sections, the innermost layer is dense: a thin dark fringe
/// follows the edge (Becke line). The grey crosses the threshold on the fringe's inner flank; the edge itself is where
/// it is darkest. The mean grey of every channel as a function of the distance from the outline shows it as a dip
/// between lumen and wall. It counts as a rim where it is
/// - deeper than a tenth of the contrast after the overshoot on the lumen's side is taken off (sharpening rings alike
///   on both sides), and
/// - narrow: its darkest line within 1.5 widths of the edge's blur (10 to 90 %), and its bottom, up to a fifth of its
///   depth, at most 1.2 wide. What has a wide bottom is a layer of the wall.
///
/// Where the rim is no wider than the blur its darkest line lies up to half the blur outside its middle, since the
/// lumen beside it is brighter than the wall.
/// @param brightLumen whether lumens are brighter than walls; else everything is mirrored
/// @param ignored 255 where the picture is to be left out; may be empty
[[nodiscard]] Rim findRim(const Picture& picture, const cv::Mat& lumen, const EdgeDistance& edge, bool brightLumen,
  double reach, const cv::Mat& ignored);

/// Moves the outline of a mask outwards; pieces do not grow together.
void moveOutwards(cv::Mat& mask, const EdgeDistance& edge, double shift);

/// Takes pixels that a mask gained back where its pieces would touch through them.
void keepApart(cv::Mat& mask, const cv::Mat& before, const EdgeDistance& edge);

} // namespace lamella::micrograph
