// Equilibrium of bond lattices: exact fields, all solvers alike, iterations that do not grow, and
// samples that fall apart.
#include "BondSamples.h"

#include "core/Error.h"
#include "peridynamics/PeriodicCell.h"

#include <gtest/gtest.h>

#include <functional>

namespace
{

using namespace lamella;
using namespace lamella::test;

// A bar that is periodic across: stretched by platens, every bond feels the same strain, so u is linear, the reaction
// is C₂₂ ε times the width, and the first bond to break is one along the load, at a strain of s₀.
TEST(BondEquilibrium, UniformBar)
{
  for (const double horizon : { 2.0, 3.0, 4.0, 5.0, 6.0, 8.0 })
  {
    BondModel m = modelOf(Continuum::PlaneStress, horizon);
    m.periodic = { true, false, false };
    const Sample s{ makeLattice(40, 64, 1, 2, spacing), std::vector<std::uint8_t>(40 * 64, 1), {} };
    const BondLattice bonds = latticeOf(m, s, everyone());
    Loading loading;
    loading.strain = 2e-3;
    loading.rigid = false;
    const Solution r = solve(bonds, loading, with(EquilibriumSolver::Multigrid, 1e-12));
    const LatticeModuli moduli = latticeModuli(bonds.stencil(), Continuum::PlaneStress);
    const double nu = moduli.poissonsRatio;
    const double c22 = young * moduli.youngsModulus / (1 - nu * nu);
    // the residual's tolerance times a condition number of some hundred
    EXPECT_NEAR(r.reaction.low[1] / (c22 * loading.strain * 40 * spacing), 1, 1e-9) << horizon;
    EXPECT_NEAR(r.reaction.low[1], -r.reaction.high[1], 1e-9 * std::abs(r.reaction.low[1])) << horizon;
    const StretchMaximum first = largestStretch(bonds, r.u, false);
    EXPECT_NEAR(loading.strain / first.ratio, 0.01, 1e-8) << horizon;
    // mean stress over the bulk is the reaction over the width
    const auto section = sectionForce(bonds, r.u, 1, 32, false);
    EXPECT_NEAR(std::abs(section[1]) / std::abs(r.reaction.low[1]), 1, 1e-9) << horizon;
  }
}

// The mean strain of a periodic cell of one phase gives the constants of the lattice themselves.
TEST(BondEquilibrium, PeriodicCellOfOnePhase)
{
  for (const double horizon : { 2.0, 3.0, 5.0 })
    for (const Continuum continuum : { Continuum::PlaneStress, Continuum::Space })
    {
      const bool space = continuum == Continuum::Space;
      if (space && horizon > 3)
        continue;
      BondModel m = modelOf(continuum, horizon);
      m.periodic = { true, true, space };
      const std::int64_t n = space ? 12 : 24;
      const Lattice l = makeLattice(n, n, space ? n : 1, space ? 3 : 2, spacing);
      const Sample s{ l, std::vector<std::uint8_t>(static_cast<std::size_t>(l.count()), 1), {} };
      const BondLattice bonds = latticeOf(m, s, alone());
      const EffectiveStiffness c = effectiveStiffness(bonds);
      const LatticeModuli moduli = latticeModuli(bonds.stencil(), continuum);
      EXPECT_NEAR(c.constants.youngsModulus[0] / (young * moduli.youngsModulus), 1, 1e-10) << horizon;
      EXPECT_EQ(c.solutions[0].iterations, 0);
      EXPECT_NEAR(c.constants.youngsModulus[1] / c.constants.youngsModulus[0], 1, 1e-10) << horizon;
      EXPECT_NEAR(c.constants.poissonsRatio[0], moduli.poissonsRatio, 1e-10) << horizon;
    }
}

// A laminate across the load: between its layers bonds of the mean stiffness. Its stiffness lies between the bounds of
// Voigt and Reuss, and the whole tensor is symmetric.
TEST(BondEquilibrium, PeriodicCellIsSymmetricAndBounded)
{
  BondModel m = aggregateModel(2);
  m.periodic = { true, true, false };
  Sample s = aggregate(48, 48, 1, 0.3);
  const BondLattice bonds = latticeOf(m, s, alone());
  EquilibriumOptions o;
  o.tolerance = 1e-9;
  const EffectiveStiffness c = effectiveStiffness(bonds, o);
  const auto at = [&](int i, int j) { return c.stiffness[static_cast<std::size_t>(3 * i + j)]; };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j)
      EXPECT_NEAR(at(i, j), at(j, i), 1e-7 * at(0, 0)); // of energies that converge like the square of the residual
  EXPECT_GT(at(0, 0), 0);
  EXPECT_LT(at(0, 0), 4 * young * 1.2);
}

