#pragma once

#include "lattice/Lattice.h"

#include <cstdint>
#include <span>

/// What is done to the greys of a volume before they are parted. Volumes are lattice.count() values, x fastest.
namespace lamella::micrograph
{

/// Convolves with a Gaussian, in place; the volume goes on beyond its faces as in a mirror.
/// @param deviation [voxels]; 0 leaves everything as it is
/// Memory: as many planes as the kernel is long (6 deviations), of floats.
void smooth(const Lattice& lattice, std::span<std::uint16_t> grey, double deviation);

struct VolumeLight
{
  double unevenness = 0; ///< how much it varied, over the contrast
  bool flattened = false;
};

/// Brings the darkest and the brightest class to one grey each, in place, where that raises Otsu's separability by more
/// than 0.002: polynomials of fourth degree in x, y and z, least squares through the classes' means in blocks.
/// @param classes 2 or 3
[[nodiscard]] VolumeLight flattenVolume(const Lattice& lattice, std::span<std::uint16_t> grey, int classes);

} // namespace lamella::micrograph
