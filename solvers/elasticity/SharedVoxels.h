#pragma once

#include "elasticity/VoxelStiffness.h"
#include "lattice/Lattice.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// Voxels that a surface cuts, of which each of two phases has a share: greys of an unsegmented volume, exact area
/// fractions of outlines.
namespace lamella::elasticity
{

/// By share of `high`. With a void, the solid's stiffness times its share. Of two isotropic solids, the laminate that
/// the voxel is to its neighbours, its axis across the layers (Backus, J. Geophys. Res. 67 (1962) 4427): errors then
/// fall like the voxel, evenly, whichever of the two is stiffer, so that two spacings tell the limit.
/// @param low, high each void, isotropic or with an axis; an expansion of an isotropic one is the same in all
///   directions
/// @throws ParameterError: one is rigid, both are void, two solids of which one is not isotropic
[[nodiscard]] std::vector<VoxelMaterial> sharedMaterials(
  Continuum continuum, const VoxelMaterial& low, const VoxelMaterial& high, std::span<const double> shares);

/// Where the share grows most, of each voxel: the direction across the surface in it. Any direction where nothing
/// tells.
[[nodiscard]] std::vector<std::array<float, 3>> shareAxes(const Lattice& lattice, std::span<const std::uint8_t> ids,
  std::span<const double> shares, bool periodic, int threads);

/// The shares of a lattice of fewer voxels over the same box: means of those that each voxel covers.
/// @returns ids, the nearest of `shares`
[[nodiscard]] std::vector<std::uint8_t> coarserShares(const Lattice& lattice, std::span<const std::uint8_t> ids,
  std::span<const double> shares, const std::array<std::int64_t, 3>& size);

} // namespace lamella::elasticity
