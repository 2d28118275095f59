#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/NodeField.h"

#include <array>
#include <cstdint>
#include <optional>

namespace lamella::peridynamics
{

/// A sample that breaks, in one state. Fields are those of the rank's slab.
struct BrokenState
{
  double strain = 0;                        ///< imposed
  double stress = 0;                        ///< [Pa]
  std::int64_t broken = 0;                  ///< bonds, of the whole sample
  bool last = false;                        ///< the end of the run
  std::int64_t number = 0;                  ///< among all states asked for, from 0, those before a checkpoint too
  int axis = 0;                             ///< of the load
  std::array<std::int64_t, 2> lowPlaten{};  ///< [first, last) layer along it that a platen holds
  std::array<std::int64_t, 2> highPlaten{}; ///< likewise
  NodeField<double> bonds{};                ///< broken bonds of each node: whole numbers, one component
  NodeField<double> damage{};               ///< these over the bonds that it had, 0 where it had none
  std::optional<NodeField<double>> displacement{};  ///< [m]
  std::optional<NodeField<double>> stressOfNodes{}; ///< as nodalStress() [Pa]
  std::optional<NodeField<double>> energyDensity{}; ///< as energyDensity() [J/m³]
};

/// Finds the last two of a state from its displacement, where they are asked for.
void measure(BrokenState& state, const BondLattice& bonds, bool stress, bool energyDensity, bool nonlinear);

/// How many bonds of each of this rank's nodes broke, and which share of those that it had that is.
class NodeDamage
{
public:
  /// @param bonds not broken yet; must outlive this
  explicit NodeDamage(const BondLattice& bonds);

  /// Takes note of a broken bond, whichever rank owns its ends.
  void add(const Bond& bond);
  /// Broken bonds of the own nodes: whole numbers, one component.
  [[nodiscard]] const NodeField<double>& counts() const noexcept { return counts_; }
  /// These over the bonds that a node had, 0 where it had none.
  [[nodiscard]] NodeField<double> damage() const;

private:
  const BondLattice& bonds_;
  NodeField<float> degree_; ///< bonds of a node at first
  NodeField<double> counts_;
};

} // namespace lamella::peridynamics
