#pragma once

#include "peridynamics/BondLattice.h"

#include <cstdint>
#include <numeric>
#include <vector>

namespace lamella::peridynamics
{

/// Disjoint sets of positions; the least of a set stands for it.
class Sets
{
public:
  explicit Sets(std::int64_t count)
    : parent_(static_cast<std::size_t>(count))
  {
    std::iota(parent_.begin(), parent_.end(), std::int64_t{ 0 });
  }
  std::int64_t find(std::int64_t i)
  {
    while (at(i) != i)
    {
      at(i) = at(at(i));
      i = at(i);
    }
    return i;
  }
  void join(std::int64_t a, std::int64_t b)
  {
    a = find(a);
    b = find(b);
    if (a < b)
      at(b) = a;
    else
      at(a) = b;
  }
  /// Every entry becomes the one that stands for its set.
  void flatten()
  {
    for (std::size_t i = 0; i < parent_.size(); ++i) // the least of a set comes first
      parent_[i] = parent_[static_cast<std::size_t>(parent_[i])];
  }
  [[nodiscard]] std::int64_t& at(std::int64_t i) { return parent_[static_cast<std::size_t>(i)]; }

private:
  std::vector<std::int64_t> parent_;
};

/// Joins the ends of every bond that lies in the layout, rim included: images at periodic sides are nodes of their own
/// here, and so are the rows of other ranks. The sets are flat then.
[[nodiscard]] Sets joinBonds(const BondLattice& bonds);

} // namespace lamella::peridynamics
