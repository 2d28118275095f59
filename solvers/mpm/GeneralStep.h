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
  SharedRows<Dim>* rows; ///< of a grid that several ranks share, else null
  double time;
  double dt;   ///< by which points move
  double kick; ///< over which forces act: from half a step ago to half a step ahead

  /// Collective where ranks share the grid: lumped mass, PIC or APIC then.
  /// @return the work of body forces other than gravity, on this rank's points [J]
  /// @throws DivergenceError: a point outside the grid; a consistent mass that cannot be solved with
  double run() const;
};

extern template struct GeneralStep<2>;
extern template struct GeneralStep<3>;

} // namespace lamella::mpm
