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
      const std::size_t i = (first + a) % n_;
      const double s = weight * c[a];
      rhs_[i] -= s * constant;
      for (std::size_t b = a; b < 4; ++b)
      {
        band_[i][b - a] += s * c[b]; // entry (i, i + b − a), modulo n
      }
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
    factor();
    if (!closed_)
    {
      substitute(rhs_.data());
      return;
    }
    // The last three unknowns D close the ring: [B C; Cᵀ D].
    std::array<std::vector<double>, 3> column;
    std::array<std::array<double, 3>, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k)
    {
      column[k].assign(core_, 0.0);
      const std::size_t j = core_ + k;
      for (std::size_t d = 1; d <= 3; ++d)
      {
        if (j - d < core_)
        {
          column[k][j - d] += band_[j - d][d];
        }
        if (j + d >= n_)
        {
          column[k][j + d - n_] += band_[j][d];
        }
      }
      for (std::size_t l = k; l < 3; ++l)
      {
        corner[k][l] = corner[l][k] = band_[core_ + k][l - k];
      }
    }
    const std::array<std::vector<double>, 3> before = column;
    for (auto& c : column)
    {
      substitute(c.data());
    }
    substitute(rhs_.data());
    std::array<double, 3> right{};
    for (std::size_t k = 0; k < 3; ++k)
    {
      right[k] = rhs_[core_ + k] - dot(before[k], rhs_);
      for (std::size_t l = 0; l < 3; ++l)
      {
        corner[k][l] -= dot(before[k], column[l]);
      }
    }
    for (std::size_t k = 0; k < 3; ++k) // Gauss, positive definite
    {
      for (std::size_t l = k + 1; l < 3; ++l)
      {
        const double f = corner[l][k] / corner[k][k];
        for (std::size_t m = k; m < 3; ++m)
        {
          corner[l][m] -= f * corner[k][m];
        }
        right[l] -= f * right[k];
      }
    }
    for (std::size_t k = 3; k-- > 0;)
    {
      for (std::size_t l = k + 1; l < 3; ++l)
      {
        right[k] -= corner[k][l] * right[l];
      }
      right[k] /= corner[k][k];
      rhs_[core_ + k] = right[k];
    }
    for (std::size_t i = 0; i < core_; ++i)
    {
      rhs_[i] -= column[0][i] * right[0] + column[1][i] * right[1] + column[2][i] * right[2];
    }
  }
  [[nodiscard]] double solution(std::size_t i) const { return rhs_[i]; }

private:
  [[nodiscard]] double dot(const std::vector<double>& a, const std::vector<double>& b) const
  {
    double sum = 0; // a column of C is zero but for its ends
    for (std::size_t i = 0; i < core_; ++i)
    {
      if (i == 3 && core_ > 6)
      {
        i = core_ - 3;
      }
      sum += a[i] * b[i];
    }
    return sum;
  }

  /// L D Lᵀ of the core; L's columns and 1/D take the band's place in `factor_`.
  void factor()
  {
    factor_.resize(core_);
    for (std::size_t i = 0; i < core_; ++i)
    {
      factor_[i] = band_[i];
    }
    for (std::size_t i = 0; i < core_; ++i)
    {
      auto& row = factor_[i];
      const double inverse = 1 / row[0];
      const std::array<double, 3> l{ row[1] * inverse, row[2] * inverse, row[3] * inverse };
      for (std::size_t a = 1; a <= 3 && i + a < core_; ++a)
      {
        for (std::size_t b = a; b <= 3; ++b)
        {
          factor_[i + a][b - a] -= l[a - 1] * row[b];
        }
      }
      row = { inverse, l[0], l[1], l[2] };
    }
  }
  void substitute(double* x) const
  {
    for (std::size_t i = 0; i < core_; ++i)
    {
      for (std::size_t a = 1; a <= 3 && i + a < core_; ++a)
      {
        x[i + a] -= factor_[i][a] * x[i];
      }
    }
    for (std::size_t i = core_; i-- > 0;)
    {
      double value = x[i] * factor_[i][0];
      for (std::size_t a = 1; a <= 3 && i + a < core_; ++a)
      {
        value -= factor_[i][a] * x[i + a];
      }
      x[i] = value;
    }
  }

  std::size_t n_, core_;
  bool closed_;
  std::vector<std::array<double, 4>> band_;
  std::vector<std::array<double, 4>> factor_;
  std::vector<double> rhs_;
};

} // namespace lamella::micrograph
