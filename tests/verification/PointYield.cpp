// Walls that yield: closed forms, by themselves and in motion.
#include "MaterialPointSamples.h"
#include "PointChance.h"

#include "mpm/SymmetricEigen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace
{

using namespace lamella;
using namespace lamella::mpm;
using samples::Chance;
using samples::plain;

/// A bar in space pulled to a logarithmic strain, its sides free.
struct Bar
{
  std::array<double, Hencky::constants> c;
  double history[Hencky::history] = { 0, 0, 0 };
  double along = 0, across = 0; // logarithms of Fe

  [[nodiscard]] double stress() const { return Hencky::kirchhoff(c.data(), stretched(), x, history)(0, 0); }
  [[nodiscard]] Matrix<3> stretched() const
  {
    return { { std::exp(along), 0, 0, 0, std::exp(across), 0, 0, 0, std::exp(across) } };
  }
  void pull(double step)
  {
    // sides free: their stress after the return rises with the strain across; bisection
    double low = -2 * std::abs(step);
    double high = 2 * std::abs(step);
    const Matrix<3> before = stretched();
    const auto old = std::to_array(history);
    for (int i = 0; i < 80; ++i)
    {
      const double middle = 0.5 * (low + high);
      Matrix<3> f = before;
      for (int k = 0; k < 3; ++k)
        f(k, k) *= std::exp(k == 0 ? step : middle);
      std::copy(old.begin(), old.end(), history);
      Hencky::flow(c.data(), f, x, history);
      (Hencky::kirchhoff(c.data(), f, x, history)(1, 1) > 0 ? high : low) = middle;
      along = std::log(f(0, 0));
      across = std::log(f(1, 1));
    }
  }

  static constexpr Vector<3> x{ { 1, 0, 0 } };
};

/// The matrix that eigenvalues and directions are of, less it, and the directions' products, less the identity.
template <int Dim>
std::array<double, 2> astray(const Matrix<Dim>& m)
{
  const SymmetricEigen<Dim, double> eigen(m);
  const Matrix<Dim> again = spectral(eigen.values, eigen.directions);
  const Matrix<Dim> one = lessIdentity(symmetricProductTransposed(eigen.directions, eigen.directions));
  Matrix<Dim> rest;
  for (int i = 0; i < Dim * Dim; ++i)
    rest.m[i] = again.m[i] - m.m[i];
  return { std::sqrt(contraction(rest, rest) / contraction(m, m)), std::sqrt(contraction(one, one)) };
}

// Rotations give the matrix again, to round-off; one is enough in a plane.
TEST(PointYield, EigenvaluesMakeTheMatrix)
{
  for (const auto& [xx, yy, xy] : { std::array{ 1.0, 1.0, 0.0 }, { 2.0, 0.5, 0.0 }, { 1.0, 1.0, 0.3 },
         { 1.0, 1.0, -0.3 }, { 4.0, 0.1, 0.6 }, { 0.1, 4.0, -0.6 }, { 1.0, 1.0 + 1e-15, 1e-9 } })
  {
    const auto [rest, one] = astray<2>({ { xx, xy, xy, yy } });
    EXPECT_LT(rest, 2e-15);
    EXPECT_LT(one, 1e-15);
    for (const double zz : { 1.7, xx, 1e-3 })
      for (const double yz : { 0.0, xy, 1e-12 })
      {
        const auto [left, unit] = astray<3>({ { xx, xy, -yz, xy, yy, yz, -yz, yz, zz } });
        EXPECT_LT(left, 4e-15); // some fifteen rotations
        EXPECT_LT(unit, 4e-15);
      }
  }
  Chance<3> chance;
  for (int trial = 0; trial < 1000; ++trial)
  {
    const Matrix<3> f = chance.deformation(0.1, 3);
    const auto [rest, one] = astray<3>(symmetricTransposedProduct(f, f));
    EXPECT_LT(rest, 4e-15);
    EXPECT_LT(one, 4e-15);
  }
}

// In logarithmic strains a bar is the one of the textbook: E up to the yield stress, E H/(E + H) beyond, E back.
TEST(PointYield, BarYieldsHardensAndUnloads)
{
  const double young = plain.youngsModulus;
  const double limit = 30e6;
  const double hardening = 0.2e9;
  Bar bar{ henckyConstants({ { young, plain.poissonsRatio, 0 }, limit, hardening }) };
  const double first = limit / young;
  bar.pull(0.999 * first);
  EXPECT_NEAR(bar.stress(), 0.999 * limit, 1e-9 * limit); // bisection leaves 1e-12 of strain
  EXPECT_EQ(bar.history[Hencky::plasticStrain], 0);
  bar.pull(0.001 * first + 0.05);
  const double beyond = 0.05 * young * hardening / (young + hardening);
  EXPECT_NEAR(bar.stress(), limit + beyond, 1e-8 * limit);
  const double flowed = bar.history[Hencky::plasticStrain];
  EXPECT_NEAR(flowed, 0.05 * young / (young + hardening), 1e-9);
  // plastic work: the mean yield stress times the plastic strain
  EXPECT_NEAR(bar.history[Hencky::plasticWork], (limit + 0.5 * beyond) * flowed, 1e-8 * limit * flowed);
  const double top = bar.stress();
  bar.pull(-0.005);
  EXPECT_NEAR(bar.stress(), top - 0.005 * young, 1e-8 * limit);
}

TEST(PointYield, PlasticFlowKeepsVolumeAndEndsOnTheSurface)
{
  const auto c = henckyConstants({ plain, 20e6, 0.1e9 });
  const Vector<2> x{ { 1, 0 } };
  Chance<2> chance;
  for (int trial = 0; trial < 50; ++trial)
  {
    auto f = chance.deformation(0.7, 1.3);
    double h[3] = { 0.01, 0.02, 0 };
    const double volume = determinant(f) * std::exp(h[1]);
    const double before = Hencky::energy(c.data(), f, x, h);
    Hencky::flow(c.data(), f, x, h);
    EXPECT_NEAR(determinant(f) * std::exp(h[1]), volume, 1e-13);
    EXPECT_GT(h[2], 0);
    EXPECT_LT(Hencky::energy(c.data(), f, x, h) + h[2], before); // the trial had more
    const double once = h[0];
    Hencky::flow(c.data(), f, x, h);
    EXPECT_NEAR(h[0], once, 1e-12); // already there
  }
}

// In plane strain a flat point's state is the one that a point in space has.
TEST(PointYield, PlasticPlaneStrainIsThatOfSpace)
{
  const auto c = henckyConstants({ plain, 20e6, 0.1e9 });
  const Vector<2> x{ { 1, 0 } };
  const Vector<3> y{ { 1, 0, 0 } };
  Chance<2> chance;
  auto f = Matrix<2>::identity();
  auto g = Matrix<3>::identity();
  double flat[3] = { 0, 0, 0 };
  double deep[3] = { 0, 0, 0 };
  for (int step = 0; step < 20; ++step)
  {
    const auto more = chance.deformation(0.97, 1.02);
    f = product(more, f);
    g = product(Matrix<3>{ { more(0, 0), more(0, 1), 0, more(1, 0), more(1, 1), 0, 0, 0, 1 } }, g);
    Hencky::flow(c.data(), f, x, flat);
    Hencky::flow(c.data(), g, y, deep);
    EXPECT_NEAR(flat[0], deep[0], 1e-13);
    EXPECT_NEAR(flat[1], std::log(g(2, 2)), 1e-13);
    EXPECT_NEAR(flat[2], deep[2], 1e-12 * deep[2]);
    EXPECT_NEAR(Hencky::kirchhoff(c.data(), f, x, flat)(0, 1), Hencky::kirchhoff(c.data(), g, y, deep)(0, 1),
      1e-11 * plain.youngsModulus);
    EXPECT_NEAR(Hencky::thirdStress(c.data(), f, x, flat), Hencky::kirchhoff(c.data(), g, y, deep)(2, 2),
      1e-11 * plain.youngsModulus);
  }
  EXPECT_GT(flat[0], 0.01);
}

// A block pressed between four walls in plane strain moves evenly from its first step on; its logarithmic strain ε
// along y is that of the walls, and the return has a closed form: q = 2μ|ε| − 3μ ε̄ = σ_y + H ε̄.
TEST(PointYield, YieldingBlockInMotion)
{
  const PlasticMaterial m{ { .youngsModulus = 1, .poissonsRatio = 0.3, .barrier = 0 }, 0.02, 0.1 };
  const auto c = henckyConstants(m);
  const Lattice lattice = makeLattice(8, 8, 1, 2, 0.125);
  const std::vector<std::uint8_t> phase(64, 1);
  PointOptions made;
  made.density = { 1.0 };
  made.history = Hencky::history;
  auto points = pointsFromLattice<2>(lattice, phase, {}, made);
  const double rate = 0.05; // the grid keeps its eight cells: with other cells forces on them are not quite even
  samples::setVelocities<2>(points, [&](const Vector<2>& x) { return Vector<2>{ { 0, -rate * x[1] } }; });
  PointDynamicsOptions<2> o;
  o.spacing = 0.125;
  o.sides = { { { samples::wallAt(0), samples::wallAt(1) }, { samples::wallAt(0), samples::wallAt(1, -rate) } } };
  PointDynamics<2> body(std::move(points), makeLaw<2, Hencky>({ c }), o);
  body.advanceTo(0.95);
  const double before = body.time(); // forces on walls are those of a step's start
  body.advance(1);
  EXPECT_TRUE(body.fused());
  const auto logarithm = [&](double time) { return std::log(1 - rate * time); };
  const auto flow = [&](double strain) { return (-2 * c[1] * strain - 0.02) / (3 * c[1] + 0.1); };
  const double flowed = flow(logarithm(body.time()));
  const double q = 0.02 + 0.1 * flowed;
  for (std::size_t p = 0; p < body.points().count(); ++p)
  {
    EXPECT_NEAR(body.points().column(MaterialPoints<2>::histories + Hencky::plasticStrain)[p], flowed, 1e-10);
    EXPECT_NEAR(
      body.points().column(MaterialPoints<2>::histories + Hencky::plasticWork)[p], 0.5 * (0.02 + q) * flowed, 1e-10);
  }
  EXPECT_NEAR(body.energies().plastic, 0.5 * (0.02 + q) * flowed, 1e-10); // in a box of 1 × 1
  // the walls leave a height of exp ε, and plastic flow keeps volume: round-off of the sum
  const std::array<double, 2> volumes = body.volumes();
  EXPECT_NEAR(volumes[0] / volumes[1], std::exp(logarithm(body.time())), 1e-10);
  const double strain = logarithm(before);
  const double tau = (c[0] + 2 * c[1] / 3) * strain - 2 * (0.02 + 0.1 * flow(strain)) / 3;
  // over a width of 1; points carry gradients of velocity that are a step old: of the order of ρ V² = 2.5e-3 times Δt/H
  // = 0.05
  EXPECT_NEAR(body.wall(1, 1).force, -tau / std::exp(strain), 1e-4);
}

} // namespace
