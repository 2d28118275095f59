// Transients: order of convergence against exact solutions, with diffusive scaling (time step ~ spacing²), and what is
// conserved.
#include "LatticeBoltzmann.h"

#include <gtest/gtest.h>

#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::test;

constexpr double pi = std::numbers::pi;

PhaseImage uniform(std::int64_t nx, std::int64_t ny, std::int64_t nz, double spacing)
{
  PhaseImage image;
  image.lattice = makeLattice(nx, ny, nz, nz > 1 ? 3 : 2, spacing);
  image.phases = PhaseTable({ "a" });
  image.phase.assign(static_cast<std::size_t>(image.lattice.count()), 0);
  return image;
}

double order(double coarse, double fine)
{
  return std::log2(coarse / fine);
}

// cos kx in a periodic box decays as exp(−D k² t), along an axis and along a diagonal.
TEST(LatticeBoltzmannDecay, IsOfSecondOrder)
{
  const double d = 0.7;
  const double end = 0.02; // of a box of length 1: to 58 % along an axis
  for (const auto stencil : everyLattice)
    for (const auto collision : { Collision::BGK, Collision::TRT })
      for (const int waves : { 0, 1 }) // along y
      {
        double errors[2] = {};
        for (const int level : { 0, 1 })
        {
          const std::int64_t n = 12 << level;
          const auto image = uniform(n, n, dimensionOf(stencil) == 3 ? 4 : 1, 1.0 / static_cast<double>(n));
          SteppingOptions o;
          o.stencil = stencil;
          o.collision = collision;
          o.sides = { Boundary::Periodic, Boundary::Periodic, Boundary::Periodic };
          o.relaxation = 0.4;
          auto solver = stepper(image, { d }, o);
          const auto wave = [&](double x, double y, double)
          { return std::cos(2 * pi * (x + waves * y) / static_cast<double>(n)); };
          const auto initial = fieldOf(decompose(image.lattice, MPI_COMM_SELF), wave);
          solver.start(initial);
          solver.run(std::vector<double>{ end }, [](const LatticeBoltzmann&) {});
          const double decay = std::exp(-d * 4 * pi * pi * (1 + waves) * solver.time());
          const auto u = valueOf(solver, image.lattice.count());
          for (std::size_t i = 0; i < u.size(); ++i)
            errors[level] = std::max(errors[level], std::fabs(u[i] / decay - initial[i]));
        }
        EXPECT_LT(errors[1], 0.02) << name(stencil) << " " << name(collision);
        EXPECT_GT(order(errors[0], errors[1]), 1.8) << name(stencil) << " " << name(collision) << " " << waves;
      }
}

// u = 1 and 0 on the faces, 0 inside at the start: Σ over the sines of the slab (Carslaw & Jaeger, 3.3).
TEST(LatticeBoltzmannSlab, HeatsUpAtSecondOrder)
{
  const double d = 2e-7; // m²/s
  const double length = 1e-3;
  const double end = 0.5; // s
  for (const auto collision : { Collision::TRT, Collision::BGK })
  {
    double errors[2] = {};
    for (const int level : { 0, 1 })
    {
      const bool onNodes = collision == Collision::BGK;
      const std::int64_t cells = 16 << level;
      const std::int64_t n = cells + (onNodes ? 1 : 0);
      const double dx = length / static_cast<double>(cells);
      SteppingOptions o;
      o.collision = collision;
      o.relaxation = 0.5;
      auto solver = stepper(uniform(n, 3, 1, dx), { d }, o);
      std::vector<double> seen;
      solver.run(std::vector<double>{ end / 2, end }, [&](const LatticeBoltzmann& s) { seen.push_back(s.time()); });
      ASSERT_EQ(seen.size(), 2U);
      EXPECT_NEAR(seen[0], end / 2, solver.timeStep()); // the nearest pair of steps
      EXPECT_NEAR(seen[1], end, solver.timeStep());
      const auto u = valueOf(solver, 3 * n);
      for (std::int64_t x = 0; x < n; ++x)
      {
        const double at = (static_cast<double>(x) + (onNodes ? 0 : 0.5)) * dx / length;
        double exact = 1 - at;
        for (int k = 1; k < 60; ++k)
          exact -= 2 / (k * pi) * std::sin(k * pi * at) * std::exp(-d * std::pow(k * pi / length, 2) * solver.time());
        errors[level] = std::max(errors[level], std::fabs(u[static_cast<std::size_t>(n + x)] - exact));
      }
    }
    EXPECT_LT(errors[1], 1e-3) << name(collision);
    EXPECT_GT(order(errors[0], errors[1]), 1.8) << name(collision);
  }
}

