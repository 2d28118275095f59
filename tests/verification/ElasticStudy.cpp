// Materials by name, and the elastic job as a whole: stiffness of the lattice, first break, balance, ranks, warnings.
#include "Bonds.h"

#include "core/Error.h"
#include "peridynamics/ElasticStudy.h"
#include "peridynamics/PairTable.h"

#include <gtest/gtest.h>

#include <limits>

namespace
{

using namespace lamella;
using namespace lamella::peridynamics;
using namespace lamella::test;

constexpr double spacing = 1e-4;
constexpr double young = 2e9;

Sample filled(std::int64_t nx, std::int64_t ny, std::int64_t nz = 1)
{
  const Lattice lattice = makeLattice(nx, ny, nz, nz > 1 ? 3 : 2, spacing);
  return { lattice, std::vector<std::uint8_t>(static_cast<std::size_t>(lattice.count()), 1), {} };
}

BondModel one(double horizon = 3)
{
  BondModel m;
  m.horizon = horizon;
  m.pairs[{ 1, 1 }].material.youngsModulus = young;
  m.pairs[{ 1, 1 }].material.criticalStretch = 2e-3;
  return m;
}

/// 1e-11: far below what is compared.
ElasticOptions exact()
{
  ElasticOptions o;
  o.equilibrium.tolerance = 1e-11;
  return o;
}

ElasticResult solve(const BondModel& m, const Sample& s, const ElasticOptions& o, const Communicator& comm)
{
  const Block b = slab(s.lattice, Stencil(s.lattice.dimension, m.horizon), comm);
  const std::size_t axis = s.lattice.dimension == 3 ? 2 : 1;
  const auto layer = static_cast<std::size_t>(s.lattice.count() / s.lattice.size[axis]);
  const std::size_t first = layer * static_cast<std::size_t>(b.start[axis]);
  const auto count = static_cast<std::size_t>(b.count());
  return studyElastic(m, s.lattice, std::span(s.phase).subspan(first, count),
    s.grain.empty() ? std::span<const std::int32_t>() : std::span<const std::int32_t>(s.grain).subspan(first, count), o,
    comm);
}

/// A plate with holes, and a stiffer half.
Sample plate(std::int64_t nx = 40, std::int64_t ny = 60)
{
  Sample s = filled(nx, ny);
  for (std::int64_t y = 0; y < ny; ++y)
    for (std::int64_t x = 0; x < nx; ++x)
    {
      const bool hole =
        (x - 13) * (x - 13) + (y - 22) * (y - 22) < 40 || (x - 28) * (x - 28) + (y - 40) * (y - 40) < 50;
      s.phase[static_cast<std::size_t>(s.lattice.index(x, y))] = hole ? 0 : x < nx / 2 ? 1 : 2;
    }
  return s;
}

BondModel two()
{
  BondModel m = one();
  m.pairs[{ 2, 2 }].material = { .youngsModulus = 4 * young, .criticalStretch = 2e-3 };
  m.pairs[{ 1, 2 }].material = { .youngsModulus = young, .criticalStretch = 2e-3 };
  return m;
}

// Platens disturb the strain near them only, alike in a short and a long bar: the bar between has the stiffness of the
// lattice sums, E/(1 − ν²) where it is periodic across. What is left of the disturbance falls as e^(−2πL/W) or faster.
TEST(ElasticStudy, BarHasTheStiffnessOfTheLatticeSums)
{
  for (const double horizon : { 2.0, 3.0, 4.0 })
  {
    SCOPED_TRACE(horizon);
    BondModel m = one(horizon);
    m.periodic = { true, false, false };
    const ElasticResult low = solve(m, filled(12, 60), exact(), alone());
    const ElasticResult high = solve(m, filled(12, 100), exact(), alone());
    const double compliance =
      (high.length / high.effectiveModulus - low.length / low.effectiveModulus) / (high.length - low.length);
    const LatticeModuli lattice = latticeModuli(Stencil(2, horizon), Continuum::PlaneStress);
    const double expected = young * lattice.youngsModulus / (1 - lattice.poissonsRatio * lattice.poissonsRatio);
    EXPECT_NEAR(1 / compliance / expected, 1, 1e-7);
    EXPECT_EQ(low.solve.hinges, 0);
    EXPECT_EQ(low.warnings.empty(), horizon >= 3);
  }
}

// Both platens carry the same force; it is that through every section; work done is energy stored; the mean over the
// box of the nodes' stresses is the sum over bonds, by whichever way it was had.
TEST(ElasticStudy, ForcesWorkAndMeansAgree)
{
  for (const LoadCase load : { LoadCase::Stretch, LoadCase::Shear, LoadCase::Traction })
  {
    SCOPED_TRACE(static_cast<int>(load));
    const Sample s = plate();
    ElasticOptions o = exact();
    o.loading.load = load;
    o.loading.traction = 1e6;
    o.loading.rigid = true; // all work is done by one displacement
    const ElasticResult plain = solve(two(), s, o, alone());
    EXPECT_FALSE(plain.stress);
    o.stress = true;
    o.energyDensity = true;
    const ElasticResult r = solve(two(), s, o, alone());
    const auto c = static_cast<std::size_t>(r.across);
    EXPECT_NEAR(r.reactions.low[c] / -r.reactions.high[c], 1, 1e-8);
    const BondLattice bonds = latticeOf(two(), s, alone());
    for (const std::int64_t layer : { 10, 30, 45 })
      EXPECT_NEAR(sectionForce(bonds, r.displacement, 1, layer, false)[c] / (r.effectiveStress * r.area), 1, 1e-8);
    if (load == LoadCase::Traction)
      EXPECT_NEAR(r.effectiveStress / 1e6, 31.0 / 40, 0.3); // the force goes on solid nodes
    else
      EXPECT_NEAR(0.5 * r.effectiveStress * r.area * r.strain * r.length / r.elasticEnergy, 1, 1e-8);
    double energy = 0;
    std::array<double, 3> sum{};
    for (std::int64_t y = 0; y < 60; ++y)
      for (std::int64_t x = 0; x < 40; ++x)
      {
        energy += r.energyDensity->at(0, x, y) * spacing * spacing;
        for (int k = 0; k < 3; ++k)
          sum[static_cast<std::size_t>(k)] += r.stress->at(k, x, y) / 2400;
      }
    EXPECT_NEAR(energy / r.elasticEnergy, 1, 1e-12);
    const double scale = std::abs(r.effectiveStress);
    EXPECT_NEAR(r.meanStress[0], sum[0], 1e-9 * scale);
    EXPECT_NEAR(r.meanStress[1], sum[1], 1e-9 * scale);
    EXPECT_NEAR(r.meanStress[3], sum[2], 1e-9 * scale);
    EXPECT_EQ(r.meanStress[2], 0);
    EXPECT_EQ(plain.meanStress, r.meanStress);
    EXPECT_EQ(r.solidNodes, bonds.solidNodes());
    EXPECT_EQ(r.nodes, 2400);
    EXPECT_GT(r.strips.mixed, 0);
  }
}

// The mean over a periodic sample is taken another way.
TEST(ElasticStudy, MeanStressOfAPeriodicSample)
{
  BondModel m = one();
  m.periodic = { true, false, false };
  m.continuum = Continuum::PlaneStrain;
  const ElasticResult r = solve(m, filled(16, 40), exact(), alone());
  const double c12 = r.meanStress[0] / r.meanStress[1]; // in the bulk ν/(1 − ν); the platens hold nothing along x
  EXPECT_GT(c12, 0.2);
  EXPECT_NEAR(r.meanStress[2], 0.25 * (r.meanStress[0] + r.meanStress[1]), 1e-9 * r.meanStress[1]);
  EXPECT_NEAR(r.meanStress[3], 0, 1e-9 * r.meanStress[1]);
}

// Loaded up to the strain that was foretold the most stretched bond has just its s₀, and it is the one that was named.
TEST(ElasticStudy, FirstBreakByScaling)
{
  BondModel m = one();
  m.notches = { { { 0, 30.5 * spacing, 0 }, { 15.5 * spacing, 0, 0 }, {} } };
  const Sample s = filled(40, 60);
  const ElasticResult r = solve(m, s, exact(), alone());
  ASSERT_TRUE(r.firstBreak);
  // at the tip of the notch
  EXPECT_NEAR(r.firstBreak->position[0], 15.5 * spacing, 3 * spacing);
  EXPECT_NEAR(r.firstBreak->position[1], 30.5 * spacing, 2 * spacing);
  EXPECT_EQ(r.firstBreak->phases, (std::array<std::uint8_t, 2>{ 1, 1 }));
  EXPECT_NEAR(r.firstBreak->ratio * r.firstBreak->strain, 1e-3, 1e-15);
  EXPECT_NEAR(r.firstBreak->stress / r.firstBreak->strain / r.effectiveModulus, 1, 1e-12);
  ElasticOptions o = exact();
  o.loading.strain = r.firstBreak->strain;
  const ElasticResult there = solve(m, s, o, alone());
  EXPECT_NEAR(there.largestRatio, 1, 1e-9);
  EXPECT_EQ(there.firstBreak->bond, r.firstBreak->bond);
  // compressed, other bonds are stretched, later
  o.loading.strain = -1e-3;
  const ElasticResult pressed = solve(m, s, o, alone());
  EXPECT_LT(pressed.firstBreak->strain, -r.firstBreak->strain);
  EXPECT_NEAR(pressed.effectiveModulus / r.effectiveModulus, 1, 1e-9);
  // nothing can be scaled when strains are large, and the ratio differs by some of the strain
  o.loading.strain = 1e-3;
  o.equilibrium.strains = Strains::Large;
  const ElasticResult large = solve(m, s, o, alone());
  EXPECT_FALSE(large.firstBreak);
  EXPECT_NEAR(large.largestRatio / r.largestRatio, 1, 0.02);
  EXPECT_NE(large.largestRatio, r.largestRatio);
}

TEST(ElasticStudy, NothingBreaksWithoutACriticalStretch)
{
  BondModel m = one();
  m.pairs[{ 1, 1 }].material.criticalStretch.reset();
  const ElasticResult r = solve(m, filled(20, 30), exact(), alone());
  EXPECT_FALSE(r.firstBreak);
  EXPECT_EQ(r.largestRatio, 0);
}

// On any number of ranks: 1e-9, for the solver's residual is 1e-11.
TEST(ElasticStudy, RanksChangeNothing)
{
  for (const bool space : { false, true })
  {
    SCOPED_TRACE(space);
    Sample s = space ? filled(14, 13, 30) : plate();
    BondModel m = space ? one() : two();
    m.continuum = space ? Continuum::Space : Continuum::PlaneStress;
    if (space)
      for (std::size_t i = 0; i < s.phase.size(); ++i) // without symmetry: no two bonds are stretched alike
        s.phase[i] = i * 2654435761U % 4294967296U < 500'000'000U ? 0 : 1;
    ElasticOptions o = exact();
    o.stress = true;
    o.sensitivity = true;
    const ElasticResult own = solve(m, s, o, alone());
    const ElasticResult all = solve(m, s, o, everyone());
    EXPECT_NEAR(all.effectiveModulus / own.effectiveModulus, 1, 1e-9);
    EXPECT_NEAR(all.elasticEnergy / own.elasticEnergy, 1, 1e-9);
    EXPECT_NEAR(all.firstBreak->strain / own.firstBreak->strain, 1, 1e-8);
    EXPECT_EQ(all.firstBreak->bond, own.firstBreak->bond);
    EXPECT_EQ(all.sensitivity->pair, own.sensitivity->pair);
    for (std::size_t i = 0; i < own.sensitivity->stiffness.size(); ++i)
      EXPECT_NEAR(all.sensitivity->stiffness[i], own.sensitivity->stiffness[i], 1e-8);
    EXPECT_EQ(all.firstBreak->phases, own.firstBreak->phases);
    EXPECT_EQ(all.firstBreak->position, own.firstBreak->position);
    for (std::size_t c = 0; c < 6; ++c)
      EXPECT_NEAR(all.meanStress[c], own.meanStress[c], 1e-9 * own.effectiveStress);
    EXPECT_EQ(all.bonds, own.bonds);
    EXPECT_EQ(all.solve.hinges, own.solve.hinges);
    EXPECT_EQ(all.warnings, own.warnings);
    ASSERT_EQ(all.thickness.size(), own.thickness.size());
    for (std::size_t i = 0; i < all.thickness.size(); ++i)
    {
      EXPECT_EQ(all.thickness[i].median, own.thickness[i].median);
      EXPECT_EQ(all.thickness[i].thinShare, own.thickness[i].thinShare);
    }
  }
}

// The adjoint at the default tolerance, in single precision. Coarse levels are cut elsewhere, so what its residual
// leaves differs: each may err by 1e-3 of the largest derivative, which is about a half.
TEST(ElasticStudy, RanksAgreeOnDerivatives)
{
  ElasticOptions o = exact();
  o.equilibrium.tolerance = EquilibriumOptions{}.tolerance;
  o.sensitivity = true;
  const ElasticResult own = solve(two(), plate(), o, alone());
  const ElasticResult all = solve(two(), plate(), o, everyone());
  ASSERT_TRUE(own.sensitivity && all.sensitivity);
  EXPECT_GT(own.sensitivity->iterations, 0);
  EXPECT_EQ(all.sensitivity->pair, own.sensitivity->pair);
  ASSERT_EQ(all.sensitivity->stiffness.size(), own.sensitivity->stiffness.size());
  for (std::size_t i = 0; i < own.sensitivity->stiffness.size(); ++i)
    EXPECT_NEAR(all.sensitivity->stiffness[i], own.sensitivity->stiffness[i], 1e-3) << i;
}

// A traction on two blocks with a layer between them that is a million times softer: what moves is the layer, and the
// residual counts over the forces that hold the blocks. What it does on the way is told, tells how far the modulus is
// off, and is 1e-8 of what the load does; a residual of 1e-3 leaves no more, but may be of the layer's own size, which
// is warned of.
TEST(ElasticStudy, ATractionIsDoubted)
{
  if (everyone().rank() != 0)
    return;
  Sample s = filled(40, 60);
  std::fill_n(s.phase.begin() + std::ptrdiff_t{ 40 } * 28, 40 * 4, std::uint8_t{ 2 });
  const auto pulled = [&](double soft, double tolerance, EquilibriumSolver solver)
  {
    BondModel m = one();
    m.pairs[{ 2, 2 }].material.youngsModulus = m.pairs[{ 1, 2 }].material.youngsModulus = soft * young;
    ElasticOptions o;
    o.loading.load = LoadCase::Traction;
    o.loading.traction = 1e3;
    o.equilibrium.tolerance = tolerance;
    o.equilibrium.solver = solver;
    o.threads = 1;
    return solve(m, s, o, alone());
  };
  for (const double soft : { 1e-1, 1e-4, 1e-6 })
  {
    SCOPED_TRACE(soft);
    const ElasticResult exact = pulled(soft, 1e-6, EquilibriumSolver::Direct);
    for (const auto solver : { EquilibriumSolver::Multigrid, EquilibriumSolver::Jacobi })
      for (const double tolerance : { 1e-3, 1e-6 })
      {
        const ElasticResult r = pulled(soft, tolerance, solver);
        EXPECT_GT(r.solve.doubt, 0);
        EXPECT_LT(r.solve.doubt, 1e-7);
        // of second order in what is left of displacements: measured 4e-5 at 1e-3
        EXPECT_NEAR(r.effectiveModulus / exact.effectiveModulus, 1, 0.1 * tolerance);
        const bool nothing = !r.warnings.empty() && r.warnings.back().find("tolerance of nothing") != std::string::npos;
        EXPECT_EQ(nothing, soft < 1e-5 && tolerance > 1e-4);
      }
  }
}

// What is said of a doubt depends on what it is of.
TEST(ElasticStudy, DoubtsAreNamed)
{
  EXPECT_EQ(doubtWarning(1e-4), "");
  EXPECT_EQ(doubtWarning(std::numeric_limits<double>::quiet_NaN(), true), "");
  EXPECT_EQ(
    doubtWarning(0.023).find("forces through sections of the sample differ by 0.023 times that on the platens: "), 0U);
  EXPECT_EQ(
    doubtWarning(0.023, true).find("the forces that are not in balance do 0.023 times the work of the load: "), 0U);
}

// Each warning has its numbers.
TEST(ElasticStudy, Warnings)
{
  if (everyone().rank() != 0)
    return;
  const auto warnings = [](const BondModel& m, const Sample& s)
  { return solve(m, s, ElasticOptions(), alone()).warnings; };
  // 0.60: references, lattice sums at h/δx = 2
  ASSERT_EQ(warnings(one(2), filled(20, 30)).size(), 1U);
  EXPECT_NE(warnings(one(2), filled(20, 30))[0].find("Young's modulus at 45° is 0.60"), std::string::npos);
  // a layer of two nodes between two blocks
  Sample layer = filled(20, 40);
  for (std::size_t x = 0; x < 20; ++x)
    layer.phase[20 * 20 + x] = layer.phase[21 * 20 + x] = 2;
  BondModel m = two();
  m.phaseNames = { "void", "wall", "lamella" };
  auto found = warnings(m, layer);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].find("lamella is 2 nodes thick (median; 100 % of its nodes"), 0U) << found[0];
  // at the sample's edge nobody knows how thick it is
  Sample edge = filled(20, 40);
  std::fill_n(edge.phase.begin(), 20, std::uint8_t{ 2 });
  EXPECT_TRUE(warnings(m, edge).empty());
  // a grain that floats in a hole
  Sample loose = filled(40, 60);
  for (std::int64_t y = 20; y < 40; ++y)
    for (std::int64_t x = 10; x < 30; ++x)
      if (x < 14 || x > 25 || y < 24 || y > 35)
        loose.phase[static_cast<std::size_t>(loose.lattice.index(x, y))] = 0;
  found = warnings(one(), loose);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].find("1 loose pieces with 144 nodes"), std::string::npos) << found[0];
}

