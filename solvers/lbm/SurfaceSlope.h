#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace lamella::lbm
{

/// How a phase falls off around one of its nodes, from the nodes within `Reach` of it along each axis: a vector out of
/// the phase, of no particular length, zeros where it lies on both sides alike. Differences of all pairs of nodes two
/// apart, summed with weights of 1, 2, 1 across (Sobel's) for a reach of 1; for 2 the sum of those of the 3 × 3 × 3
/// nodes around.
///
/// @param depth   Reach in space, 0 in the plane
/// @param row     row(dy, dz): ids of the row that lies so far away, whose node of the same x is at the index x
/// @param x       indices of the nodes from −Reach to Reach along x; beyond a side what stands for them
template <int Reach, class Rows>
[[nodiscard]] std::array<int, 3> surfaceSlope(
  std::uint8_t phase, int depth, const std::array<std::int64_t, 2 * Reach + 1>& x, Rows&& row)
{
  static_assert(Reach == 1 || Reach == 2);
  constexpr std::array<int, 3> across = Reach == 1 ? std::array{ 2, 1, 0 } : std::array{ 4, 3, 1 };
  const auto weight = [&](int step) { return across[static_cast<std::size_t>(std::abs(step))]; };
  const auto sign = [](int step) { return step < 0 ? 1 : step > 0 ? -1 : 0; };
  std::array<int, 3> slope{ 0, 0, 0 };
  for (int dz = -depth; dz <= depth; ++dz)
    for (int dy = -Reach; dy <= Reach; ++dy)
    {
      const std::uint8_t* const ids = row(dy, dz);
      int fall = 0;
      int all = 0;
      for (int dx = -Reach; dx <= Reach; ++dx)
      {
        const int same = static_cast<int>(ids[x[static_cast<std::size_t>(dx + Reach)]] == phase);
        fall += sign(dx) * same;
        all += weight(dx) * same;
      }
      slope[0] += weight(dy) * weight(dz) * fall;
      slope[1] += sign(dy) * weight(dz) * all;
      slope[2] += sign(dz) * weight(dy) * all;
    }
  return slope;
}

} // namespace lamella::lbm
