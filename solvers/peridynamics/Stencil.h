#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::peridynamics
{

/// A bond as seen from its first node: the other one lies at `offset` lattice spacings, |offset| ≤ horizon.
struct Offset
{
  std::array<int, 3> step{ 0, 0, 0 };
  double length = 0; ///< in spacings
  double weight = 1; ///< of its stiffness, over that of a bond of the continuum's micromodulus
};

/// The bonds of a node on a square (cubic) lattice: all nodes within the horizon, each volume counted in full.
///
/// Only half of them are listed, so that each bond of the lattice is met once: those whose last nonzero step is
/// positive, ordered as memory is (z, then y, then x). The other half are their opposites.
class Stencil
{
public:
  /// @param horizon h/δx, 1 to 8
  /// @throws ParameterError for another dimension than 2 or 3 and a horizon outside its range
  Stencil(int dimension, double horizon);

  [[nodiscard]] int dimension() const noexcept { return dimension_; }
  [[nodiscard]] double horizon() const noexcept { return horizon_; }
  /// Half of the bonds of a node.
  [[nodiscard]] const std::vector<Offset>& half() const noexcept { return half_; }
  /// The same with other weights, one for each of half(), positive.
  [[nodiscard]] Stencil weighted(std::span<const double> weights) const;
  /// Bonds of a node in the bulk: 4, 12, 28, 48, 80, 112 in 2D for a horizon of 1 to 6 (Frank et al. 2020).
  [[nodiscard]] std::int64_t bondsPerNode() const noexcept { return 2 * static_cast<std::int64_t>(half_.size()); }
  /// Largest step along an axis: how many layers of nodes a neighbouring block must lend.
  [[nodiscard]] int layers() const noexcept { return layers_; }

private:
  int dimension_;
  double horizon_;
  int layers_;
  std::vector<Offset> half_;
};

} // namespace lamella::peridynamics