template <class E, class F>
std::string message(F&& f)
{
  try
  {
    f();
  }
  catch (const E& error)
  {
    EXPECT_FALSE(error.hint().empty());
    return error.what();
  }
  return "nothing was thrown";
}

TEST(ElasticStudy, BadInput)
{
  if (everyone().rank() != 0)
    return;
  const auto run = [](const BondModel& m, const Sample& s, ElasticOptions o = {}) { (void)solve(m, s, o, alone()); };
  ElasticOptions o;
  o.loading.strain = 0;
  EXPECT_EQ(message<ParameterError>([&] { run(one(), filled(20, 30), o); }), "the strain is 0: nothing is loaded");
  o.loading.strain = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message<ParameterError>([&] { run(one(), filled(20, 30), o); }), "the strain nan is not a finite number");
  o = {};
  o.loading.load = LoadCase::Traction;
  EXPECT_EQ(message<ParameterError>([&] { run(one(), filled(20, 30), o); }), "the traction is 0: nothing is loaded");
  o = {};
  o.memory = 1e5;
  EXPECT_EQ(
    message<MemoryError>([&] { run(one(), filled(200, 300), o); }).find("the equilibrium of 60000 nodes needs "), 0U);
  Sample apart = filled(20, 40);
  std::fill_n(apart.phase.begin() + 20 * 15, 20 * 6, std::uint8_t{ 0 });
  EXPECT_EQ(message<NoPathError>([&] { run(one(), apart); })
              .find("no piece of the sample reaches from one platen to the other along y: it is in 2 pieces"),
    0U);
  Sample both = filled(20, 40);
  std::fill_n(both.phase.begin(), 400, std::uint8_t{ 2 });
  BondModel m = one();
  m.pairs[{ 2, 2 }].material.youngsModulus = young;
  m.phaseNames = { "void", "wall", "lamella" };
  EXPECT_EQ(message<ParameterError>([&] { run(m, both); }), "no material is given for bonds of wall and lamella");
  EXPECT_EQ(message<ParameterError>([&] { run(one(0.5), filled(20, 30)); }).find("the horizon is 0.5 spacings"), 0U);
  EXPECT_EQ(message<ParameterError>([&] { run(one(8), filled(7, 30)); }),
    "a horizon of 8 spacings does not fit into 7 nodes along x");
  m = one();
  m.notches = { { { 1, 1, 0 }, { 1, 0, 0 }, {} } };
  EXPECT_EQ(message<ParameterError>([&] { run(m, filled(20, 30)); }).find("notch 1 from (1, 1, 0) m lies outside"), 0U);
}

