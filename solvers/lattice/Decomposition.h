#pragma once

#include "core/Communicator.h"
#include "lattice/Lattice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace lamella
{

/// The part of a lattice that a rank holds: whole rows along x, a block of rows along y and z.
struct Block
{
  std::array<std::int64_t, 3> start{ 0, 0, 0 };
  std::array<std::int64_t, 3> size{ 0, 0, 0 };

  [[nodiscard]] std::int64_t count() const noexcept { return size[0] * size[1] * size[2]; }
};

/// Cartesian decomposition of a lattice over the ranks of a communicator: along z and y, never along x, which stays
/// contiguous for SIMD. Rank r holds part (r % parts[1], r / parts[1]) along (y, z).
///
/// Parts begin at multiples of `alignment` (a power of two) so that `levels()` coarsenings by two keep every coarse
/// node on the rank of its fine node.
class Decomposition
{
public:
  /// @param unevenness  how much more than its even share the largest part may hold so that parts can be halved
  /// @throws ParameterError when there are more ranks than rows to share out
  Decomposition(const Lattice& lattice, const Communicator& comm, double unevenness = 0.03);

  [[nodiscard]] const Block& block() const noexcept { return block_; }
  [[nodiscard]] Block block(int rank) const;
  [[nodiscard]] std::array<int, 3> parts() const noexcept { return parts_; }
  /// How often the lattice can be halved with every part beginning at an even row.
  [[nodiscard]] int levels() const noexcept { return levels_; }
  /// Rank that holds the part one step along `axis` (1: y, 2: z), or -1 beyond the box unless periodic.
  [[nodiscard]] int neighbour(int axis, int step, bool periodic) const;

private:
  Lattice lattice_;
  int rank_ = 0;
  std::array<int, 3> parts_{ 1, 1, 1 };
  std::int64_t alignment_ = 1;
  int levels_ = 0;
  Block block_;
};

/// @throws ParameterError when there are more ranks than rows to share out
[[nodiscard]] Block decompose(const Lattice& lattice, MPI_Comm comm);

/// Exchange of one layer of ghost rows of arrays whose rows lie at ((z + gz)(ny + 2) + y + 1), y = -1 … ny and
/// z = -1 … nz (gz = 1) in 3D, z = 0 only (gz = 0) in 2D. Corners come along. Beyond the box nothing is touched.
class Halo
{
public:
  Halo() = default;
  /// @param size rows of this rank along x, y, z (x is not used)
  Halo(int dimension, std::array<std::int64_t, 3> size, const Decomposition& parts, const Communicator& comm,
    std::array<bool, 3> periodic);

  /// Segment of one row: first byte from the array's begin, and length.
  struct Segment
  {
    std::byte* data;
    std::size_t bytes;
  };
  using RowSegment = std::function<Segment(std::int64_t row)>;

  /// Fills ghost rows with the neighbours' outer rows. Rows may differ in length (compact storage).
  void exchange(const RowSegment& segment) const;
  /// The same for rows of equal length.
  void exchange(void* base, std::size_t rowBytes) const;
  /// Adds the high ghost rows (y = ny, z = nz) to the neighbours' first rows.
  void addHighGhosts(float* base, std::size_t rowLength) const;

  [[nodiscard]] std::int64_t row(std::int64_t y, std::int64_t z) const noexcept
  {
    return (z + ghostZ_) * (size_[1] + 2) + y + 1;
  }
  [[nodiscard]] std::int64_t rows() const noexcept { return (size_[1] + 2) * (size_[2] + 2 * ghostZ_); }
  /// Is the ghost layer on this side of the block part of the lattice (another rank's, or periodic)?
  [[nodiscard]] bool inside(int axis, int step) const noexcept { return neighbour_[axis][step > 0 ? 1 : 0] >= 0; }

private:
  struct RowPair
  {
    std::int64_t source;
    std::int64_t target;
  };
  /// Rows to send to the neighbour in direction `step`, and where those from the other side go.
  [[nodiscard]] std::vector<RowPair> rowPairs(int axis, int step) const;

  const Communicator* comm_ = nullptr;
  std::array<std::int64_t, 3> size_{ 1, 1, 1 };
  int ghostZ_ = 0;
  std::array<std::array<int, 2>, 3> neighbour_{ { { -1, -1 }, { -1, -1 }, { -1, -1 } } };
};

} // namespace lamella
