#pragma once

#include "packing/GrainSystem.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

namespace lamella::packing
{

/// What may change besides the grains' positions.
enum class BoxMotion
{
  Fixed,
  Volume,   ///< one degree of freedom: the shape is kept
  EachAxis, ///< a degree of freedom each axis: every pair of walls carries the pressure
};

struct RelaxationOptions
{
  BoxMotion box = BoxMotion::Fixed;
  double pressure = 0; ///< [stiffness × diameter / diameter^Dim]
  /// EachAxis: walls may carry up to this share more than the pressure, or less, where that brings the last edge over
  /// the first nearer to `aspect`; in proportion to what is missing, all of it at 1 %.
  double shapeShare = 0;
  double aspect = 1;
  double tolerance = 1e-4; ///< of GrainSystem::unbalanced(), and of the pressure on each axis
  double negligible = 0;   ///< box fixed: mean overlap a grain [diameters] that counts as none
  /// newton(): of the contacts' forces, see ContactLaw [stiffness² diameter²].
  double smoothing = 0;
  std::int64_t maxSteps = 1'000'000;
  std::function<bool()> interrupted; ///< asked now and then; true ends it with Cancelled
  /// relax(): told before each step how many have been made, with the forces of the state as it is.
  std::function<void(std::int64_t)> watch;
};

/// What the walls along each axis are to carry: a share of `pressure`.
template <int Dim>
[[nodiscard]] typename GrainSystem<Dim>::Vec wallShares(
  const GrainSystem<Dim>& grains, const RelaxationOptions& options)
{
  using Vec = typename GrainSystem<Dim>::Vec;
  if (options.box != BoxMotion::EachAxis || options.shapeShare == 0)
    return Vec::Ones();
  const double missing = 100 * std::log(grains.box[Dim - 1] / grains.box[0] / options.aspect);
  const double more = options.shapeShare * std::clamp(missing, -1.0, 1.0);
  Vec shares = Vec::Constant(1 - more / (Dim - 1));
  shares[Dim - 1] = 1 + more;
  return shares;
}

struct RelaxationResult
{
  std::int64_t steps = 0;
  bool atRest = false;
};

/// Damped dynamics to rest: the equations of motion of discrete elements (semi-implicit Euler), whose velocities are
/// turned towards the forces and taken away when they lead uphill (FIRE: Bitzek et al., Phys. Rev. Lett. 97 (2006)
/// 170201, with the corrections of Guénolé et al., Comput. Mater. Sci. 175 (2020) 109584).
/// Without contacts it ends as soon as no two grains overlap.
template <int Dim>
RelaxationResult relax(GrainSystem<Dim>& grains, const RelaxationOptions& options);

/// Newton's method on the enthalpy U + pV of frictionless grains, for the last digits: contact networks close to
/// jamming are so soft that dynamics need 10⁵ steps. Sparse Cholesky factors (BlockCholesky), shifted where the matrix
/// is not positive definite, with backtracking.
template <int Dim>
RelaxationResult newton(GrainSystem<Dim>& grains, const RelaxationOptions& options);

} // namespace lamella::packing
