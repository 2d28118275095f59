#pragma once

#include "lattice/Decomposition.h"

#include <bit>
#include <cstdint>
#include <vector>

namespace lamella
{

/// A subset of the nodes of a block and its ghost rows, one bit a node, with constant-time ranking: `id()` numbers the
/// members row by row from 0. The base of all compact storage: nodes outside the set take one bit and nothing else.
///
/// Memory: 1.5 bits a node of the block.
class NodeSet
{
public:
  NodeSet() = default;
  NodeSet(std::int64_t nx, const Halo& halo)
    : nx_(nx)
    , words_((nx + 63) / 64)
    , rows_(halo.rows())
    , bits_(static_cast<std::size_t>(words_ * rows_), 0)
  {
  }

  [[nodiscard]] bool contains(std::int64_t row, std::int64_t x) const noexcept
  {
    return (bits_[word(row, x)] >> (x & 63)) & 1U;
  }
  void insert(std::int64_t row, std::int64_t x) noexcept { bits_[word(row, x)] |= std::uint64_t{ 1 } << (x & 63); }
  void erase(std::int64_t row, std::int64_t x) noexcept { bits_[word(row, x)] &= ~(std::uint64_t{ 1 } << (x & 63)); }
  /// Keeps only the members that are also in another set of the same shape.
  void intersect(const NodeSet& other) noexcept
  {
    for (std::size_t i = 0; i < bits_.size(); ++i)
      bits_[i] &= other.bits_[i];
  }

  /// Fills the ghost rows from the neighbours.
  void exchange(const Halo& halo) { halo.exchange(bits_.data(), static_cast<std::size_t>(words_) * 8); }

  /// Numbers the members; call after the last change.
  void number()
  {
    before_.resize(bits_.size() + 1);
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < bits_.size(); ++i)
    {
      before_[i] = count;
      count += static_cast<std::uint32_t>(std::popcount(bits_[i]));
    }
    before_.back() = count;
  }
  /// Position of a member among all members, ghost rows included; number() must have been called.
  [[nodiscard]] std::uint32_t id(std::int64_t row, std::int64_t x) const noexcept
  {
    const std::size_t w = word(row, x);
    return before_[w] + static_cast<std::uint32_t>(std::popcount(bits_[w] & ((std::uint64_t{ 1 } << (x & 63)) - 1)));
  }
  /// Id of the first member at or after the begin of a row.
  [[nodiscard]] std::uint32_t rowBegin(std::int64_t row) const noexcept
  {
    return before_[static_cast<std::size_t>(row * words_)];
  }
  [[nodiscard]] std::uint32_t size() const noexcept { return before_.empty() ? 0 : before_.back(); }

  /// Calls f(x) for the members of a row, x rising.
  template <class F>
  void forEach(std::int64_t row, F&& f) const
  {
    for (std::int64_t w = 0; w < words_; ++w)
      for (std::uint64_t rest = bits_[static_cast<std::size_t>(row * words_ + w)]; rest != 0; rest &= rest - 1)
        f(w * 64 + std::countr_zero(rest));
  }

  [[nodiscard]] std::int64_t rows() const noexcept { return rows_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return bits_.size() * 8 + before_.size() * 4; }

private:
  [[nodiscard]] std::size_t word(std::int64_t row, std::int64_t x) const noexcept
  {
    return static_cast<std::size_t>(row * words_ + (x >> 6));
  }

  std::int64_t nx_ = 0;
  std::int64_t words_ = 0;
  std::int64_t rows_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> before_;
};

} // namespace lamella
