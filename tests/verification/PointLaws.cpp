// Laws of material points: what every elastic law must obey, and closed forms.
#include "lattice/Error.h"
#include "mpm/PlasticLaw.h"
#include "mpm/WallMaterial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

namespace
{

using namespace lamella;
using namespace lamella::mpm;

constexpr IsotropicMaterial plain{ .youngsModulus = 3e9, .poissonsRatio = 0.3 };
constexpr OrthotropicMaterial wall{ .along = 8e9,
  .across = 2e9,
  .poissonsRatio = 0.35,
  .acrossRatio = 0.2,
  .shearModulus = 0.9e9 };

template <int Dim>
class Chance
{
public:
  Matrix<Dim, double> turn()
  {
    Matrix<Dim, double> m;
    for (auto& row : m.a)
      for (double& v : row)
        v = normal_(engine_);
    if (determinant(m) < 0)
      for (double& v : m.a[0])
        v = -v;
    return rotation(m);
  }
  Vector<Dim, double> direction()
  {
    const Matrix<Dim, double> r = turn();
    Vector<Dim, double> v;
    for (int i = 0; i < Dim; ++i)
      v.a[i] = r.a[i][0];
    return v;
  }
  /// Stretches between `least` and `most` along any directions, turned at will.
  Matrix<Dim, double> deformation(double least, double most)
  {
    Matrix<Dim, double> d{};
    for (int i = 0; i < Dim; ++i)
      d.a[i][i] = std::uniform_real_distribution<double>(least, most)(engine_);
    return product(product(turn(), d), turn());
  }

private:
  std::mt19937_64 engine_{ 7 };
  std::normal_distribution<double> normal_;
};

template <int Dim>
double largest(const Matrix<Dim, double>& m)
{
  double most = 0;
  for (const auto& row : m.a)
    for (const double v : row)
      most = std::max(most, std::abs(v));
  return most;
}

template <int Dim>
double difference(Matrix<Dim, double> m, const Matrix<Dim, double>& n)
{
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      m.a[i][j] -= n.a[i][j];
  return largest(m);
}

template <int Dim>
Vector<Dim, double> image(const Matrix<Dim, double>& m, const Vector<Dim, double>& v)
{
  Vector<Dim, double> r{};
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      r.a[i] += m.a[i][j] * v.a[j];
  return r;
}

/// ψ with F changed by t a⊗(Fᵀ n).
template <int Dim, class Law>
double energyAlong(const Law& law, const Matrix<Dim, double>& f, const Vector<Dim, double>& axis,
  const Vector<Dim, double>& a, const Vector<Dim, double>& n, double t)
{
  Matrix<Dim, double> g = f;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      for (int k = 0; k < Dim; ++k)
        g.a[i][j] += t * a.a[i] * n.a[k] * f.a[k][j];
  return law.energy(g, axis);
}

/// The laws that have no memory, by one interface.
template <int Dim>
struct Hencky
{
  PlasticLaw<Dim> law{ plain, std::numeric_limits<double>::infinity(), 0 };
  PlasticState state{};
  Matrix<Dim, double> kirchhoff(const Matrix<Dim, double>& f, const Vector<Dim, double>&) const
  {
    return law.kirchhoff(f, state);
  }
  double energy(const Matrix<Dim, double>& f, const Vector<Dim, double>&) const { return law.energy(f, state); }
  double waveModulus(const Matrix<Dim, double>& f) const { return law.waveModulus(f, state); }
};

template <int Dim, class Test>
void everyLaw(const Test& test)
{
  for (const PlaneState state : { PlaneState::Stress, PlaneState::Strain })
  {
    SCOPED_TRACE(state == PlaneState::Stress ? "plane stress" : "plane strain");
    test(isotropicLaw<Dim>(plain, state));
    test(orthotropicLaw<Dim>(wall, state));
    if (Dim == 3)
      break;
  }
  test(Hencky<Dim>());
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
          work += a.a[i] * force.a[i];
        EXPECT_NEAR(slope, work, 1e-7 * std::max(largest(tau), 1e9)) << trial;
        for (int i = 0; i < Dim; ++i)
          for (int j = 0; j < i; ++j)
            EXPECT_NEAR(tau.a[i][j], tau.a[j][i], 1e-12 * std::max(largest(tau), 1e9));
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
        EXPECT_LE(second, law.waveModulus(f) * (1 + 1e-5));
      }
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
  const auto law = orthotropicLaw<3>(wall);
  // stress 1 MPa along the axis, then along a direction across it, then shear between the two
  const Matrix<3, double> frame = [&]
  {
    Matrix<3, double> r = chance.turn();
    for (int i = 0; i < 3; ++i)
      r.a[i][0] = axis.a[i];
    double along = 0;
    for (int i = 0; i < 3; ++i)
      along += r.a[i][1] * axis.a[i];
    double length = 0;
    for (int i = 0; i < 3; ++i)
    {
      r.a[i][1] -= along * axis.a[i];
      length += r.a[i][1] * r.a[i][1];
    }
    for (int i = 0; i < 3; ++i)
      r.a[i][1] /= std::sqrt(length);
    const auto c = cofactor(r); // the third column as the cross product of the first two
    for (int i = 0; i < 3; ++i)
      r.a[i][2] = c.a[i][2];
    return r;
  }();
  const auto turned = [&](const Matrix<3, double>& m) { return productTransposed(product(frame, m), frame); };
  const double p = 1e6;
  struct
  {
    Matrix<3, double> strain, stress;
  } const table[] = {
    { { { { s11 * p, 0, 0 }, { 0, s12 * p, 0 }, { 0, 0, s12 * p } } }, { { { p, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 } } } },
    { { { { s12 * p, 0, 0 }, { 0, s22 * p, 0 }, { 0, 0, s23 * p } } }, { { { 0, 0, 0 }, { 0, p, 0 }, { 0, 0, 0 } } } },
    { { { { 0, p / 2 / 0.9e9, 0 }, { p / 2 / 0.9e9, 0, 0 }, { 0, 0, 0 } } },
      { { { 0, p, 0 }, { p, 0, 0 }, { 0, 0, 0 } } } },
    { { { { 0, 0, 0 }, { 0, 0, p * (s22 - s23) }, { 0, p * (s22 - s23), 0 } } },
      { { { 0, 0, 0 }, { 0, 0, p }, { 0, p, 0 } } } },
  };
  for (const auto& row : table)
  {
    EXPECT_LT(difference(law.hooke(turned(row.strain), axis), turned(row.stress)), 1e-9 * p);
    Matrix<3, double> f = turned(row.strain);
    for (auto& line : f.a)
      for (double& v : line)
        v *= 1e-4;
    const double small = 1e-4 * p;
    for (int i = 0; i < 3; ++i)
      f.a[i][i] += 1;
    // strains of 1e-7 to second order
    EXPECT_LT(difference(law.kirchhoff(f, axis),
                [&]
                {
                  Matrix<3, double> t = turned(row.stress);
                  for (auto& line : t.a)
                    for (double& v : line)
                      v *= 1e-4;
                  return t;
                }()),
      1e-6 * small);
  }
}

