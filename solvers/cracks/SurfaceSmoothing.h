#pragma once

#include "cracks/CrackSurface.h"

#include <array>
#include <vector>

namespace lamella::cracks
{

/// Where the points of a crack's stairs lie on the smoothest surface that still passes between the nodes that it parts:
/// the least of Σ |p − p₀|² + Σ λ |p − mean of its neighbours|², p₀ the corners of the voxels. λ begins so large that
/// all is flat, and is lowered around the pairs that the surface does not pass between. Smoothing the remainder once
/// more restores what this takes off bends. In node numbers.
[[nodiscard]] std::vector<std::array<double, 3>> smoothSurface(const CrackSurface& surface);

} // namespace lamella::cracks
