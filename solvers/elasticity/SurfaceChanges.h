#pragma once

#include <cstdint>
#include <vector>

namespace lamella::elasticity
{

/// How ε_i : C : ε_j of fields, mean over the box, changes with where the surface between two phases lies.
struct SurfaceChange
{
  std::uint8_t first = 0, second = 0; ///< phase ids, the first one the lower
  double area = 0;                    ///< of the surface over the box's volume [1 / edge of a voxel along x]
  /// By triangle(fields, i, j), where the first grows into the second [Pa / edge of a voxel along x].
  std::vector<double> shift;
};

} // namespace lamella::elasticity
