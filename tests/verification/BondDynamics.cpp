// Bonds in motion: waves of known frequency, every energy accounted for, the static solution in the end.
#include "BondSamples.h"

#include "core/Error.h"
#include "peridynamics/fracture/Dynamics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::test;
using namespace lamella::peridynamics;

constexpr double density = 1500;

BondModel periodicModel(int dimension)
{
  BondModel m = modelOf(dimension == 3 ? Continuum::Space : Continuum::PlaneStress, dimension == 3 ? 2 : 3);
  m.periodic = { true, true, dimension == 3 };
  return m;
}

FixedComponents nothingFixed(const BondLattice& bonds)
{
  return FixedComponents(bonds.layout().count());
}

template <class F>
void fillNodes(NodeField<double>& field, F&& value)
{
  const NodeLayout& l = field.layout();
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        for (int c = 0; c < l.dimension; ++c)
          field.at(c, x, y, z) = value(x + l.start[0], y + l.start[1], z + l.start[2], c);
}

/// ω² of a longitudinal wave along x with so many waves in n nodes: Σ over a node's bonds of k/|ξ| eₓ² (1 − cos q
/// ξₓ)/m.
double longitudinal(const BondLattice& bonds, double mass, int waves, std::int64_t n)
{
  double sum = 0;
  const std::int64_t i = bonds.layout().index(0, 0, 0);
  for (std::size_t o = 0; o < bonds.stencil().half().size(); ++o)
  {
    const Offset& offset = bonds.stencil().half()[o];
    const double e = offset.step[0] / offset.length;
    const double q = 2 * std::numbers::pi * waves / static_cast<double>(n);
    sum += 2 * bonds.springConstant(i, static_cast<int>(o)) * e * e * (1 - std::cos(q * offset.step[0]));
  }
  return std::sqrt(sum / mass);
}

// Velocity Verlet turns a linear mode by 2 asin(ω dt/2) a step, exactly; the amplitude is 1e-7 of the wave's length,
// so that the nonlinear force differs from the linear one by that part.
TEST(BondDynamics, AWaveHasItsFrequency)
{
  for (const int dimension : { 2, 3 })
  {
    SCOPED_TRACE(dimension);
    const std::int64_t n = 24;
    const Sample s = dimension == 2 ? block(n, 16) : block(n, 12, 12);
    const BondModel model = periodicModel(dimension);
    BondLattice bonds = latticeOf(model, s, everyone());
    DynamicsOptions o;
    o.density = density;
    BondDynamics motion(bonds, nothingFixed(bonds), o);
    const double omega = longitudinal(bonds, motion.mass(), 2, n);
    const double turn = 2 * std::asin(omega * motion.step() / 2);
    NodeField<double> u(bonds.layout());
    const NodeField<double> v(bonds.layout());
    const double amplitude = 1e-7 * spacing;
    fillNodes(u,
      [&](std::int64_t x, std::int64_t, std::int64_t, int c) {
        return c == 0 ? amplitude * std::cos(4 * std::numbers::pi * static_cast<double>(x) / static_cast<double>(n))
                      : 0;
      });
    motion.setState(u, v);
    const std::int64_t steps = 1000;
    motion.advance(steps);
    double worst = 0;
    const NodeLayout& l = bonds.layout();
    for (std::int64_t x = 0; x < l.size[0]; ++x)
      worst = std::max(worst,
        std::abs(motion.displacement().at(0, x, 0) - u.at(0, x, 0) * std::cos(static_cast<double>(steps) * turn)));
    EXPECT_LT(worst, 1e-5 * amplitude);
    EXPECT_NEAR(motion.time(), static_cast<double>(steps) * motion.step(), 1e-9 * motion.time());
  }
}

// Twice a step below the bound the shortest waves grow, at the bound they do not: the bound is no more than a fifth
// short of the true limit on these lattices.
TEST(BondDynamics, TheStableStepIsABound)
{
  for (const int dimension : { 2, 3 })
  {
    SCOPED_TRACE(dimension);
    const Sample s = dimension == 2 ? block(16, 16) : block(10, 10, 10);
    BondLattice bonds = latticeOf(periodicModel(dimension), s, alone());
    const double mass = density * std::pow(spacing, dimension);
    const double step = stableStep(bonds, mass);
    // The highest frequency of all plane waves along an axis.
    double highest = 0;
    for (int waves = 1; waves <= 8; ++waves)
      highest = std::max(highest, longitudinal(bonds, mass, waves, 16));
    EXPECT_LE(step, 2 / highest);
    EXPECT_GT(step, 0.8 * 2 / highest);
    DynamicsOptions o;
    o.density = density;
    o.step = 1.01 * step;
    try
    {
      BondDynamics refused(bonds, nothingFixed(bonds), o);
      FAIL() << "a step above the bound";
    }
    catch (const ParameterError& error)
    {
      EXPECT_NE(std::string(error.what()).find("above the stable one"), std::string::npos) << error.what();
    }
  }
}

