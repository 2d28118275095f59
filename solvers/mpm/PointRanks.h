#pragma once

#include "core/Communicator.h"
#include "mpm/BackgroundGrid.h"
#include "mpm/MaterialPoints.h"
#include "mpm/SharedRows.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lamella::mpm
{

/// How ranks share material points: the grid is cut across one axis into slabs of whole rows of cells, a slab a rank,
/// of about as many points each. A row holds the points that are nearest to one row of nodes. On one rank nothing is
/// done.
template <int Dim>
class PointRanks
{
public:
  static constexpr int leastRows = SharedRows<Dim>::most; ///< of a slab: with fewer three ranks would share a node

  explicit PointRanks(const Communicator& comm)
    : comm_(comm)
  {
  }
  PointRanks(const PointRanks&) = delete;
  PointRanks& operator=(const PointRanks&) = delete;

  [[nodiscard]] const Communicator& comm() const noexcept { return comm_; }
  /// Chooses the axis to cut: that with the most rows now.
  /// @throws ParameterError: fewer than `leastRows` a rank
  void chooseAxis(const BackgroundGrid<Dim>& grid);
  /// Moves points to the ranks in whose slabs they are, and the cuts first: when the number of rows is another, or when
  /// the busiest rank had 5 % more points than it would have otherwise. Collective.
  /// @throws DivergenceError: fewer than `leastRows` a rank
  void distribute(MaterialPoints<Dim>& points, const BackgroundGrid<Dim>& grid);
  /// This rank's part of a grid of as many cells as the points were last distributed over: its slab, and beyond cuts as
  /// far as points reach that are a cell away from it.
  [[nodiscard]] BackgroundGrid<Dim> local(const BackgroundGrid<Dim>& grid) const;
  /// None on one rank.
  [[nodiscard]] SharedRows<Dim>* rows() noexcept { return rows_ ? &*rows_ : nullptr; }

  /// Each point on the rank to which its number belongs, in no order. Collective.
  /// @param firsts first number of each rank, and one behind all numbers; rising
  [[nodiscard]] MaterialPoints<Dim> byNumber(
    const MaterialPoints<Dim>& points, std::span<const std::int64_t> firsts) const;
  /// The points of all ranks in the order of their numbers, on rank 0; none on the others. Collective.
  [[nodiscard]] MaterialPoints<Dim> gather(const MaterialPoints<Dim>& points) const;
  /// @throws InputError on all ranks: two points of one number. Collective.
  void checkNumbers(const MaterialPoints<Dim>& points) const;

private:
  [[nodiscard]] std::vector<int> rowsOf(const MaterialPoints<Dim>& points, const GridAxis& g) const;
  [[nodiscard]] std::vector<int> balanced(const std::vector<double>& counts) const;
  void migrate(MaterialPoints<Dim>& points, const std::vector<int>& rows) const;
  /// @param to the points that go to each rank, all of this one's, those that stay too
  [[nodiscard]] MaterialPoints<Dim> send(
    const MaterialPoints<Dim>& points, const std::vector<std::vector<std::size_t>>& to) const;

  Communicator comm_;
  int axis_ = 0;
  std::vector<int> firsts_; ///< row of each rank, and the number of rows
  std::optional<SharedRows<Dim>> rows_;
};

extern template class PointRanks<2>;
extern template class PointRanks<3>;

} // namespace lamella::mpm
