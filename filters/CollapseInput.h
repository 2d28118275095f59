#pragma once

#include "compression/CornerMotion.h"

#include <cstdint>
#include <vector>

class vtkPolyData;

/// Helpers of vtkCollapseMap; not installed.
namespace lamella
{

/// Material points of one state.
struct CollapseInput
{
  std::vector<std::uint32_t> id;
  std::vector<double> position; ///< 3 a point [m]
  std::vector<double> gradient; ///< 9 or 4 a point
  double strain = 0;

  [[nodiscard]] compression::PointState state() const { return { id, position, gradient }; }
};

/// Checks in the order present, at points, components, whole.
/// @param time of the step, where the points have no field data `strain`; NaN: they have no time either
/// @throws InputError
[[nodiscard]] CollapseInput collapseInput(vtkPolyData* points, int dimension, double time);

} // namespace lamella
