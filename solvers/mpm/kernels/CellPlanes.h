#pragma once

// Planes of nodes across x, of which a cell has three and shares two with the next along its row: each is taken from
// the grid and made polynomials across the row once, and gathers what the cells along the row give before it is added
// to the grid once. Only for sources compiled for several instruction sets: everything here is local to one object
// file.

#include "mpm/kernels/CellPolynomials.h"
#include "mpm/kernels/PointKernels.h"

namespace lamella::mpm
{
namespace
{

/// Where the nodes of planes lie among four values a node.
template <int Dim>
class PlaneNodes
{
public:
  explicit PlaneNodes(const PointSweep& sweep)
  {
    for (int a = 0; a < Dim; ++a)
      stride_[a] = 4 * sweep.axis[a].stride;
  }
  /// First node of plane i of a cell.
  [[nodiscard]] std::int64_t first(const PointCell& cell, int i) const
  {
    std::int64_t at = i * stride_[0];
    for (int a = 0; a < Dim; ++a)
      at += (cell.base[a] + 1) * stride_[a];
    return at;
  }
  /// From there to the node on a line.
  [[nodiscard]] std::int64_t line(int n) const
  {
    return n % 3 * stride_[1] + (Dim == 3 ? n / 3 * stride_[Dim - 1] : 0);
  }

private:
  std::int64_t stride_[Dim];
};

/// Whether a cell is the next along the row.
template <int Dim>
inline bool follows(const PointCell& next, const PointCell* before)
{
  bool same = before != nullptr && next.base[0] == before->base[0] + 1;
  for (int a = 1; a < Dim && same; ++a)
    same = next.base[a] == before->base[a];
  return same;
}

/// Planes of velocities.
/// @tparam Cells whose planes are held together, besides two of the cell before
template <int Dim, int Cells>
class TakenPlanes
{
public:
  static constexpr int lines = cellLines<Dim>;

  explicit TakenPlanes(const PointSweep& sweep)
    : velocity_(sweep.velocity)
    , nodes_(sweep)
  {
  }
  /// Coefficients across the row, and nodes along it, of a cell's planes. They stay until Cells − 1 more were taken.
  void take(const PointCell& cell, const Node** planes)
  {
    const bool next = follows<Dim>(cell, last_);
    for (int i = 0; i < 3; ++i)
      planes[i] = planes_[i] = next && i < 2 ? planes_[i + 1] : plane(nodes_.first(cell, i));
    last_ = &cell;
  }

private:
  static constexpr int slots = 3 * Cells + 2;

  const Node* plane(std::int64_t at)
  {
    Node values[lines];
#pragma GCC unroll 9
    for (int n = 0; n < lines; ++n)
      values[n] = Node::load(velocity_ + at + nodes_.line(n));
    acrossRow<Dim>(values, [](Node& a, Node& b, Node& c) { toPowers(a, b, c); });
    slot_ = slot_ + 1 < slots ? slot_ + 1 : 0;
#pragma GCC unroll 9
    for (int n = 0; n < lines; ++n)
      held_[slot_][n] = values[n];
    return held_[slot_];
  }

  const double* velocity_;
  PlaneNodes<Dim> nodes_;
  const PointCell* last_ = nullptr;
  const Node* planes_[3] = {}; ///< of the last cell
  Node held_[slots][lines];    ///< in turns
  int slot_ = 0;
};

/// Planes of masses and momenta.
template <int Dim>
class GivenPlanes
{
public:
  static constexpr int lines = cellLines<Dim>;

  explicit GivenPlanes(const PointSweep& sweep)
    : momentum_(sweep.momentum)
    , nodes_(sweep)
  {
  }
  /// @return the cell's three planes of moments across the row, to be added to
  Node* const* of(const PointCell& cell)
  {
    if (follows<Dim>(cell, last_))
    {
      give(0);
      Node* const given = planes_[0];
      planes_[0] = planes_[1];
      planes_[1] = planes_[2];
      planes_[2] = given;
    }
    else
      finish();
    last_ = &cell;
    return planes_;
  }
  /// Gives the grid what it has not got yet.
  void finish()
  {
    for (int i = 0; i < 3 && last_ != nullptr; ++i)
      give(i);
    last_ = nullptr;
  }

private:
  void give(int i)
  {
    Node values[lines];
#pragma GCC unroll 9
    for (int n = 0; n < lines; ++n)
    {
      values[n] = planes_[i][n];
      planes_[i][n] = Node(0.0);
    }
    acrossRow<Dim>(values, [](Node& a, Node& b, Node& c) { fromPowers(a, b, c); });
    double* const first = momentum_ + nodes_.first(*last_, i);
#pragma GCC unroll 9
    for (int n = 0; n < lines; ++n)
    {
      double* const node = first + nodes_.line(n);
      (Node::load(node) + values[n]).store(node);
    }
  }

  double* momentum_;
  PlaneNodes<Dim> nodes_;
  const PointCell* last_ = nullptr;
  Node held_[3][lines] = {};
  Node* planes_[3] = { held_[0], held_[1], held_[2] }; ///< of the last cell
};

} // namespace
} // namespace lamella::mpm