/// A bar that is pulled apart at both ends: it stretches, breaks, and its pieces fly.
struct Pulled
{
  EnergyBalance energies;
  std::vector<DynamicBreak> broken;
};

Pulled pulled(double safety, double damping, bool breaking, double speed, double until, const Communicator& comm)
{
  const Sample s = aggregate(32, 48);
  BondModel model = aggregateModel(2);
  BondLattice bonds = latticeOf(model, s, comm);
  Loading loading;
  LoadedSample sample = applyLoading(bonds, loading);
  DynamicsOptions o;
  o.density = density;
  o.safety = safety;
  o.damping = damping;
  o.breaking = breaking;
  BondDynamics motion(bonds, std::move(sample.fixed), o);
  NodeField<double> v(bonds.layout());
  const double height = 48;
  fillNodes(v,
    [&](std::int64_t, std::int64_t y, std::int64_t, int c)
    { return c == 1 ? speed * (static_cast<double>(y) + 0.5) / height : 0; });
  motion.setState(NodeField<double>(bonds.layout()), v);
  motion.advance(std::llround(until / motion.step()));
  return { motion.energies(), motion.broken() };
}

// The balance's defect is velocity Verlet's own: it falls with the square of the step, to 1e-6, with bonds that break
// and without.
TEST(BondDynamics, EnergyIsBalanced)
{
  for (const bool breaking : { false, true })
  {
    SCOPED_TRACE(breaking);
    std::array<double, 2> defect{};
    for (int i = 0; i < 2; ++i)
    {
      const Pulled p = pulled(i == 0 ? 0.1 : 0.02, 0, breaking, 6, 4e-5, everyone());
      defect[static_cast<std::size_t>(i)] = std::abs(p.energies.defect());
      EXPECT_EQ(breaking, !p.broken.empty());
      EXPECT_EQ(p.energies.damped, 0);
      EXPECT_EQ(breaking, p.energies.broken > 0);
    }
    EXPECT_LT(defect[1], 1e-6) << defect[0];
    // Without breaks the coarser one is near round-off already.
    const double order = breaking ? std::log(defect[0] / defect[1]) / std::log(5) : 2;
    EXPECT_NEAR(order, 2, 0.3);
  }
}

TEST(BondDynamics, TheSameOnAnyNumberOfRanks)
{
  const Pulled one = pulled(0.8, 0.05, true, 6, 6e-5, alone());
  const Pulled all = pulled(0.8, 0.05, true, 6, 6e-5, everyone());
  ASSERT_GT(one.broken.size(), 10U);
  ASSERT_EQ(one.broken.size(), all.broken.size());
  for (std::size_t i = 0; i < one.broken.size(); ++i)
  {
    EXPECT_TRUE(one.broken[i].bond == all.broken[i].bond) << i;
    EXPECT_EQ(one.broken[i].step, all.broken[i].step);
    EXPECT_NEAR(one.broken[i].energy, all.broken[i].energy, 1e-9 * one.broken[i].energy);
  }
  EXPECT_NEAR(one.energies.kinetic, all.energies.kinetic, 1e-9 * one.energies.kinetic);
}