TEST(PointLaws, PlaneStatesAreThoseOfSpace)
{
  Chance<2> chance;
  const auto axis = chance.direction();
  const Vector<3, double> axisInSpace{ { axis.a[0], axis.a[1], 0 } };
  const Matrix<2, double> e{ { { 1e-3, -4e-4 }, { -4e-4, 2e-3 } } };
  const auto check = [&](const auto& stress, const auto& strain, const auto& space)
  {
    const auto at = [&](double third) {
      return space.hooke(Matrix<3, double>{ { { 1e-3, -4e-4, 0 }, { -4e-4, 2e-3, 0 }, { 0, 0, third } } }, axisInSpace);
    };
    const auto held = at(0);
    // the third strain that leaves no stress along it
    const auto free = at(-held.a[2][2] / (at(1).a[2][2] - held.a[2][2]));
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
      {
        EXPECT_NEAR(strain.hooke(e, axis).a[i][j], held.a[i][j], 1e-12 * 8e9);
        EXPECT_NEAR(stress.hooke(e, axis).a[i][j], free.a[i][j], 1e-12 * 8e9);
      }
  };
  check(
    orthotropicLaw<2>(wall, PlaneState::Stress), orthotropicLaw<2>(wall, PlaneState::Strain), orthotropicLaw<3>(wall));
  check(isotropicLaw<2>(plain, PlaneState::Stress), isotropicLaw<2>(plain, PlaneState::Strain), isotropicLaw<3>(plain));
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
    const auto flat = isotropicLaw<2>(plain, PlaneState::Strain).kirchhoff(f, axis);
    EXPECT_LT(difference(flat, orthotropicLaw<2>(alike, PlaneState::Strain).kirchhoff(f, axis)), 1e-11 * 3e9);
    const auto g = space.deformation(0.2, 2);
    const auto direction = space.direction();
    EXPECT_LT(
      difference(isotropicLaw<3>(plain).kirchhoff(g, direction), orthotropicLaw<3>(alike).kirchhoff(g, direction)),
      1e-10 * 3e9);
    const Matrix<3, double> held{ { { f.a[0][0], f.a[0][1], 0 }, { f.a[1][0], f.a[1][1], 0 }, { 0, 0, 1 } } };
    const auto deep = orthotropicLaw<3>(wall).kirchhoff(held, { { axis.a[0], axis.a[1], 0 } });
    const auto thin = orthotropicLaw<2>(wall, PlaneState::Strain).kirchhoff(f, axis);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        EXPECT_NEAR(deep.a[i][j], thin.a[i][j], 1e-10 * 8e9);
  }
}

