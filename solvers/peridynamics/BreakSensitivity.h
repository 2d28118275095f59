#pragma once

#include "peridynamics/Equilibrium.h"
#include "peridynamics/Loading.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// How the stress at which the first bond breaks changes with the materials, by one adjoint equilibrium.
namespace lamella::peridynamics
{

struct PairNumber;

struct BreakSensitivity
{
  /// (k/σ) ∂σ/∂k by pair, in the order of describePairs(), σ the effective stress at the first break; its sum is 1. Of
  /// pairs that are of one kind (BondModel::pairGroups) the first has that of all, and the others 0.
  std::vector<double> stiffness;
  std::size_t pair = 0; ///< of the bond that breaks: (s₀/σ) ∂σ/∂s₀ is 1 of it and 0 of all others
  std::int64_t iterations = 0;
};

/// What is known of a sample at equilibrium.
struct BreakState
{
  const NodeField<double>& u;     ///< its displacements, rim filled
  const NodeField<double>& force; ///< linearForce() of them: −K u
  Bond bond;                      ///< that breaks first, by largestStretch()
  int axis = 0;                   ///< of loading
  int across = 0;                 ///< component along which the load acts
  /// With which the high platen pulls along the load, against it where negative [N], [N/m]; 0 where it is the force
  /// that is given.
  double pull = 0;
  /// How far the high platen has moved along the load, where nothing else is moved: then u is, scaled, the part of the
  /// adjoint that the platen moves, or nearly so. 0 where that is not known [m].
  double movement = 0;
};

/// Linear. The force on the high platen is F = cᵀK u, the stretch of the bond s = qᵀu, and σ ∝ F s₀/s. With
/// displacements λ that are c/F where the platens hold, and in equilibrium with q/s elsewhere, any change K′ of the
/// stiffness matrix changes log σ by λᵀK′u: one solve, whatever there is to change. Under a traction F does not change,
/// and c is 0. Where all bonds are of one kind there is nothing to solve. Collective.
/// @param bonds none of them broken
/// @param pairKinds BondKinds::ofPairs() of the model they were made of
/// @param equilibrium of this sample
/// @param state where others are as critical as its bond, that is one of several, and the derivative is on one side
/// only
/// @throws as Equilibrium::solve()
[[nodiscard]] BreakSensitivity breakSensitivity(const BondLattice& bonds, std::span<const int> pairKinds,
  Equilibrium& equilibrium, const LoadedSample& sample, const BreakState& state);

/// ∂ log σ/∂ log p of the stress at the first break, of a value of the table of materials (PairTable.h).
[[nodiscard]] double relativeChange(const BreakSensitivity& sensitivity, const PairNumber& number);

} // namespace lamella::peridynamics
