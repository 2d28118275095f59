#pragma once

#include <opencv2/core.hpp>

#include <optional>

namespace lamella::micrograph
{

struct Flattened
{
  cv::Mat grey;
  double scale = 0;      ///< over which the local greys were averaged [pixels]; 0: not flattened
  double unevenness = 0; ///< how much the light varied, over the contrast
};

/// Divides the light out of a CV_32F picture and brings the local grey of the dark class to 64, that of the bright one
/// to 192.
/// @param scaleAsked over which the stain may vary [pixels], 0 to leave the picture as it is; else five cells
[[nodiscard]] Flattened flatten(const cv::Mat& grey, const std::optional<double>& scaleAsked);

/// Every so many rows and columns of a CV_32F picture, so that about `most` pixels are left.
[[nodiscard]] cv::Mat thinned(const cv::Mat& grey, double most);

/// Standard deviation of the noise (Immerkær 1996: a mask blind to planes and edges of second order).
[[nodiscard]] double noiseOf(const cv::Mat& grey);

} // namespace lamella::micrograph
