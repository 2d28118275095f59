// Laws of material points: what every elastic law must obey, and closed forms.
#include "PointChance.h"

#include "core/Error.h"
#include "mpm/MaterialPoints.h"
#include "mpm/NeoHookean.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace
{

using namespace lamella;
using namespace lamella::mpm;
using samples::Chance;
using samples::plain;

constexpr OrthotropicMaterial wall{ .along = 8e9,
  .across = 2e9,
  .poissonsRatio = 0.35,
  .acrossRatio = 0.2,
  .shearModulus = 0.9e9 };

template <int Dim>
double largest(const Matrix<Dim>& m)
{
  double most = 0;
  for (const double v : m.m)
    most = std::max(most, std::abs(v));
  return most;
}

template <int Dim>
Matrix<Dim> times(double s, Matrix<Dim> m)
{
  for (double& v : m.m)
    v *= s;
  return m;
}

template <int Dim>
double difference(Matrix<Dim> m, const Matrix<Dim>& n)
{
  for (int i = 0; i < Dim * Dim; ++i)
    m.m[i] -= n.m[i];
  return largest(m);
}

template <int Dim>
Vector<Dim> image(const Matrix<Dim>& m, const Vector<Dim>& v)
{
  Vector<Dim> r{};
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      r[i] += m(i, j) * v[j];
  return r;
}

/// ψ with F changed by t a⊗(Fᵀ n).
template <int Dim, class Law>
double energyAlong(
  const Law& law, const Matrix<Dim>& f, const Vector<Dim>& axis, const Vector<Dim>& a, const Vector<Dim>& n, double t)
{
  Matrix<Dim> g = f;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      for (int k = 0; k < Dim; ++k)
        g(i, j) += t * a[i] * n[k] * f(k, j);
  return law.energy(g, axis);
}

/// A law with its constants; one with a memory at its start.
template <class Law, int Dim>
struct Material
{
  std::array<double, Law::constants> c;

  Matrix<Dim> kirchhoff(const Matrix<Dim>& f, const Vector<Dim>& axis) const
  {
    if constexpr (Law::history > 0)
      return Law::kirchhoff(c.data(), f, axis, fresh);
    else
      return Law::kirchhoff(c.data(), f, axis);
  }
  double energy(const Matrix<Dim>& f, const Vector<Dim>& axis) const
  {
    if constexpr (Law::history > 0)
      return Law::energy(c.data(), f, axis, fresh);
    else
      return Law::energy(c.data(), f, axis);
  }
  double stiffness(const Matrix<Dim>& f, const Vector<Dim>& axis) const
  {
    if constexpr (Law::history > 0)
      return Law::stiffness(c.data(), f, axis, fresh);
    else
      return Law::stiffness(c.data(), f, axis);
  }
  Matrix<Dim> hooke(const Matrix<Dim>& e, const Vector<Dim>& axis) const { return Law::hooke(c.data(), e, axis); }

  static constexpr double fresh[MaterialPoints<Dim>::mostHistory] = {};
};

template <int Dim>
Material<Isotropic, Dim> isotropic(const IsotropicMaterial& m, PlaneState state = PlaneState::Stress)
{
  return { isotropicConstants<Dim>(m, state) };
}

template <int Dim>
Material<Orthotropic, Dim> orthotropic(const OrthotropicMaterial& m, PlaneState state = PlaneState::Stress)
{
  return { orthotropicConstants<Dim>(m, state) };
}

template <int Dim>
Material<Hencky, Dim> hencky(
  const IsotropicMaterial& m, double yieldStress = std::numeric_limits<double>::infinity(), double hardening = 0)
{
  return { henckyConstants({ m, yieldStress, hardening }) };
}

template <int Dim>
Material<Hill, Dim> hill(const OrthotropicMaterial& m)
{
  return { hillConstants({ m, std::numeric_limits<double>::infinity() }) };
}

template <int Dim, class Test>
void everyLaw(const Test& test)
{
  for (const PlaneState state : { PlaneState::Stress, PlaneState::Strain })
  {
    SCOPED_TRACE(state == PlaneState::Stress ? "plane stress" : "plane strain");
    test(isotropic<Dim>(plain, state));
    test(orthotropic<Dim>(wall, state));
    if (Dim == 3)
      break;
  }
  test(hencky<Dim>(plain));
  test(hill<Dim>(wall));
}

template <int Dim>
void stressIsTheDerivativeOfEnergy()
{
  everyLaw<Dim>(
    [](const auto& law)
    {
      Chance<Dim> chance;
      for (int trial = 0; trial < 200; ++trial)
      {
        const auto f = chance.deformation(0.3, 1.6);
        const auto axis = chance.direction();
        const auto a = chance.direction();
        const auto n = chance.direction();
        // dψ along t a⊗(Fᵀ n) is a·τ n; differences of fourth order leave 1e-13 of truncation and 1e-12 of round-off
        const double h = 1e-3;
        const auto at = [&](double t) { return energyAlong(law, f, axis, a, n, t); };
        const double slope = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
        const auto tau = law.kirchhoff(f, axis);
        const auto force = image(tau, n);
        double work = 0;
        for (int i = 0; i < Dim; ++i)
          work += a[i] * force[i];
        EXPECT_NEAR(slope, work, 1e-7 * std::max(largest(tau), 1e9)) << trial;
        for (int i = 0; i < Dim; ++i)
          for (int j = 0; j < i; ++j)
            EXPECT_NEAR(tau(i, j), tau(j, i), 1e-12 * std::max(largest(tau), 1e9));
      }
    });
}

TEST(PointLaws, StressIsTheDerivativeOfEnergy)
{
  stressIsTheDerivativeOfEnergy<2>();
  stressIsTheDerivativeOfEnergy<3>();
}

template <int Dim>
void rotationsChangeNothing()
{
  everyLaw<Dim>(
    [](const auto& law)
    {
      Chance<Dim> chance;
      for (int trial = 0; trial < 50; ++trial)
      {
        const auto f = chance.deformation(0.2, 2);
        const auto axis = chance.direction();
        const auto q = chance.turn();
        const auto tau = law.kirchhoff(f, axis);
        const auto turned = law.kirchhoff(product(q, f), axis);
        const double scale = std::max(largest(tau), 1e9);
        EXPECT_LT(difference(turned, productTransposed(product(q, tau), q)), 1e-11 * scale);
        EXPECT_NEAR(law.energy(product(q, f), axis), law.energy(f, axis), 1e-12 * scale);
        // the material turned with its axis before it is strained
        EXPECT_LT(difference(law.kirchhoff(productTransposed(f, q), image(q, axis)), tau), 1e-11 * scale);
        // spin alone: no stress beyond round-off
        EXPECT_LT(largest(law.kirchhoff(q, axis)), 1e-14 * 8e9 * 10);
      }
    });
}

TEST(PointLaws, RotationsChangeNothing)
{
  rotationsChangeNothing<2>();
  rotationsChangeNothing<3>();
}

// Second derivative of the energy along a wave is ρ₀ c²: never above what the time step is taken from.
template <int Dim>
void wavesAreNoFasterThanTheBound()
{
  everyLaw<Dim>(
    [](const auto& law)
    {
      Chance<Dim> chance;
      for (int trial = 0; trial < 2000; ++trial)
      {
        const auto f = chance.deformation(0.1, 1.6);
        const auto axis = chance.direction();
        const auto a = trial % 2 == 0 ? chance.direction() : axis;
        const auto n = trial % 3 == 0 ? chance.direction() : a;
        const double h = 1e-3;
        const auto at = [&](double t) { return energyAlong(law, f, axis, a, n, t); };
        const double second = (at(h) - 2 * at(0) + at(-h)) / (h * h);
        // 1e-5: of the difference
        EXPECT_LE(second, law.stiffness(f, axis) * (1 + 1e-5));
      }
      // and no more than the fastest wave where nothing is strained: along the axis, which is the stiffest direction
      const auto one = Matrix<Dim>::identity();
      const auto axis = chance.direction();
      const double h = 1e-3;
      const auto at = [&](double t) { return energyAlong(law, one, axis, axis, axis, t); };
      EXPECT_NEAR((at(h) - 2 * at(0) + at(-h)) / (h * h), law.stiffness(one, axis), 1e-5 * law.stiffness(one, axis));
    });
}

TEST(PointLaws, WavesAreNoFasterThanTheBound)
{
  wavesAreNoFasterThanTheBound<2>();
  wavesAreNoFasterThanTheBound<3>();
}

// Small strains: Hooke's law of the constants given, from their compliance, in the material's axes.
TEST(PointLaws, SmallStrainsObeyHooke)
{
  const double s11 = 1 / wall.along;
  const double s12 = -wall.poissonsRatio / wall.along;
  const double s22 = 1 / wall.across;
  const double s23 = -wall.acrossRatio / wall.across;
  Chance<3> chance;
  const auto axis = chance.direction();
  const auto law = orthotropic<3>(wall);
  // stress 1 MPa along the axis, then along a direction across it, then shear between the two
  const Matrix<3> frame = [&]
  {
    Matrix<3> r = chance.turn();
    for (int i = 0; i < 3; ++i)
      r(i, 0) = axis[i];
    double along = 0;
    for (int i = 0; i < 3; ++i)
      along += r(i, 1) * axis[i];
    double length = 0;
    for (int i = 0; i < 3; ++i)
    {
      r(i, 1) -= along * axis[i];
      length += r(i, 1) * r(i, 1);
    }
    for (int i = 0; i < 3; ++i)
      r(i, 1) /= std::sqrt(length);
    const auto c = cofactor(r); // the third column as the cross product of the first two
    for (int i = 0; i < 3; ++i)
      r(i, 2) = c(i, 2);
    return r;
  }();
  const auto turned = [&](const Matrix<3>& m) { return productTransposed(product(frame, m), frame); };
  const double p = 1e6;
  struct
  {
    Matrix<3> strain, stress;
  } const table[] = {
    { { { s11 * p, 0, 0, 0, s12 * p, 0, 0, 0, s12 * p } }, { { p, 0, 0, 0, 0, 0, 0, 0, 0 } } },
    { { { s12 * p, 0, 0, 0, s22 * p, 0, 0, 0, s23 * p } }, { { 0, 0, 0, 0, p, 0, 0, 0, 0 } } },
    { { { 0, p / 2 / 0.9e9, 0, p / 2 / 0.9e9, 0, 0, 0, 0, 0 } }, { { 0, p, 0, p, 0, 0, 0, 0, 0 } } },
    { { { 0, 0, 0, 0, 0, p * (s22 - s23), 0, p * (s22 - s23), 0 } }, { { 0, 0, 0, 0, 0, p, 0, p, 0 } } },
  };
  for (const auto& row : table)
  {
    EXPECT_LT(difference(law.hooke(turned(row.strain), axis), turned(row.stress)), 1e-9 * p);
    Matrix<3> f = times(1e-4, turned(row.strain));
    const double small = 1e-4 * p;
    for (int i = 0; i < 3; ++i)
      f(i, i) += 1;
    // strains of 1e-7 to second order
    EXPECT_LT(difference(law.kirchhoff(f, axis), times(1e-4, turned(row.stress))), 1e-6 * small);
  }
}

TEST(PointLaws, PlaneStatesAreThoseOfSpace)
{
  Chance<2> chance;
  const auto axis = chance.direction();
  const Vector<3> axisInSpace{ { axis[0], axis[1], 0 } };
  const Matrix<2> e{ { 1e-3, -4e-4, -4e-4, 2e-3 } };
  const auto check = [&](const auto& stress, const auto& strain, const auto& space)
  {
    const auto at = [&](double third) {
      return space.hooke(Matrix<3>{ { 1e-3, -4e-4, 0, -4e-4, 2e-3, 0, 0, 0, third } }, axisInSpace);
    };
    const auto held = at(0);
    // the third strain that leaves no stress along it
    const auto free = at(-held(2, 2) / (at(1)(2, 2) - held(2, 2)));
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
      {
        EXPECT_NEAR(strain.hooke(e, axis)(i, j), held(i, j), 1e-12 * 8e9);
        EXPECT_NEAR(stress.hooke(e, axis)(i, j), free(i, j), 1e-12 * 8e9);
      }
  };
  check(orthotropic<2>(wall, PlaneState::Stress), orthotropic<2>(wall, PlaneState::Strain), orthotropic<3>(wall));
  check(isotropic<2>(plain, PlaneState::Stress), isotropic<2>(plain, PlaneState::Strain), isotropic<3>(plain));
}

// An orthotropic law with an isotropic material's constants is the isotropic one, at any strain; a plane whose third
// direction is not strained is plane strain, at any strain.
TEST(PointLaws, LawsAgreeWhereTheyMust)
{
  const OrthotropicMaterial alike{ .along = 3e9, .across = 3e9, .poissonsRatio = 0.3, .acrossRatio = 0.3 };
  EXPECT_NEAR(shearModulus(alike), 3e9 / 2.6, 1);
  Chance<2> plane;
  Chance<3> space;
  for (int trial = 0; trial < 20; ++trial)
  {
    const auto f = plane.deformation(0.2, 2);
    const auto axis = plane.direction();
    const auto flat = isotropic<2>(plain, PlaneState::Strain).kirchhoff(f, axis);
    EXPECT_LT(difference(flat, orthotropic<2>(alike, PlaneState::Strain).kirchhoff(f, axis)), 1e-11 * 3e9);
    const auto g = space.deformation(0.2, 2);
    const auto direction = space.direction();
    EXPECT_LT(difference(isotropic<3>(plain).kirchhoff(g, direction), orthotropic<3>(alike).kirchhoff(g, direction)),
      1e-10 * 3e9);
    const Matrix<3> held{ { f(0, 0), f(0, 1), 0, f(1, 0), f(1, 1), 0, 0, 0, 1 } };
    const auto deep = orthotropic<3>(wall).kirchhoff(held, { { axis[0], axis[1], 0 } });
    const auto thin = orthotropic<2>(wall, PlaneState::Strain).kirchhoff(f, axis);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        EXPECT_NEAR(deep(i, j), thin(i, j), 1e-10 * 8e9);
  }
}

TEST(PointLaws, RotationOfStronglyStretchedPoints)
{
  Chance<3> chance;
  for (const double least : { 1e-3, 1e-2, 0.1, 1.0 })
    for (int trial = 0; trial < 100; ++trial)
    {
      Matrix<3> d{};
      d(0, 0) = 1;
      d(1, 1) = trial % 2 == 0 ? 1 : least;
      d(2, 2) = least;
      const auto q = chance.turn();
      const auto r = chance.turn();
      // F = r (qᵀ d q): its rotation is r; errors grow with the inverse of the two least stretches' sum. Volumes that
      // are far from 1 change nothing
      for (const double size : { 1.0, 0.1, 10.0 })
      {
        Matrix<3> u = product(transposedProduct(q, d), q);
        for (double& value : u.m)
          value *= size;
        const auto f = product(r, u);
        EXPECT_LT(difference(rotation(f), r), 1e-14 / least);
        EXPECT_LT(difference(leftStretch(f), productTransposed(product(r, u), r)), 1e-14 / least * size);
      }
    }
}

// Closed forms: block stretched along its axis with no change across, and simple shear.
TEST(PointLaws, UniaxialAndShear)
{
  OrthotropicMaterial m = wall;
  m.barrier = 0;
  const auto law = orthotropic<2>(m, PlaneState::Stress);
  const double det = 1 - wall.poissonsRatio * wall.poissonsRatio * wall.across / wall.along;
  const double q11 = wall.along / det;
  const double q12 = wall.poissonsRatio * wall.across / det;
  for (const double stretch : { 0.4, 0.9, 1.3 })
  {
    const auto tau = law.kirchhoff(Matrix<2>{ { stretch, 0, 0, 1 } }, { { 1, 0 } });
    EXPECT_NEAR(tau(0, 0), q11 * (stretch - 1) * stretch, 1e-13 * q11);
    EXPECT_NEAR(tau(1, 1), q12 * (stretch - 1), 1e-13 * q11);
  }
  // simple shear γ of an isotropic wall: V has trace √(4 + γ²) = s and V² = B, hence V = (B + I)/s
  const auto alike = isotropic<2>({ plain.youngsModulus, plain.poissonsRatio, 0 }, PlaneState::Strain);
  for (const double g : { 0.1, 1.0, 3.0 })
  {
    const auto tau = alike.kirchhoff(Matrix<2>{ { 1, g, 0, 1 } }, { { 1, 0 } });
    const double s = std::sqrt(4 + g * g);
    const double shear = 2 * alike.c[1] * (g - g / s) + alike.c[0] * (s - 2) * g / s;
    EXPECT_NEAR(tau(0, 1), shear, 1e-13 * plain.youngsModulus);
  }
}

TEST(PointLaws, BarrierRisesWithoutBoundAndIsNotFeltBySmallStrains)
{
  using Barrier = VolumeBarrier;
  EXPECT_EQ(Barrier::energy(2.0, 1.5), 0);
  EXPECT_EQ(Barrier::kirchhoff(2.0, 1.5), 0);
  double pressure = 0;
  for (double j = 0.99; j > 1e-6; j *= 0.9)
  {
    const double p = -Barrier::kirchhoff(2.0, j) / j;
    EXPECT_GT(p, pressure);
    EXPECT_TRUE(std::isfinite(p));
    pressure = p;
  }
  EXPECT_GT(pressure, 1e11); // κ/J² in the end
  // at a strain of 1e-3 its stress is 4e-9 κ
  EXPECT_NEAR(-Barrier::kirchhoff(2.0, 1 - 1e-3), 2.0 * 4e-9, 1e-11);
}

std::string complaint(const OrthotropicMaterial& m, PlaneState state = PlaneState::Stress)
{
  try
  {
    (void)orthotropicConstants<2>(m, state, "lamella");
  }
  catch (const ParameterError& error)
  {
    return std::string(error.what()) + " | " + error.hint();
  }
  return {};
}

TEST(PointLaws, RefusesWhatIsNotPositiveDefinite)
{
  OrthotropicMaterial m = wall;
  m.poissonsRatio = 2.1; // bound √(8/2) = 2
  EXPECT_EQ(complaint(m),
    "lamella: Poisson's ratio along the axis is 2.1: the stiffness would not be positive definite | with its other "
    "constants it lies between -2 and 2");
  m.poissonsRatio = 1.9; // in plane strain √(4 (1 − 0.2)/2) = 1.265
  EXPECT_EQ(complaint(m), "");
  EXPECT_NE(complaint(m, PlaneState::Strain).find("between -1.26491 and 1.26491"), std::string::npos);
  m = wall;
  m.acrossRatio = 1;
  EXPECT_NE(complaint(m, PlaneState::Strain).find("among the directions across the axis is 1"), std::string::npos);
  m = wall;
  m.across = -1;
  EXPECT_NE(complaint(m).find("Young's modulus across the axis is -1 Pa"), std::string::npos);
  m = wall;
  m.shearModulus = 0;
  EXPECT_NE(complaint(m).find("the shear modulus is 0 Pa"), std::string::npos);
  m = wall;
  m.barrier = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint(m).find("a barrier of nan"), std::string::npos);
  const auto flat = [](double poissonsRatio, PlaneState state) {
    return isotropicConstants<2>({ 1, poissonsRatio }, state);
  };
  EXPECT_THROW((void)flat(0.5, PlaneState::Strain), ParameterError);
  EXPECT_NO_THROW((void)flat(0.5, PlaneState::Stress));
  EXPECT_THROW((void)henckyConstants({ plain, 0, 0 }), ParameterError);
  EXPECT_THROW((void)henckyConstants({ plain, 1, -1 }), ParameterError);
}

