#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/NodeField.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

/// What pushes and moves a sample in motion: tractions on its sides, boxes of nodes that keep a velocity.
namespace lamella::peridynamics
{

/// Nodes of the whole lattice: [low, high) along each axis.
struct NodeBox
{
  std::array<std::int64_t, 3> low{ 0, 0, 0 };
  std::array<std::int64_t, 3> high{ 0, 0, 0 };

  [[nodiscard]] bool contains(const std::array<std::int64_t, 3>& node) const noexcept
  {
    for (std::size_t a = 0; a < 3; ++a)
      if (node[a] < low[a] || node[a] >= high[a])
        return false;
    return true;
  }
};

/// The nodes whose positions lie between two corners [m], ends included to a millionth of a spacing.
[[nodiscard]] NodeBox nodesBetween(
  const Lattice& lattice, const std::array<double, 3>& low, const std::array<double, 3>& high);

/// So many layers of nodes on a side.
/// @param high the side at the end of the axis, else the one at its beginning
[[nodiscard]] NodeBox sideLayers(const Lattice& lattice, int axis, bool high, std::int64_t layers);

/// A force on an area of a side [Pa], spread evenly over layers of nodes: a bond model has no surface to pull on.
struct SideTraction
{
  int axis = 1;
  bool high = true;
  std::array<double, 3> traction{ 0, 0, 0 }; ///< force on the sample over area, whichever the side is [Pa]
  int layers = 0;                            ///< 0: as many as a bond reaches
};

/// Forces on the nodes [N], [N/m in 2D]: traction · δx^(d−1)/layers on every solid node of the layers, so that where a
/// column of the layers is solid it carries the whole traction. Sums where sides meet.
/// @throws ParameterError: an axis that is none or is periodic, a traction that is not finite, more layers than nodes
[[nodiscard]] NodeField<double> tractionLoad(const BondLattice& bonds, std::span<const SideTraction> tractions);

/// Nodes that keep a velocity, by component; those without a value are free.
struct MovedNodes
{
  NodeBox box;
  std::array<std::optional<double>, 3> velocity{}; ///< [m/s]
};

/// As BondDynamics takes it.
struct ImposedMotion
{
  FixedComponents fixed;
  NodeField<double> velocity; ///< [m/s] of fixed components, 0 elsewhere
};

/// Where boxes overlap the last one decides, component by component.
/// @throws ParameterError: a velocity that is not finite; a box without a solid node
[[nodiscard]] ImposedMotion imposeMotion(const BondLattice& bonds, std::span<const MovedNodes> moved);

} // namespace lamella::peridynamics
