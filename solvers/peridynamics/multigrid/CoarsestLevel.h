#pragma once

#include "peridynamics/multigrid/Level.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <cstdint>
#include <memory>

namespace lamella::peridynamics
{

/// The pseudo-inverse of a small level's matrix: whatever is not held, or held by a hinge, does not move. A level that
/// could not be made small enough, for periodic sides can only be halved while they are even, is factorised.
class CoarsestLevel
{
public:
  explicit CoarsestLevel(const Level& level);
  /// Is a level of this size small enough for it?
  [[nodiscard]] static bool possible(const NodeLayout& layout) noexcept;
  /// x = A⁺ r on the level that it was made of.
  void solve(Level& level) const;
  [[nodiscard]] std::int64_t bytes() const noexcept
  {
    return static_cast<std::int64_t>(inverse_.size()) * static_cast<std::int64_t>(sizeof(float)) +
      (factors_ ? factors_->matrixL().nestedExpression().nonZeros() * 12 : 0);
  }

private:
  using Factors = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
  Eigen::MatrixXf inverse_;
  std::unique_ptr<Factors> factors_;
};

} // namespace lamella::peridynamics
