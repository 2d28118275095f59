#pragma once

#include "lattice/Lattice.h"

#include <cstdint>
#include <span>

/// What is done to the greys of a volume before they are parted. Volumes are lattice.count() values, x fastest.
namespace lamella::micrograph
{

/// Convolves with ½ (3 − x²/s²) exp(−x²/2s²) along each axis, in place: the Gaussian kernel of fourth order (M. P.
/// Wand, W. R. Schucany, Can. J. Statist. 18, 1990, 197–204). It leaves polynomials up to the third degree as they are,
/// so that curved surfaces do not move as they do under a Gaussian (by s² times their mean curvature), and takes white
/// noise to 0.33 s^(−3/2). The volume goes on beyond its faces as in a mirror.
/// @param deviation s [voxels], of 0.7 or more (below, the voxels do not show its shape); 0 leaves everything as it is
/// Memory: as many planes as the kernel is long (8 s), of floats.
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