// Two layers of equal thickness between faces: an eigenfunction, sin μ₁x in the first layer, sin μ₂(1 − x) in the
// second, with D₁μ₁² = D₂μ₂² = rate and value and flux continuous, decays as exp(−rate t).
TEST(LatticeBoltzmannLayers, DecayAtSecondOrder)
{
  const double d1 = 1.0;
  const double d2 = 0.1;
  // D₁μ₁ cot(μ₁/2) = −D₂μ₂ cot(μ₂/2), by halving; below the first pole of the right side
  const auto mismatch = [&](double rate)
  {
    const double m1 = std::sqrt(rate / d1);
    const double m2 = std::sqrt(rate / d2);
    return d1 * m1 / std::tan(m1 / 2) + d2 * m2 / std::tan(m2 / 2);
  };
  double low = d2 * pi * pi * 1.0001;      // μ₂/2 = π/2: both terms above 0
  double high = d2 * 4 * pi * pi * 0.9999; // μ₂/2 = π: −∞
  ASSERT_GT(mismatch(low), 0);
  ASSERT_LT(mismatch(high), 0);
  while (high - low > 1e-14 * high)
    (mismatch(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
  const double m1 = std::sqrt(low / d1);
  const double m2 = std::sqrt(low / d2);
  const auto shape = [&](double x)
  { return x < 0.5 ? std::sin(m1 * x) / std::sin(m1 / 2) : std::sin(m2 * (1 - x)) / std::sin(m2 / 2); };

  for (const auto stencil : everyLattice)
  {
    std::array<double, 3> errors{};
    for (const int level : { 0, 1, 2 })
    {
      const std::int64_t n = 16 << level;
      auto image = uniform(n, 2, dimensionOf(stencil) == 3 ? 2 : 1, 1.0 / static_cast<double>(n));
      for (std::size_t i = 0; i < image.phase.size(); ++i)
        image.phase[i] = static_cast<std::int64_t>(i) % n < n / 2 ? 0 : 1;
      SteppingOptions o;
      o.stencil = stencil;
      o.faceValues[0] = { 0, 0 };
      o.relaxation = 1.0;
      auto solver = stepper(image, { d1, d2 }, o);
      const auto initial = fieldOf(decompose(image.lattice, MPI_COMM_SELF),
        [&](double x, double, double) { return shape((x + 0.5) / static_cast<double>(n)); });
      solver.start(initial);
      solver.run(std::vector<double>{ 0.5 }, [](const LatticeBoltzmann&) {});
      const double decay = std::exp(-low * solver.time());
      const auto u = valueOf(solver, image.lattice.count());
      for (std::size_t i = 0; i < u.size(); ++i)
        errors[static_cast<std::size_t>(level)] =
          std::max(errors[static_cast<std::size_t>(level)], std::fabs(u[i] - decay * initial[i]));
    }
    EXPECT_LT(errors[2], 2e-3) << name(stencil);
    EXPECT_GT(order(errors[0], errors[1]), 1.7) << name(stencil);
    EXPECT_GT(order(errors[1], errors[2]), 1.8) << name(stencil);
  }
}

TEST(LatticeBoltzmannMass, IsConservedBetweenInsulatedSides)
{
  for (const auto stencil : everyLattice)
    for (const auto collision : { Collision::BGK, Collision::TRT })
    {
      const auto image = dimensionOf(stencil) == 2 ? noise(23, 17, 1, 0.6, 3) : noise(9, 8, 7, 0.6, 3);
      for (const double weak : { 0.2, 0.0 })
      {
        SteppingOptions o;
        o.stencil = stencil;
        o.collision = collision;
        o.sides = { Boundary::Insulated, Boundary::Periodic, Boundary::Insulated };
        auto solver = stepper(image, { weak, 1.0 }, o);
        std::mt19937_64 random(7);
        solver.start(fieldOf(decompose(image.lattice, MPI_COMM_SELF),
          [&](double, double, double) { return static_cast<double>(random() >> 11) * 0x1p-53; }));
        const double before = solver.mean();
        solver.advance(400);
        EXPECT_NEAR(solver.mean(), before, 1e-13) << name(stencil) << " " << name(collision); // round-off of 400 steps
      }
    }
}

} // namespace