TEST(BondEquilibrium, SolversAgree)
{
  struct Case
  {
    Sample sample;
    BondModel model;
    Loading loading;
  };
  std::vector<Case> cases;
  cases.push_back({ aggregate(48, 96), aggregateModel(2), {} });
  cases.push_back({ aggregate(45, 70), aggregateModel(2, 100), { .load = LoadCase::Shear } });
  cases.push_back({ aggregate(48, 60), aggregateModel(2), { .load = LoadCase::Traction, .traction = 1e6 } });
  cases.push_back({ aggregate(48, 60), aggregateModel(2), { .smooth = true } });
  cases.push_back({ aggregate(48, 60), aggregateModel(2), { .load = LoadCase::Biaxial, .lateralStrain = -5e-4 } });
  cases.push_back({ aggregate(10, 11, 12), aggregateModel(3), {} });
  BondModel corrected = aggregateModel(2);
  corrected.surfaceCorrection = true;
  corrected.notches = { { { 10.3 * spacing, 30.2 * spacing, 0 }, { 20 * spacing, 0, 0 }, {} } };
  cases.push_back({ aggregate(48, 60), corrected, {} });
  BondModel across = aggregateModel(2);
  across.periodic = { true, false, false };
  cases.push_back({ aggregate(48, 60), across, {} });
  BondModel far = aggregateModel(2);
  far.horizon = 6;
  cases.push_back({ aggregate(60, 80), far, {} });
  for (std::size_t k = 0; k < cases.size(); ++k)
  {
    SCOPED_TRACE(k);
    const BondLattice bonds = latticeOf(cases[k].model, cases[k].sample, alone());
    const auto by = [&](EquilibriumSolver solver, double tolerance)
    { return solve(bonds, cases[k].loading, with(solver, tolerance)); };
    const Solution multigrid = by(EquilibriumSolver::Multigrid, 1e-12);
    const Solution jacobi = by(EquilibriumSolver::Jacobi, 1e-12);
    // the residual's tolerance times the condition number, some 1e4
    EXPECT_LT(difference(multigrid, jacobi, bonds), 1e-8);
    EXPECT_LT(multigrid.result.iterations, jacobi.result.iterations / 2);
    if (!cases[k].loading.smooth) // which leaves the sample free to slide
    {
      const Solution direct = by(EquilibriumSolver::Direct, 1e-12);
      EXPECT_LT(difference(multigrid, direct, bonds), 1e-8);
      EXPECT_NEAR(multigrid.reaction.low[1], direct.reaction.low[1], 1e-8 * std::abs(direct.reaction.low[1]));
    }
    if (k == 0)
      EXPECT_LT(difference(by(EquilibriumSolver::DynamicRelaxation, 1e-9), multigrid, bonds), 1e-5);
  }
}

// Twice and four times as fine: the same sample, hardly more iterations.
TEST(BondEquilibrium, IterationsDoNotGrow)
{
  for (const bool homogeneous : { true, false })
  {
    std::vector<std::int64_t> iterations;
    for (const std::int64_t n : { 64, 128, 256 })
    {
      Sample s = aggregate(n, n);
      if (homogeneous)
        std::fill(s.phase.begin(), s.phase.end(), std::uint8_t{ 1 });
      const BondLattice bonds = latticeOf(aggregateModel(2), s, alone());
      iterations.push_back(solve(bonds, {}, with(EquilibriumSolver::Multigrid, 1e-6)).result.iterations);
    }
    EXPECT_LT(static_cast<double>(iterations[2]), 1.5 * static_cast<double>(iterations[0])) << homogeneous;
    EXPECT_LE(iterations[2], homogeneous ? 4 : 25);
  }
}

