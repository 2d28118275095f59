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
};

inline void take(PointDynamicsOptions<2>& options, const Method& method)
{
  options.shape = method.shape;
  options.transfer = method.transfer;
  options.mass = method.mass;
  options.update = method.update;
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
