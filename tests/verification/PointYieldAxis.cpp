// Walls that yield along and across an axis: closed forms, by themselves and in motion.
#include "MaterialPointSamples.h"
#include "PointChance.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::mpm;
using samples::Chance;

using State = std::array<double, Hill::history>;

const OrthotropicPlasticMaterial fibre{ { .along = 8e9, .across = 3e9, .shearModulus = 1e9, .barrier = 0 }, 60e6, 25e6,
  18e6, 0.4e9 };
const Vector<3> x{ { 1, 0, 0 } };

double largest(const Matrix<3>& m)
{
  double most = 0;
  for (const double v : m.m)
    most = std::max(most, std::fabs(v));
  return most;
}

/// Yields at once, and keeps what it has of F.
template <int Dim>
Matrix<Dim> stressed(
  const std::array<double, Hill::constants>& c, const Matrix<Dim>& F, const Vector<Dim>& axis, State& state)
{
  Matrix<Dim> f = F;
  Hill::flow(c.data(), f, axis, state.data());
  return Hill::kirchhoff(c.data(), F, axis, state.data());
}

/// A bar pulled along a direction (1: along the axis, 0: across it) to a logarithmic strain, in small pieces, its sides
/// free. Strains on the axes of the wall.
struct Bar
{
  std::array<double, Hill::constants> c;
  int along; ///< direction that is pulled: 0 the axis, 1 across
  State state{};
  std::array<double, 3> strain{};

  /// Kirchhoff stress on the wall's axes with these strains.
  std::array<double, 3> at(const std::array<double, 3>& e, State& s) const
  {
    const Matrix<3> F{ { std::exp(e[0]), 0, 0, 0, std::exp(e[1]), 0, 0, 0, std::exp(e[2]) } };
    const Matrix<3> t = stressed<3>(c, F, x, s);
    return { t(0, 0), t(1, 1), t(2, 2) };
  }
  /// Newton's method on the two free strains, with differences: linear between yields, so a few steps do.
  double pull(double step)
  {
    const auto i = static_cast<std::size_t>(along);
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    std::array<double, 3> e = strain;
    e[i] += step;
    State s = state;
    std::array<double, 3> t{};
    for (int turn = 0; turn < 60; ++turn)
    {
      s = state;
      t = at(e, s);
      std::array<std::array<double, 2>, 2> m{};
      constexpr double d = 1e-9;
      for (const std::size_t column : { std::size_t{ 0 }, std::size_t{ 1 } })
      {
        std::array<double, 3> more = e;
        more[column == 0 ? j : k] += d;
        State other = state;
        const std::array<double, 3> u = at(more, other);
        m[0][column] = (u[j] - t[j]) / d;
        m[1][column] = (u[k] - t[k]) / d;
      }
      const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
      e[j] -= (m[1][1] * t[j] - m[0][1] * t[k]) / det;
      e[k] -= (m[0][0] * t[k] - m[1][0] * t[j]) / det;
    }
    state = s;
    strain = e;
    return t[i];
  }
};

// In logarithmic strains a bar along the axis is the one of the textbook: E up to the yield stress X, E H/(E + H)
// beyond, E back. Across it it yields at Y, and hardens with H/r², since q = r τ and q dε̄ = τ dε.
TEST(PointYieldAxis, BarsAlongAndAcrossYieldHardenAndUnload)
{
  const auto c = hillConstants(fibre);
  for (const int along : { 0, 1 })
  {
    const double young = along == 0 ? fibre.elastic.along : fibre.elastic.across;
    const double limit = along == 0 ? fibre.yieldStress : *fibre.yieldAcross;
    const double r = fibre.yieldStress / limit;
    const double hardening = fibre.hardening / (r * r);
    Bar bar{ c, along };
    EXPECT_NEAR(bar.pull(0.999 * limit / young), 0.999 * limit, 1e-7 * limit); // differences, see pull()
    EXPECT_EQ(bar.state[Hill::plasticStrain], 0);
    double stress = bar.pull(0.001 * limit / young);
    for (int i = 0; i < 10; ++i)
      stress = bar.pull(0.005);
    const double beyond = 0.05 * young * hardening / (young + hardening);
    EXPECT_NEAR(stress, limit + beyond, 1e-6 * limit) << along;
    EXPECT_NEAR(bar.state[Hill::plasticStrain], r * beyond / fibre.hardening, 1e-8) << along;
    EXPECT_NEAR(bar.state[Hill::plasticWork], (limit + 0.5 * beyond) * beyond / hardening, 1e-5 * limit * 0.05);
    EXPECT_NEAR(bar.pull(-0.001), stress - 0.001 * young, 1e-6 * limit) << along;
  }
}

