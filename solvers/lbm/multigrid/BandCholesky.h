#pragma once

#include <cstdint>
#include <span>
#include <vector>

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
  BandCholesky(std::int64_t size, std::int64_t width);

  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  /// Adds to an element of the lower triangle; those above it are left out.
  void add(std::int64_t row, std::int64_t column, double value)
  {
    if (row >= column)
      band_[static_cast<std::size_t>(column * (width_ + 1) + row - column)] += value;
  }
  /// In place. False where the matrix is not positive definite.
  [[nodiscard]] bool factorize();
  /// Right-hand side in, solution out.
  void solve(std::span<double> x) const;

private:
  std::int64_t size_ = 0;
  std::int64_t width_ = 0;
  std::vector<double> band_; ///< by column: its diagonal and what is below it
};

} // namespace lamella::lbm
