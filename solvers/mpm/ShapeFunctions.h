#pragma once

#include <cmath>

/// Shape functions of the grid's nodes, along one axis; in space they are products. Lengths in spacings, counted from
/// node 0.
namespace lamella::mpm
{

/// Values at one place: of the nodes base, base + 1, ….
template <int Nodes>
struct AxisShape
{
  int base;
  double value[Nodes];    ///< sum to 1
  double gradient[Nodes]; ///< [1/spacing]
};

/// Hat functions; the paper's. Not smooth: points that cross cells jolt.
struct Linear
{
  static constexpr int nodes = 2;

  [[nodiscard]] static AxisShape<2> at(double x, double /*width*/) noexcept
  {
    const double cell = std::floor(x);
    const double f = x - cell;
    return { static_cast<int>(cell), { 1 - f, f }, { -1, 1 } };
  }
  /// Σ N (x_i − x)²
  [[nodiscard]] static double moment(const AxisShape<2>& s, double x) noexcept
  {
    const double f = x - s.base;
    return f * (1 - f);
  }
};

/// Hat functions averaged over the width of a point (uniform GIMP; Bardenhagen and Kober, CMES 5 (2004) 477):
/// continuous gradients.
struct Gimp
{
  static constexpr int nodes = 3;

  /// @param width of a point, 0 < width ≤ 1
  [[nodiscard]] static AxisShape<3> at(double x, double width) noexcept
  {
    const double half = width / 2;
    const double base = std::floor(x - half);
    AxisShape<3> s{ static_cast<int>(base), {}, {} };
    for (int a = 0; a < 3; ++a)
    {
      const double d = x - base - a;
      s.value[a] = (integral(d + half) - integral(d - half)) / width;
      s.gradient[a] = (hat(d + half) - hat(d - half)) / width;
    }
    return s;
  }
  [[nodiscard]] static double moment(const AxisShape<3>& s, double x) noexcept
  {
    double sum = 0;
    for (int a = 0; a < 3; ++a)
      sum += s.value[a] * (s.base + a - x) * (s.base + a - x);
    return sum;
  }

private:
  static double hat(double d) noexcept { return std::fmax(0.0, 1 - std::fabs(d)); }
  static double integral(double d) noexcept
  {
    const double c = std::fmin(1.0, std::fmax(-1.0, d));
    return c - c * std::fabs(c) / 2;
  }
};

/// Quadratic B-splines (Steffen, Kirby and Berzins, Int. J. Numer. Meth. Eng. 76 (2008) 922). Near a wall the nodes
/// beyond it mirror those before it, so no spline differs from the others.
struct QuadraticSpline
{
  static constexpr int nodes = 3;

  [[nodiscard]] static AxisShape<3> at(double x, double /*width*/) noexcept
  {
    const double base = std::floor(x - 0.5);
    const double f = x - base; // 0.5 … 1.5
    return { static_cast<int>(base),
      { 0.5 * (1.5 - f) * (1.5 - f), 0.75 - (f - 1) * (f - 1), 0.5 * (f - 0.5) * (f - 0.5) },
      { f - 1.5, 2 - 2 * f, f - 0.5 } };
  }
  [[nodiscard]] static double moment(const AxisShape<3>& /*s*/, double /*x*/) noexcept { return 0.25; }
};

} // namespace lamella::mpm
