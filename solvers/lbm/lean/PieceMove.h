#pragma once

#include "core/Communicator.h"
#include "lattice/Decomposition.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::lbm
{

/// Moves what the unknowns of a level of pieces have between two ways of sharing out its blocks. Ranks send to those
/// that have blocks in common with them, which are few. Four bytes a value.
class PieceMove
{
public:
  /// Collective. @param before,after  blocks of every rank  @param start of this rank's unknowns before, by block, and
  /// their number  @param comm outlives this
  PieceMove(const Communicator& comm, const std::vector<Block>& before, const std::vector<Block>& after,
    std::span<const std::uint32_t> start);

  /// Of this rank's unknowns after, by block, and their number.
  [[nodiscard]] const std::vector<std::uint32_t>& start() const noexcept { return start_; }

  /// One value an unknown. Collective, as all below.
  template <class T>
  void forward(const std::vector<T>& before, std::vector<T>& after) const
  {
    static_assert(sizeof(T) == 4);
    move(leaving_, arriving_, before.data(), after.data());
  }
  template <class T>
  void backward(const std::vector<T>& after, std::vector<T>& before) const
  {
    static_assert(sizeof(T) == 4);
    move(arriving_, leaving_, after.data(), before.data());
  }
  /// Several values an unknown: those of i are the ones from row[i] to row[i + 1].
  template <class T>
  void forwardRows(const std::vector<std::uint32_t>& rowBefore, const std::vector<T>& before,
    const std::vector<std::uint32_t>& rowAfter, std::vector<T>& after) const
  {
    static_assert(sizeof(T) == 4);
    moveRows(leaving_, arriving_, rowBefore.data(), before.data(), rowAfter.data(), after.data());
  }
  [[nodiscard]] std::size_t bytes() const noexcept;

private:
  /// This rank's unknowns that another one, or this one itself, has too; in the order of blocks.
  struct Share
  {
    int rank;
    std::vector<std::uint32_t> unknowns;
  };
  using Shares = std::vector<Share>;
  void move(const Shares& from, const Shares& to, const void* source, void* target) const;
  void moveRows(const Shares& from, const Shares& to, const std::uint32_t* rowFrom, const void* source,
    const std::uint32_t* rowTo, void* target) const;

  const Communicator* comm_;
  std::vector<std::uint32_t> start_;
  Shares leaving_;
  Shares arriving_;
};

} // namespace lamella::lbm
