#pragma once

#include "pictures/Picture.h"
#include "segmentation/Rims.h"
#include "segmentation/SegmentTypes.h"

#include <opencv2/core.hpp>

#include <cstdint>
#include <vector>

namespace lamella::micrograph
{

struct RayGaps
{
  std::vector<Mark> marks; ///< one a gap
  std::int64_t nodes = 0;
};

/// Takes gaps in rays for wall: a section tears along its rays, and their cells with dark contents are no lumens. A gap
/// is
/// - slender among broad lumens (LumenShapes.h), and
/// - in darker tissue than other lumens: the transmission of the tissue beside it (its mean over that of the lumen,
///   which takes the light out) lies in some channel among the darkest tenth (1.28 deviations below the median, from
///   the median absolute deviation) and at least a tenth of the wall's usual absorption below the median.
/// The clean cells of an intact ray are slender too but their walls are as other walls; they stay. Some are dark by
/// chance: all stay where fewer than half of the slender ones are, or where so many dark ones have a probability above
/// 0.02 (binomial, with the share of dark ones among all other lumens). Where more than a tenth of all lumens are gaps
/// by this it is the tissue that is so, and all stay, too. For bright lumens only.
/// @param edge of the lumens before they were moved over rims
/// @param near,far which distances from there are the tissue beside a lumen [pixels]
RayGaps dropRayGaps(
  cv::Mat& lumen, const Picture& picture, const EdgeDistance& edge, double near, double far, double slender);

} // namespace lamella::micrograph
