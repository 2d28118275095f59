#pragma once

#include "micrograph/MicrographOverlay.h"

#include <opencv2/core.hpp>

namespace lamella::cli
{

using Colour = cv::Vec3f; // red, green, blue

inline const Colour outlineColour(0, 90, 200);
inline const Colour strokeColour(20, 20, 20);
inline const Colour lamellaColour(255, 170, 0);
inline const Colour vesselColour(0, 170, 150);
inline const Colour markColour(220, 0, 60);
inline const Colour gapColour(240, 130, 0);
inline const Colour wallColour(214, 208, 202);
inline const Colour ink(25, 25, 25);

/// As OpenCV draws with it.
[[nodiscard]] cv::Scalar scalar(const Colour& colour);

/// Blends a colour into a picture where a mask (0 … 1, its corner at `at`) says so.
void blend(cv::Mat& picture, const cv::Mat& mask, const Colour& colour, float alpha, cv::Point at = { 0, 0 });

/// The picture over a white strip with a scale bar and what the colours mean; as many rows of them as are needed.
/// @param scale pixels a metre
[[nodiscard]] cv::Mat withLegend(const cv::Mat& picture, const OverlayParts& parts, double scale);

} // namespace lamella::cli
