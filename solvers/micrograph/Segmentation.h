#pragma once

#include "micrograph/Picture.h"

#include <optional>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// Which side of the threshold is lumen.
enum class LumenSide
{
  Auto, ///< the side that falls into more pieces enclosed by the other: lumens are closed cells, walls hang together
  Bright,
  Dark
};

/// How a raw scan becomes phases. Everything that is not given is found from the picture.
struct SegmentOptions
{
  LumenSide lumen = LumenSide::Auto;
  std::optional<double> background; ///< scale over which the stain may vary [pixels]; 0: no flattening at all
  std::optional<double> smoothing;  ///< standard deviation of the Gaussian before thresholding [pixels]; 0: none
  std::optional<double> threshold;  ///< on the flattened grey, 0 … 255; else Otsu's
  std::optional<std::int64_t> smallestLumen; ///< smaller specks of lumen become wall [pixels]
  std::optional<std::int64_t> smallestWall;  ///< smaller specks of wall inside lumens become lumen [pixels]
  double grow = 0; ///< moves the lumens' outlines outwards by so many pixels (inwards if negative), for stained rims
};

/// What segment() did.
struct SegmentReport
{
  std::string channel; ///< "grey", "red", "green", "blue"
  bool brightLumen = true;
  double background = 0;   ///< [pixels]; 0: no flattening
  double unevenness = 0;   ///< how much the light varied, over the contrast between lumen and wall
  double noise = 0;        ///< standard deviation of the noise, over the contrast between lumen and wall
  double smoothing = 0;    ///< [pixels]
  double threshold = 0;    ///< on the flattened grey, 0 … 255
  double separability = 0; ///< between-class over total variance at the threshold, 0 … 1; below 0.7 look twice
  std::int64_t smallestLumen = 0;
  std::int64_t smallestWall = 0;
  std::int64_t lumensRemoved = 0; ///< specks
  std::int64_t wallsRemoved = 0;  ///< specks
  std::int64_t nodesChanged = 0;  ///< by cleaning
  std::int64_t lumens = 0;        ///< left, connected through faces
  double lumenFraction = 0;

  /// A line for each step, for people.
  [[nodiscard]] std::vector<std::string> lines() const;
};

struct Segmentation
{
  PhaseImage image; ///< phases "lumen" 0 and "wall" 1
  SegmentReport report;
  std::vector<std::string> warnings;
};

/// Finds lumens and walls in a raw scan (2D):
/// 1. of a colour picture the channel whose two classes are farthest apart (Otsu's separability);
/// 2. flattening: the light, a polynomial of fourth degree through the bright class, is divided out; then the local
/// greys
///    of lumens and of walls, averaged over several cells, are brought to 192 and 64, for uneven stain;
/// 3. Gaussian smoothing where there is noise;
/// 4. Otsu's threshold (IEEE Trans. SMC 9, 1979, 62–66);
/// 5. cleaning: specks of lumen become wall, specks of wall enclosed by lumen become lumen.
///
/// On the conifer scan that the tests use the lumens agree with an expert's to an intersection over union of 0.886
/// (plain Otsu of the green channel 0.883 to 0.886), and 0.927 with `grow` = 1.5: the expert's outlines lie outside the
/// lumens' dark rims. Time: about 0.3 µs a pixel.
/// @throws ParameterError for a volume or options outside their range; InputError for a picture of one single grey
[[nodiscard]] Segmentation segment(const Picture& picture, const SegmentOptions& options = {});

} // namespace lamella::micrograph
