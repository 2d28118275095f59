#pragma once

#include "micrograph/Contour.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace lamella::test
{

/// A disk in the middle of a square cell, as a polygon of the same area. Between two opposite faces and insulated
/// sides the cell conducts as the square array does, by symmetry.
/// @param fraction the disk's share of the area  @param cell the square's side [m]
inline micrograph::ContourSet squareOfDisk(double fraction, double cell, int corners = 2000)
{
  const double step = 2 * std::numbers::pi / corners;
  const double radius = cell * std::sqrt(fraction / (0.5 * corners * std::sin(step)));
  micrograph::ContourSet set{ { cell, cell }, { micrograph::Contour{ {}, true, 1 } } };
  for (int k = 0; k < corners; ++k)
    set.contours[0].points.push_back(
      micrograph::Point{ cell / 2 + radius * std::cos(k * step), cell / 2 + radius * std::sin(k * step) });
  return set;
}

/// Effective conductivity of the square array of disks over that of the matrix, by Rayleigh's multipoles (Perrins,
/// McKenzie & McPhedran, Proc. R. Soc. A 369 (1979) 207): with B_n the amplitude of r^-n cos nθ, n odd, around each
/// disk of radius a in a square of side 1 under a mean gradient of 1, and T = (s − 1)/(s + 1),
///   B_n = −T a^2n (δ_n1 − Σ_m C(n+m−1, n) S_(n+m) B_m),  k = 1 − 2π B_1,
/// where S_2 = π, S_4 = Γ(1/4)^8/(960 π²), and the others follow from it as in Laurent's series of Weierstrass's ℘.
/// @param fraction share of area, up to 0.7 (towards touching disks, π/4, it takes ever more terms)
/// @param s        conductivity of the disks over that of the matrix, ≥ 0
/// @param terms    multipoles, of which ten are enough for nine digits up to 0.6
inline double squareArrayOfDisks(double fraction, double s, int terms = 40)
{
  const double t = (s - 1) / (s + 1);
  const double a = std::sqrt(fraction / std::numbers::pi);
  const auto most = static_cast<std::size_t>(2 * terms + 1);
  // c_k = (2k − 1) S_2k, in units of a^2k so that nothing overflows
  std::vector<double> c(most, 0.0);
  c[2] = 3 * std::pow(std::tgamma(0.25), 8) / (960 * std::numbers::pi * std::numbers::pi) * std::pow(a, 4);
  for (std::size_t k = 4; k < most; ++k)
  {
    for (std::size_t m = 2; m + 2 <= k; ++m)
      c[k] += c[m] * c[k - m];
    c[k] *= 3 / static_cast<double>((2 * k + 1) * (k - 3));
  }
  // C(n + m − 1, n) S_(n+m)
  const auto size = static_cast<std::size_t>(terms);
  std::vector<double> sums(size * size);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j)
    {
      const auto n = static_cast<double>(2 * i + 1);
      const auto m = static_cast<double>(2 * j + 1);
      const std::size_t k = i + j + 1;
      sums[i * size + j] = std::exp(std::lgamma(n + m) - std::lgamma(n + 1) - std::lgamma(m)) *
        (k == 1 ? std::numbers::pi * a * a : c[k] / static_cast<double>(2 * k - 1));
    }
  // x_n = B_n / a^n by Gauss & Seidel: the disks' influence on each other is a contraction
  std::vector<double> x(size, 0.0);
  for (double change = 1; change > 1e-15;)
  {
    change = 0;
    for (std::size_t i = 0; i < size; ++i)
    {
      double others = i == 0 ? -a : 0.0;
      for (std::size_t j = 0; j < size; ++j)
        others += sums[i * size + j] * x[j];
      change = std::max(change, std::abs(t * others - x[i]));
      x[i] = t * others;
    }
  }
  return 1 - 2 * std::numbers::pi * a * x[0];
}

} // namespace lamella::test
