// Energies and volumes of material points, and what is done to all of their velocities.
#include "mpm/FusedStep.h"
#include "mpm/PointDynamics.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lamella::mpm
{
namespace
{

template <int Dim>
bool hasAffine(const PointDynamicsOptions<Dim>& options)
{
  return options.transfer == Transfer::Apic && options.shape == Shape::QuadraticSpline;
}

/// What a point's kinetic energy is half its mass times, what its affine velocity holds included.
template <int Dim>
double velocitySquared(const BackgroundGrid<Dim>& grid, const Vector<Dim>& v, const Matrix<Dim>& affine)
{
  double squares = 0;
  for (int a = 0; a < Dim; ++a)
  {
    squares += v[a] * v[a];
    for (int b = 0; b < Dim; ++b)
    {
      const double c = affine(a, b) * grid.axis(b).spacing;
      squares += c * c / 4;
    }
  }
  return squares;
}

} // namespace

template <int Dim>
double PointDynamics<Dim>::gravityMoment() const
{
  double sum = 0;
  for (int a = 0; a < Dim; ++a)
    for (std::size_t p = 0; p < points_.count() && options_.gravity[a] != 0; ++p)
      sum += options_.gravity[a] * points_.column(MaterialPoints<Dim>::masses)[p] * points_.column(a)[p];
  return sum;
}

template <int Dim>
template <class F>
double PointDynamics<Dim>::sumOver(F&& f) const
{
  constexpr std::int64_t block = 4096;
  const auto count = static_cast<std::int64_t>(points_.count());
  std::vector<double> sums(static_cast<std::size_t>((count + block - 1) / block));
#pragma omp parallel for schedule(static) if (sums.size() > 1)
  for (std::int64_t b = 0; b < static_cast<std::int64_t>(sums.size()); ++b)
  {
    double sum = 0;
    for (std::int64_t p = b * block; p < std::min(count, (b + 1) * block); ++p)
      sum += f(static_cast<std::size_t>(p));
    sums[static_cast<std::size_t>(b)] = sum;
  }
  double total = 0;
  for (const double sum : sums)
    total += sum;
  return options_.comm.sum(total);
}

template <int Dim>
double PointDynamics<Dim>::kineticEnergy() const
{
  using Points = MaterialPoints<Dim>;
  if (looked_.kineticAt == step_)
    return looked_.kinetic;
  const auto mass = points_.column(Points::masses);
  const bool withAffine = hasAffine(options_);
  return sumOver(
    [&](std::size_t p)
    {
      const Matrix<Dim> c = withAffine ? affine(p) : Matrix<Dim>{};
      return mass[p] * velocitySquared(grid_, points_.vector(Points::velocities, p), c) / 2;
    });
}

template <int Dim>
double PointDynamics<Dim>::elasticEnergy() const
{
  using Points = MaterialPoints<Dim>;
  if (looked_.elasticAt == step_)
    return looked_.elastic;
  return sumOver(
    [&](std::size_t p)
    {
      return points_.column(Points::volumes)[p] *
        law_->energy(points_.phase()[p], points_.matrix(Points::deformations, p), points_.vector(Points::axes, p),
          points_.memory(p).data());
    });
}

template <int Dim>
double PointDynamics<Dim>::plasticWork() const
{
  if (law_->history() == 0)
    return 0;
  return sumOver([&](std::size_t p)
    { return points_.column(MaterialPoints<Dim>::volumes)[p] * law_->plasticWork(points_.memory(p).data()); });
}

template <int Dim>
std::array<double, 2> PointDynamics<Dim>::volumes() const
{
  using Points = MaterialPoints<Dim>;
  const auto volume = points_.column(Points::volumes);
  return { sumOver(
             [&](std::size_t p)
             {
               return volume[p] * determinant(points_.matrix(Points::deformations, p)) *
                 law_->thirdStretch(points_.memory(p).data());
             }),
    sumOver([&](std::size_t p) { return volume[p]; }) };
}

template <int Dim>
double PointDynamics<Dim>::changeVelocities(double keep, double add, int axis, double rate, double still)
{
  using Points = MaterialPoints<Dim>;
  const auto x = points_.column(axis);
  const auto mass = points_.column(Points::masses);
  const bool withAffine = hasAffine(options_);
  const double more = (1 - keep + add) * rate;
  const double gained = sumOver( // C, which is not at hand, is found once
    [&](std::size_t p)
    {
      Vector<Dim> v = points_.vector(Points::velocities, p);
      Matrix<Dim> c = withAffine ? affine(p) : Matrix<Dim>{};
      const double before = velocitySquared(grid_, v, c);
      for (int a = 0; a < Dim; ++a)
        v[a] = keep * v[a] + (a == axis ? more * (x[p] - still) : 0);
      for (int i = 0; i < Dim * Dim; ++i)
        c.m[i] = keep * c.m[i] + (withAffine && i == axis * (Dim + 1) ? more : 0);
      return mass[p] * (velocitySquared(grid_, v, c) - before) / 2;
    });
  for (int a = 0; a < Dim; ++a)
  {
    const double own = a == axis ? rate : 0;
    auto v = points_.column(Points::velocities + a);
#pragma omp parallel for simd schedule(static) if (points_.count() > 2000)
    for (std::size_t p = 0; p < points_.count(); ++p)
      v[p] = keep * v[p] + (1 - keep + add) * own * (x[p] - still);
  }
  looked_.kineticAt = -1;
  if (fused_)
    fused_->change(keep, axis, more, still);
  else
    points_.changeAffines(keep, axis, more);
  return gained;
}

template <int Dim>
void PointDynamics<Dim>::scaleVelocities(double factor)
{
  supplied_ += changeVelocities(factor, 0, 0, 0, 0);
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side)
      walls_(a, side).velocity *= factor;
}

template <int Dim>
void PointDynamics<Dim>::addStretching(int axis, double rate, double still)
{
  supplied_ += changeVelocities(1, 1, axis, rate, still);
}

template <int Dim>
void PointDynamics<Dim>::calm(double factor, int axis, double rate, double still)
{
  changeVelocities(factor, 0, axis, rate, still);
}

template <int Dim>
PointEnergies PointDynamics<Dim>::energies() const
{
  std::array<double, 2> moments{ gravityMoment(), startMoment_ };
  options_.comm.sum(moments);
  return { kineticEnergy(), elasticEnergy(), supplied_ + moments[0] - moments[1], initial_, plasticWork() };
}

template double PointDynamics<2>::gravityMoment() const;
template double PointDynamics<3>::gravityMoment() const;
template double PointDynamics<2>::kineticEnergy() const;
template double PointDynamics<3>::kineticEnergy() const;
template double PointDynamics<2>::elasticEnergy() const;
template double PointDynamics<3>::elasticEnergy() const;
template double PointDynamics<2>::plasticWork() const;
template double PointDynamics<3>::plasticWork() const;
template std::array<double, 2> PointDynamics<2>::volumes() const;
template std::array<double, 2> PointDynamics<3>::volumes() const;
template void PointDynamics<2>::scaleVelocities(double);
template void PointDynamics<3>::scaleVelocities(double);
template void PointDynamics<2>::addStretching(int, double, double);
template void PointDynamics<3>::addStretching(int, double, double);
template void PointDynamics<2>::calm(double, int, double, double);
template void PointDynamics<3>::calm(double, int, double, double);
template double PointDynamics<2>::changeVelocities(double, double, int, double, double);
template double PointDynamics<3>::changeVelocities(double, double, int, double, double);
template PointEnergies PointDynamics<2>::energies() const;
template PointEnergies PointDynamics<3>::energies() const;

} // namespace lamella::mpm
