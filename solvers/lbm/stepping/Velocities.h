#pragma once

#include "lbm/Links.h"
#include "lbm/SteadyDiffusion.h"

#include <vector>

namespace lamella::lbm
{

/// The populations of a lattice that are stored: the one at rest, if its weight is not 0 (D3Q7's is), then pairs of
/// opposite ones, those along an axis first.
struct Velocities
{
  std::vector<Direction> c;
  std::vector<double> weight;
  int rest = 1; ///< number of populations at rest, 0 or 1

  explicit Velocities(Stencil stencil);

  [[nodiscard]] int count() const noexcept { return static_cast<int>(c.size()); }
  [[nodiscard]] int opposite(int q) const noexcept { return q < rest ? q : ((q - rest) ^ 1) + rest; }
  [[nodiscard]] int find(const Direction& d) const noexcept;
};

} // namespace lamella::lbm
