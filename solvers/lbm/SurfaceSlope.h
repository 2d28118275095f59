#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lamella::lbm
{

/// The 3 × 3 (× 3) nodes around one: differences of all pairs of nodes two apart, summed with weights of 1, 2, 1 across
/// (Sobel's).
struct NearestNodes
{
  using Sum = int;
  bool flat = false; ///< in the plane
  [[nodiscard]] int reach(std::size_t axis) const noexcept { return axis == 2 && flat ? 0 : 1; }
  [[nodiscard]] int weight(std::size_t /*axis*/, int step) const noexcept { return step == 0 ? 2 : 1; }
};

/// How a phase falls off around one of its nodes, from the nodes around: a vector out of the phase, each component in
/// a unit of its own, zeros where it lies on both sides alike.
///
/// @param window  which nodes: reach(axis) to either side, with weight(axis, step) across
/// @param row     row(dy, dz): ids of the row that lies so far away, whose node of the same x is at the index x
/// @param x       indices of the nodes from −reach to reach along x; beyond a side what stands for them
template <class Window, class Rows>
[[nodiscard]] std::array<typename Window::Sum, 3> surfaceSlope(
  std::uint8_t phase, const Window& window, std::span<const std::int64_t> x, Rows&& row)
{
  using Sum = typename Window::Sum;
  const auto sign = [](int step) { return static_cast<Sum>(step < 0 ? 1 : step > 0 ? -1 : 0); };
  const int reach = window.reach(0);
  std::array<Sum, 3> slope{ 0, 0, 0 };
  for (int dz = -window.reach(2); dz <= window.reach(2); ++dz)
    for (int dy = -window.reach(1); dy <= window.reach(1); ++dy)
    {
      const std::uint8_t* const ids = row(dy, dz);
      Sum fall = 0;
      Sum all = 0;
      for (int dx = -reach; dx <= reach; ++dx)
      {
        const auto same = static_cast<Sum>(ids[x[static_cast<std::size_t>(dx + reach)]] == phase);
        fall += sign(dx) * same;
        all += window.weight(0, dx) * same;
      }
      slope[0] += window.weight(1, dy) * window.weight(2, dz) * fall;
      slope[1] += sign(dy) * window.weight(2, dz) * all;
      slope[2] += sign(dz) * window.weight(1, dy) * all;
    }
  return slope;
}

} // namespace lamella::lbm