TEST(PointLaws, RotationOfStronglyStretchedPoints)
{
  Chance<3> chance;
  for (const double least : { 1e-3, 1e-2, 0.1, 1.0 })
    for (int trial = 0; trial < 100; ++trial)
    {
      Matrix<3, double> d{};
      d.a[0][0] = 1;
      d.a[1][1] = trial % 2 == 0 ? 1 : least;
      d.a[2][2] = least;
      const auto q = chance.turn();
      const auto r = chance.turn();
      // F = r (qᵀ d q): its rotation is r; errors grow with the inverse of the two least stretches' sum
      const auto f = product(r, product(transposedProduct(q, d), q));
      EXPECT_LT(difference(rotation(f), r), 1e-14 / least);
    }
}

// Closed forms: block stretched along its axis with no change across, and simple shear.
TEST(PointLaws, UniaxialAndShear)
{
  OrthotropicMaterial m = wall;
  m.barrier = 0;
  const auto law = orthotropicLaw<2>(m, PlaneState::Stress);
  const double det = 1 - wall.poissonsRatio * wall.poissonsRatio * wall.across / wall.along;
  const double q11 = wall.along / det;
  const double q12 = wall.poissonsRatio * wall.across / det;
  for (const double stretch : { 0.4, 0.9, 1.3 })
  {
    const auto tau = law.kirchhoff(Matrix<2, double>{ { { stretch, 0 }, { 0, 1 } } }, { { 1, 0 } });
    EXPECT_NEAR(tau.a[0][0], q11 * (stretch - 1) * stretch, 1e-13 * q11);
    EXPECT_NEAR(tau.a[1][1], q12 * (stretch - 1), 1e-13 * q11);
  }
  // simple shear γ of an isotropic wall: V has trace √(4 + γ²) = s and V² = B, hence V = (B + I)/s
  const auto isotropic = isotropicLaw<2>({ plain.youngsModulus, plain.poissonsRatio, 0 }, PlaneState::Strain);
  for (const double g : { 0.1, 1.0, 3.0 })
  {
    const auto tau = isotropic.kirchhoff(Matrix<2, double>{ { { 1, g }, { 0, 1 } } }, { { 1, 0 } });
    const double s = std::sqrt(4 + g * g);
    const double shear = 2 * isotropic.mu * (g - g / s) + isotropic.lambda * (s - 2) * g / s;
    EXPECT_NEAR(tau.a[0][1], shear, 1e-13 * plain.youngsModulus);
  }
}

TEST(PointLaws, BarrierRisesWithoutBoundAndIsNotFeltBySmallStrains)
{
  const VolumeBarrier b{ 2.0 };
  EXPECT_EQ(b.energy(1.5), 0);
  EXPECT_EQ(b.kirchhoff(1.5), 0);
  double pressure = 0;
  for (double j = 0.99; j > 1e-6; j *= 0.9)
  {
    const double p = -b.kirchhoff(j) / j;
    EXPECT_GT(p, pressure);
    EXPECT_TRUE(std::isfinite(p));
    pressure = p;
  }
  EXPECT_GT(pressure, 1e11); // κ/J² in the end
  // at a strain of 1e-3 its stress is 4e-9 κ
  EXPECT_NEAR(-b.kirchhoff(1 - 1e-3), 2.0 * 4e-9, 1e-11);
}

