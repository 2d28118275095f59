#pragma once

#include "segmentation/SegmentTypes.h"

#include <opencv2/core.hpp>

#include <vector>

namespace lamella::micrograph
{

/// The shapes of labelled lumens (CV_32S), by label; label 0 is empty.
[[nodiscard]] std::vector<LumenShape> lumenShapes(const cv::Mat& labels, int count);

/// Slender lumens among broad ones, as cells of rays are and gaps in rays: lumens at least `slender` times as long as
/// wide whose neighbours on both long sides are, seen in the same direction, `slender` times less so. A latewood cell
/// is slender too, but so are its neighbours. Cells without neighbours on both sides are not judged.
/// @return labels
[[nodiscard]] std::vector<int> slenderAmongBroad(
  const cv::Mat& labels, const std::vector<LumenShape>& shapes, double slender);

} // namespace lamella::micrograph
