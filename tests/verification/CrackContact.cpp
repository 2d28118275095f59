// Cracks that close: pressed they are as if they were not there, pulled as cut; whatever broke first, and on any number
// of ranks.
#include "../TemporaryFolder.h"
#include "FractureSamples.h"

#include "core/Error.h"
#include "peridynamics/fracture/FractureStudy.h"

#include <gtest/gtest.h>

#include <omp.h>

namespace
{

using namespace lamella;
using namespace lamella::test;
using lamella::testing::TemporaryFolder;

constexpr double tight = 1e-9;

FractureOptions contact(std::vector<KnownBond> cracks = {})
{
  FractureOptions o = by(FractureMethod::Accurate);
  o.contact = true;
  o.cracks = std::move(cracks);
  o.tolerance = tight;
  return o;
}

Loading load(double strain, LoadCase kind = LoadCase::Stretch)
{
  Loading l;
  l.strain = strain;
  l.load = kind;
  return l;
}

bool all(double, double)
{
  return true;
}

double modulus(const Breakable& s, const Loading& loading, const FractureOptions& options)
{
  BondLattice bonds = latticeOf(s.model, s.sample, alone());
  return QuasiStaticFracture(bonds, loading, options).record().modulus;
}

/// Without a crack, or with one for good.
double linearModulus(const Breakable& s, const Loading& loading, const std::vector<KnownBond>& cracks = {})
{
  BondLattice bonds = latticeOf(s.model, s.sample, alone());
  bonds.breakBonds(bondsOf(cracks));
  FractureOptions o = by(FractureMethod::Accurate);
  o.tolerance = tight;
  return QuasiStaticFracture(bonds, loading, o).record().modulus;
}

std::vector<KnownBond> plus(std::vector<KnownBond> a, const std::vector<KnownBond>& b)
{
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Where the uncracked sample presses every bond that is cut, it is the solution with the crack, too. Held at its sides
// (biaxial) it presses all of them whatever the horizon; free at its sides it stretches bonds at more than 60° to the
// load, of which horizons up to two have none across the crack.
TEST(CrackContact, PressedColumnIsWhole)
{
  for (const double horizon : { 1.5, 2.0, 3.0 })
  {
    const Breakable s = strip(16, 40, horizon);
    const BondLattice bonds = latticeOf(s.model, s.sample, alone());
    const std::vector<KnownBond> crack = crossing(bonds, 1, all);
    const std::vector<KnownBond> two = plus(crack, crossing(bonds, 1, all, 6)); // with a loose piece between them
    for (const LoadCase kind : { LoadCase::Biaxial, LoadCase::Stretch })
    {
      if (kind == LoadCase::Stretch && horizon > 2)
        continue;
      const double whole = linearModulus(s, load(-1e-3, kind));
      EXPECT_NEAR(modulus(s, load(-1e-3, kind), contact(crack)) / whole, 1, 100 * tight);
      EXPECT_NEAR(modulus(s, load(-1e-3, kind), contact(two)) / whole, 1, 100 * tight);
    }
    EXPECT_THROW((void)modulus(s, load(1e-3), contact(crack)), NoPathError);
    EXPECT_THROW((void)modulus(s, load(1e-3), contact(two)), NoPathError);
  }
}

// The bonds at 63° to the load, of those across the crack, are stretched by the sides' growth and open.
TEST(CrackContact, SteepBondsOpen)
{
  const Breakable s = strip(16, 40, 3);
  const BondLattice bonds = latticeOf(s.model, s.sample, alone());
  const double share = modulus(s, load(-1e-3), contact(crossing(bonds, 1, all))) / linearModulus(s, load(-1e-3));
  EXPECT_LT(share, 1);
  EXPECT_GT(share, 0.9999);
}

// Where its faces cannot part a crack bears shear by the bonds that are askew to it: half of them are pressed.
TEST(CrackContact, FacesInterlock)
{
  for (const double horizon : { 1.5, 2.0, 3.0 })
  {
    const Breakable s = strip(16, 40, horizon);
    const BondLattice bonds = latticeOf(s.model, s.sample, alone());
    const Loading shear = load(1e-3, LoadCase::Shear);
    EXPECT_NEAR(modulus(s, shear, contact(crossing(bonds, 1, all))) / linearModulus(s, shear), 0.9, 0.02);
  }
}

TEST(CrackContact, SpaceAndPeriodicSides)
{
  Breakable s{ block(10, 8, 18), modelOf(Continuum::Space, 2) };
  s.model.periodic = { true, false, false };
  const BondLattice bonds = latticeOf(s.model, s.sample, alone());
  const std::vector<KnownBond> crack = crossing(bonds, 2, all);
  EXPECT_NEAR(modulus(s, load(-1e-3), contact(crack)) / linearModulus(s, load(-1e-3)), 1, 100 * tight);
  const std::vector<KnownBond> part = crossing(bonds, 2, [](double, double y) { return y < 4; });
  EXPECT_NEAR(modulus(s, load(1e-3), contact(part)) / linearModulus(s, load(1e-3), part), 1, 100 * tight);
}

// Across the load, at an edge or in the middle: pressed it is not there, pulled it is open all along.
TEST(CrackContact, PartialCracks)
{
  const Breakable s = strip(32, 48, 2);
  const BondLattice bonds = latticeOf(s.model, s.sample, alone());
  const std::vector<KnownBond> edge = crossing(
    bonds, 1, [](double x, double) { return x < 12; });
  const std::vector<KnownBond> centre = crossing(bonds, 1, [](double x, double) { return std::abs(x - 15.5) < 8; });
  for (const std::vector<KnownBond>& crack : { edge, centre })
  {
    const double whole = linearModulus(s, load(1e-3));
    const double cracked = linearModulus(s, load(1e-3), crack);
    EXPECT_LT(cracked, 0.9 * whole);
    EXPECT_NEAR(modulus(s, load(-1e-3), contact(crack)) / whole, 1, 100 * tight);
    EXPECT_NEAR(modulus(s, load(1e-3), contact(crack)) / cracked, 1, 100 * tight);
  }
}

// A crack along the interface of two materials: closed bonds have the stiffness of their pair.
TEST(CrackContact, Bimaterial)
{
  Breakable s = strip(16, 40, 2);
  for (std::size_t i = 0; i < s.sample.phase.size() / 2; ++i)
    s.sample.phase[i] = 2;
  s.model.pairs[{ 1, 2 }] = { BondMaterial{ .youngsModulus = 2 * young, .criticalStretch = 0.01 } };
  s.model.pairs[{ 2, 2 }] = { BondMaterial{ .youngsModulus = 4 * young, .criticalStretch = 0.01 } };
  const BondLattice bonds = latticeOf(s.model, s.sample, alone());
  const std::vector<KnownBond> crack = crossing(bonds, 1, all);
  const double whole = linearModulus(s, load(-1e-3));
  EXPECT_GT(whole, 1.2 * linearModulus(strip(16, 40, 2), load(-1e-3)));
  EXPECT_NEAR(modulus(s, load(-1e-3), contact(crack)) / whole, 1, 100 * tight);
}

/// A tenth of all bonds, by chance.
std::vector<KnownBond> scattered(const BondLattice& bonds, unsigned seed)
{
  std::mt19937 random(seed);
  std::vector<KnownBond> found;
  const NodeLayout& l = bonds.layout();
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      bonds.forEachBond(y, z,
        [&](std::int64_t i, std::int64_t, int o, int kind)
        {
          if (random() % 10 == 0)
            found.push_back({ bonds.bond(i, o), kind });
        });
  return found;
}

/// With a crack from the left that is not among them.
std::vector<KnownBond> scatteredAndCrack(const BondLattice& bonds, unsigned seed)
{
  std::vector<KnownBond> cracks = scattered(bonds, seed);
  std::set<Bond> there;
  for (const KnownBond& b : cracks)
    there.insert(b.bond);
  for (const KnownBond& b : crossing(bonds, 1, [](double x, double) { return x < 10; }))
    if (!there.contains(b.bond))
      cracks.push_back(b);
  return cracks;
}

// A convex energy has one minimum: where no free node feels a force while closed bonds are pressed and open ones are
// not. There it is half of force times movement, as everything is in proportion to the load.
TEST(CrackContact, MinimumOfTheEnergy)
{
  const Breakable s = strip(24, 40, 3);
  for (const LoadCase kind : { LoadCase::Stretch, LoadCase::Shear, LoadCase::Biaxial })
    for (const double strain : { 1e-3, -1e-3 })
    {
      BondLattice bonds = latticeOf(s.model, s.sample, alone());
      std::vector<KnownBond> cracks = scatteredAndCrack(bonds, 5);
      Loading loading = load(strain, kind);
      loading.rigid = true; // so that work is force times movement
      FractureOptions o = contact(cracks);
      o.maxBroken = 1;
      QuasiStaticFracture f(bonds, loading, o);
      ASSERT_EQ(f.run(), FractureEnd::MaxBroken);
      cracks.push_back({ f.record().broken.front().bond, 1 });
      const NodeField<double> u = f.displacement();
      const NodeLayout& l = bonds.layout();

      NodeField<double> force(l);
      linearForce(bonds, u, force);
      double free = 0;
      double held = 0;
      for (int c = 0; c < 2; ++c)
        for (std::int64_t y = 0; y < l.size[1]; ++y)
          for (std::int64_t x = 0; x < l.size[0]; ++x)
          {
            const std::int64_t i = l.index(x, y);
            ((f.sample().fixed[i] >> c & 1U) != 0 ? held : free) += std::pow(force.component(c)[i], 2);
          }
      EXPECT_LT(
        std::sqrt(free / held), 100 * tight); // the tolerance counts over the forces on nodes that have not moved

      std::int64_t closed = 0;
      for (const KnownBond& b : cracks)
      {
        const Offset& half = bonds.stencil().half()[static_cast<std::size_t>(b.bond.offset)];
        const std::int64_t i = l.index(b.bond.node[0], b.bond.node[1]);
        const std::int64_t j = i + bonds.jump(b.bond.offset);
        double along = 0;
        for (int c = 0; c < 2; ++c)
          along += half.step[static_cast<std::size_t>(c)] * (u.component(c)[j] - u.component(c)[i]);
        const double stretch = along / (half.length * half.length * spacing);
        const bool there = bonds.kind(i, b.bond.offset) != 0;
        closed += there ? 1 : 0;
        EXPECT_LE(there ? stretch : -stretch, 10 * tight * f.strain());
      }
      EXPECT_GT(closed, 0);
      EXPECT_LT(closed, static_cast<std::int64_t>(cracks.size()));

      if (kind == LoadCase::Biaxial)
        continue; // platens at the sides do work, too
      const double width = 24 * spacing;
      const double length = static_cast<double>(f.sample().highLayers[0] - f.sample().lowLayers[1] + 1) * spacing;
      const CurvePoint& end = f.record().curve.back();
      EXPECT_NEAR(elasticEnergy(bonds, u, false) / (0.5 * end.stress * end.strain * width * length), 1, 100 * tight);
    }
}

// What is left of a sample bears the same whatever broke first, and whatever was closed in between.
TEST(CrackContact, OrderDoesNotMatter)
{
  for (const double strain : { 1e-3, -1e-3 })
  {
    const Breakable s = walls(48, 5);
    FractureOptions o = contact();
    o.maxBroken = 60;
    const FractureRecord run = fracture(s, o, load(strain));
    ASSERT_EQ(run.broken.size(), 60U);
    std::vector<KnownBond> cracks;
    for (const BrokenBond& b : run.broken)
      cracks.insert(cracks.begin(), { b.bond, 1 });
    const double again = modulus(s, load(strain), contact(cracks));
    EXPECT_NEAR(again / (run.curve.back().stress / run.curve.back().strain), 1, 1e-5); // walls bend: 1e4 tolerances
  }
}

// Bonds that are whole break as they do without contact until one would close.
TEST(CrackContact, TensionBreaksAlike)
{
  const Breakable s = strip(40, 60, 2);
  const BondLattice bonds = latticeOf(s.model, s.sample, alone());
  const std::vector<KnownBond> crack = crossing(bonds, 1, [](double x, double) { return x < 9.2; });
  Breakable notched = s;
  notched.model.notches.push_back({ { 0, 30 * spacing }, { 9.7 * spacing, 0 } });
  FractureOptions with = contact(crack);
  FractureOptions without = with;
  without.contact = false;
  without.cracks.clear();
  with.maxBroken = without.maxBroken = 20;
  const FractureRecord a = fracture(s, with);
  const FractureRecord b = fracture(notched, without);
  ASSERT_EQ(b.broken.size(), 20U);
  expectSame(a, b, 1e-6);
}

// A notch is a crack, and closes; a state's fields are those of its closed bonds.
TEST(CrackContact, NotchesClose)
{
  Breakable s = strip(32, 48, 2);
  const double whole = linearModulus(s, load(-1e-3));
  s.model.notches.push_back({ { 0, 24 * spacing }, { 12 * spacing, 0 } });
  const double cut = linearModulus(s, load(-1e-3));
  FractureStudyOptions o;
  o.loading = load(-1e-3);
  o.fracture.tolerance = tight;
  o.fracture.maxBroken = 5;
  std::vector<FractureState> states;
  o.keep = [&](FractureState state) { states.push_back(std::move(state)); };
  const auto study = [&]
  { return studyFracture(s.model, s.sample.lattice, s.sample.phase, s.sample.grain, o, alone()); };
  EXPECT_NEAR(study().record.modulus / cut, 1, 100 * tight);
  o.fracture.contact = true;
  states.clear();
  const FractureResult r = study();
  EXPECT_EQ(r.method, FractureMethod::Accurate);
  EXPECT_NEAR(r.record.modulus / whole, 1, 100 * tight);
  ASSERT_EQ(states.size(), 1U);
  std::vector<Bond> broken;
  for (const BrokenBond& b : r.record.broken)
    broken.push_back(b.bond);
  const BondLattice left = remainingBonds(
    s.model, s.sample.lattice, s.sample.phase, s.sample.grain, broken, &o.loading,
    [&](NodeField<double>& v) { v = *states.front().displacement; }, alone());
  NodeField<double> u = *states.front().displacement;
  left.exchange(u);
  EXPECT_NEAR(
    sectionForce(left, u, 1, 24, false)[1], -states.front().stress * r.area, 1e-6 * states.front().stress * r.area);
}

TEST(CrackContact, ThreadsDoNotMatter)
{
  const Breakable s = walls(48, 5);
  FractureOptions o = contact();
  o.maxBroken = 40;
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const FractureRecord one = fracture(s, o, load(-1e-3));
  omp_set_num_threads(3);
  const FractureRecord three = fracture(s, o, load(-1e-3));
  omp_set_num_threads(before);
  expectSame(one, three, 0);
}

TEST(CrackContact, GoesOnFromACheckpoint)
{
  TemporaryFolder folder;
  const Breakable s = walls(48, 5);
  for (const Breaking breaking : { Breaking::Strict, Breaking::Batched })
  {
    FractureOptions o = contact();
    o.breaking = breaking;
    o.renewEvery = 7;
    o.maxBroken = 60;
    const FractureRecord straight = fracture(s, o, load(-1e-3));
    FractureOptions first = o;
    first.checkpoint.path = folder.path() / "run.h5";
    first.maxBroken = 30;
    (void)fracture(s, first, load(-1e-3));
    FractureOptions second = o;
    second.continueFrom = first.checkpoint.path;
    const FractureRecord resumed = fracture(s, second, load(-1e-3));
    expectSame(straight, resumed, 0);
    EXPECT_EQ(straight.statistics.equilibria, resumed.statistics.equilibria);
    second.contact = false;
    EXPECT_THROW((void)fracture(s, second, load(-1e-3)), InputError);
  }
}

TEST(CrackContact, Refusals)
{
  const Breakable s = strip(16, 40, 2);
  FractureOptions events = contact();
  events.method = FractureMethod::Events;
  EXPECT_THROW((void)fracture(s, events), ParameterError);
  EXPECT_THROW((void)fracture(s, contact(), load(1e-3, LoadCase::Pressure)), ParameterError);
}

} // namespace
