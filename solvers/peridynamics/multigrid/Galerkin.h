#pragma once

#include "peridynamics/multigrid/Level.h"

#include <functional>

namespace lamella::peridynamics
{

/// The matrix of a lattice as the Galerkin product reads it, row by row: blocks A(i, i + step) for half of the
/// neighbours, each a number of channels times constant entries, or entry by entry.
struct MatrixRows
{
  struct Neighbour
  {
    std::array<int, 3> step;
    std::array<float, 6> tensor; ///< entries of the block that a channel of one stands for; used with one channel
  };
  std::vector<Neighbour> neighbours;
  int channels = 1; ///< 1, or all entries
  /// Writes channel c of neighbour q for the nodes 0 … size[0] − 1 of own row (y, z) to out + c · stride.
  /// @return false: all zero, nothing was written
  std::function<bool(int q, std::int64_t y, std::int64_t z, float* out, std::int64_t stride)> block;
  /// Entries of A(i, i), n to a row.
  std::function<void(std::int64_t y, std::int64_t z, float* out, std::int64_t stride)> diagonal;
  /// What node x of a row holds along the axis in which it holds most, components that are fixed left out; n to a row.
  std::function<void(std::int64_t y, std::int64_t z, float* out)> stiffness;
  int reach = 0; ///< largest step
};

/// Coarse matrix Pᵀ A P, P bilinear (trilinear) interpolation from every second node: fills half, blocks, diagonal.
/// A side that is not periodic gets a coarse node at or beyond its last fine one.
/// @param fine layout of the fine level
/// @param coarse layout set, its rim as deep as coarseReach(rows.reach)
/// @param packed in 16 bits an entry, where the coarse level has no rim; its diagonal blocks are then those before
/// the others were rounded
void galerkinProduct(const MatrixRows& rows, const NodeLayout& fine, Level& coarse, bool packed = false);

/// Steps that the stencil of a coarse level reaches.
[[nodiscard]] constexpr int coarseReach(int reach) noexcept
{
  return reach % 2 == 0 ? reach / 2 + 1 : (reach + 1) / 2;
}

/// The rows of a coarse level.
[[nodiscard]] MatrixRows rowsOf(const Level& level);

} // namespace lamella::peridynamics
