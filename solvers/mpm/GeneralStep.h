#pragma once

#include "mpm/PointDynamics.h"

#include <vector>

namespace lamella::mpm
{

/// A step of PointDynamics in every combination of shapes, transfers, mass and stress update: written plainly; the
/// fused kernels are measured against it.
template <int Dim>
struct GeneralStep
{
  MaterialPoints<Dim>& points;
  const PointLaw<Dim>& law;
  const PointDynamicsOptions<Dim>& options;
  const BackgroundGrid<Dim>& grid;
  Walls<Dim>& walls;
  double time;
  double dt;   ///< by which points move
  double kick; ///< over which forces act: from half a step ago to half a step ahead

  /// @return the work of body forces other than gravity [J]
  /// @throws DivergenceError: a point outside the grid; a consistent mass that cannot be solved with
  double run() const;
};

extern template struct GeneralStep<2>;
extern template struct GeneralStep<3>;

} // namespace lamella::mpm