// In plane strain the stress along the third direction is that of the law in space, F's third stretch being 1: to
// round-off, which the barrier's high powers and Newton's iteration for R make larger than 1e-16. In plane stress it is
// 0.
TEST(PointLaws, ThirdStressOfPlaneStrainIsThatOfSpace)
{
  constexpr IsotropicMaterial even{ .youngsModulus = 8e9, .poissonsRatio = 0.35 };
  const auto flat = makeLaw<2, Isotropic>({ isotropicConstants<2>(even, PlaneState::Strain) }, PlaneState::Strain);
  const auto deep = makeLaw<3, Isotropic>({ isotropicConstants<3>(even) });
  const auto flatWall =
    makeLaw<2, Orthotropic>({ orthotropicConstants<2>(wall, PlaneState::Strain) }, PlaneState::Strain);
  const auto deepWall = makeLaw<3, Orthotropic>({ orthotropicConstants<3>(wall) });
  const auto flatRubber = makeLaw<2, NeoHookean>({ { 2e9, 1e9 } }, PlaneState::Strain);
  const auto deepRubber = makeLaw<3, NeoHookean>({ { 2e9, 1e9 } });
  const auto thin = makeLaw<2, Orthotropic>({ orthotropicConstants<2>(wall, PlaneState::Stress) }, PlaneState::Stress);
  Chance<2> chance;
  for (int trial = 0; trial < 50; ++trial)
  {
    const Matrix<2> f = chance.deformation(0.6, 1.4);
    const Matrix<3> g{ { f(0, 0), f(0, 1), 0, f(1, 0), f(1, 1), 0, 0, 0, 1 } };
    const Vector<2> axis = chance.direction();
    const Vector<3> axisInSpace{ { axis[0], axis[1], 0 } };
    constexpr double tolerance = 1e-11 * 8e9;
    EXPECT_NEAR(flat->thirdStress(0, f, axis), deep->kirchhoff(0, g, axisInSpace)(2, 2), tolerance);
    EXPECT_NEAR(flatWall->thirdStress(0, f, axis), deepWall->kirchhoff(0, g, axisInSpace)(2, 2), tolerance);
    EXPECT_NEAR(flatRubber->thirdStress(0, f, axis), deepRubber->kirchhoff(0, g, axisInSpace)(2, 2), tolerance);
    EXPECT_EQ(thin->thirdStress(0, f, axis), 0);
    EXPECT_EQ(deepWall->thirdStress(0, g, axisInSpace), 0);
  }
}

} // namespace
