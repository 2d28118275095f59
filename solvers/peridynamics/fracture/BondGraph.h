#pragma once

#include "peridynamics/BondLattice.h"

#include <array>
#include <vector>

namespace lamella::peridynamics
{

/// The bonds of a lattice as a graph of nodes.
class BondGraph
{
public:
  explicit BondGraph(const BondLattice& bonds)
    : bonds_(bonds)
    , reach_(bonds.stencil().layers())
    , width_(2 * reach_ + 1)
    , offset_(cube(width_), 0)
  {
    int o = 0;
    for (const Offset& half : bonds.stencil().half())
    {
      const auto& s = half.step;
      offset_[place(s)] = ++o;
      offset_[place({ -s[0], -s[1], -s[2] })] = -o;
    }
  }

  /// Calls f(j, step) for every node at the other end of a bond of node i, until it returns true.
  /// @return whether it did
  template <class F>
  bool anyNeighbour(std::int64_t i, F&& f) const
  {
    const auto& half = bonds_.stencil().half();
    for (int o = 0; o < static_cast<int>(half.size()); ++o)
    {
      const auto& s = half[static_cast<std::size_t>(o)].step;
      const std::int64_t jump = bonds_.jump(o);
      if (bonds_.kind(i, o) != 0 && f(i + jump, s))
        return true;
      if (bonds_.kind(i - jump, o) != 0 && f(i - jump, std::array<int, 3>{ -s[0], -s[1], -s[2] }))
        return true;
    }
    return false;
  }

  /// Is there a bond between node i and the one a step from it?
  [[nodiscard]] bool bonded(std::int64_t i, const std::array<int, 3>& step) const
  {
    for (const int s : step)
      if (s < -reach_ || s > reach_)
        return false;
    const int o = offset_[place(step)];
    return o > 0 ? bonds_.kind(i, o - 1) != 0 : o < 0 && bonds_.kind(i - bonds_.jump(-o - 1), -o - 1) != 0;
  }

  /// Does another node have bonds to node i and to the one a step from it?
  [[nodiscard]] bool shareNeighbour(std::int64_t i, const std::array<int, 3>& step) const
  {
    return anyNeighbour(
      i,
      [&](std::int64_t n, const std::array<int, 3>& s) {
        return bonded(n, { step[0] - s[0], step[1] - s[1], step[2] - s[2] });
      });
  }

private:
  [[nodiscard]] static std::size_t cube(int width)
  {
    const auto w = static_cast<std::size_t>(width);
    return w * w * w;
  }
  [[nodiscard]] std::size_t place(const std::array<int, 3>& s) const
  {
    const int at = s[0] + reach_ + width_ * (s[1] + reach_ + width_ * (s[2] + reach_));
    return static_cast<std::size_t>(at);
  }

  const BondLattice& bonds_;
  int reach_;
  int width_;
  std::vector<int> offset_; ///< of a step, from 1; negative backwards
};

} // namespace lamella::peridynamics
