#pragma once

#include "lattice/Lattice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::compression
{

/// Material points of one state. Each is known by its id: its place in the order in which mpm::pointsFromLattice()
/// makes them, node by node in memory, within a node's cell x fastest.
struct PointState
{
  std::span<const std::uint32_t> id; ///< each of 0 … n − 1 once
  std::span<const double> position;  ///< n × 3: x, y, z [m]
  std::span<const double> gradient;  ///< n × 9 or, in 2D, n × 4: F by rows
};

/// Corners of pixels (voxels), counted from the lattice's low corner: corner (i, j, k) is the low one of node (i, j,
/// k).
struct CornerLattice
{
  explicit CornerLattice(const Lattice& lattice) noexcept;

  std::array<std::int64_t, 3> size{ 1, 1, 1 };

  [[nodiscard]] std::int64_t count() const noexcept { return size[0] * size[1] * size[2]; }
  [[nodiscard]] std::int64_t index(const std::array<std::int64_t, 3>& corner) const noexcept
  {
    return corner[0] + size[0] * (corner[1] + size[1] * corner[2]);
  }
  [[nodiscard]] std::array<std::int64_t, 3> corner(std::int64_t index) const noexcept
  {
    return { index % size[0], index / size[0] % size[1], index / size[0] / size[1] };
  }
};

/// How some corners of a lattice of phases move with the material points of the wall's nodes around them: a corner X
/// goes to x_p + F_p (X − X_p) of the point nearest to it in each node of the wall that shares it, and to the mean of
/// these. Corners that no wall touches lie on the sample's rim; they go to the straight line (plane) that fits best, by
/// least squares, the other corners on their side.
class CornerMotion
{
public:
  CornerMotion() = default;
  /// @param phase lattice.count() phases; all but `empty` have points
  /// @param corners indices in the lattice of corners
  CornerMotion(
    const Lattice& lattice, std::span<const std::uint8_t> phase, std::uint8_t empty, std::vector<std::int64_t> corners);

  [[nodiscard]] std::size_t count() const noexcept { return corners_.size(); }
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Where a corner is at the start [m].
  [[nodiscard]] std::array<double, 3> start(std::size_t corner) const noexcept;

  /// Where corners are [m], 3 numbers each, the third 0 in 2D; NaN on a side of the sample that no wall touches.
  /// Time: a pass over the ids, and a few operations a corner.
  /// @param places 3 count()
  /// @throws InputError: columns of unequal length; not k^dimension points a node of the wall; an id that is missing; a
  /// point that is not finite
  void places(const PointState& state, std::span<double> places) const;

private:
  void closeRim(std::span<double> places) const;

  Lattice lattice_;
  std::size_t solid_ = 0;             ///< nodes of the wall
  std::vector<std::int64_t> corners_; ///< indices in the lattice of corners
  std::vector<std::uint32_t> first_;  ///< of each corner in the two below, and the end
  std::vector<std::uint32_t> node_;   ///< which of the wall's nodes
  std::vector<std::uint8_t> end_;     ///< bit axis: the corner is at the node's high end along it
  std::vector<std::uint32_t> rim_;    ///< corners on sides of the lattice
};

} // namespace lamella::compression