// Where a stress along any direction begins to flow: Hill's 1/σ² = c⁴/X² + (1/S² − 1/X²) c² s² + s⁴/Y².
TEST(PointYieldAxis, YieldStressByDirectionIsHills)
{
  const auto c = hillConstants(fibre);
  // strain of a stress along n, from the compliance on the wall's axes
  const OrthotropicMaterial& m = fibre.elastic;
  for (const double angle : { 0.0, 0.2, 0.5, 0.9, 1.3, 1.5707963267948966 })
  {
    const double cos = std::cos(angle);
    const double sin = std::sin(angle);
    const double X = fibre.yieldStress;
    const double Y = *fibre.yieldAcross;
    const double S = *fibre.yieldShear;
    const double expected = 1 /
      std::sqrt(cos * cos * cos * cos / (X * X) + (1 / (S * S) - 1 / (X * X)) * cos * cos * sin * sin +
        sin * sin * sin * sin / (Y * Y));
    const auto flows = [&](double stress)
    {
      const double t1 = stress * cos * cos;
      const double t2 = stress * sin * sin;
      const double t12 = stress * cos * sin;
      const double e1 = t1 / m.along - m.poissonsRatio * t2 / m.along;
      const double e2 = t2 / m.across - m.poissonsRatio * t1 / m.along;
      const double e3 = -m.poissonsRatio * t1 / m.along - m.acrossRatio * t2 / m.across;
      const double e12 = t12 / (2 * *m.shearModulus);
      // exp of the strain: by its own axes
      const double mean = 0.5 * (e1 + e2);
      const double radius = std::hypot(0.5 * (e1 - e2), e12);
      const double turn = 0.5 * std::atan2(2 * e12, e1 - e2);
      const double a = std::exp(mean + radius);
      const double b = std::exp(mean - radius);
      const double k = std::cos(turn);
      const double l = std::sin(turn);
      Matrix<3> F{ { a * k * k + b * l * l, (a - b) * k * l, 0, (a - b) * k * l, a * l * l + b * k * k, 0, 0, 0,
        std::exp(e3) } };
      State s{};
      Hill::flow(c.data(), F, x, s.data());
      return s[Hill::plasticStrain] > 0;
    };
    EXPECT_FALSE(flows(expected * (1 - 1e-9))) << angle; // round-off of strains of 1 %
    EXPECT_TRUE(flows(expected * (1 + 1e-9))) << angle;
  }
}

// Turned with its axis a wall does the same, and a rotation of the whole turns the stress.
TEST(PointYieldAxis, TurnedItIsTheSame)
{
  const auto c = hillConstants(fibre);
  Chance<3> chance;
  for (int trial = 0; trial < 50; ++trial)
  {
    const Matrix<3> q = chance.turn();
    const Matrix<3> p = chance.turn();
    Vector<3> turned;
    for (int i = 0; i < 3; ++i)
      turned[i] = q(i, 0);
    State own{};
    State other{};
    Matrix<3> F = Matrix<3>::identity();
    for (int step = 0; step < 5; ++step)
    {
      F = product(chance.deformation(0.97, 1.03), F);
      const Matrix<3> t = stressed<3>(c, F, x, own);
      const Matrix<3> u = stressed<3>(c, product(p, productTransposed(F, q)), turned, other);
      const Matrix<3> back = product(transposedProduct(p, u), p);
      for (int i = 0; i < 9; ++i)
        EXPECT_NEAR(back.m[i], t.m[i], 1e-11 * fibre.elastic.along); // round-off of strains, times the modulus
      EXPECT_NEAR(own[Hill::plasticStrain], other[Hill::plasticStrain], 1e-12);
    }
    EXPECT_GT(own[Hill::plasticStrain], 0.01);
  }
}