// What is asked for beforehand covers what is taken, and not several times over.
TEST(ElasticStudy, MemoryIsForeseen)
{
  if (everyone().rank() != 0)
    return;
  for (const bool space : { false, true })
  {
    BondModel m = one();
    m.continuum = space ? Continuum::Space : Continuum::PlaneStress;
    const Sample s = space ? filled(40, 40, 40) : filled(256, 256);
    ElasticOptions o;
    o.stress = true;
    const double foreseen = elasticBytes(m, s.lattice, false, o, 1);
    const ElasticResult r = solve(m, s, o, alone());
    EXPECT_GT(foreseen, static_cast<double>(r.bytes)) << space;
    EXPECT_LT(foreseen, 3 * static_cast<double>(r.bytes)) << space;
  }
}

const std::vector<std::string> names{ "void", "wall", "middle-lamella", "lamella" };

TEST(PairTable, NamesOfPairs)
{
  EXPECT_EQ(findPair("wall", names), (PairKey{ 1, 1, false }));
  EXPECT_EQ(findPair("wall-wall", names), (PairKey{ 1, 1, true }));
  EXPECT_EQ(findPair("lamella-wall", names), (PairKey{ 1, 3, false }));
  EXPECT_EQ(findPair("middle-lamella", names), (PairKey{ 2, 2, false }));
  EXPECT_EQ(findPair("middle-lamella-wall", names), (PairKey{ 1, 2, false }));
  EXPECT_EQ(findPair("wall-middle-lamella", names), (PairKey{ 1, 2, false }));
  EXPECT_EQ(findPair("middle-lamella-middle-lamella", names), (PairKey{ 2, 2, true }));
  EXPECT_FALSE(findPair("middle-wall", names));
  EXPECT_FALSE(findPair("", names));
  for (const char* text : { "wall", "wall-wall", "wall-middle-lamella" })
    EXPECT_EQ(pairText(*findPair(text, names), names), text);
}

