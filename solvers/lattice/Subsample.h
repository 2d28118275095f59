#pragma once

#include "lattice/Phases.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Coarser pictures of the same material: every second, every fourth pixel of a picture of spacing h is a picture of
/// spacing 2h, 4h, as true to the material as a camera with larger pixels would have made it from points, and each
/// picture holds several of them that share no pixel. How a property changes from them to the picture, and how much it
/// differs between them, tells what the picture's own pixels do to it (lbm/PictureError.h).
namespace lamella
{

/// Every `stride`-th node along each axis, from `first` on; an axis of one node keeps it.
/// @param first below the stride and within the lattice
/// @return a lattice of `stride` times the spacing; its origin is that of its first node
[[nodiscard]] PhaseImage subsample(const PhaseImage& image, std::array<std::int64_t, 3> first, int stride);

/// First nodes of the different pictures that every `stride`-th node gives: stride^dimension of them, fewer where an
/// axis is shorter; of more than `most` about as many as that, spread evenly. The order is fixed.
[[nodiscard]] std::vector<std::array<std::int64_t, 3>> subsampleStarts(
  const Lattice& lattice, int stride, std::size_t most = 8);

} // namespace lamella
