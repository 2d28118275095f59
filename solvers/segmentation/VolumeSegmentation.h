#pragma once

#include "lattice/GreyRanges.h"
#include "pictures/Picture.h"
#include "segmentation/Segmentation.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// How a grey volume becomes phases. Everything that is not given is found from the volume.
struct VolumeOptions
{
  /// Which greys are which phase; numbers are greys of the file, once the light is even. None: `void` and `solid`,
  /// parted by Otsu's level.
  GreyRanges phases;
  LumenSide empty = LumenSide::Auto;    ///< with no phases given: the side of `void`; Auto: the dark one
  std::optional<double> threshold;      ///< with no phases given: grey between the two
  bool flatten = true;                  ///< takes a slow background out where that tells the phases apart better
  std::optional<double> smoothing;      ///< s of smooth() [voxels], from 0.7; 0: none
  std::optional<std::int64_t> smallest; ///< smaller pieces become what is around them [voxels]; 0: none do
};

/// What segmentVolume() did. Lengths in voxels, greys as in the file.
struct VolumeReport
{
  std::string polarity;            ///< "void is dark", or "" where the caller named the phases
  double unevenness = 0;           ///< how much the light varied, over the contrast
  bool flattened = false;          ///< whether that was taken out
  double smoothing = 0;            ///< s of smooth()
  double separabilityBefore = 0;   ///< of Otsu's classes before it
  double noiseLeft = 0;            ///< standard deviation within phases, as far from edges as can be, over the contrast
  std::vector<double> levels;      ///< greys between the classes, rising
  std::vector<double> means;       ///< grey of each class away from its edges
  double separability = 0;         ///< GreyLevels
  double valley = 0;               ///< GreyLevels
  std::vector<std::string> phases; ///< names by id
  std::vector<double> shares;      ///< by id
  std::vector<double> shareError;  ///< by id: how much the share changes where levels move by 5 % of the contrast
  double surfaceDoubt = 0;         ///< how far surfaces move where levels do [voxels], the largest of the phases
  std::vector<double> thickness;   ///< by id: how many voxels thick it is (VolumePieces.h)
  std::int64_t smallest = 0;       ///< pieces below this size went
  std::int64_t specks = 0;         ///< how many went
  std::int64_t speckVoxels = 0;    ///< that changed by it
  std::int64_t shellVoxels = 0;    ///< of a middle class between a dark and a bright one, that are blur

  /// A line for each step, for people.
  [[nodiscard]] std::vector<std::string> lines() const;
};

struct VolumeSegmentation
{
  PhaseImage image;
  VolumeReport report;
  std::vector<std::string> warnings;
};

/// Finds phases in a grey volume, such as a tomogram:
/// 1. smoothing (a Gaussian kernel of fourth order, VolumeFilters.h), as wide as makes Otsu's classes most separable
/// (in eight boxes of 48³): less would leave noise, more
///    would take away what is thin;
/// 2. light: polynomials of fourth degree through the darkest and the brightest class are brought to one grey each,
///    where that tells the classes apart better;
/// 3. levels: Otsu's, moved to half height between the greys that classes have away from their edges, where what the
///    smoothing took from thin walls is given back to the first order; or as given;
/// 4. voxels of a middle class that lie between a darker and a brighter one within two voxels on either side are blur,
///    and go to the nearer of the two;
/// 5. pieces smaller than `smallest` take the phase of most of their neighbours.
///
/// Rings of a tomograph are not taken out, and a field of view with nothing around it has to be cut off first: a
/// warning tells of it.
///
/// Memory beside the picture: 1 byte a voxel for the phases, 12 bytes for every run of one phase along x (where lines
/// in the phases are 8 voxels long, 1.5 bytes a voxel); the picture's own greys are worked on in place.
/// @throws ParameterError for a picture that is no volume or options outside their range; InputError for a volume of
///         one single grey and for greys in no phase
[[nodiscard]] VolumeSegmentation segmentVolume(Picture picture, const VolumeOptions& options = {});

} // namespace lamella::micrograph
