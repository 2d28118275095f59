#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/NodeField.h"
#include "peridynamics/multigrid/Agglomeration.h"
#include "peridynamics/multigrid/LayerShare.h"
#include "peridynamics/multigrid/LevelKernels.h"
#include "peridynamics/multigrid/LevelRim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <vector>

namespace lamella::peridynamics
{

/// What bonds that broke have taken off a packed matrix since it was made: k c cᵀ ⊗ e eᵀ each, with the weights c of a
/// level's nodes. The diagonal blocks are without it already.
struct BrokenSpring
{
  struct Node
  {
    std::int64_t index = 0; ///< position
    float weight = 0;       ///< c
  };
  float stiffness = 0; ///< k/|ξ|
  std::array<float, 3> direction{};
  std::array<std::int64_t, 3> low{};  ///< nodes lie in low ≤ n < high
  std::array<std::int64_t, 3> high{}; ///<
  std::vector<Node> nodes;
};

/// One lattice of the multigrid hierarchy: its matrix (the finest has that of its bonds) and work vectors.
struct Level
{
  NodeLayout layout;
  std::array<bool, 3> periodic{};
  const Communicator* comm = nullptr;
  LevelRim rim;
  std::size_t halvings = 0; ///< of the finest lattice

  // the matrix of a coarse level: blocks to half of the neighbours, A(i, i + q), and of the node itself; a packed one
  // is without those that no bond can reach
  std::vector<std::array<int, 3>> half;
  NodeField<float> blocks;   ///< component q · entries + e; until arrange(), and only where the rim is not empty
  NodeField<float> diagonal; ///< entries of A(i, i)
  NodeField<float> inverse;  ///< of their pseudo-inverses
  float lambda = 2;          ///< largest eigenvalue of D⁻¹A, a little over

  NodeField<float> x; ///< correction
  NodeField<float> r; ///< residual
  NodeField<float> d; ///< direction; its rim is kept up to date

  bool gathered = false; ///< the next level is the same lattice, on fewer ranks or whole on every one
  std::unique_ptr<Agglomeration> agglomeration; ///< where it is on fewer

  LayerShare share;    ///< of a lattice that every rank has whole: how they share out the layers
  bool shared = false; ///< each does its own; otherwise every one does all

  // of a packed matrix
  NodeField<float> scale;           ///< one component; zero where nothing holds
  std::vector<BrokenSpring> broken; ///< since it was made, or they were last packed with it

  void allocateVectors();
  /// Makes room for the matrix, zero. One that has no rim is put in order from the start.
  /// @param packed in 16 bits an entry; only where it has no rim
  void allocateMatrix(bool packed = false);
  /// Are the blocks between nodes stored in 16 bits: A(i, j) as whole numbers times scale(i) scale(j)? They are then
  /// true to 1/65534 of √(Dᵢ Dⱼ), D about the nodes' own stiffness, so that a soft phase keeps its digits beside a
  /// stiff one; diagonal blocks are single precision and make up for it, so that a translation still costs nothing.
  [[nodiscard]] bool packed() const noexcept { return numbers_.size() > 0; }
  /// Packs component q · entries + e of own row (y, z). @param values one a node
  void pack(int component, std::int64_t y, std::int64_t z, const float* values);
  /// out += what broken springs take off the product with x, at the nodes low ≤ n < high.
  void addBroken(const NodeField<float>& x, NodeField<float>& out, const std::array<std::int64_t, 3>& low,
    const std::array<std::int64_t, 3>& high) const;
  /// Packs them with the blocks, where there are many of them.
  void foldBroken();
  /// Moves the blocks together row by row: products then read one stream of memory instead of dozens.
  void arrange();
  /// Nobody else has nodes of this level and no side is periodic: the rim is empty, and so not stored of the blocks.
  [[nodiscard]] bool rimless() const noexcept;
  /// Nodes for which a level without a rim stores blocks: rows are read up to the reach beyond their ends, eight nodes
  /// at a time.
  [[nodiscard]] static std::int64_t rimlessNodes(const NodeLayout& l) noexcept
  {
    return rimlessPitch(l) * l.size[1] * l.size[2];
  }
  /// Block component q · entries + e at a position: an own node's, or one of the rim where there is one.
  [[nodiscard]] float& block(int component, std::int64_t index) noexcept
  {
    return values_.size() > 0 ? values_[place(component, index)] : blocks.component(component)[index];
  }
  [[nodiscard]] const float& block(int component, std::int64_t index) const noexcept
  {
    return values_.size() > 0 ? values_[place(component, index)] : blocks.component(component)[index];
  }
  /// The same whatever it is stored as.
  [[nodiscard]] float value(int component, std::int64_t index) const noexcept
  {
    return packed() ? unpack(component, index, static_cast<float>(numbers_[place(component, index)]))
                    : block(component, index);
  }
  /// Fills in all but the fields: for a row that begins at a position.
  void pointTo(BlockRow& row, std::int64_t index) const noexcept;
  /// That row's `mirrored`.
  [[nodiscard]] const std::uint8_t* mirrored(std::int64_t y, std::int64_t z) const noexcept;
  [[nodiscard]] int entries() const noexcept { return blockEntries(layout.dimension); }
  [[nodiscard]] std::int64_t bytes() const noexcept;

private:
  [[nodiscard]] static std::int64_t rimlessPitch(const NodeLayout& l) noexcept
  {
    return (l.size[0] + l.ghost + 7) / 8 * 8;
  }
  [[nodiscard]] std::int64_t components() const noexcept { return static_cast<std::int64_t>(half.size()) * entries(); }
  [[nodiscard]] std::int64_t place(int component, std::int64_t index) const noexcept
  {
    std::int64_t row = layout.rowOf(index);
    std::int64_t column = layout.xOf(index);
    if (tight_)
      row = (row / layout.rowsY() - layout.ghostZ()) * layout.size[1] + row % layout.rowsY() - layout.ghost;
    else
      column += layout.before;
    return (row * components() + component) * pitch_ + column;
  }
  void findJumps();
  [[nodiscard]] float unpack(int component, std::int64_t index, float number) const noexcept;

