#pragma once

#include "lbm/multigrid/StaggeredAllocator.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamella::lbm
{

/// Layout of one multigrid level on one rank: rows along x split by the parity of x, one ghost row around the block in
/// y (and z), room for one ghost node at each end of a row.
struct Grid
{
  int dimension = 2;
  std::int64_t nx = 1;
  std::int64_t ny = 1;
  std::int64_t nz = 1;
  std::int64_t even = 1; ///< nodes of even x in a row
  std::int64_t odd = 0;
  std::int64_t half = 8; ///< floats from the even to the odd part of a row
  std::int64_t stride = 16;
  int ghostZ = 0;

  Grid() = default;
  Grid(int dim, std::int64_t x, std::int64_t y, std::int64_t z)
    : dimension(dim)
    , nx(x)
    , ny(y)
    , nz(z)
    , even((x + 1) / 2)
    , odd(x / 2)
    // two slots behind the even part: its right ghost and the odd part's left one
    , half(((x + 1) / 2 + 2 + 7) / 8 * 8)
    , stride(2 * half)
    , ghostZ(dim == 3 ? 1 : 0)
  {
  }

  static constexpr std::int64_t lead = 16; ///< floats before the first row and after the last: blocks may read past it
  [[nodiscard]] std::int64_t rows() const noexcept { return (ny + 2) * (nz + 2 * ghostZ); }
  [[nodiscard]] std::size_t floats() const noexcept { return static_cast<std::size_t>(2 * lead + rows() * stride); }
  /// Offset of a row's even part, y = -1 … ny, z = -1 … nz (3D).
  [[nodiscard]] std::int64_t row(std::int64_t y, std::int64_t z) const noexcept
  {
    return lead + ((z + ghostZ) * (ny + 2) + y + 1) * stride;
  }
  [[nodiscard]] std::int64_t count(int part) const noexcept { return part == 0 ? even : odd; }
  /// Offset, from a row's begin, of the node dx = -1, 0, 1 away from node 0 of the even (0) or odd (1) part.
  [[nodiscard]] std::int64_t shift(int part, int dx) const noexcept
  {
    if (part == 0)
      return dx == 0 ? 0 : dx > 0 ? half : half - 1;
    return dx == 0 ? half : dx > 0 ? 1 : 0;
  }
  /// Offset of the node at x.
  [[nodiscard]] std::int64_t node(std::int64_t x) const noexcept { return (x & 1) != 0 ? half + (x - 1) / 2 : x / 2; }
};

using FloatArray = std::vector<float, StaggeredAllocator<float>>;

} // namespace lamella::lbm
