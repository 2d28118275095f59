#pragma once

#include "core/Communicator.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lamella
{

/// The planes of nodes of a box, shared out over ranks: each has some that follow each other, the first of them even.
/// What a rank needs of its neighbours are the planes next to its own.
class PlaneParts
{
public:
  static constexpr std::int64_t fewNodes = 4096; ///< which every rank works out by itself

  PlaneParts() = default; ///< not split: every rank has all planes
  /// Are there several ranks, and planes enough for all of them?
  [[nodiscard]] static bool canSplit(std::int64_t planes, int ranks) noexcept
  {
    return ranks > 1 && (planes + 1) / 2 >= ranks;
  }
  /// Split where that can be.
  PlaneParts(std::int64_t planes, bool periodic, const Communicator& comm);

  [[nodiscard]] bool split() const noexcept { return begin_.size() > 1; }
  [[nodiscard]] std::int64_t first() const noexcept { return begin_[rank()]; }    ///< of a split box
  [[nodiscard]] std::int64_t last() const noexcept { return begin_[rank() + 1]; } ///< one behind
  [[nodiscard]] std::int64_t planes() const noexcept { return begin_.back(); }    ///< of the whole split box
  /// First and one behind the last of a rank, of a split box.
  [[nodiscard]] std::array<std::int64_t, 2> of(int rank) const noexcept
  {
    return { begin_[static_cast<std::size_t>(rank)], begin_[static_cast<std::size_t>(rank) + 1] };
  }
  [[nodiscard]] bool beginEven() const; ///< all parts do, the rest of a coarsening by two too
  /// Where each second plane is kept, each rank keeping those that it has.
  [[nodiscard]] PlaneParts halved(std::int64_t planes) const;

  // All of these are collective, and do nothing where the box is not split.

  /// `mine` to the next rank, and into `theirs` that of the one before; around the ends of a periodic axis.
  void up(const float* mine, float* theirs, std::size_t count) const { shift(mine, theirs, count * sizeof(float), 1); }
  void up(const double* mine, double* theirs, std::size_t count) const
  {
    shift(mine, theirs, count * sizeof(double), 1);
  }
  /// The same to the one before and from the next.
  void down(const float* mine, float* theirs, std::size_t count) const
  {
    shift(mine, theirs, count * sizeof(float), -1);
  }
  void down(const double* mine, double* theirs, std::size_t count) const
  {
    shift(mine, theirs, count * sizeof(double), -1);
  }
  /// Of values by plane, from the box's first plane on, of which each rank knows those of its own planes: all. Planes
  /// beyond those that were shared out are the last rank's.
  void gather(std::span<double> values, std::int64_t planes) const;
  void gather(std::span<float> values, std::int64_t planes) const;
  void sum(std::span<double> values) const; ///< of all ranks, in place
  /// `add` on one rank after the other, each going on with the values of the one before; then all have the last one's.
  /// So sums do not depend on the number of ranks.
  void inOrder(std::span<std::byte> values, const std::function<void()>& add) const;

private:
  [[nodiscard]] std::size_t rank() const noexcept { return static_cast<std::size_t>(comm_.rank()); }
  void shift(const void* mine, void* theirs, std::size_t bytes, int by) const;
  void gatherBytes(void* values, std::int64_t planes, std::size_t each) const;

  Communicator comm_{ MPI_COMM_SELF };
  std::vector<std::int64_t> begin_; ///< by rank, and one behind the last plane; empty: not split
  bool periodic_ = false;
};

} // namespace lamella
