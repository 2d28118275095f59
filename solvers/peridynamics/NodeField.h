#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>

namespace lamella::peridynamics
{

/// Where the nodes of this rank's part of a lattice lie in memory: x fastest, then y, then z, with a rim of `ghost`
/// nodes on every side of every dimension. Rows are padded so that x = 0 lies on a cache line. Where sides across x are
/// periodic a row begins `margin` nodes before that; else nothing lies before it, all that there is at x < 0 is zero,
/// and the padding of the row before is that, too.
struct NodeLayout
{
  static constexpr std::int64_t margin = 16; ///< nodes before x = 0

  int dimension = 2;
  int ghost = 0;                                 ///< at most 8
  std::array<std::int64_t, 3> size{ 1, 1, 1 };   ///< owned nodes along x, y, z; size[2] is 1 in 2D
  std::array<std::int64_t, 3> start{ 0, 0, 0 };  ///< of the owned nodes, in the whole lattice
  std::array<std::int64_t, 3> global{ 1, 1, 1 }; ///< nodes of the whole lattice
  std::int64_t before = margin;                  ///< nodes of a row before x = 0: `margin` or none
  std::int64_t pitch = 0;                        ///< from a row to the next, in nodes; a multiple of 16

  [[nodiscard]] int ghostZ() const noexcept { return dimension == 3 ? ghost : 0; }
  /// Rows along y in memory.
  [[nodiscard]] std::int64_t rowsY() const noexcept { return size[1] + 2 * ghost; }
  /// All rows in memory.
  [[nodiscard]] std::int64_t rows() const noexcept { return rowsY() * (size[2] + 2 * ghostZ()); }
  /// Nodes in memory, rim and padding included: the length of every array.
  [[nodiscard]] std::int64_t count() const noexcept { return rows() * pitch + margin - before; }
  [[nodiscard]] std::int64_t owned() const noexcept { return size[0] * size[1] * size[2]; }
  /// Number of a row, -ghost ≤ y < size[1] + ghost, and z likewise.
  [[nodiscard]] std::int64_t row(std::int64_t y, std::int64_t z = 0) const noexcept
  {
    return (z + ghostZ()) * rowsY() + y + ghost;
  }
  /// Position where a row begins; `pitch` nodes from there on are its own.
  [[nodiscard]] std::int64_t begin(std::int64_t row) const noexcept { return row * pitch + margin - before; }
  /// Row of a position.
  [[nodiscard]] std::int64_t rowOf(std::int64_t index) const noexcept { return (index - margin + before) / pitch; }
  /// x of a position, from the first owned node.
  [[nodiscard]] std::int64_t xOf(std::int64_t index) const noexcept
  {
    return (index - margin + before) % pitch - before;
  }
  /// Length of a buffer of a row with x = 0 at `margin`, whatever the sides.
  [[nodiscard]] std::int64_t bufferLength() const noexcept { return (margin + size[0] + ghost + 15) / 16 * 16; }
  /// Position of a node in the arrays; x, y, z count from the first owned node.
  [[nodiscard]] std::int64_t index(std::int64_t x, std::int64_t y, std::int64_t z = 0) const noexcept
  {
    return row(y, z) * pitch + margin + x;
  }
  /// x, y, z of a position.
  [[nodiscard]] std::array<std::int64_t, 3> node(std::int64_t index) const noexcept
  {
    const std::int64_t row = rowOf(index);
    return { xOf(index), row % rowsY() - ghost, row / rowsY() - ghostZ() };
  }
  [[nodiscard]] bool ownedNode(const std::array<std::int64_t, 3>& node) const noexcept
  {
    return node[0] >= 0 && node[0] < size[0] && node[1] >= 0 && node[1] < size[1] && node[2] >= 0 && node[2] < size[2];
  }

  /// Where a node of the whole lattice lies in memory, if it is this rank's.
  [[nodiscard]] std::optional<std::int64_t> ownedIndex(std::array<std::int64_t, 3> node) const noexcept
  {
    for (std::size_t a = 0; a < 3; ++a)
      node[a] -= start[a];
    return ownedNode(node) ? std::optional(index(node[0], node[1], node[2])) : std::nullopt;
  }