BondModel applied(const PairTable& table, double horizon = 3)
{
  BondModel m;
  m.horizon = horizon;
  const std::vector<std::int64_t> nodes{ 5, 10, 0, 10 };
  applyMaterials(table, names, nodes, spacing, m);
  return m;
}

TEST(PairTable, Materials)
{
  PairTable t;
  t.young = { { "wall", 8e9 }, { "lamella", 0.5 }, { "stone", 1 } };
  t.toughness = { { "wall", 1e6 }, { "lamella", 0.25 } };
  t.relativeTo = "wall";
  t.like = { { "wall-lamella", "lamella" }, { "wall-wall", "wall-lamella" } };
  t.criticalStretch = {};
  const BondModel m = applied(t);
  EXPECT_TRUE(m.pairByGrain);
  EXPECT_EQ(m.voids, std::vector<std::uint8_t>{ 0 });
  const auto check = [&](std::uint8_t a, std::uint8_t b) { return m.pairs.at({ a, b }).material; };
  EXPECT_EQ(check(1, 1).youngsModulus, 8e9);
  EXPECT_EQ(check(3, 3).youngsModulus, 4e9);
  EXPECT_EQ(*check(3, 3).toughness, 2.5e5);
  EXPECT_EQ(check(1, 3).youngsModulus, 4e9);
  EXPECT_EQ(*m.pairs.at({ 1, 1 }).betweenGrains->toughness, 2.5e5);
  // a pair's own wins over what it is like
  t.fractureEnergy = { { "wall", 3 } };
  t.relativeTo.clear();
  t.young["lamella"] = 4e9;
  t.toughness = { { "lamella", 2.5e5 } };
  t.criticalStretch = { { "wall-lamella", 1e-3 } };
  const BondModel own = applied(t);
  EXPECT_EQ(*own.pairs.at({ 1, 3 }).material.criticalStretch, 1e-3);
  EXPECT_FALSE(own.pairs.at({ 1, 3 }).material.toughness);
  EXPECT_EQ(own.pairs.at({ 1, 3 }).material.youngsModulus, 4e9);
}