// Damped motion ends in the equilibrium.
TEST(BondDynamics, DampingLeadsToTheEquilibrium)
{
  const Sample s = aggregate(24, 32);
  BondLattice bonds = latticeOf(aggregateModel(2), s, everyone());
  Loading loading;
  loading.strain = 1e-6;
  LoadedSample sample = applyLoading(bonds, loading);
  Equilibrium equilibrium(bonds, sample.fixed, with(EquilibriumSolver::Multigrid, 1e-10));
  NodeField<double> exact = sample.displacement;
  equilibrium.solve(exact);
  DynamicsOptions o;
  o.density = density;
  o.damping = 0.02;
  BondDynamics motion(bonds, sample.fixed, o);
  const NodeField<double> rest(bonds.layout());
  motion.setState(sample.displacement, rest);
  motion.advance(12000);
  double worst = 0;
  double largest = 0;
  const NodeLayout& l = bonds.layout();
  for (std::int64_t y = 0; y < l.size[1]; ++y)
    for (std::int64_t x = 0; x < l.size[0]; ++x)
      if (bonds.solid(l.index(x, y)) && bonds.degree(l.index(x, y)) > 4)
      {
        worst = std::max(worst, std::abs(motion.displacement().at(1, x, y) - exact.at(1, x, y)));
        largest = std::max(largest, std::abs(exact.at(1, x, y)));
      }
  EXPECT_LT(bonds.communicator().max(worst), 1e-5 * bonds.communicator().max(largest));
  // What was in the first state and is not in the last has been damped. It began with a shock, whose shortest waves
  // turn by more than 1 a step: velocity Verlet keeps an energy that differs by (ω dt)²/4 of theirs.
  EXPECT_LT(std::abs(motion.energies().defect()), 0.05);
  EXPECT_GT(motion.energies().damped, 0);
}

// A1 and A2 by hand: without breaks Γ = 1 − exp(−t/τ); after a burst of energy ω₀ at t = 0, ω = ω₀ exp(−t/τ) and the
// rate falls at first as exp(−1) says.
TEST(BondDynamics, TheLoadingRateGivesWay)
{
  RegulatedRate calm(2, 5);
  for (int i = 0; i < 300; ++i)
    calm.advance(0.01, 0);
  EXPECT_NEAR(calm.rate(), 1 - std::exp(-1.5), 1e-12);
  RegulatedRate burst(2, 5, 1);
  burst.advance(1e-3, 5);
  for (int i = 1; i < 3000; ++i)
    burst.advance(1e-3, 0);
  EXPECT_NEAR(burst.damage(), 5 * std::exp(-1.5), 1e-9);
  // dΓ/dt = −(Γ − exp(−exp(−t/τ)))/τ with z = exp(−t/τ): Γ = z + ∫ over z' of exp(−z') z/z'² …, by Simpson's rule here.
  const double tau = 2;
  const auto slope = [&](double t, double g) { return -(g - std::exp(-std::exp(-t / tau))) / tau; };
  double g = 1;
  const double h = 1e-3;
  for (int i = 0; i < 3000; ++i)
  {
    const double t = h * i;
    const double a = slope(t, g);
    const double b = slope(t + h / 2, g + h / 2 * a);
    const double c = slope(t + h / 2, g + h / 2 * b);
    g += h / 6 * (a + 2 * b + 2 * c + slope(t + h, g + h * c));
  }
  EXPECT_NEAR(burst.rate(), g, 1e-7); // second order in the step: (1e-3/2)²
  EXPECT_THROW(RegulatedRate(0, 1), ParameterError);
  EXPECT_THROW(RegulatedRate(1, std::nan("")), ParameterError);
  EXPECT_THROW(RegulatedRate(1, 1, 2), ParameterError);
}

TEST(BondDynamics, StopsAndRefuses)
{
  const Sample s = block(12, 12);
  BondLattice bonds = latticeOf(modelOf(Continuum::PlaneStress, 3), s, alone());
  DynamicsOptions o;
  o.density = density;
  o.progress = [](const DynamicsProgress& p) { return p.step >= 200; };
  BondDynamics motion(bonds, nothingFixed(bonds), o);
  EXPECT_FALSE(motion.advance(1000));
  EXPECT_GE(motion.steps(), 200);
  EXPECT_LE(motion.steps(), 300); // a hundred steps from one look to the next at most
  for (const auto& spoil : std::array<void (*)(DynamicsOptions&), 5>{ [](DynamicsOptions& x) { x.density = 0; },
         [](DynamicsOptions& x) { x.safety = 1.5; }, [](DynamicsOptions& x) { x.damping = -1; },
         [](DynamicsOptions& x) { x.step = 0.0; }, [](DynamicsOptions& x) { x.density = std::nan(""); } })
  {
    DynamicsOptions bad;
    spoil(bad);
    EXPECT_THROW(BondDynamics(bonds, nothingFixed(bonds), bad), ParameterError);
  }
  NodeField<double> u(bonds.layout());
  u.at(0, 5, 5) = std::nan("");
  EXPECT_THROW(
    {
      motion.setState(u, NodeField<double>(bonds.layout()));
      motion.advance(1);
    },
    DivergenceError);
}

} // namespace
