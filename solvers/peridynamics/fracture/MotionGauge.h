#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/NodeField.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::peridynamics
{

/// The mean strain of a sample in motion: how far the nodes on its two sides have moved apart on the mean, over how far
/// they do at a strain of one.
class MotionGauge
{
public:
  /// Collective.
  /// @param axis from side to side @param along component of displacement that counts
  /// @param low, high [first, last) layers of the whole lattice
  /// @param unit displacement at a strain of one [m]; null: where the sample is strained evenly
  MotionGauge(const BondLattice& bonds, int axis, int along, const std::array<std::int64_t, 2>& low,
    const std::array<std::int64_t, 2>& high, const NodeField<double>* unit);

  /// NaN where a side has no matter. Collective.
  [[nodiscard]] double strain(const NodeField<double>& displacement) const;

private:
  /// Mean of values over the nodes of the high side, less that over those of the low one. @param value of a position
  template <class F>
  [[nodiscard]] double apart(F&& value) const;

  const BondLattice& bonds_;
  int along_;
  std::array<std::vector<std::int64_t>, 2> nodes_; ///< positions, of the low and of the high side
  double atOne_ = 0;
};

/// Densities of the nodes [kg/m³], one component, 0 in voids.
/// @param phase of the rank's slab
/// @param byPhase of the phases, by number; 0, and what is beyond: `other`
[[nodiscard]] NodeField<double> densitiesOf(
  const BondLattice& bonds, std::span<const std::uint8_t> phase, std::span<const double> byPhase, double other);

/// Mass of the sample over the volume of its box, voids included [kg/m³]. Collective.
[[nodiscard]] double meanDensity(const BondLattice& bonds, const NodeField<double>& densities);

} // namespace lamella::peridynamics
