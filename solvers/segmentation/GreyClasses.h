#pragma once

#include <opencv2/core.hpp>

#include <vector>

namespace lamella::micrograph
{

/// One class of greys: a summit of the histogram.
struct GreyClass
{
  double grey = 0;  ///< where its summit is
  double share = 0; ///< of the pixels in flat places that belong to it
  double from = 0;  ///< where it begins: the valley below it; 0 for the first
};

/// How many classes of greys there are: a picture of lumens and walls has two, a tomogram of void, matrix and fibres
/// three.
///
/// Counted are places that are flat: where noise is smoothed and the grey varies by less than a sixteenth of the
/// contrast over three pixels, so that the ramps at edges make no class of their own. Summits of their histogram
/// (smoothed over a twentieth of the contrast) are classes of their own where the valley between them is lower than
/// three quarters of the lower one. Of more than a million pixels every so many bands of rows are looked at.
/// @param grey CV_32F, 0 … 255
/// @param contrast between lumens and walls [greys]
/// @param noise standard deviation over the contrast
/// @return by rising grey; classes of less than `least` of the flat places are left out, and nobody else's
[[nodiscard]] std::vector<GreyClass> greyClasses(
  const cv::Mat& grey, double contrast, double noise, double least = 0.03);

} // namespace lamella::micrograph
