#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lamella
{

/// A regular lattice of nodes at pixel (voxel) centres, x fastest, then y, then z: the memory order of vtkImageData.
///
/// In 2D the first row in memory is the *bottom* row of the picture, as VTK has it, so that ParaView shows a picture
/// upright. Volumes keep the order of their file.
struct Lattice
{
  int dimension = 2;                             ///< 2 or 3
  std::array<std::int64_t, 3> size{ 1, 1, 1 };   ///< nodes along x, y, z; size[2] is 1 in 2D
  double spacing = 1.0;                          ///< δx [m], along x, and along every axis where aspect says nothing
  std::array<double, 3> origin{ 0.5, 0.5, 0.5 }; ///< position of the first node [m]; half a spacing from the edge
  /// Spacing along each axis over `spacing`. Only steady diffusion takes voxels that are not cubes.
  std::array<double, 3> aspect{ 1, 1, 1 };

  [[nodiscard]] std::int64_t count() const noexcept { return size[0] * size[1] * size[2]; }
  [[nodiscard]] std::int64_t index(std::int64_t x, std::int64_t y, std::int64_t z = 0) const noexcept
  {
    return x + size[0] * (y + size[1] * z);
  }
  [[nodiscard]] double spacingAlong(int axis) const noexcept { return spacing * aspect[axis]; }
  [[nodiscard]] bool cubes() const noexcept { return aspect == std::array<double, 3>{ 1, 1, 1 }; }
  /// Length of the box along an axis [m]: one spacing a node, edge to edge.
  [[nodiscard]] double length(int axis) const noexcept { return spacingAlong(axis) * static_cast<double>(size[axis]); }
};

/// What voxels somebody takes: steady diffusion and readers any, all others cubes.
enum class Voxels
{
  Cubes,
  Any
};

/// A lattice whose first node lies half a spacing from the coordinate planes.
[[nodiscard]] inline Lattice makeLattice(std::int64_t nx, std::int64_t ny, std::int64_t nz, int dimension,
  double spacing, const std::array<double, 3>& aspect = { 1, 1, 1 }) noexcept
{
  return Lattice{ dimension, { nx, ny, nz }, spacing,
    { spacing * aspect[0] / 2, spacing * aspect[1] / 2, dimension == 3 ? spacing * aspect[2] / 2 : 0.0 }, aspect };
}

} // namespace lamella
