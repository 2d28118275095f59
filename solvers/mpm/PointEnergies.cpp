// Energies and volumes of material points, and what is done to all of their velocities.
#include "mpm/FusedStep.h"
#include "mpm/PointDynamics.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lamella::mpm
{

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
  const auto mass = points_.column(Points::masses);
  const bool affine = options_.transfer == Transfer::Apic && options_.shape == Shape::QuadraticSpline;
  return sumOver(
    [&](std::size_t p)
    {
      const Matrix<Dim> C = affine ? this->affine(p) : Matrix<Dim>{};
      double squares = 0;
      for (int a = 0; a < Dim; ++a)
      {
        const double v = points_.column(Points::velocities + a)[p];
        squares += v * v;
        for (int b = 0; b < Dim && affine; ++b)
        {
          const double c = C(a, b) * grid_.axis(b).spacing;
          squares += c * c / 4;
        }
      }
      return mass[p] * squares / 2;
    });
}

template <int Dim>
double PointDynamics<Dim>::elasticEnergy() const
{
  using Points = MaterialPoints<Dim>;
  return sumOver(
    [&](std::size_t p)
    {
      return points_.column(Points::volumes)[p] *
        law_->energy(points_.phase()[p], points_.matrix(Points::deformations, p), points_.vector(Points::axes, p),
          points_.memory(p).data());
    });
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
  const double before = kineticEnergy();
  const auto x = points_.column(axis);
  for (int a = 0; a < Dim; ++a)
  {
    const double own = a == axis ? rate : 0;
    auto v = points_.column(Points::velocities + a);
#pragma omp parallel for simd schedule(static) if (points_.count() > 2000)
    for (std::size_t p = 0; p < points_.count(); ++p)
      v[p] = keep * v[p] + (1 - keep + add) * own * (x[p] - still);
  }
  if (fused_)
    fused_->change(keep, axis, (1 - keep + add) * rate, still);
  else
    points_.changeAffines(keep, axis, (1 - keep + add) * rate);
  return kineticEnergy() - before;
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
  return { kineticEnergy(), elasticEnergy(), supplied_ + moments[0] - moments[1], initial_ };
}

template double PointDynamics<2>::gravityMoment() const;
template double PointDynamics<3>::gravityMoment() const;
template double PointDynamics<2>::kineticEnergy() const;
template double PointDynamics<3>::kineticEnergy() const;
template double PointDynamics<2>::elasticEnergy() const;
template double PointDynamics<3>::elasticEnergy() const;
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
