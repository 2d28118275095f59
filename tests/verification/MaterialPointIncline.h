// Blocks on an incline: Coulomb's law, exact.
#pragma once

#include "MaterialPointSamples.h"

#include "core/Communicator.h"
#include "mpm/BodyContact.h"
#include "mpm/Isotropic.h"
#include "mpm/WallMaterial.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>

namespace lamella::mpm::samples
{

inline constexpr double weight = 1e-3; // g over E/(ρ L), L the width: strains of half that
inline constexpr double tangent = 0.5; // of the incline

/// Acceleration of a block on an incline [m/s²].
inline double sliding(double friction)
{
  const double root = std::sqrt(1 + tangent * tangent);
  return weight * (tangent - friction) / root;
}

template <int Dim>
std::array<double, Isotropic::constants> constants()
{
  return isotropicConstants<Dim>({ 1, 0.3, 1 });
}

/// Mean of a column over the points of a phase, of all ranks.
template <int Dim>
double mean(const PointDynamics<Dim>& body, int column, int phase = 1, const Communicator& comm = Communicator())
{
  double sum = 0;
  double mass = 0;
  for (std::size_t p = 0; p < body.points().count(); ++p)
    if (body.points().phase()[p] == phase)
    {
      const double m = body.points().column(MaterialPoints<Dim>::masses)[p];
      sum += m * body.points().column(column)[p];
      mass += m;
    }
  return comm.sum(sum) / comm.sum(mass);
}

/// What becomes of a block on an incline.
struct Incline
{
  int cells = 8;         ///< along the slope, of a width of 1
  double friction = 0.3; ///< of what it lies on
  bool fused = true;
  bool onBody = false; ///< on a slab as thick as itself, of another phase, that a platen holds; else on the platen
  bool sheared = true; ///< by its weight from the start on, as far as friction bears it
  int periods = 1;     ///< widths along the slope
};

inline constexpr double thick = 0.5;

/// A block as long as the period along x (and z), half as thick, on y = 0 or a slab; gravity is tilted.
template <int Dim>
std::unique_ptr<PointDynamics<Dim>> blockOn(const Incline& is, const Communicator& comm = Communicator())
{
  const double h = 1.0 / is.cells;
  std::array<int, Dim> size;
  size.fill(is.cells);
  size[0] *= is.periods;
  if (!is.onBody)
    size[1] = is.cells / 2;
  if (Dim == 3)
    size[Dim - 1] = 4;
  MaterialPoints<Dim> points = filled<Dim>(size, h, 2, 1.0);
  const auto c = constants<Dim>();
  const double down = weight / std::sqrt(1 + tangent * tangent);
  const double top = is.onBody ? 2 * thick : thick;
  for (std::size_t p = 0; p < points.count(); ++p)
  {
    const double y = points.column(1)[p];
    points.phase()[p] = is.onBody && y < thick ? 0 : 1;
    Matrix<Dim> F = Matrix<Dim>::identity();
    F(1, 1) -= down * (top - y) / (c[0] + 2 * c[1]);
    if (is.sheared)
      F(0, 1) += tangent * down * (top - y) / c[1];
    points.setMatrix(MaterialPoints<Dim>::deformations, p, F);
  }
  PointDynamicsOptions<Dim> options;
  options.spacing = h;
  options.fused = is.fused;
  options.comm = comm;
  options.gravity[0] = tangent * down;
  options.gravity[1] = -down;
  options.sides[0] = { periodicAt(0), periodicAt(is.periods) };
  if (Dim == 3)
    options.sides[Dim - 1] = { periodicAt(0), periodicAt(4 * h) };
  options.sides[1] = { wallAt(0), Side{} };
  if (is.onBody)
  {
    options.sides[1][0].sticks = true;
    options.bodies = { 2, { 0, 1 }, { 0, is.friction, is.friction, 0 } };
  }
  else
    options.sides[1][0].friction = is.friction;
  return std::make_unique<PointDynamics<Dim>>(shareOf(points, comm), makeLaw<Dim, Isotropic>({ c }), options);
}

// From one look to the next momentum along the slope grows by that part of the weight, less the coefficient times what
// presses: Δp_x = m g Δt sin θ − μ (m g Δt cos θ + Δp_y), however the block vibrates, as long as all of it slides and
// is pressed on. Velocities are those of half a step ago. At the start it sticks for a step or two.
template <int Dim>
void slidesByCoulomb(const Incline& is, const Communicator& comm = Communicator())
{
  const auto body = blockOn<Dim>(is, comm);
  ASSERT_EQ(body->fused(), is.fused);
  std::array<double, 3> before{};
  for (int look = 0; look < 5; ++look)
  {
    body->advance(100);
    const std::array<double, 3> now{ body->time() - body->step() / 2,
      mean(*body, MaterialPoints<Dim>::velocities, 1, comm),
      mean(*body, MaterialPoints<Dim>::velocities + 1, 1, comm) };
    // round-off, over the momentum that the weight brought
    if (look > 0)
      EXPECT_NEAR(now[1] - before[1], sliding(is.friction) * (now[0] - before[0]) - is.friction * (now[2] - before[2]),
        1e-11 * weight * now[0]);
    before = now;
  }
  // its vibration, and what it sticks for at the start: a thousandth of the difference of two large terms
  EXPECT_NEAR(before[1], sliding(is.friction) * before[0], 1e-4 * weight * before[0]);
}

} // namespace lamella::mpm::samples
