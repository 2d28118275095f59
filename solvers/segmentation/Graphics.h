#pragma once

#include "pictures/Picture.h"
#include "segmentation/SegmentTypes.h"

#include <opencv2/core.hpp>

#include <vector>

namespace lamella::micrograph
{

struct Graphics
{
  std::vector<Mark> marks;
  cv::Mat mask;     ///< CV_8U, 255 on and next to the marks; empty if there are none
  double white = 0; ///< share of the picture in fully white places wider than several cells
  double black = 0; ///< in fully black ones
};

/// Finds what was drawn over a picture: in pure white or black (within 2 % of the range in all channels), if not more
/// than a quarter of the picture is of that colour anyway:
/// - margins: rows or columns at a side of which 95 % are of it, up to the last such within a tenth of the picture;
/// - bars: rectangles (95 % of their box) at least five times as long as thick, 3 pixels thick and 20 long;
/// - text: three or more thin-stroked shapes of like height side by side.
/// Text on a box of its own colour, coloured graphics and arrows are not found.
/// @param place the width of a place that is called fully white or black [pixels]
[[nodiscard]] Graphics findGraphics(const Picture& picture, double place);

/// Replaces the masked part of a grey (CV_32F) by the nearest grey outside it.
void paintOver(cv::Mat& grey, const cv::Mat& mask);

} // namespace lamella::micrograph