// Flow ends on the yield surface, along its normal, takes nothing from the volume and never gives energy: what the
// trial had more than is left is at least the plastic work, since the stress falls on the way.
TEST(PointYieldAxis, FlowIsIsochoricAndDissipates)
{
  const auto c = hillConstants(fibre);
  Chance<3> chance;
  for (int trial = 0; trial < 200; ++trial)
  {
    State s{};
    Matrix<3> F = Matrix<3>::identity();
    for (int step = 0; step < 4; ++step)
    {
      F = product(chance.deformation(0.8, 1.25), F);
      const State before = s;
      const double had = Hill::energy(c.data(), F, x, s.data());
      const Matrix<3> kept = F;
      Hill::flow(c.data(), F, x, s.data());
      for (int i = 0; i < 9; ++i)
        EXPECT_EQ(F.m[i], kept.m[i]);
      EXPECT_GE(s[Hill::plasticWork], before[Hill::plasticWork]);
      EXPECT_LE(
        Hill::energy(c.data(), F, x, s.data()) + s[Hill::plasticWork] - before[Hill::plasticWork], had * (1 + 1e-12));
      const double once = s[Hill::plasticStrain];
      Hill::flow(c.data(), F, x, s.data());
      EXPECT_NEAR(s[Hill::plasticStrain], once, 1e-12); // already there
    }
  }
  // what is isotropic resists only with its bulk modulus where it is squeezed alike from all sides, however far it
  // flowed
  const OrthotropicPlasticMaterial same{ { .along = 3e9, .across = 3e9, .barrier = 0 }, 20e6, {}, {}, 0 };
  const auto k = hillConstants(same);
  State s{};
  const Matrix<3> F = chance.deformation(0.7, 1.3);
  const Matrix<3> t = stressed<3>(k, F, x, s);
  EXPECT_NEAR(trace(t) / 3, 3e9 / (3 * (1 - 0.6)) * std::log(determinant(F)), 1e-3);
}

// With both moduli and both yield stresses alike it is Hencky's wall, whatever the axis; loads that do not turn.
TEST(PointYieldAxis, IsHenckysWhereAllDirectionsAreAlike)
{
  const OrthotropicPlasticMaterial same{ { .along = 3e9, .across = 3e9 }, 20e6, {}, {}, 0.1e9 };
  const auto c = hillConstants(same);
  const auto plain = henckyConstants({ { .youngsModulus = 3e9 }, 20e6, 0.1e9 });
  Chance<3> chance;
  for (int trial = 0; trial < 20; ++trial)
  {
    const Vector<3> axis = chance.direction();
    const Matrix<3> once = chance.deformation(0.98, 1.02);
    const Matrix<3> stretch = symmetricTransposedProduct(once, once); // no rotation, and one set of axes
    Matrix<3> F = Matrix<3>::identity();
    Matrix<3> elastic = F;
    State s{};
    double history[Hencky::history] = {};
    for (int step = 0; step < 6; ++step)
    {
      F = product(stretch, F);
      elastic = product(stretch, elastic);
      Hencky::flow(plain.data(), elastic, axis, history);
      const Matrix<3> t = stressed<3>(c, F, axis, s);
      const Matrix<3> u = Hencky::kirchhoff(plain.data(), elastic, axis, history);
      for (int i = 0; i < 9; ++i)
        EXPECT_NEAR(t.m[i], u.m[i], 1e-10 * 3e9);
      EXPECT_NEAR(s[Hill::plasticStrain], history[Hencky::plasticStrain], 1e-12);
      EXPECT_NEAR(s[Hill::plasticWork], history[Hencky::plasticWork], 1e-10 * 20e6);
    }
    EXPECT_GT(s[Hill::plasticStrain], 0.01);
  }
}

// In plane strain a flat point's state is the one that a point in space has.
TEST(PointYieldAxis, PlaneStrainIsThatOfSpace)
{
  const auto c = hillConstants(fibre);
  Chance<2> chance;
  const Vector<2> flatAxis = chance.direction();
  const Vector<3> axis{ { flatAxis[0], flatAxis[1], 0 } };
  auto f = Matrix<2>::identity();
  State flat{};
  State deep{};
  for (int step = 0; step < 20; ++step)
  {
    f = product(chance.deformation(0.97, 1.02), f);
    const Matrix<3> g{ { f(0, 0), f(0, 1), 0, f(1, 0), f(1, 1), 0, 0, 0, 1 } };
    const Matrix<2> t = stressed<2>(c, f, flatAxis, flat);
    const Matrix<3> u = stressed<3>(c, g, axis, deep);
    for (std::size_t i = 0; i < flat.size(); ++i)
      EXPECT_NEAR(flat[i], deep[i], 1e-13 * (i == Hill::plasticWork ? fibre.yieldStress : 1));
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        EXPECT_NEAR(t(i, j), u(i, j), 1e-11 * fibre.elastic.along);
    EXPECT_NEAR(Hill::thirdStress(c.data(), f, flatAxis, flat.data()), u(2, 2), 1e-11 * fibre.elastic.along);
  }
  EXPECT_GT(flat[Hill::plasticStrain], 0.01);
  EXPECT_LT(largest(Hill::kirchhoff(c.data(), Matrix<3>::identity(), axis, State{}.data())), 1e-6);
}

