#pragma once

#include "peridynamics/multigrid/Level.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

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
  /// Takes k v vᵀ off the matrix; v by unknown, as number() counts them. Exact, but for where that leaves something
  /// without a hold.
  /// @return false: so it does (or the level is factorised); make this anew
  [[nodiscard]] bool subtract(const std::vector<std::pair<std::int64_t, double>>& v, double k);
  [[nodiscard]] static std::int64_t number(
    const NodeLayout& l, std::int64_t x, std::int64_t y, std::int64_t z, int component) noexcept
  {
    return l.dimension * (x + l.size[0] * (y + l.size[1] * z)) + component;
  }
  [[nodiscard]] std::int64_t bytes() const noexcept
  {
    return static_cast<std::int64_t>(inverse_.size()) * static_cast<std::int64_t>(sizeof(float)) +
      static_cast<std::int64_t>(exact_.size()) * static_cast<std::int64_t>(sizeof(double)) +
      (factors_ ? factors_->matrixL().nestedExpression().nonZeros() * 12 : 0);
  }

private:
  using Factors = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
  Eigen::MatrixXf inverse_;
  Eigen::MatrixXd exact_; ///< the same, once it has been changed
  std::unique_ptr<Factors> factors_;
};

} // namespace lamella::peridynamics
