#pragma once

#include "packing/GrainSystem.h"

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
  double pressure = 0;     ///< [stiffness × diameter / diameter^Dim]
  double tolerance = 1e-4; ///< of GrainSystem::unbalanced(), and of the pressure on each axis
  double negligible = 0;   ///< box fixed: mean overlap a grain [diameters] that counts as none
  std::int64_t maxSteps = 1'000'000;
  std::function<bool()> interrupted; ///< asked now and then; true ends it with Cancelled
};

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
/// jamming are so soft that dynamics need 10⁵ steps. Sparse Cholesky factors (Eigen), shifted where the matrix is not
/// positive definite, with backtracking.
template <int Dim>
RelaxationResult newton(GrainSystem<Dim>& grains, const RelaxationOptions& options);

} // namespace lamella::packing
