#pragma once

#include "peridynamics/NodeField.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace lamella::peridynamics
{

/// Is an axis one whose last two nodes count as one for the next level? Those of an odd number that begins again; n − 1
/// positions are left, which can be halved.
[[nodiscard]] inline bool isFolded(
  const NodeLayout& fine, const std::array<bool, 3>& periodic, std::size_t axis) noexcept
{
  return periodic[axis] && fine.global[axis] % 2 != 0 && fine.global[axis] > 1;
}

/// An odd number n of nodes along a periodic axis: the last two count as one, at position n − 2, and n − 1 of them can
/// be halved. Steps across those two are then shorter by one.
struct Fold
{
  std::int64_t global = 0; ///< n; 0: nothing is folded
  std::int64_t start = 0;  ///< of the own nodes
  std::int64_t own = 0;    ///< own nodes

  Fold() = default;
  Fold(const NodeLayout& l, const std::array<bool, 3>& periodic, std::size_t axis)
    : global(isFolded(l, periodic, axis) ? l.global[axis] : 0)
    , start(l.start[axis])
    , own(l.size[axis])
  {
  }
  /// Are both of the two nodes this rank's? They always are one rank's.
  [[nodiscard]] bool here() const noexcept { return global > 0 && start + own == global; }
  /// Own positions.
  [[nodiscard]] std::int64_t positions() const noexcept { return own - (here() ? 1 : 0); }
  /// Is the step from own node i shorter by one?
  [[nodiscard]] bool shortens(std::int64_t i, int step) const noexcept
  {
    if (global == 0 || step == 0)
      return false;
    // upwards it passes from n − 2 or below to n − 1 or beyond
    const std::int64_t from = i + start + (step < 0 ? step : 0);
    const std::int64_t lower = (from + global) % global;
    return lower <= global - 2 && lower + std::abs(step) >= global - 1;
  }
};

[[nodiscard]] constexpr int shorter(int step) noexcept
{
  return step > 0 ? step - 1 : step + 1;
}

} // namespace lamella::peridynamics
