#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/fracture/EventKernels.h"
#include "peridynamics/multigrid/Level.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

/// Nodes low ≤ n < high.
struct Box
{
  std::array<std::int64_t, 3> low{ 0, 0, 0 };
  std::array<std::int64_t, 3> high{ 0, 0, 0 };

  [[nodiscard]] std::int64_t count() const noexcept
  {
    return (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
  }
};

/// Grown by some nodes on every side, and cut where the lattice ends; along x where its last vector does.
[[nodiscard]] Box expanded(const Box& box, int by, const NodeLayout& layout);
/// Along x from an even node, for it is interpolated from pairs, over whole vectors; x may then reach into the padding,
/// where all is zero.
[[nodiscard]] Box inVectors(const Box& box, const NodeLayout& layout);
/// Both.
[[nodiscard]] Box grown(const Box& box, int by, const NodeLayout& layout);

/// The coarse nodes from which a box of the finer level is interpolated.
[[nodiscard]] Box parentsOf(const Box& fine, const NodeLayout& coarse);
/// The same, in vectors.
[[nodiscard]] Box parents(const Box& fine, const NodeLayout& coarse);
/// All nodes.
[[nodiscard]] Box whole(const NodeLayout& layout);
[[nodiscard]] Box united(const Box& a, const Box& b);

/// Calls f(y, z) for the rows of a box.
template <class F>
void forRows(const Box& box, F&& f)
{
  for (std::int64_t z = box.low[2]; z < box.high[2]; ++z)
    for (std::int64_t y = box.low[1]; y < box.high[1]; ++y)
      f(y, z);
}

/// The same, rows over the threads where the box is large.
template <class F>
void forManyRows(const Box& box, F&& f)
{
  const std::int64_t ny = box.high[1] - box.low[1];
  const std::int64_t rows = ny * (box.high[2] - box.low[2]);
#pragma omp parallel for schedule(static) if (box.count() >= worthThreads)
  for (std::int64_t i = 0; i < rows; ++i)
    f(box.low[1] + i % ny, box.low[2] + i / ny);
}

/// A field of a level, or of a part of it, by the level's nodes.
struct WindowField
{
  NodeField<float>& field;
  std::array<std::int64_t, 3> first{ 0, 0, 0 }; ///< node of the level that is the field's first

  [[nodiscard]] float* row(int c, std::int64_t x, std::int64_t y, std::int64_t z) const noexcept
  {
    return field.component(c) + field.layout().index(x - first[0], y - first[1], z - first[2]);
  }
};

/// The springs of the bonds in a box of the finest level, written out: the bits are looked at once, the product is
/// taken several times.
class SpringWindow
{
public:
  explicit SpringWindow(const BondLattice& bonds);

  /// @param box nodes whose products will be asked for
  void read(const BondLattice& bonds, const Box& box);
  /// out = plus − A u on the rows of layer z in a part of the box. Returns u·out.
  /// @param rows all but the jumps
  /// @param layout of u
  double product(WindowRows rows, const NodeLayout& layout, const Box& part, std::int64_t z) const;
  [[nodiscard]] std::int64_t bytes() const noexcept
  {
    return static_cast<std::int64_t>(values_.capacity() * sizeof(float));
  }

private:
  [[nodiscard]] std::int64_t rowOf(std::int64_t y, std::int64_t z) const noexcept
  {
    return ((z - rows_.low[2]) * (rows_.high[1] - rows_.low[1]) + y - rows_.low[1]) * count_ * width_;
  }

  int dimension_;
  int reach_;
  std::int64_t count_; ///< bonds of the half stencil
  std::vector<std::array<int, 3>> steps_;
  std::array<std::vector<float>, 3> directions_;
  std::vector<std::vector<float>> tables_; ///< k/|ξ| by kind, of each bond of the stencil
  Box rows_;                               ///< what is written out
  std::int64_t width_ = 0;
  std::vector<float> values_; ///< row by row, bond by bond
};

} // namespace lamella::peridynamics
