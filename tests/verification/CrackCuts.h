// Broken bonds of ideal cracks: all bonds that cross a given line.
#pragma once

#include "cracks/CrackPaths.h"
#include "peridynamics/Stencil.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

namespace lamella::test
{

using namespace lamella::cracks;
using Line = std::vector<Place>;

inline constexpr double pi = std::numbers::pi;

/// The bonds of a picture that cross a line of straight pieces, `event` is the number of the piece from 1
/// and `when` a tenth of it.
/// @param phase of a node; the bonds carry the phases of their ends
inline std::vector<CutBond> cut(
  const Lattice& lattice, double horizon, const Line& line,
  const std::function<int(std::int64_t, std::int64_t)>& phase = [](std::int64_t, std::int64_t) { return 1; })
{
  const peridynamics::Stencil stencil(2, horizon);
  const int reach = stencil.layers();
  std::vector<CutBond> bonds;
  for (std::size_t k = 0; k + 1 < line.size(); ++k)
  {
    const Place& a = line[k];
    const Place along{ line[k + 1][0] - a[0], line[k + 1][1] - a[1] };
    const auto first = [&](std::size_t c)
    { return std::max<std::int64_t>(0, std::llround(std::floor(std::min(a[c], a[c] + along[c]))) - reach); };
    const auto last = [&](std::size_t c)
    {
      return std::min<std::int64_t>(
        lattice.size[c] - 1, std::llround(std::ceil(std::max(a[c], a[c] + along[c]))) + reach);
    };
    for (std::int64_t y = first(1); y <= last(1); ++y)
      for (std::int64_t x = first(0); x <= last(0); ++x)
        for (const peridynamics::Offset& o : stencil.half())
        {
          const std::int64_t otherX = x + o.step[0];
          const std::int64_t otherY = y + o.step[1];
          if (otherX < 0 || otherY < 0 || otherX >= lattice.size[0] || otherY >= lattice.size[1] || phase(x, y) == 0 ||
            phase(otherX, otherY) == 0)
            continue;
          const double det = along[0] * o.step[1] - along[1] * o.step[0];
          const Place to{ static_cast<double>(x) - a[0], static_cast<double>(y) - a[1] };
          const double onLine = (to[0] * o.step[1] - to[1] * o.step[0]) / det;
          const double onBond = (to[0] * along[1] - to[1] * along[0]) / det;
          if (std::abs(det) < 1e-14 || onLine < 0 || onLine > 1 || onBond < 0 || onBond > 1)
            continue;
          const auto p = static_cast<std::uint8_t>(phase(x, y));
          const auto q = static_cast<std::uint8_t>(phase(otherX, otherY));
          bonds.push_back({ { x, y, 0 }, o.step, static_cast<std::int64_t>(k) + 1, 0.1 * static_cast<double>(k + 1),
            { std::min(p, q), std::max(p, q) }, false });
        }
  }
  return canonical(std::move(bonds)); // one that two pieces cross, once
}

inline Lattice square(std::int64_t n)
{
  return makeLattice(n, n, 1, 2, 1e-3);
}

/// What the paths of an ideal crack are.
inline CrackPaths pathsOf(const Lattice& lattice, double horizon, std::vector<CutBond> bonds)
{
  return findCrackPaths(lattice, horizon, canonical(std::move(bonds)));
}

inline double lengthOf(const Line& line)
{
  double sum = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    sum += std::hypot(line[i + 1][0] - line[i][0], line[i + 1][1] - line[i][1]);
  return sum;
}

/// Distance of a place from a line.
inline double distance(const Place& p, const Line& line)
{
  double least = 1e300;
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
  {
    const Place along{ line[i + 1][0] - line[i][0], line[i + 1][1] - line[i][1] };
    const double part = std::clamp(
      ((p[0] - line[i][0]) * along[0] + (p[1] - line[i][1]) * along[1]) / (along[0] * along[0] + along[1] * along[1]),
      0.0, 1.0);
    least = std::min(least, std::hypot(p[0] - line[i][0] - part * along[0], p[1] - line[i][1] - part * along[1]));
  }
  return least;
}

inline double farthest(const CrackPath& path, const Line& line)
{
  double most = 0;
  for (const CrackPoint& p : path.points)
    most = std::max(most, distance(p.place, line));
  return most;
}

/// Difference of two axial directions [rad].
inline double turn(double a, double b)
{
  return std::abs(std::remainder(a - b, pi));
}

/// A circle, closed, or a part of it.
inline Line arc(const Place& centre, double radius, double from = 0, double to = 2 * pi, int pieces = 2000)
{
  Line line;
  for (int i = 0; i <= pieces; ++i)
  {
    const double t = from + (to - from) * i / pieces;
    line.push_back({ centre[0] + radius * std::cos(t), centre[1] + radius * std::sin(t) });
  }
  return line;
}

/// Two waves from side to side.
inline Line sine(std::int64_t n, double amplitude)
{
  Line line;
  constexpr int pieces = 4000;
  const auto size = static_cast<double>(n);
  for (int i = 0; i <= pieces; ++i)
  {
    const double part = static_cast<double>(i) / pieces;
    line.push_back({ size * part - 0.5, size / 2 + 0.2 + amplitude * std::sin(4 * pi * part) });
  }
  return line;
}

} // namespace lamella::test
