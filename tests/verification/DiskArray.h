#pragma once

#include "outlines/Contour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

/// A hexagonal array of disks at distance 1 (times `side`): the disk in the middle of a box of 1 by √3 and quarters of
/// four more in its corners, polygons of the disks' area. Between two opposite faces and insulated sides the box
/// conducts as the array does, by symmetry, along either axis.
inline micrograph::ContourSet hexagonsOfDisks(double fraction, double side, int corners = 2000)
{
  const double step = 2 * std::numbers::pi / corners;
  const double height = side * std::sqrt(3.0);
  const double radius = std::sqrt(fraction * side * height / 2 / (0.5 * corners * std::sin(step)));
  micrograph::ContourSet set{ { side, height }, {} };
  const std::array<micrograph::Point, 5> centres{ micrograph::Point{ side / 2, height / 2 }, micrograph::Point{ 0, 0 },
    micrograph::Point{ side, 0 }, micrograph::Point{ side, height }, micrograph::Point{ 0, height } };
  for (const micrograph::Point& centre : centres)
  {
    micrograph::Contour disk{ {}, true, static_cast<std::int32_t>(set.contours.size()) + 1 };
    for (int k = 0; k < corners; ++k)
      disk.points.push_back({ centre[0] + radius * std::cos(k * step), centre[1] + radius * std::sin(k * step) });
    set.contours.push_back(disk);
  }
  return set;
}

/// Effective conductivity of an array of disks over that of the matrix, by Rayleigh's multipoles (Perrins, McKenzie &
/// McPhedran, Proc. R. Soc. A 369 (1979) 207): with B_n the amplitude of r^-n cos nθ, n odd, around each
/// disk of radius a at distance 1 from its neighbours, in a cell of area A, under a mean gradient of 1, and
/// T = (s − 1)/(s + 1),
///   B_n = −T a^2n (δ_n1 − Σ_m C(n+m−1, n) S_(n+m) B_m),  k = 1 − 2π B_1/A,
/// where S_2 = π/A, and the others follow from S_4 and S_6 as in Laurent's series of Weierstrass's ℘.
/// With a resistance R on the disks' surface the value jumps there by R times the flux: at order n they answer like
/// perfect ones of s/(1 + n s R k/a), k the matrix's conductivity.
/// @param fraction share of area (towards touching disks it takes ever more terms)
/// @param s        conductivity of the disks over that of the matrix, ≥ 0
/// @param area     A  @param s4, s6 lattice sums Σ z^-4, Σ z^-6
/// @param terms    multipoles
/// @param resistance R k/a
inline double arrayOfDisks(
  double fraction, double s, double area, double s4, double s6, int terms, double resistance = 0)
{
  const double a = std::sqrt(fraction * area / std::numbers::pi);
  const auto most = static_cast<std::size_t>(2 * terms + 1);
  // c_k = (2k − 1) S_2k, in units of a^2k so that nothing overflows
  std::vector<double> c(most, 0.0);
  c[2] = 3 * s4 * std::pow(a, 4);
  c[3] = 5 * s6 * std::pow(a, 6);
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
        (k == 1 ? std::numbers::pi * a * a / area : c[k] / static_cast<double>(2 * k - 1));
    }
  // x_n = B_n / a^n by Gauss & Seidel: the disks' influence on each other is a contraction
  std::vector<double> x(size, 0.0);
  for (double change = 1; change > 1e-15;)
  {
    change = 0;
    for (std::size_t i = 0; i < size; ++i)
    {
      const double seen = s / (1 + static_cast<double>(2 * i + 1) * s * resistance);
      const double t = (seen - 1) / (seen + 1);
      double others = i == 0 ? -a : 0.0;
      for (std::size_t j = 0; j < size; ++j)
        others += sums[i * size + j] * x[j];
      change = std::max(change, std::abs(t * others - x[i]));
      x[i] = t * others;
    }
  }
  return 1 - 2 * std::numbers::pi * a * x[0] / area;
}

/// The square array: S_4 = Γ(1/4)^8/(960 π²), S_6 = 0. Up to 0.7 of π/4; ten terms are enough for nine digits to 0.6.
inline double squareArrayOfDisks(double fraction, double s, int terms = 40, double resistance = 0)
{
  return arrayOfDisks(
    fraction, s, 1, std::pow(std::tgamma(0.25), 8) / (960 * std::numbers::pi * std::numbers::pi), 0, terms, resistance);
}

/// The hexagonal array, neighbours at distance 1 in cells of √3/2: S_4 = 0, S_6 = Γ(1/3)^18/(8960 π⁶). Up to 0.85 of
/// π/√12 = 0.9069.
inline double hexagonalArrayOfDisks(double fraction, double s, int terms = 40)
{
  return arrayOfDisks(fraction, s, std::sqrt(3.0) / 2, 0,
    std::pow(std::tgamma(1.0 / 3), 18) / (8960 * std::pow(std::numbers::pi, 6)), terms);
}

} // namespace lamella::test
