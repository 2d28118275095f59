#pragma once

#include "MaterialPointSamples.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace lamella::mpm::samples
{

struct Method
{
  Shape shape = Shape::QuadraticSpline;
  Transfer transfer = Transfer::Apic;
  MassMatrix mass = MassMatrix::Lumped;
  StressUpdate update = StressUpdate::Last;
  Precision precision = Precision::Double;
};

inline void take(PointDynamicsOptions<2>& options, const Method& method)
{
  options.shape = method.shape;
  options.transfer = method.transfer;
  options.mass = method.mass;
  options.update = method.update;
  options.precision = method.precision;
}

struct BarResult
{
  double error = 0;  ///< of the mean velocity over two periods, root mean square over its amplitude
  double energy = 0; ///< at the end over that at the start
};

/// Bar fixed at one end, free at the other, E = ρ = L = 1, v(x, 0) = V₀ sin bx, b = π/2: mean velocity V₀/b cos bt. The
/// amplitude of 1e-4 keeps it linear to 1e-4.
inline BarResult vibrate(int cells, const Method& method)
{
  using std::numbers::pi;
  using Points = MaterialPoints<2>;
  const double h = 1.0 / cells;
  const double b = pi / 2;
  const double amplitude = 1e-4;
  Points points = filled<2>({ cells, 3 }, h, 2, 1.0);
  setVelocities<2>(points, [&](const Place<2>& x) { return Vector<2>{ amplitude * std::sin(b * x[0]), 0 }; });
  PointDynamicsOptions<2> options;
  options.spacing = h;
  options.share = 0.4;
  options.sides = { { { wallAt(0), Side{} }, { wallAt(0), wallAt(3 * h) } } };
  take(options, method);
  PointDynamics<2> bar(std::move(points), neoHookean<2>(1, 0), options);
  double squares = 0;
  std::int64_t count = 0;
  while (bar.time() < 2 * 2 * pi / b)
  {
    bar.advance(1);
    const double t = bar.time() - bar.step() / 2; // velocities are half a step old
    double mean = 0;
    for (const double v : bar.points().column(Points::velocities))
      mean += v / static_cast<double>(bar.points().count());
    squares += std::pow(mean * b / amplitude - std::cos(b * t), 2);
    ++count;
  }
  const PointEnergies e = bar.energies();
  return { std::sqrt(squares / static_cast<double>(count)), (e.kinetic + e.elastic) / e.initial };
}

/// Axis-aligned manufactured solution on the unit square, E = ρ = c = 1, ν = 0.3, u = A sin 2πX sin cπt, v with a phase
/// of π. @return displacement's root mean square error at t = ½, where it is largest, over A
inline double manufactured(int cells, double amplitude, const Method& method, int perNode = 2)
{
  using std::numbers::pi;
  const double h = 1.0 / cells;
  const double lambda = 0.3 / (1.3 * 0.4);
  const double mu = 1 / 2.6;
  MaterialPoints<2> points = filled<2>({ cells, cells }, h, perNode, 1.0);
  std::vector<Vector<2>> start;
  for (std::size_t p = 0; p < points.count(); ++p)
    start.push_back(points.vector(MaterialPoints<2>::positions, p));
  setVelocities<2>(points,
    [&](const Place<2>& x) {
      return Vector<2>{ amplitude * pi * std::sin(2 * pi * x[0]), -amplitude * pi * std::sin(2 * pi * x[1]) };
    });
  PointDynamicsOptions<2> options;
  options.spacing = h;
  options.share = 0.5;
  options.sides = { { { wallAt(0), wallAt(1) }, { wallAt(0), wallAt(1) } } };
  options.acceleration = [&](std::uint32_t id, double t)
  {
    Vector<2> u;
    Vector<2> F;
    for (int a = 0; a < 2; ++a)
    {
      const double s = std::sin(pi * t + (a == 0 ? 0 : pi));
      u[a] = amplitude * std::sin(2 * pi * start[id][a]) * s;
      F[a] = 1 + 2 * pi * amplitude * std::cos(2 * pi * start[id][a]) * s;
    }
    Vector<2> b;
    for (int a = 0; a < 2; ++a)
      b[a] = pi * pi * u[a] * (4 * mu - 1 - 4 * (lambda * (std::log(F[0] * F[1]) - 1) - mu) / (F[a] * F[a]));
    return b;
  };
  take(options, method);
  PointDynamics<2> body(std::move(points), neoHookean<2>(1, 0.3), options);
  body.advanceTo(0.5);
  double squares = 0;
  for (std::size_t p = 0; p < body.points().count(); ++p)
  {
    const Vector<2>& from = start[body.points().id()[p]];
    for (int a = 0; a < 2; ++a)
    {
      const double exact = from[a] + amplitude * std::sin(2 * pi * from[a]) * (a == 0 ? 1 : -1);
      squares += std::pow(body.points().column(a)[p] - exact, 2);
    }
  }
  return std::sqrt(squares / static_cast<double>(body.points().count())) / amplitude;
}

} // namespace lamella::mpm::samples
