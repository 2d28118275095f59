#pragma once

#include <vector>

namespace lamella::lbm
{

/// The least eigenvalue of the preconditioned matrix, from the coefficients of conjugate gradients: they are those of
/// the Lanczos process, whose tridiagonal matrix has Ritz values for eigenvalues (G. Meurant and Z. Strakoš, Acta
/// Numerica 15 (2006) 471, section 2). The least one comes down to the least eigenvalue as soon as that matters to the
/// error.
class LanczosSpectrum
{
public:
  /// The search begins anew, or the preconditioner has changed. What was found before still counts.
  void restart();
  /// One iteration: its step length, and the factor of the previous direction in this one (0 in the first).
  void add(double alpha, double beta);
  [[nodiscard]] bool empty() const noexcept { return seen_ == 0; }
  /// 1 as long as nothing is known: a multigrid cycle that comes from a Galerkin product never overshoots.
  [[nodiscard]] double smallest() const noexcept { return smallest_; }

private:
  std::vector<double> diagonal_;
  std::vector<double> below_;
  double previousAlpha_ = 0;
  double smallest_ = 1;
  int seen_ = 0;
};

} // namespace lamella::lbm
