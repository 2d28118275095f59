#pragma once

#include <Eigen/Core>

#include <algorithm>

namespace lamella::lbm
{

/// L D Lᵀ of a symmetric positive definite matrix that is zero beyond a narrow band: of a small lattice, unknowns row
/// by row. It needs neither an ordering nor an analysis of its zeros, which take sparse factors of some hundred
/// unknowns longer than the factors themselves.
class BandCholesky
{
public:
  BandCholesky() = default;
  /// All zero. @param width of the band: the largest row less column
  BandCholesky(Eigen::Index size, Eigen::Index width);

  [[nodiscard]] bool empty() const noexcept { return band_.cols() == 0; }
  /// Adds to an element of the lower triangle; those above it are left out.
  void add(Eigen::Index row, Eigen::Index column, double value)
  {
    if (row >= column)
      band_(row - column, column) += value;
  }
  /// In place. False where the matrix is not positive definite.
  [[nodiscard]] bool factorize();
  /// Right-hand side in, solution out.
  void solve(Eigen::Ref<Eigen::VectorXd> x) const;

private:
  [[nodiscard]] Eigen::Index below(Eigen::Index column) const
  {
    return std::min(band_.rows() - 1, band_.cols() - 1 - column);
  }

  Eigen::MatrixXd band_; ///< a column's diagonal and what is below it; factorised: D, and D times L's
};

} // namespace lamella::lbm
