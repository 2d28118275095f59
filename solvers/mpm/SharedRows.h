#pragma once

#include "core/Communicator.h"
#include "mpm/BackgroundGrid.h"
#include "mpm/GridWalls.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lamella::mpm
{

/// The rows of nodes along the cut axis that this rank has in common with its neighbours: points of both give to them.
/// Four rows at a cut, since a point may be a cell away from the rows of its rank and splines reach a node further.
/// Three where the ends of a period meet, which no point passes by more than a quarter of a cell.
template <int Dim>
class SharedRows
{
public:
  static constexpr int most = 4;

  /// @param comm several ranks; must outlive this
  SharedRows(const Communicator& comm, int axis)
    : comm_(&comm)
    , axis_(axis)
  {
  }
  [[nodiscard]] int axis() const noexcept { return axis_; }

  /// Adds what the neighbours' points have given. The same to the last bit on both sides, as there are only two.
  /// Nothing is done meanwhile: beside a pass over the points the exchange is short. Collective.
  /// @param grid of this rank  @param nodes mass and momentum, folded along the other axes  @param body whose they are
  /// @return what a period that goes around the ranks adds to its far end, in all on rank 0
  WallSums add(const BackgroundGrid<Dim>& grid, std::span<double> nodes, std::size_t body = 0);
  /// Then, momentum at the ends of such a period once it is known how fast it grows [m/s].
  void shift(const BackgroundGrid<Dim>& grid, std::span<double> nodes, double velocity, std::size_t body = 0) const;
  /// Values by side of the grid.
  using Sides = std::array<std::vector<double>, 2>;
  /// Gives `out` to the neighbour of each side, whose as many values are then `in`. A side without any is left alone,
  /// as it is by its neighbour. Collective but for that.
  void swap(const Sides& out, Sides& in) const;
  /// The first and the last of the shared rows at an end that is cut, by their node along the axis. The outer one, −1
  /// or cells + 1, is the last that this rank has, and the inner one the last that its neighbour has.
  [[nodiscard]] std::array<int, 2> span(const BackgroundGrid<Dim>& grid, int side) const
  {
    const GridAxis& g = grid.axis(axis_);
    const int rows = count(g, side);
    return side == 0 ? std::array<int, 2>{ -1, rows - 2 } : std::array<int, 2>{ g.cells + 2 - rows, g.cells + 1 };
  }
  /// Of all ranks. Collective.
  void sum(std::array<std::array<WallSums, 2>, Dim>& sums) const;

private:
  [[nodiscard]] static bool seam(const GridAxis& g, int side) noexcept
  {
    return g.isCut(side) && g.end(side) == Edge::Periodic;
  }
  [[nodiscard]] static int count(const GridAxis& g, int side) noexcept { return seam(g, side) ? most - 1 : most; }
  /// Calls f(values of a node, values of it in a buffer) for the shared rows of an end, in every such line.
  template <class Node, class F>
  void forEachShared(
    const BackgroundGrid<Dim>& grid, std::span<double> nodes, int side, Lines lines, Node* buffer, F&& f) const;

  const Communicator* comm_;
  int axis_;
  Sides out_;
  std::vector<Sides> in_; ///< by body
};

extern template class SharedRows<2>;
extern template class SharedRows<3>;

} // namespace lamella::mpm
