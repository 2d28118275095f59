#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace lamella::test
{

/// The part of each voxel in a sphere of a volume fraction in a cubic cell that repeats; x fastest.
/// @param centre over the cell  @param samples a voxel that the surface may cross has samples³
inline std::vector<double> sphereShares(
  std::int64_t n, double fraction, std::array<double, 3> centre = { 0.5, 0.513, 0.479 }, int samples = 8)
{
  const double cell = static_cast<double>(n);
  const double radius = std::cbrt(fraction * 3 / (4 * std::numbers::pi)) * cell;
  std::vector<double> share;
  share.reserve(static_cast<std::size_t>(n * n * n));
  const auto from = [&](std::int64_t i, std::size_t axis)
  {
    const double d = static_cast<double>(i) + 0.5 - centre[axis] * cell;
    return d - cell * std::round(d / cell);
  };
  for (std::int64_t z = 0; z < n; ++z)
    for (std::int64_t y = 0; y < n; ++y)
      for (std::int64_t x = 0; x < n; ++x)
      {
        const std::array<double, 3> d{ from(x, 0), from(y, 1), from(z, 2) };
        const double distance = std::hypot(d[0], d[1], d[2]);
        if (std::abs(distance - radius) > std::numbers::sqrt3 / 2)
        {
          share.push_back(distance < radius ? 1 : 0);
          continue;
        }
        int inside = 0;
        const auto at = [&](std::size_t axis, int i) { return d[axis] + (i + 0.5) / samples - 0.5; };
        for (int k = 0; k < samples; ++k)
          for (int j = 0; j < samples; ++j)
            for (int i = 0; i < samples; ++i)
              inside += std::hypot(at(0, i), at(1, j), at(2, k)) < radius ? 1 : 0;
        share.push_back(inside / static_cast<double>(samples * samples * samples));
      }
  return share;
}

} // namespace lamella::test
