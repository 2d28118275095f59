#pragma once

#include "elasticity/ElasticConstants.h"
#include "peridynamics/CellBounds.h"
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
  std::vector<double> stiffness; ///< components², by rows; symmetric
  double asymmetry = 0;          ///< largest difference of two opposite components as solved, over the largest of all
  CellBounds bounds;
  elasticity::ElasticConstants constants;
  std::array<bool, 3> crosses{}; ///< along which axes some piece of the solid goes on into the next cell
  std::int64_t pieces = 0;
  std::int64_t loosePieces = 0; ///< of them: they go on nowhere and were taken out, for they carry nothing
  std::int64_t looseNodes = 0;
  std::vector<EquilibriumResult> solutions; ///< one a unit strain; without iterations where the strain is uniform
};

/// Solves for the periodic fluctuation under each unit strain in turn. A direction that nothing crosses has no
/// stiffness, which is an answer and no error. Collective.
/// @param bonds periodic along every axis
/// @throws ParameterError when a side is not periodic, and for large strains; NoPathError when no piece of the cell
/// goes on into the next in any direction; as Equilibrium::solve()
[[nodiscard]] EffectiveStiffness effectiveStiffness(const BondLattice& bonds, const EquilibriumOptions& options = {});

/// Displacement of a mean strain: uᵢ = Σ εᵢⱼ xⱼ about the lattice's first node, in the rim too, where it goes on as if
/// the box did not end [m].
/// @param strain xx, yy, 2xy in 2D; xx, yy, zz, 2yz, 2xz, 2xy in space
[[nodiscard]] NodeField<double> affineField(const BondLattice& bonds, const std::vector<double>& strain);

/// Mean over the box, voids included, of the linearised stress [Pa]: xx, yy, xy in 2D; xx, yy, zz, yz, xz, xy in space.
/// The rim of u must be up to date. Collective.
[[nodiscard]] std::vector<double> meanStress(const BondLattice& bonds, const NodeField<double>& u);

} // namespace lamella::peridynamics
