#pragma once

#include <cmath>

namespace lamella
{

/// What no quantity of a sample or a material leaves, whichever its unit: squares, cubes and ratios of what lies
/// between are numbers, too.
inline constexpr double leastPlausible = 1e-30;
inline constexpr double mostPlausible = 1e30;

/// Whether arithmetic with it is safe: its size lies between these.
[[nodiscard]] inline bool plausible(double value) noexcept
{
  return std::fabs(value) >= leastPlausible && std::fabs(value) <= mostPlausible;
}

} // namespace lamella
