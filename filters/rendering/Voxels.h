#pragma once

#include "Canvas.h"

#include "vtkSmartPointer.h"

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

class vtkPolyData;

namespace lamella::rendering
{

/// A block of voxels, of which some are solid: seen and hiding what is behind them.
struct VoxelBlock
{
  std::array<int, 3> size{ 1, 1, 1 };
  std::array<double, 3> spacing{ 1, 1, 1 };
  std::array<double, 3> corner{ 0, 0, 0 }; ///< lower corner of voxel (0, 0, 0)
  std::vector<bool> solid;

  [[nodiscard]] std::size_t Index(int i, int j, int k) const
  {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
      static_cast<std::size_t>(size[0]) +
      static_cast<std::size_t>(i);
  }
};

/// How faces are lit: the share of their colour that faces across x, y and z keep, and how much darker hollows are
/// (0: not at all).
struct VoxelLight
{
  std::array<double, 3> faces{ 1, 1, 1 };
  double hollows = 0;
};

/// The square faces between solid voxels and empty ones (or the outside) that look towards the viewer, with a colour at
/// each corner (unsigned char RGB point scalars). Hollows are darkened by how much solid there is in front of a corner,
/// within a few voxels, from a summed-volume table: O(voxels + faces).
/// @param towards from the data to the viewer; faces that look away are left out
/// @param translucent keep the faces that others hide
/// @param colorOf colour of a voxel, by its index
[[nodiscard]] vtkSmartPointer<vtkPolyData> VoxelFaces(const VoxelBlock& block, const std::array<double, 3>& towards,
  bool translucent, const VoxelLight& light, const std::function<Color(std::size_t)>& colorOf);

} // namespace lamella::rendering
