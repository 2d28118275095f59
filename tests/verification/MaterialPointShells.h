// Bodies that exercise every part of a step, to compare one way of going it with another.
#pragma once

#include "MaterialPointSamples.h"

#include "mpm/Isotropic.h"
#include "mpm/Orthotropic.h"
#include "mpm/WallMaterial.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>

namespace lamella::mpm::samples
{

enum class Scene
{
  Straight, ///< straight sides, a platen that sticks and moves by some cells
  Open,     ///< no sides, a pulling platen
  Periodic, ///< a period that grows, a platen
  Torus     ///< all periods; the first grows, the last finds how fast it has to
};

/// Laws that kernels are compiled for, of two phases.
template <int Dim>
std::shared_ptr<const PointLaw<Dim>> lawOf(LawKind kind)
{
  switch (kind)
  {
    case LawKind::Isotropic:
      return makeLaw<Dim, Isotropic>(
        { isotropicConstants<Dim>({ 1, 0.3, 1 }), isotropicConstants<Dim>({ 0.7, 0.2, 1 }) });
    case LawKind::Hencky: // both yield at strains that the shell comes to, but Hill's second phase
      return makeLaw<Dim, Hencky>(
        { henckyConstants({ { 1, 0.3, 1 }, 0.02, 0.1 }), henckyConstants({ { 0.7, 0.2, 1 }, 0.01, 0 }) });
    case LawKind::Hill:
      return makeLaw<Dim, Hill>({ hillConstants({ { 1, 0.8, 0.3, 0.3, {}, 1 }, 0.02, 0.015, 0.01, 0.1 }),
        hillConstants({ { 1.2, 0.5, 0.2, 0.3, {}, 1 }, std::numeric_limits<double>::infinity() }) });
    case LawKind::Orthotropic:
      return makeLaw<Dim, Orthotropic>({ orthotropicConstants<Dim>({ 1, 0.8, 0.3, 0.3, {}, 1 }),
        orthotropicConstants<Dim>({ 1.2, 0.5, 0.2, 0.3, {}, 1 }) });
    default:
      return makeLaw<Dim, NeoHookean>({ { 0.3, 0.5 }, { 0.6, 0.4 } });
  }
}

/// A shell with sheared, swirling start, under gravity, so that points change cells everywhere; two phases.
/// On several ranks each gives some of the points, far from where they belong.
template <int Dim>
std::unique_ptr<PointDynamics<Dim>> shell(LawKind law, Scene scene, bool fused, int cells,
  const Communicator& comm = Communicator(), Precision precision = Precision::Double)
{
  const double h = 1.0 / cells;
  std::array<int, Dim> size;
  size.fill(cells);
  const std::shared_ptr<const PointLaw<Dim>> made = lawOf<Dim>(law);
  MaterialPoints<Dim> points = filled<Dim>(
    size, h, 2, 1.0,
    [&](const Place<Dim>& x)
    {
      double square = 0;
      for (int a = 0; a < Dim; ++a)
        square += (x[a] - 0.5) * (x[a] - 0.5);
      return scene == Scene::Periodic || scene == Scene::Torus || (square > 0.04 && square < 0.25);
    },
    made->history());
  for (std::size_t p = 0; p < points.count(); ++p)
  {
    points.phase()[p] = points.column(0)[p] < 0.4 ? 0 : 1;
    Vector<Dim> axis{}; // turning with the place
    axis[0] = std::cos(5 * points.column(1)[p]);
    axis[1] = std::sin(5 * points.column(1)[p]);
    points.setVector(MaterialPoints<Dim>::axes, p, axis);
  }
  setVelocities<Dim>(points,
    [](const Place<Dim>& x)
    {
      Vector<Dim> v{};
      v[0] = 0.2 * std::sin(7 * x[1]);
      v[1] = -0.3 * x[1] + 0.1 * std::sin(9 * x[0]);
      return v;
    });
  PointDynamicsOptions<Dim> options;
  options.spacing = h;
  options.fused = fused;
  options.precision = precision;
  options.comm = comm;
  options.gravity[0] = 0.3;
  options.gravity[1] = -0.1;
  for (auto& sides : options.sides)
    sides = { wallAt(0), wallAt(1) };
  switch (scene)
  {
    case Scene::Straight:
      options.sides[0] = { straightAt(0), straightAt(1) };
      options.sides[1][1] = wallAt(1, -0.3);
      options.sides[1][1].sticks = true;
      break;
    case Scene::Open:
      options.sides[0] = { Side{}, Side{} };
      options.sides[1] = { Side{}, wallAt(1, 0.1) };
      break;
    case Scene::Periodic:
      options.sides[0] = { periodicAt(0), periodicAt(1) };
      options.sides[0][1].velocity = 0.1;
      options.sides[1][1] = wallAt(1, -0.2);
      break;
    case Scene::Torus:
      for (auto& sides : options.sides)
        sides = { periodicAt(0), periodicAt(1) };
      options.sides[0][1].velocity = 0.1;
      options.sides[Dim - 1][1].straight = true;
      break;
  }
  return std::make_unique<PointDynamics<Dim>>(shareOf(points, comm), made, options);
}

} // namespace lamella::mpm::samples
