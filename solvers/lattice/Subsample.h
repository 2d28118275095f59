#pragma once

#include "lattice/Phases.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Coarser pictures of the same material: every second, every fourth pixel of a picture of spacing h is a picture of
/// spacing 2h, 4h, as true to the material as a camera with larger pixels would have made it from points, and each
/// picture holds several of them that share no pixel. How a property changes from them to the picture, and how much it
/// differs between them, tells what the picture's own pixels do to it (lattice/PictureError.h).
namespace lamella
{

/// Every `stride`-th node along each axis, from `first` on; an axis of one node keeps it.
/// @param first below the stride and within the lattice
/// @return a lattice of `stride` times the spacing; its origin is that of its first node
[[nodiscard]] PhaseImage subsample(const PhaseImage& image, std::array<std::int64_t, 3> first, int stride);

/// How a picture that repeats is thinned to one of about `stride` times the spacing that repeats as it does: n of the N
/// nodes along an axis, the i-th of them node first + floor(i N/n), counted around. Where N can be divided by the
/// stride that is every stride-th node. Else n is such that pixels stay as near to squares (cubes) as they can, and the
/// stride is not a whole number.
struct PeriodicThinning
{
  std::array<std::int64_t, 3> from{ 1, 1, 1 }; ///< N
  std::array<std::int64_t, 3> size{ 1, 1, 1 }; ///< n
  double stride = 1;                           ///< mean of N/n over the axes that matter, geometric

  /// @param first 0 … N − 1
  [[nodiscard]] std::int64_t node(std::size_t axis, std::int64_t i, std::int64_t first) const noexcept
  {
    return (first + i * from[axis] / size[axis]) % from[axis];
  }
};

/// @param matters by axis, whether the picture changes along it; where not the shape of pixels does not matter
[[nodiscard]] PeriodicThinning periodicThinning(
  const Lattice& lattice, int stride, std::array<bool, 3> matters = { true, true, true });

/// First nodes of the different pictures that every `stride`-th node gives: stride^dimension of them, fewer where an
/// axis is shorter; of more than `most` about as many as that, spread evenly. The order is fixed.
[[nodiscard]] std::vector<std::array<std::int64_t, 3>> subsampleStarts(
  const Lattice& lattice, int stride, std::size_t most = 8);

} // namespace lamella
