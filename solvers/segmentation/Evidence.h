#pragma once

#include "segmentation/GreyClasses.h"
#include "segmentation/PieceShapes.h"
#include "segmentation/SegmentTypes.h"

#include <opencv2/core.hpp>

#include <cstdint>
#include <vector>

namespace lamella::micrograph
{

/// What speaks for and against a segmentation: told from its result and from the greys that it came from. Lengths in
/// pixels.
struct Evidence
{
  SideShape lumens; ///< what was taken for lumens
  SideShape walls;  ///< the other side: were it the lumens, they would look like this
  /// Classes of greys as the picture has them, and once the light is even; three and more are too many for two phases.
  std::vector<GreyClass> classes;
  std::vector<GreyClass> evenClasses;
  double wallThickness = 0;      ///< median between neighbouring lumens
  double wallShareThick = 0;     ///< of the walls, in places that hold a disk five times as wide as the thinner walls
  std::int64_t blind = 0;        ///< places within the walls where one of the narrower lumens would fit with its wall
  double edgeWidth = 0;          ///< over which the mean edge goes from 10 to 90 % of its height
  double lumenWidth = 0;         ///< median of the widest disks in lumens
  std::int64_t spots = 0;        ///< bright tops in the walls: lumens that are too small to be seen
  double spotShare = 0;          ///< about what they hold of the picture
  double narrow = 0;             ///< share of the whole lumens that hold no disk four pixels wide
  std::int64_t gaps = 0;         ///< tears, slide beside the tissue: open or ragged, and far larger than the lumens
  double gapShare = 0;           ///< of the picture
  double compactWithoutGaps = 0; ///< `lumens.compact`, were they not there
  std::vector<cv::Rect> gapBoxes;
};

/// @param lumen CV_8U mask, 255 in lumens
/// @param asSeen CV_32F, the channel as the picture has it
/// @param even CV_32F, the grey that the threshold saw, mirrored so that lumens are bright
/// @param noise standard deviation over the contrast
/// @param smallest lumens below that are specks [pixels]
[[nodiscard]] Evidence gather(
  const cv::Mat& lumen, const cv::Mat& asSeen, const cv::Mat& even, double noise, std::int64_t smallest);

} // namespace lamella::micrograph