  AlignedArray<float> values_;          ///< the blocks: by rows, components, nodes
  AlignedArray<std::int16_t> numbers_;  ///< in place of these, where they are packed
  bool tight_ = false;                  ///< own nodes only
  std::int64_t pitch_ = 0;              ///< of these rows
  std::vector<std::int64_t> jumps_;     ///< of the half stencil in nodes
  std::vector<std::int64_t> backJumps_; ///< the same in floats of the blocks
  /// Is the row from which a neighbour leads here stored? By how many rows there are before and after along y and
  /// before along z, each up to the reach; by neighbour.
  std::vector<std::uint8_t> mirrored_;
};

/// Row and column of the entries of a symmetric block, in the plane and in space.
inline constexpr int entryRow[2][6] = { { 0, 1, 0 }, { 0, 1, 2, 0, 1, 0 } };
inline constexpr int entryColumn[2][6] = { { 0, 1, 1 }, { 0, 1, 2, 1, 2, 2 } };

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

/// The same for rows of the layers first ≤ layer < last along the slowest axis.
template <class F>
void forLayers(const NodeLayout& layout, std::int64_t first, std::int64_t last, F&& f)
{
  const std::int64_t ny = layout.size[1];
  const std::int64_t rows = layout.dimension == 3 ? ny : 1; // a layer
#pragma omp parallel for schedule(static) if ((last - first) * rows * layout.size[0] >= worthThreads)
  for (std::int64_t i = first * rows; i < last * rows; ++i)
    f(i % ny, i / ny);
}

/// The same for the rows that this rank does: of a shared level its layers.
template <class F>
void forOwnRows(const Level& level, F&& f)
{
  if (level.shared)
    forLayers(level.layout, level.share.first(), level.share.last(), f);
  else
    forOwnRows(level.layout, f);
}

/// A coarse row that is restricted from the fine rows beside it.
class RestrictedRow
{
public:
  /// @param fine at twice the coarse row's first node
  /// @param dy, dz steps to the fine row, along y and z
  /// @return its weight
  float add(const float* fine, std::int64_t dy, std::int64_t dz) noexcept
  {
    const auto i = static_cast<std::size_t>(count_++);
    fine_[i] = fine;
    return weights_[i] = (dy == 0 ? 1.0F : 0.5F) * (dz == 0 ? 1.0F : 0.5F);
  }
  /// Adds to n nodes of each field.
  void restrictTo(std::int64_t n, std::initializer_list<float*> fields) const
  {
    levelKernels().restrictRows(
      n, count_, weights_.data(), fine_.data(), static_cast<int>(fields.size()), fields.begin());
  }

private:
  static constexpr std::size_t most = 25; // where sides that fold are two rows away
  int count_ = 0;
  std::array<float, most> weights_;
  std::array<const float*, most> fine_;
};

/// out −= A x on own nodes; the rim of x must be up to date.
void subtractProduct(const Level& level, const NodeField<float>& x, NodeField<float>& out);

/// Of the trace: less is round-off, where blocks are summed in single precision; or where they are packed.
inline constexpr double singularShare = 1e-6;
inline constexpr double singularShareOfPacked = 1e-4;

/// Pseudo-inverses of symmetric d × d blocks: a direction in which a block has less than a share of its trace gets
/// none.
/// @param least that share
/// @return how many of the own nodes have such a direction, but no zero block
std::int64_t invertBlocks(const NodeField<float>& blocks, NodeField<float>& inverse, double least = singularShare);

/// The same for one node, where directions of less than `least` get none either.
void invertBlock(const NodeField<float>& blocks, NodeField<float>& inverse, std::int64_t index, double least);
/// The same of a block by its entries.
void invertBlock(const std::array<double, 6>& block, NodeField<float>& inverse, std::int64_t index);

} // namespace lamella::peridynamics