// A wave is never faster than the step is taken from, in walls that have flowed far: second differences of the energy.
TEST(PointYieldAxis, WavesOfWallsThatFlowedAreNoFasterThanTheBound)
{
  const auto c = hillConstants(fibre);
  Chance<3> chance;
  double worst = 0;
  for (int trial = 0; trial < 4000; ++trial)
  {
    State s{};
    Matrix<3> F = Matrix<3>::identity();
    const Matrix<3> turn = chance.deformation(0.6, 1.5);
    for (int step = 0; step < 3; ++step)
    {
      F = product(turn, F);
      Hill::flow(c.data(), F, x, s.data());
    }
    const Vector<3> a = chance.direction();
    const Vector<3> n = trial % 2 == 0 ? a : chance.direction();
    const auto at = [&](double t)
    {
      Matrix<3> g = F;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 3; ++k)
            g(i, j) += t * a[i] * n[k] * F(k, j);
      return Hill::energy(c.data(), g, x, s.data());
    };
    const double h = 1e-3;
    worst = std::max(worst, (at(h) - 2 * at(0) + at(-h)) / (h * h) / Hill::stiffness(c.data(), F, x, s.data()));
  }
  EXPECT_LE(worst, 1 + 1e-5); // of the differences
  EXPECT_GT(worst, 0.3);      // and the bound is no waste
}

// A block in space pressed along its axis between six walls moves evenly; T₁₁ − ½ (T₂₂ + T₃₃) alone flows, and its
// return has a closed form: q = (C₁₁ − C₁₂)|ε| − (C₁₁ − 2 C₁₂ + ½ (C₂₂ + C₂₃)) ε̄ = X + H ε̄.
TEST(PointYieldAxis, YieldingBlockInMotion)
{
  const OrthotropicPlasticMaterial m{ { .along = 1, .across = 0.5, .barrier = 0 }, 0.02, 0.012, {}, 0.1 };
  const auto c = hillConstants(m);
  const Lattice lattice = makeLattice(4, 4, 4, 3, 0.25);
  const std::vector<std::uint8_t> phase(64, 1);
  const std::vector<std::array<float, 3>> axis(64, { 0, 1, 0 });
  PointOptions made;
  made.density = { 1.0 };
  made.history = Hill::history;
  auto points = pointsFromLattice<3>(lattice, phase, axis, made);
  const double rate = 0.05;
  samples::setVelocities<3>(points, [&](const Vector<3>& at) { return Vector<3>{ { 0, -rate * at[1], 0 } }; });
  PointDynamicsOptions<3> o;
  o.spacing = 0.25;
  o.sides = { { { samples::wallAt(0), samples::wallAt(1) }, { samples::wallAt(0), samples::wallAt(1, -rate) },
    { samples::wallAt(0), samples::wallAt(1) } } };
  PointDynamics<3> body(std::move(points), makeLaw<3, Hill>({ c }), o);
  body.advanceTo(0.95);
  EXPECT_TRUE(body.fused());
  const double strain = -std::log(1 - rate * body.time());
  const double apart = 2 * c[1] + c[2] + 4 * c[3] + c[4]; // C₁₁ − C₁₂
  const double falls = apart - c[2] + c[1];
  const double flowed = (apart * strain - 0.02) / (falls + 0.1);
  ASSERT_GT(flowed, 0.01);
  const double work = (0.02 + 0.05 * flowed) * flowed;
  for (std::size_t p = 0; p < body.points().count(); ++p)
  {
    EXPECT_NEAR(body.points().column(MaterialPoints<3>::histories + Hill::plasticStrain)[p], flowed, 1e-10);
    EXPECT_NEAR(body.points().column(MaterialPoints<3>::histories + Hill::plasticWork)[p], work, 1e-10);
    EXPECT_NEAR(body.points().column(MaterialPoints<3>::histories + Hill::plasticTensor + 1)[p], -flowed, 1e-10);
  }
}

TEST(PointYieldAxis, BadConstantsAreNamed)
{
  const auto message = [](auto&& change)
  {
    OrthotropicPlasticMaterial m = fibre;
    change(m);
    try
    {
      (void)hillConstants(m);
    }
    catch (const ParameterError& e)
    {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message([](auto&) {}), "");
  EXPECT_NE(message([](auto& m) { m.yieldAcross = 121e6; }).find("across the axis"), std::string::npos);
  EXPECT_NE(message([](auto& m) { m.yieldShear = 0; }).find("in shear"), std::string::npos);
  EXPECT_NE(message([](auto& m) { m.yieldStress = -1; }).find("yield stress of -1"), std::string::npos);
  EXPECT_NE(message([](auto& m) { m.hardening = -1; }).find("hardening"), std::string::npos);
  EXPECT_NE(message([](auto& m) { m.yieldStress = std::numeric_limits<double>::infinity(); }).find("never along"),
    std::string::npos);
}

} // namespace