std::string complaint(const OrthotropicMaterial& m, PlaneState state = PlaneState::Stress)
{
  try
  {
    (void)orthotropicLaw<2>(m, state, "lamella");
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
  EXPECT_THROW((void)isotropicLaw<2>({ .youngsModulus = 1, .poissonsRatio = 0.5 }, PlaneState::Strain), ParameterError);
  EXPECT_NO_THROW((void)isotropicLaw<2>({ .youngsModulus = 1, .poissonsRatio = 0.5 }, PlaneState::Stress));
  EXPECT_THROW(PlasticLaw<2>(plain, 0, 0), ParameterError);
  EXPECT_THROW(PlasticLaw<2>(plain, 1, -1), ParameterError);
}

/// A bar in space pulled to a logarithmic strain, its sides free: logarithmic strain across that leaves them so.
struct Bar
{
  PlasticLaw<3> law;
  PlasticState state{};
  double along = 0, across = 0; // logarithms of Fe
  double work = 0;

  double stress() const { return law.kirchhoff(stretched(), state).a[0][0]; }
  Matrix<3, double> stretched() const
  {
    const double a = std::exp(along);
    const double b = std::exp(across);
    return { { { a, 0, 0 }, { 0, b, 0 }, { 0, 0, b } } };
  }
  void pull(double step)
  {
    // sides free: dε across by bisection of their stress after the return, which rises with it
    double low = -2 * std::abs(step);
    double high = 2 * std::abs(step);
    Matrix<3, double> f;
    PlasticState s;
    double done = 0;
    for (int i = 0; i < 80; ++i)
    {
      const double middle = 0.5 * (low + high);
      f = stretched();
      for (int k = 0; k < 3; ++k)
        f.a[k][k] *= std::exp(k == 0 ? step : middle);
      s = state;
      done = law.yield(f, s);
      (law.kirchhoff(f, s).a[1][1] > 0 ? high : low) = middle;
    }
    state = s;
    work += done;
    along = std::log(f.a[0][0]);
    across = std::log(f.a[1][1]);
  }
};

// In logarithmic strains a bar is the one of the textbook: E up to the yield stress, E H/(E + H) beyond, E back.
TEST(PointLaws, BarYieldsHardensAndUnloads)
{
  const double young = plain.youngsModulus;
  const double limit = 30e6;
  const double hardening = 0.2e9;
  Bar bar{ PlasticLaw<3>({ young, plain.poissonsRatio, 0 }, limit, hardening) };
  const double first = limit / young;
  bar.pull(0.999 * first);
  EXPECT_NEAR(bar.stress(), 0.999 * limit, 1e-9 * limit); // bisection leaves 1e-12 of strain
  EXPECT_EQ(bar.state.strain, 0);
  bar.pull(0.001 * first + 0.05);
  const double beyond = 0.05 * young * hardening / (young + hardening);
  EXPECT_NEAR(bar.stress(), limit + beyond, 1e-8 * limit);
  EXPECT_NEAR(bar.state.strain, 0.05 * young / (young + hardening), 1e-9);
  // plastic work: the mean yield stress times the plastic strain
  EXPECT_NEAR(bar.work, (limit + 0.5 * beyond) * bar.state.strain, 1e-8 * bar.work);
  const double top = bar.stress();
  bar.pull(-0.005);
  EXPECT_NEAR(bar.stress(), top - 0.005 * young, 1e-8 * limit);
}

TEST(PointLaws, PlasticFlowKeepsVolumeAndEndsOnTheSurface)
{
  const PlasticLaw<2> law(plain, 20e6, 0.1e9);
  Chance<2> chance;
  for (int trial = 0; trial < 50; ++trial)
  {
    auto f = chance.deformation(0.7, 1.3);
    PlasticState s{ 0.01, 1.02 };
    const double volume = determinant(f) * s.acrossPlane;
    const double before = law.energy(f, s);
    const double work = law.yield(f, s);
    EXPECT_NEAR(determinant(f) * s.acrossPlane, volume, 1e-13);
    EXPECT_GT(work, 0);
    EXPECT_LT(law.energy(f, s) + work, before); // the trial had more
    PlasticState again = s;
    EXPECT_LT(law.yield(f, again), 1e-12 * work); // already there
    EXPECT_NEAR(again.strain, s.strain, 1e-12);
  }
}

// In plane strain a flat point's state is the one that a point in space has.
TEST(PointLaws, PlasticPlaneStrainIsThatOfSpace)
{
  const PlasticLaw<2> flat(plain, 20e6, 0.1e9);
  const PlasticLaw<3> deep(plain, 20e6, 0.1e9);
  Chance<2> chance;
  Matrix<2, double> f{ { { 1, 0 }, { 0, 1 } } };
  Matrix<3, double> g{ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };
  PlasticState s;
  PlasticState t;
  for (int step = 0; step < 20; ++step)
  {
    const auto more = chance.deformation(0.97, 1.02);
    f = product(more, f);
    g = product(
      Matrix<3, double>{ { { more.a[0][0], more.a[0][1], 0 }, { more.a[1][0], more.a[1][1], 0 }, { 0, 0, 1 } } }, g);
    EXPECT_NEAR(flat.yield(f, s), deep.yield(g, t), 1e-3);
    EXPECT_NEAR(s.strain, t.strain, 1e-13);
    EXPECT_NEAR(s.acrossPlane, g.a[2][2], 1e-13);
    EXPECT_NEAR(flat.kirchhoff(f, s).a[0][1], deep.kirchhoff(g, t).a[0][1], 1e-11 * plain.youngsModulus);
  }
}

} // namespace
