#pragma once

#include "peridynamics/Equilibrium.h"
#include "peridynamics/Loading.h"

#include <cstdint>
#include <vector>

/// How the stress at which the first bond breaks changes with the materials, by one adjoint equilibrium.
namespace lamella::peridynamics
{

struct PairNumber;

struct BreakSensitivity
{
  /// (k/σ) ∂σ/∂k by kind of bond from 1 on, σ the effective stress at the first break; its sum is 1.
  std::vector<double> stiffness;
  int kind = 0; ///< of the bond that breaks: (s₀/σ) ∂σ/∂s₀ is 1 of it and 0 of all others
  std::int64_t iterations = 0;
};

/// Linear. The force on the high platen is F = cᵀK u, the stretch of the bond s = qᵀu, and σ ∝ F s₀/s. With
/// displacements λ that are c/F where the platens hold, and in equilibrium with q/s elsewhere, any change K′ of the
/// stiffness matrix changes log σ by λᵀK′u: one solve, whatever there is to change. Under a traction F does not change,
/// and c is 0. Collective.
/// @param bonds none of them broken; where kinds are to tell pairs apart, of a model with BondModel::kindByPair
/// @param equilibrium of this sample
/// @param u what it solved to
/// @param bond the one that breaks, by largestStretch(): where others are as critical, it is one of several, and the
/// derivative is on one side only
/// @param force with which the high platen pulls along the load, against it where negative [N], [N/m]; 0 where it is
/// the force that is given
/// @throws as Equilibrium::solve()
[[nodiscard]] BreakSensitivity breakSensitivity(const BondLattice& bonds, Equilibrium& equilibrium,
  const LoadedSample& sample, const NodeField<double>& u, const Bond& bond, int axis, int across, double force);

/// ∂ log σ/∂ log p of the stress at the first break, of a value of the table of materials (PairTable.h).
[[nodiscard]] double relativeChange(const BreakSensitivity& sensitivity, const PairNumber& number);

} // namespace lamella::peridynamics