TEST(PairTable, Mixing)
{
  PairTable t;
  t.young = { { "wall", 1e9 }, { "lamella", 4e9 } };
  t.criticalStretch = { { "wall", 1e-2 }, { "lamella", 3e-3 } };
  EXPECT_FALSE(applied(t).pairs.contains({ 1, 3 }));
  t.mixing = Mixing::Harmonic;
  BondModel m = applied(t);
  // in series at an elongation s the soft half takes 2 s 4/5, the stiff one 2 s 1/5: they break at 6.25e-3 and 7.5e-3
  EXPECT_DOUBLE_EQ(m.pairs.at({ 1, 3 }).material.youngsModulus, 1.6e9);
  EXPECT_DOUBLE_EQ(*m.pairs.at({ 1, 3 }).material.criticalStretch, 6.25e-3);
  t.mixing = Mixing::Minimum;
  m = applied(t);
  EXPECT_DOUBLE_EQ(m.pairs.at({ 1, 3 }).material.youngsModulus, 1e9);
  EXPECT_DOUBLE_EQ(*m.pairs.at({ 1, 3 }).material.criticalStretch, 3e-3);
}

// What is told of a pair are the numbers that it was given, however they were given.
TEST(PairTable, Description)
{
  PairTable t;
  t.young = { { "wall", 2e9 }, { "lamella", 2e9 } };
  t.toughness = { { "wall", 3e5 } };
  t.fractureEnergy = { { "lamella", 45 } }; // K²/E
  for (const double horizon : { 3.0, 4.0 })
  {
    const auto pairs = describePairs(applied(t, horizon), spacing);
    ASSERT_EQ(pairs.size(), 2U);
    EXPECT_NEAR(pairs[0].fractureEnergy, 45, 1e-12);
    EXPECT_NEAR(pairs[1].toughness, 3e5, 1e-7);
    EXPECT_DOUBLE_EQ(pairs[0].criticalStretch, pairs[1].criticalStretch);
  }
}