  /// @param size, start, global see above
  /// @param periodicX are the sides across x periodic?
  [[nodiscard]] static NodeLayout make(int dimension, int ghost, const std::array<std::int64_t, 3>& size,
    const std::array<std::int64_t, 3>& start, const std::array<std::int64_t, 3>& global, bool periodicX)
  {
    const std::int64_t before = periodicX ? margin : 0;
    const std::int64_t vectors = periodicX ? size[0] : (size[0] + 7) / 8 * 8; // what reaches past their ends is zero
    const std::int64_t after = periodicX ? ghost : std::max(2, ghost);        // what is restricted reads two
    return { dimension, ghost, size, start, global, before, (before + vectors + after + 15) / 16 * 16 };
  }
  /// Of the largest part where a lattice is cut along its last axis into as many parts as there are ranks.
  [[nodiscard]] static NodeLayout largestPart(
    int dimension, int ghost, const std::array<std::int64_t, 3>& global, int ranks, bool periodicX)
  {
    std::array<std::int64_t, 3> size = global;
    std::int64_t& slowest = size[dimension == 3 ? 2 : 1];
    slowest = (slowest + ranks - 1) / ranks;
    return make(dimension, ghost, size, {}, global, periodicX);
  }
  bool operator==(const NodeLayout&) const = default;
};

/// Zeroed memory that begins on a cache line, with a zeroed cache line on either side: loops that read a vector of a
/// row's neighbours may read a few values past the first and the last row.
template <class T>
class AlignedArray
{
public:
  AlignedArray() = default;
  explicit AlignedArray(std::int64_t count)
    : count_(count)
    , data_(static_cast<T*>(
        ::operator new[](static_cast<std::size_t>(count + 2 * line) * sizeof(T), std::align_val_t{ 64 })))
  {
    std::fill_n(data_.get(), count_ + 2 * line, T{});
  }
  AlignedArray(const AlignedArray& other)
    : AlignedArray(other.count_)
  {
    std::copy_n(other.data(), count_, data());
  }
  AlignedArray(AlignedArray&&) noexcept = default;
  AlignedArray& operator=(AlignedArray other) noexcept
  {
    std::swap(count_, other.count_);
    std::swap(data_, other.data_);
    return *this;
  }
  ~AlignedArray() = default;

  [[nodiscard]] T* data() noexcept { return data_ ? data_.get() + line : nullptr; }
  [[nodiscard]] const T* data() const noexcept { return data_ ? data_.get() + line : nullptr; }
  [[nodiscard]] std::int64_t size() const noexcept { return count_; }
  [[nodiscard]] T& operator[](std::int64_t i) noexcept { return data_[static_cast<std::size_t>(line + i)]; }
  [[nodiscard]] const T& operator[](std::int64_t i) const noexcept { return data_[static_cast<std::size_t>(line + i)]; }

private:
  static constexpr std::int64_t line = 64 / sizeof(T);
  struct Free
  {
    void operator()(T* p) const noexcept { ::operator delete[](p, std::align_val_t{ 64 }); }
  };
  std::int64_t count_ = 0;
  std::unique_ptr<T[], Free> data_;
};

/// Which nodes cannot move, by bits: bit c for component c. As long as the layout, rim included.
using FixedComponents = AlignedArray<std::uint8_t>;

/// A vector at every node, one array a component (2 in 2D, 3 in 3D; any number where a function says so), zero at
/// first. Rim and padding must hold finite numbers: they are read, and multiplied by the stiffness zero of bonds that
/// are not.
template <class Real>
class NodeField
{
public:
  NodeField() = default;
  explicit NodeField(const NodeLayout& layout, int components = 0)
    : layout_(layout)
    , components_(components > 0 ? components : layout.dimension)
    , values_(layout.count() * components_)
  {
  }

  [[nodiscard]] const NodeLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] int components() const noexcept { return components_; }
  /// layout().count() values.
  [[nodiscard]] Real* component(int c) noexcept { return values_.data() + c * layout_.count(); }
  [[nodiscard]] const Real* component(int c) const noexcept { return values_.data() + c * layout_.count(); }
  [[nodiscard]] Real& at(int c, std::int64_t x, std::int64_t y, std::int64_t z = 0) noexcept
  {
    return component(c)[layout_.index(x, y, z)];
  }
  [[nodiscard]] Real at(int c, std::int64_t x, std::int64_t y, std::int64_t z = 0) const noexcept
  {
    return component(c)[layout_.index(x, y, z)];
  }
  void fill(Real value) { std::fill_n(values_.data(), values_.size(), value); }

private:
  NodeLayout layout_;
  int components_ = 0;
  AlignedArray<Real> values_;
};

} // namespace lamella::peridynamics
