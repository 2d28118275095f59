#pragma once

#include "mpm/BoxSides.h"
#include "mpm/MaterialPoints.h"
#include "mpm/PointLaw.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// The stiffness of material points at rest: small strains of a whole box, by an implicit solve of the discretisation
/// that the explicit method has with quadratic splines. Exactly quasi-static.
namespace lamella::mpm
{

enum class StiffnessSolver : std::uint8_t
{
  Automatic,          ///< Cholesky for few nodes in a plane, else multigrid
  Cholesky,           ///< sparse factors by blocks of a node, as preconditioner of a few conjugate gradient steps
  ConjugateGradients, ///< preconditioned by the nodes' own blocks; without a matrix: the least memory
  Multigrid           ///< conjugate gradients on the matrix by rows, all load cases at once; PointMultigrid.h
};

/// What a solve will take, told once its nodes are known.
struct PointStiffnessPlan
{
  std::int64_t nodes = 0;
  double bytes = 0; ///< at most, about
  /// Processor time, about: of a body without pores, and of one whose walls are as thin as the grid allows [s]
  std::array<double, 2> seconds{};
};

/// @param cases of load
/// @param factors of Cholesky, not multigrid
[[nodiscard]] PointStiffnessPlan planPointStiffness(int dimension, std::int64_t nodes, std::size_t cases, bool factors);

template <int Dim>
struct PointStiffnessOptions
{
  std::array<double, Dim> lower{}; ///< corners of the box [m]: walls stand there
  std::array<double, Dim> upper{};
  double spacing = 0; ///< of the grid [m]; the nearest that divides the box's length, axis by axis
  /// Of both ends of every axis. Periodic all round, the whole tensor: the points are joined to their images. Sticky
  /// walls all round: an upper bound of it. Walls all round: stretching and pressing only.
  std::array<BoxSides, Dim> sides{};
  StiffnessSolver solver = StiffnessSolver::Automatic;
  /// Of the residual, as PointStiffness::residual. Multigrid ends before it where PointStiffness::lost says so.
  double tolerance = 1e-6;
  std::int64_t maximumIterations = 20000;
  double memory = 0;                      ///< bytes that may be taken; 0: all that are free
  std::function<bool(double)> progress{}; ///< share done; true asks to stop
  std::function<void(const PointStiffnessPlan&)> planned{};
};

/// What a box does under stress along one axis.
template <int Dim>
struct UniaxialStiffness
{
  double modulus = 0; ///< mean stress over strain [Pa]
  /// Strain along every axis over the one along the loaded axis: 1 there, minus Poisson's ratio along straight sides
  /// with no force, 0 along fixed ones.
  std::array<double, Dim> strain{};
  std::array<double, Dim> stress{}; ///< mean stress along every axis over the strain along the loaded one [Pa]
};

template <int Dim>
struct PointStiffness
{
  /// The strains of the box that its sides allow, as places in Voigt's order (xx, yy, xy or xx, yy, zz, yz, xz, xy);
  /// shear strains as angles.
  std::vector<int> strains;
  /// Mean stress over the box, voids included, for each of them: strains² by rows, symmetric [Pa].
  std::vector<double> stiffness;

  std::size_t points = 0;
  std::int64_t nodes = 0; ///< of the grid, that points act on
  std::array<double, Dim> spacing{};
  std::vector<std::int64_t> iterations; ///< of conjugate gradients, by strain
  /// The worst; of forces over the roots of K's diagonal, over the root of the energy of a box strained evenly.
  double residual = 0;
  /// 0 where the tolerance was reached. Else iterations ended before it, since hundreds of them had brought the
  /// stiffness no further: the largest share of a box's energy that the last hundred took away. What is left to take is
  /// more of that, of the size of a few such hundreds.
  double lost = 0;
  double setupSeconds = 0; ///< wall: points, matrix, factors
  double solveSeconds = 0;

  /// @param axis loaded
  /// @param fixed sides along the other axes stay where they are; else they are straight, with no force
  /// @throws ParameterError where the box's sides do not allow that strain
  [[nodiscard]] UniaxialStiffness<Dim> along(int axis, bool fixed = false) const;
};

/// @throws ParameterError: options outside their range, fewer than five cells along an axis, a law with fewer phases
/// than the points have
/// @throws InputError: no points, points that are not finite or lie outside the box
/// @throws NoPathError: nothing carries a load from one end of an axis to the other
/// @throws MemoryError, before it takes any
/// @throws DivergenceError: the tolerance was not reached; Cancelled
template <int Dim>
[[nodiscard]] PointStiffness<Dim> pointStiffness(
  const MaterialPoints<Dim>& points, const PointLaw<Dim>& law, const PointStiffnessOptions<Dim>& options);

extern template struct PointStiffness<2>;
extern template struct PointStiffness<3>;
extern template PointStiffness<2> pointStiffness<2>(
  const MaterialPoints<2>&, const PointLaw<2>&, const PointStiffnessOptions<2>&);
extern template PointStiffness<3> pointStiffness<3>(
  const MaterialPoints<3>&, const PointLaw<3>&, const PointStiffnessOptions<3>&);

} // namespace lamella::mpm
