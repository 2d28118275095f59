#pragma once

#include "peridynamics/Loading.h"

namespace lamella::peridynamics
{

/// The force on the platens that does work when the load rises, positive along it.
class PlatenForce
{
public:
  PlatenForce(const BondLattice& bonds, const Loading& loading, const LoadedSample& sample);

  /// @param force on every node, those of the platens included: BondForces.h
  /// Half of what the two platens feel together: the same at equilibrium. Collective.
  template <class Real>
  [[nodiscard]] double of(const BondLattice& bonds, const NodeField<Real>& force) const;
  /// Positive the other way from now on.
  void turn() noexcept { sign_ = -sign_; }
  /// How far a state is from equilibrium: the largest difference between the force through a section between the
  /// platens and that on the platens, over the latter; 0 where both vanish, infinite where only the latter does.
  /// Collective.
  [[nodiscard]] double imbalance(const BondLattice& bonds, const NodeField<double>& force) const;
  /// Of the section that carries it [m²], [m] in the plane.
  [[nodiscard]] double area() const noexcept { return area_; }
  /// Bits 1 and 2 of nodes within the low and the high platen, bit 4 of those with a fixed component; rim not filled.
  [[nodiscard]] AlignedArray<std::uint8_t> marks(const BondLattice& bonds, const LoadedSample& sample) const;

private:
  int axis_;
  int component_;
  double sign_;
  double area_ = 1;
  std::array<std::int64_t, 2> low_;
  std::array<std::int64_t, 2> high_;
};

} // namespace lamella::peridynamics
