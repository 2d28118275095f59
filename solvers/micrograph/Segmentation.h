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
  Auto, ///< bright where the picture is in colour (a stained section in transmitted light), else by the border's greys
  Bright,
  Dark
};

/// How a raw scan becomes phases. Everything that is not given is found from the picture.
struct SegmentOptions
{
  LumenSide lumen = LumenSide::Auto;
  std::optional<double> background; ///< scale over which the light may vary [pixels]; 0: even light
  std::optional<double> smoothing;  ///< standard deviation of the Gaussian before thresholding [pixels]; 0: none
  std::optional<double> threshold;  ///< on the flattened grey, 0 … 255; else Otsu's
  std::optional<std::int64_t> smallestLumen; ///< smaller specks of lumen become wall [pixels]
  std::optional<std::int64_t> smallestWall;  ///< smaller specks of wall become lumen [pixels]
};

/// What segment() did.
struct SegmentReport
{
  std::string channel; ///< "grey", "red", "green", "blue"
  bool brightLumen = true;
  double background = 0;   ///< [pixels]; 0: no flattening
  double unevenness = 0;   ///< how much the light varied, over the contrast between lumen and wall
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

/// Finds lumens and walls in a raw scan (2D): the channel of the best contrast, background flattening, Gaussian
/// smoothing, Otsu's threshold (Otsu 1979), then cleaning: specks of lumen become wall, specks of wall inside lumens
/// become lumen.
/// @throws ParameterError for a volume or options outside their range; InputError for a picture of one single grey
[[nodiscard]] Segmentation segment(const Picture& picture, const SegmentOptions& options = {});

} // namespace lamella::micrograph
