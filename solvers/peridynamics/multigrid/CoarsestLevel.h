#pragma once

#include "peridynamics/multigrid/Level.h"

#include <Eigen/Dense>

#include <cstdint>

namespace lamella::peridynamics
{

/// The pseudo-inverse of a small level's matrix: whatever is not held, or held by a hinge, does not move.
class CoarsestLevel
{
public:
  explicit CoarsestLevel(const Level& level);
  /// x = A⁺ r on the level that it was made of.
  void solve(Level& level) const;
  [[nodiscard]] std::int64_t bytes() const noexcept
  {
    return static_cast<std::int64_t>(inverse_.size()) * static_cast<std::int64_t>(sizeof(float));
  }

private:
  Eigen::MatrixXf inverse_;
};

} // namespace lamella::peridynamics