TEST(PairTable, BadTables)
{
  const auto fails = [](const PairTable& t) { return message<ParameterError>([&] { (void)applied(t); }); };
  PairTable good;
  good.young = { { "wall", 1e9 }, { "lamella", 1e9 } };
  EXPECT_EQ(fails({}), "phase 'wall' has no Young's modulus (10 nodes)");
  PairTable t = good;
  t.young["wall"] = -1;
  EXPECT_EQ(fails(t), "Young's modulus of wall is -1");
  t = good;
  t.criticalStretch["lamella"] = 0;
  EXPECT_EQ(fails(t), "the critical stretch of lamella is 0");
  t = good;
  t.young["wall"] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fails(t), "Young's modulus of wall is nan");
  t = good;
  t.toughness["wall-lamella"] = 1;
  EXPECT_EQ(fails(t), "it is said how wall-lamella breaks, but it has no Young's modulus");
  t = good;
  t.young["lamella-wall"] = t.young["wall-lamella"] = 1;
  EXPECT_EQ(fails(t), "Young's modulus of wall-lamella is given twice");
  t = good;
  t.like = { { "wall-lamella", "wall-wall" }, { "wall-wall", "wall-lamella" } };
  EXPECT_EQ(fails(t), "bonds of wall-lamella are like others that are like them in turn");
  t = good;
  t.like = { { "wall-lamella", "stone" } };
  EXPECT_EQ(fails(t), "bonds of 'wall-lamella' are to be like 'stone', which is no pair of phases");
  t = good;
  t.relativeTo = "wall-lamella";
  EXPECT_EQ(fails(t), "values are relative to 'wall-lamella', which has no value for Young's modulus");
  t = good;
  t.voids = { "void", "lamella" };
  EXPECT_EQ(message<ParameterError>(
              [&] { (void)studyElastic(applied(t), filled(9, 20).lattice, filled(9, 20).phase, {}, {}, alone()); }),
    "a material is given for lamella, but lamella carries no bonds");
}

} // namespace
