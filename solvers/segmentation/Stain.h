#pragma once

#include "pictures/Picture.h"
#include "segmentation/SegmentTypes.h"

#include <opencv2/core.hpp>

#include <array>
#include <string>

namespace lamella::micrograph
{

struct StainGrey
{
  cv::Mat grey;                    ///< CV_32F, 0 … 255; row 0 is the first in memory
  std::string name;                ///< "grey", "red", "green", "blue", "stain"
  std::array<double, 3> weights{}; ///< of red, green and blue; all 0 for grey
  double separability = 0;
};

/// One channel of a picture as CV_32F in 0 … 255; 16-bit pictures scaled by their brightest value.
/// @param which 0, 1, 2: red, green, blue; 3: grey
[[nodiscard]] cv::Mat channelOf(const Picture& picture, int which);

/// The grey of the channel asked for, or of the best one.
///
/// The combination is Fisher's linear discriminant (Annals of Eugenics 7, 1936, 179–188) between the two classes of the
/// best single channel, thrice improved, scaled so that their means lie at 64 and 192. Auto takes it only where it
/// leaves at most 0.9 of the scatter inside the classes that the best channel leaves: a single channel is the sharper
/// picture (JPEG stores colour differences at half the resolution).
/// @throws ParameterError for a colour asked of a grey picture
[[nodiscard]] StainGrey stainGrey(const Picture& picture, Channel asked);

} // namespace lamella::micrograph