// Platens that turn take everything along; no bond is stretched, though displacements are as large as the sample.
TEST(BondEquilibrium, LargeRotationIsFreeOfForce)
{
  const Sample s{ makeLattice(16, 40, 1, 2, spacing), std::vector<std::uint8_t>(16 * 40, 1), {} };
  const BondLattice bonds = latticeOf(modelOf(Continuum::PlaneStress, 3), s, alone());
  LoadedSample loaded = applyLoading(bonds, {});
  const NodeLayout& l = bonds.layout();
  const double angle = 0.7;
  NodeField<double> exact(l);
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 16; ++x)
    {
      const double px = spacing * static_cast<double>(x);
      const double py = spacing * static_cast<double>(y);
      exact.at(0, x, y) = std::cos(angle) * px - std::sin(angle) * py - px;
      exact.at(1, x, y) = std::sin(angle) * px + std::cos(angle) * py - py;
    }
  // a guess that is off by a fiftieth of a spacing inside
  loaded.displacement = exact;
  for (std::int64_t y = 3; y < 37; ++y)
    for (std::int64_t x = 0; x < 16; ++x)
      loaded.displacement.at(0, x, y) += 0.02 * spacing * std::sin(static_cast<double>(x * y));
  EquilibriumOptions o;
  o.strains = Strains::Large;
  o.tolerance = 1e-11;
  Equilibrium equilibrium(bonds, loaded.fixed, o);
  const EquilibriumResult r = equilibrium.solve(loaded.displacement);
  for (std::int64_t y = 0; y < 40; ++y)
    for (std::int64_t x = 0; x < 16; ++x)
      for (int c = 0; c < 2; ++c)
        EXPECT_NEAR(loaded.displacement.at(c, x, y), exact.at(c, x, y), 1e-9 * 40 * spacing);
  EXPECT_LE(r.newtonSteps, 8);
  NodeField<double> f(l);
  nonlinearForce(bonds, loaded.displacement, f);
  EXPECT_NEAR(elasticEnergy(bonds, loaded.displacement, true), 0, 1e-12 * young * spacing * spacing);
}

// Small loads: large strains and small ones differ by the strain.
TEST(BondEquilibrium, LargeStrainsTendToSmall)
{
  const Sample s = aggregate(40, 60, 1, 0);
  const BondLattice bonds = latticeOf(aggregateModel(2), s, alone());
  std::vector<double> apart;
  for (const double strain : { 1e-3, 1e-4 })
  {
    Loading loading;
    loading.strain = strain;
    EquilibriumOptions o = with(EquilibriumSolver::Multigrid, 1e-11);
    const Solution small = solve(bonds, loading, o);
    o.strains = Strains::Large;
    const Solution large = solve(bonds, loading, o);
    apart.push_back(difference(large, small, bonds));
  }
  EXPECT_NEAR(apart[0] / apart[1], 10, 1);
}

