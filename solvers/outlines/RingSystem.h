#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace lamella::micrograph
{

/// Least squares in unknowns along a chain, each term in four neighbours: a positive definite matrix of seven
/// diagonals, and the corners that a ring has. Time and memory grow with the number of unknowns.
class RingSystem
{
public:
  /// @param n unknowns, at least 8
  /// @param closed the last one is beside the first
  RingSystem(std::size_t n, bool closed)
    : n_(n)
    , core_(closed ? n - 3 : n)
    , closed_(closed)
    , band_(n)
    , rows_(n)
    , rhs_(n)
  {
  }

  void clear()
  {
    std::fill(band_.begin(), band_.end(), std::array<double, 4>{});
    std::fill(rhs_.begin(), rhs_.end(), 0.0);
  }
  /// Adds weight · (c·t + constant)² for four neighbours from `first` on.
  void add(std::size_t first, const std::array<double, 4>& c, double constant, double weight)
  {
    for (std::size_t a = 0; a < 4; ++a)
    {
      const std::size_t i = first + a < n_ ? first + a : first + a - n_;
      const double s = weight * c[a];
      rhs_[i] -= s * constant;
      for (std::size_t b = a; b < 4; ++b)
        band_[i][b - a] += s * c[b]; // entry (i, i + b − a), modulo n
    }
  }
  void addDiagonal(std::size_t i, double weight, double target)
  {
    band_[i][0] += weight;
    rhs_[i] += weight * target;
  }

  /// The result stands in solution().
  void solve()
  {
    // The last three unknowns D close the ring: [B C; Cᵀ D]. B is solved for the right side and the columns of C at
    // once; C is zero but for its first and last three rows.
    std::array<std::array<double, 3>, 6> c{};
    for (std::size_t i = 0; i < core_; ++i)
      rows_[i] = { rhs_[i], 0, 0, 0 };
    std::array<std::size_t, 6> place{ 0, 1, 2, core_ - 3, core_ - 2, core_ - 1 };
    std::array<std::array<double, 3>, 3> corner{};
    if (closed_)
    {
      for (std::size_t k = 0; k < 3; ++k)
      {
        const std::size_t j = core_ + k;
        for (std::size_t d = 1; d <= 3; ++d)
        {
          if (j - d < core_)
            c[j - d + 6 - core_][k] = rows_[j - d][k + 1] = band_[j - d][d];
          if (j + d >= n_)
            c[j + d - n_][k] = rows_[j + d - n_][k + 1] = band_[j][d];
        }
        for (std::size_t l = k; l < 3; ++l)
          corner[k][l] = corner[l][k] = band_[j][l - k];
      }
    }
    solveCore();
    if (!closed_)
    {
      for (std::size_t i = 0; i < n_; ++i)
        rhs_[i] = rows_[i][0];
      return;
    }
    std::array<double, 3> right{};
    for (std::size_t k = 0; k < 3; ++k)
    {
      right[k] = rhs_[core_ + k];
      for (std::size_t m = 0; m < 6; ++m)
      {
        const auto& row = rows_[place[m]];
        right[k] -= c[m][k] * row[0];
        for (std::size_t l = 0; l < 3; ++l)
          corner[k][l] -= c[m][k] * row[l + 1];
      }
    }
    eliminate(corner, right);
    for (std::size_t k = 0; k < 3; ++k)
      rhs_[core_ + k] = right[k];
    for (std::size_t i = 0; i < core_; ++i)
    {
      const auto& row = rows_[i];
      rhs_[i] = row[0] - row[1] * right[0] - row[2] * right[1] - row[3] * right[2];
    }
  }
  [[nodiscard]] double solution(std::size_t i) const { return rhs_[i]; }

private:
  /// Gauss, for a positive definite matrix.
  static void eliminate(std::array<std::array<double, 3>, 3>& a, std::array<double, 3>& x)
  {
    for (std::size_t k = 0; k < 3; ++k)
    {
      for (std::size_t l = k + 1; l < 3; ++l)
      {
        const double f = a[l][k] / a[k][k];
        for (std::size_t m = k; m < 3; ++m)
          a[l][m] -= f * a[k][m];
        x[l] -= f * x[k];
      }
    }
    for (std::size_t k = 3; k-- > 0;)
    {
      for (std::size_t l = k + 1; l < 3; ++l)
        x[k] -= a[k][l] * x[l];
      x[k] /= a[k][k];
    }
  }

  /// L D Lᵀ of the core, whose columns and 1/D take the band's place, and rows_ solved for.
  void solveCore()
  {
    for (std::size_t i = 0; i < core_; ++i)
    {
      auto& row = band_[i];
      const double inverse = 1 / row[0];
      const std::array<double, 3> l{ row[1] * inverse, row[2] * inverse, row[3] * inverse };
      const std::size_t reach = std::min<std::size_t>(3, core_ - 1 - i);
      for (std::size_t a = 1; a <= reach; ++a)
      {
        for (std::size_t b = a; b <= 3; ++b)
          band_[i + a][b - a] -= l[a - 1] * row[b];
        for (std::size_t lane = 0; lane < 4; ++lane)
          rows_[i + a][lane] -= l[a - 1] * rows_[i][lane];
      }
      row = { inverse, l[0], l[1], l[2] };
    }
    for (std::size_t i = core_; i-- > 0;)
    {
      std::array<double, 4> value{};
      for (std::size_t lane = 0; lane < 4; ++lane)
        value[lane] = rows_[i][lane] * band_[i][0];
      const std::size_t reach = std::min<std::size_t>(3, core_ - 1 - i);
      for (std::size_t a = 1; a <= reach; ++a)
        for (std::size_t lane = 0; lane < 4; ++lane)
          value[lane] -= band_[i][a] * rows_[i + a][lane];
      rows_[i] = value;
    }
  }

  std::size_t n_, core_;
  bool closed_;
  std::vector<std::array<double, 4>> band_;
  std::vector<std::array<double, 4>> rows_; ///< right side and three columns
  std::vector<double> rhs_;
};

} // namespace lamella::micrograph
