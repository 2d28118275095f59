#pragma once

#include "elasticity/VoxelStiffness.h"

#include <span>
#include <vector>

namespace lamella::elasticity
{

/// How far a box speaks for its material, from the stiffness of the windows that it is cut into: of each component of
/// the diagonal and each constant (VoxelStiffness::windows). Windows are cut out of walls, which mirror images of them
/// go on with and copies of them do not: their sides are Straight whatever the box's.
///
/// @param options as of the box  @param box what was found of it
/// @throws as studyVoxelStiffness(); a window that nothing leads across has no stiffness, which is no error
[[nodiscard]] std::vector<statistics::WindowError> stiffnessWindows(const Lattice& lattice,
  std::span<const std::uint8_t> phase, const std::vector<VoxelMaterial>& materials,
  std::span<const std::array<float, 3>> axis, const VoxelStiffnessOptions& options, const VoxelStiffness& box);

} // namespace lamella::elasticity