TEST(BondEquilibrium, LoosePiecesAreTakenOut)
{
  Sample s{ makeLattice(40, 60, 1, 2, spacing), std::vector<std::uint8_t>(40 * 60, 1), {} };
  const auto set = [&](std::int64_t x0, std::int64_t x1, std::int64_t y0, std::int64_t y1, std::uint8_t phase)
  {
    for (std::int64_t y = y0; y < y1; ++y)
      for (std::int64_t x = x0; x < x1; ++x)
        s.phase[static_cast<std::size_t>(s.lattice.index(x, y))] = phase;
  };
  set(10, 30, 20, 40, 0);
  set(16, 24, 26, 34, 1); // an island further off than a bond reaches
  set(12, 13, 23, 24, 1); // a node on one bond, free to swing
  const BondLattice bonds = latticeOf(modelOf(Continuum::PlaneStress, 3), s, alone());
  LoadedSample loaded = applyLoading(bonds, {});
  EXPECT_EQ(loaded.loosePieces, 1);
  EXPECT_EQ(loaded.looseNodes, 64);
  const Solution r = solve(bonds, {}, with(EquilibriumSolver::Multigrid, 1e-10));
  EXPECT_EQ(r.u.at(1, 20, 30), 0);
  EXPECT_NEAR(r.reaction.low[1], -r.reaction.high[1], 1e-8 * std::abs(r.reaction.low[1]));

  set(0, 40, 28, 32, 0); // cut through
  const BondLattice cut = latticeOf(modelOf(Continuum::PlaneStress, 3), s, alone());
  try
  {
    (void)applyLoading(cut, {});
    FAIL() << "no path";
  }
  catch (const NoPathError& e)
  {
    EXPECT_NE(std::string(e.what()).find("no piece of the sample reaches"), std::string::npos) << e.what();
  }
}

// One row of nodes is no stiffer across than a string of pearls: hinges, which move nothing else.
TEST(BondEquilibrium, HangingNodesAndHinges)
{
  Sample s{ makeLattice(40, 40, 1, 2, spacing), std::vector<std::uint8_t>(40 * 40, 1), {} };
  for (std::int64_t y = 10; y < 30; ++y)
    for (std::int64_t x = 10; x < 30; ++x)
      if (y != 20 || x > 20)
        s.phase[static_cast<std::size_t>(s.lattice.index(x, y))] = x > 20 && y == 20 ? 1 : 0;
  const BondLattice bonds = latticeOf(modelOf(Continuum::PlaneStress, 1.5), s, alone());
  Loading loading;
  const Solution r = solve(bonds, loading, with(EquilibriumSolver::Multigrid, 1e-10));
  EXPECT_GT(r.result.hinges, 0);
  EXPECT_LT(r.result.iterations, 60);
  EXPECT_NEAR(r.reaction.low[1], -r.reaction.high[1], 1e-8 * std::abs(r.reaction.low[1]));
}

TEST(BondEquilibrium, RefusesWhatCannotBe)
{
  const Sample s{ makeLattice(20, 24, 1, 2, spacing), std::vector<std::uint8_t>(20 * 24, 1), {} };
  BondModel m = modelOf(Continuum::PlaneStress, 3);
  const BondLattice bonds = latticeOf(m, s, alone());
  const auto message = [&](const BondLattice& b, const Loading& loading)
  {
    try
    {
      (void)applyLoading(b, loading);
    }
    catch (const Error& e)
    {
      return std::string(e.what());
    }
    return std::string("nothing");
  };
  EXPECT_NE(message(bonds, { .strain = std::nan("") }).find("strain nan"), std::string::npos);
  EXPECT_NE(message(bonds, { .axis = 2 }).find("no axis 2"), std::string::npos);
  EXPECT_NE(message(bonds, { .layers = 12 }).find("two platens of 12 layers"), std::string::npos);
  m.periodic = { false, true, false };
  EXPECT_NE(message(latticeOf(m, s, alone()), {}).find("periodic along y"), std::string::npos);
  EXPECT_THROW((void)effectiveStiffness(bonds), ParameterError);
}

TEST(BondEquilibrium, StopsWhenAsked)
{
  const Sample s = aggregate(40, 60);
  const BondLattice bonds = latticeOf(aggregateModel(2), s, alone());
  EquilibriumOptions o = with(EquilibriumSolver::Multigrid, 1e-10);
  o.progress = [](double) { return true; };
  EXPECT_THROW(solve(bonds, {}, o), Cancelled);
  o.progress = {};
  o.maxIterations = 2;
  EXPECT_THROW(solve(bonds, {}, o), DivergenceError);
}

} // namespace
