#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/NodeField.h"
#include "peridynamics/multigrid/LevelKernels.h"
#include "peridynamics/multigrid/LevelRim.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace lamella::peridynamics
{

/// One lattice of the multigrid hierarchy: its matrix (the finest has that of its bonds) and work vectors.
struct Level
{
  NodeLayout layout;
  std::array<bool, 3> periodic{};
  const Communicator* comm = nullptr;
  LevelRim rim;

  // the matrix of a coarse level: blocks to half of the neighbours, A(i, i + q), and of the node itself
  std::vector<std::array<int, 3>> half;
  NodeField<float> blocks;   ///< component q · entries + e; until arrange()
  NodeField<float> diagonal; ///< entries of A(i, i)
  NodeField<float> inverse;  ///< of their pseudo-inverses
  float lambda = 2;          ///< largest eigenvalue of D⁻¹A, a little over

  NodeField<float> x; ///< correction
  NodeField<float> r; ///< residual
  NodeField<float> d; ///< direction; its rim is kept up to date

  bool gathered = false; ///< the next level is the same lattice, whole on every rank

  void allocateVectors();
  /// Moves the blocks together row by row: products then read one stream of memory instead of dozens.
  void arrange();
  /// Block component q · entries + e at a position.
  [[nodiscard]] float& block(int component, std::int64_t index) noexcept
  {
    return values_.size() > 0 ? values_[place(component, index)] : blocks.component(component)[index];
  }
  [[nodiscard]] float block(int component, std::int64_t index) const noexcept
  {
    return values_.size() > 0 ? values_[place(component, index)] : blocks.component(component)[index];
  }
  /// Fills in all but the fields: for a row that begins at a position.
  void pointTo(BlockRow& row, std::int64_t index) const noexcept;
  [[nodiscard]] int entries() const noexcept { return blockEntries(layout.dimension); }
  [[nodiscard]] std::int64_t bytes() const noexcept;

private:
  [[nodiscard]] std::int64_t place(int component, std::int64_t index) const noexcept
  {
    const std::int64_t components = static_cast<std::int64_t>(half.size()) * entries();
    return (index / layout.pitch * components + component) * layout.pitch + index % layout.pitch;
  }
  AlignedArray<float> values_;          ///< the blocks: by rows, components, nodes
  std::vector<std::int64_t> jumps_;     ///< of the half stencil in nodes
  std::vector<std::int64_t> backJumps_; ///< the same in floats of the blocks
};

/// Neighbours of a node within `reach` steps along every axis whose last nonzero step is positive.
[[nodiscard]] std::vector<std::array<int, 3>> forwardNeighbours(int dimension, int reach);

/// Place of a forward step in that list.
[[nodiscard]] constexpr int forwardIndex(int reach, const std::array<int, 3>& step) noexcept
{
  const int width = 2 * reach + 1;
  if (step[2] == 0 && step[1] == 0)
    return step[0] - 1;
  if (step[2] == 0)
    return reach + (step[1] - 1) * width + step[0] + reach;
  return reach + reach * width + ((step[2] - 1) * width + step[1] + reach) * width + step[0] + reach;
}

/// Fewer nodes are done sooner than a second thread wakes up.
inline constexpr std::int64_t worthThreads = 16384;

/// Calls f(y, z) for all own rows, rows over the threads.
template <class F>
void forOwnRows(const NodeLayout& layout, F&& f)
{
  const std::int64_t ny = layout.size[1];
  const std::int64_t rows = ny * layout.size[2];
#pragma omp parallel for schedule(static) if (layout.owned() >= worthThreads)
  for (std::int64_t i = 0; i < rows; ++i)
    f(i % ny, i / ny);
}

/// out −= A x on own nodes; the rim of x must be up to date.
void subtractProduct(const Level& level, const NodeField<float>& x, NodeField<float>& out);

/// Pseudo-inverses of symmetric d × d blocks: a direction in which a block has less than a millionth of its trace gets
/// none.
/// @return how many of the own nodes have such a direction, but no zero block
std::int64_t invertBlocks(const NodeField<float>& blocks, NodeField<float>& inverse);

/// The same for one node, where directions of less than `least` get none either.
void invertBlock(const NodeField<float>& blocks, NodeField<float>& inverse, std::int64_t index, double least);
/// The same of a block by its entries.
void invertBlock(const std::array<double, 6>& block, NodeField<float>& inverse, std::int64_t index);

} // namespace lamella::peridynamics
