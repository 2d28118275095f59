#pragma once

#include "core/Communicator.h"
#include "lattice/Decomposition.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// The unknowns of other ranks that those of a level of pieces are linked to: the ones in the blocks along the sides of
/// this rank's part, in the order of those blocks, after this rank's own. Empty on one rank.
class PieceHalo
{
public:
  /// y below, y above, z below, z above
  static constexpr std::size_t sides = 4;
  [[nodiscard]] static constexpr std::size_t sideOf(std::size_t axis, int step) noexcept
  {
    return 2 * (axis - 1) + (step > 0 ? 1 : 0);
  }
  [[nodiscard]] static constexpr std::size_t axisOf(std::size_t side) noexcept { return 1 + side / 2; }

  PieceHalo() = default;
  /// Collective. @param start of this rank's unknowns, by block, and their number  @param comm outlives this
  PieceHalo(const Communicator& comm, const Decomposition& parts, const std::array<bool, 3>& periodic,
    const std::array<std::int64_t, 3>& blocks, std::span<const std::uint32_t> start);

  /// Is there another rank on this side?
  [[nodiscard]] bool has(std::size_t side) const noexcept { return rank_[side] >= 0; }
  [[nodiscard]] std::size_t count() const noexcept { return ghosts_; }
  /// The block beyond (x, y, z) of a side, by its place among those along it.
  [[nodiscard]] std::size_t place(std::size_t side, const std::array<std::int64_t, 3>& block) const noexcept
  {
    return static_cast<std::size_t>(block[0] + blocks_[0] * (side < 2 ? block[2] : block[1]));
  }
  /// Its first unknown.
  [[nodiscard]] std::uint32_t start(std::size_t side, std::size_t place) const noexcept { return start_[side][place]; }
  /// The side on which a ghost is.
  [[nodiscard]] std::size_t sideWith(std::uint32_t ghost) const noexcept;
  /// This rank's unknowns along a side.
  [[nodiscard]] const std::vector<std::uint32_t>& along(std::size_t side) const noexcept { return along_[side]; }

  /// So many values a block along each side, of the neighbour's blocks there; [side] by place. Collective.
  [[nodiscard]] std::array<std::vector<std::uint32_t>, sides> ofBlocks(
    std::span<const std::uint32_t> byBlock, std::size_t each = 1) const;
  /// Fills the ghosts, which follow the own ones. Four bytes a value. Collective.
  template <class T>
  void exchange(std::vector<T>& v) const
  {
    static_assert(sizeof(T) == 4);
    if (parallel())
      exchange(reinterpret_cast<std::byte*>(v.data()));
  }
  /// The same of what is not alike for all sides: mine[side] are those along it.
  [[nodiscard]] std::array<std::vector<std::uint32_t>, sides> swap(
    const std::array<std::vector<std::uint32_t>, sides>& mine) const;

  [[nodiscard]] bool parallel() const noexcept { return comm_ != nullptr; }
  [[nodiscard]] std::size_t bytes() const noexcept;

private:
  void exchange(std::byte* values) const;

  const Communicator* comm_ = nullptr; ///< null where no other rank is near
  std::array<std::int64_t, 3> blocks_{ 1, 1, 1 };
  std::array<int, sides> rank_{ -1, -1, -1, -1 };
  std::array<std::vector<std::uint32_t>, sides> start_;
  std::array<std::vector<std::uint32_t>, sides> along_;
  std::size_t ghosts_ = 0;
  mutable std::array<std::vector<std::uint32_t>, sides> send_;
};

} // namespace lamella::lbm
