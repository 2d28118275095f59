#pragma once

#include "mpm/Tensor.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace lamella::mpm
{

/// What stands at an end of an axis.
enum class Edge : std::uint8_t
{
  Open,     ///< nothing: the body ends before the grid does
  Wall,     ///< a flat wall, on node 0 or on the last node
  Periodic, ///< the other end; both ends of an axis or none
};

/// An axis of the grid. Between two walls, or over a period, there is a whole number of cells, whose length follows the
/// walls; the grid keeps nothing from one step to the next, so a change of `cells` only moves points to other cells.
struct GridAxis
{
  double lower = 0;                                   ///< position of node 0 [m]
  double spacing = 1;                                 ///< [m]
  int cells = 1;                                      ///< from node 0 to the last
  std::array<Edge, 2> edge{ Edge::Open, Edge::Open }; ///< lower, upper
  /// Another rank's rows follow. The nodes beyond are then a copy of its, not an end; an edge that is periodic says
  /// that the period's other end is there, else it is open.
  std::array<bool, 2> cut{};

  [[nodiscard]] bool isCut(int side) const noexcept { return cut[static_cast<std::size_t>(side)]; }
  [[nodiscard]] Edge end(int side) const noexcept { return edge[static_cast<std::size_t>(side)]; }
  [[nodiscard]] double length() const noexcept { return spacing * cells; }
  [[nodiscard]] double upper() const noexcept { return lower + length(); }
  /// In spacings from node 0.
  [[nodiscard]] double coordinate(double x) const noexcept { return (x - lower) / spacing; }
};

/// Nodes −1 … cells + 1 along every axis, x fastest: a layer beyond the last nodes takes what splines spread over the
/// walls.
template <int Dim>
class BackgroundGrid
{
public:
  BackgroundGrid() = default;
  explicit BackgroundGrid(const std::array<GridAxis, Dim>& axes) { set(axes); }

  void set(const std::array<GridAxis, Dim>& axes)
  {
    axes_ = axes;
    std::int64_t stride = 1;
    for (int a = 0; a < Dim; ++a)
    {
      strides_[a] = stride;
      stride *= nodes(a);
    }
    count_ = stride;
  }

  [[nodiscard]] const GridAxis& axis(int a) const noexcept { return axes_[a]; }
  [[nodiscard]] const std::array<GridAxis, Dim>& axes() const noexcept { return axes_; }
  /// Nodes in memory along an axis.
  [[nodiscard]] int nodes(int a) const noexcept { return axes_[a].cells + 3; }
  [[nodiscard]] std::int64_t stride(int a) const noexcept { return strides_[a]; }
  [[nodiscard]] std::int64_t count() const noexcept { return count_; }
  /// Position in memory of a node, −1 ≤ node[a] ≤ cells + 1.
  [[nodiscard]] std::int64_t index(const std::array<int, Dim>& node) const noexcept
  {
    std::int64_t at = 0;
    for (int a = 0; a < Dim; ++a)
      at += (node[a] + 1) * strides_[a];
    return at;
  }
  [[nodiscard]] double smallestSpacing() const noexcept
  {
    double h = axes_[0].spacing;
    for (int a = 1; a < Dim; ++a)
      h = axes_[a].spacing < h ? axes_[a].spacing : h;
    return h;
  }

private:
  std::array<GridAxis, Dim> axes_{};
  std::array<std::int64_t, Dim> strides_{};
  std::int64_t count_ = 0;
};

} // namespace lamella::mpm
