#pragma once

#include "peridynamics/Equilibrium.h"

#include <array>
#include <vector>

namespace lamella::peridynamics
{

/// Stiffness of a cell that is periodic along every axis: mean stress over mean strain, in Voigt order (xx, yy, 2xy in
/// 2D; xx, yy, zz, 2yz, 2xz, 2xy in space) [Pa].
struct EffectiveStiffness
{
  int components = 3;
  std::vector<double> stiffness; ///< components², by rows; symmetric to the tolerance of the solution
  /// Engineering constants, from the inverse: Young's moduli [Pa] along x, y, z; shear moduli yz, xz, xy (xy alone in
  /// 2D, first) [Pa]; Poisson's ratios −ε_b/ε_a under stress along a for (a, b) = xy, yx in 2D; xy, xz, yx, yz, zx, zy.
  std::vector<double> youngsModulus;
  std::vector<double> shearModulus;
  std::vector<double> poissonsRatio;
  std::vector<EquilibriumResult> solutions; ///< one a unit strain
};

/// Solves for the periodic fluctuation under each unit strain in turn. Collective.
/// @param bonds periodic along every axis
/// @throws ParameterError when a side is not periodic; NoPathError when the cell has no stiffness in some direction,
/// for then there is no inverse; as Equilibrium::solve()
[[nodiscard]] EffectiveStiffness effectiveStiffness(const BondLattice& bonds, const EquilibriumOptions& options = {});

/// Displacement of a mean strain: uᵢ = Σ εᵢⱼ xⱼ about the lattice's first node, in the rim too, where it goes on as if
/// the box did not end [m].
/// @param strain xx, yy, 2xy in 2D; xx, yy, zz, 2yz, 2xz, 2xy in space
[[nodiscard]] NodeField<double> affineField(const BondLattice& bonds, const std::vector<double>& strain);

/// Mean over the box, voids included, of the linearised stress [Pa]: xx, yy, xy in 2D; xx, yy, zz, yz, xz, xy in space.
/// The rim of u must be up to date. Collective.
[[nodiscard]] std::vector<double> meanStress(const BondLattice& bonds, const NodeField<double>& u);

} // namespace lamella::peridynamics
