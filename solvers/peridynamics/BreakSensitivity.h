#pragma once

#include "peridynamics/Equilibrium.h"
#include "peridynamics/Loading.h"
#include "peridynamics/PairTable.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// How the stress at which the first bond breaks changes with the materials, by one adjoint equilibrium.
namespace lamella::peridynamics
{

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

/// One value of a table of materials, and what it does.
struct PairNumber
{
  std::string property; ///< "young", "fracture-energy", "toughness", "critical-stretch"
  std::string pair;     ///< as the table has it
  double value = 0;     ///< as the table has it
  /// ∂ log E/∂ log p and ∂ log s₀/∂ log p by pair, in the order of describePairs(). Of fracture energies and
  /// toughnesses s₀ hangs on E, too.
  std::vector<double> young, stretch;

  [[nodiscard]] std::string name() const { return property + ":" + pair; }
};

/// The values that some pair of the sample hangs on, by differences of the table's own rules (`like`, `relativeTo`,
/// mixing): to 1e-9; at a kink of Mixing::Minimum the mean of both sides.
/// @param names, nodes, spacing, model as applyMaterials() had them
[[nodiscard]] std::vector<PairNumber> pairNumbers(const PairTable& table, std::span<const std::string> names,
  std::span<const std::int64_t> nodes, double spacing, const BondModel& model);

/// ∂ log σ/∂ log p of the stress at the first break.
[[nodiscard]] double relativeChange(const BreakSensitivity& sensitivity, const PairNumber& number);

} // namespace lamella::peridynamics
