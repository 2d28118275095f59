// The same bonds in the same order on any number of ranks: by one equilibrium a break, and by local corrections.
#include "FractureSamples.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <tuple>

namespace
{

using namespace lamella;
using namespace lamella::test;

// Reductions over other numbers of ranks round otherwise; equilibria agree to the tolerance of their residuals, and so
// do strains to some 1e-5.
TEST(FractureRanks, SameBonds)
{
  for (const Breaking breaking : { Breaking::Strict, Breaking::Batched })
  {
    const Breakable s = walls(64);
    FractureOptions o = by(FractureMethod::Accurate, 0.2);
    o.breaking = breaking;
    o.tolerance = 1e-8;
    o.maxBroken = 40;
    const FractureRecord one = fracture(s, o);
    const FractureRecord all = fracture(s, o, {}, everyone());
    EXPECT_GT(one.broken.size(), 30U);
    expectSame(one, all, 1e-5);
    BondLattice bonds = latticeOf(s.model, s.sample, alone());
    for (const BondEnds& e : endsOf(bonds, all.broken, s.sample.phase, {}))
      EXPECT_EQ(e.low + e.high, 2);
  }
}

// Contact, too: strains agree to the tolerance, and so do the bonds that close.
TEST(FractureRanks, ContactOfCracks)
{
  const Breakable s = walls(64);
  FractureOptions o = by(FractureMethod::Accurate, 0.2);
  o.contact = true;
  o.tolerance = 1e-8;
  o.maxBroken = 40;
  Loading pressed;
  pressed.strain = -1e-3;
  const FractureRecord one = fracture(s, o, pressed);
  const FractureRecord all = fracture(s, o, pressed, everyone());
  EXPECT_GT(one.broken.size(), 30U);
  expectSame(one, all, 1e-5);

  // and where the load turns round
  o.turningPoints = { 4e-3, -1e-2, 5e-3, 0 };
  const FractureRecord there = fracture(s, o);
  const FractureRecord here = fracture(s, o, {}, everyone());
  EXPECT_GT(there.broken.size(), 10U);
  ASSERT_EQ(there.broken.size(), here.broken.size());
  for (std::size_t i = 0; i < there.broken.size(); ++i)
    EXPECT_EQ(there.broken[i].bond, here.broken[i].bond);
  ASSERT_EQ(there.branches.size(), here.branches.size());
  for (std::size_t k = 0; k < there.branches.size(); ++k)
  {
    EXPECT_EQ(there.branches[k].broken, here.branches[k].broken);
    EXPECT_NEAR(there.branches[k].work, here.branches[k].work, 1e-5 * there.peak.stress * 5e-3);
  }
}

// One that asks for it is enough; none waits for the others.
TEST(FractureRanks, OneStopsTheFirstEquilibriumOfAll)
{
  const Breakable s = walls(64);
  const int last = everyone().size() - 1;
  for (const FractureMethod method : { FractureMethod::Accurate, FractureMethod::Events })
  {
    FractureOptions o = by(method);
    o.progress = [last](const FractureProgress&) { return everyone().rank() == last; };
    EXPECT_THROW((void)fracture(s, o, {}, everyone()), Cancelled);
  }
}

// Every rank does its own layers of the same arrays, and sums are taken in the order of rows: to the last bit. Samples
// with one level that is shared out and with two (the next of more than 4096 nodes), in space, and with platens across
// the layers.
TEST(FractureRanks, EventsAreThoseOfOne)
{
  Loading across;
  across.axis = 0;
  Loading shear;
  shear.load = LoadCase::Shear;
  const Breakable space = of(breakable::cemented({ .nodes = 22, .grains = 40, .dimension = 3 }));
  for (const auto& [s, loading, most] :
    { std::tuple{ cementedGrains(48, 0.5), Loading{}, 60 }, std::tuple{ walls(128), Loading{}, 24 },
      std::tuple{ walls(96, 2), across, 24 }, std::tuple{ walls(48), shear, 24 }, std::tuple{ space, Loading{}, 24 } })
  {
    FractureOptions o = by(FractureMethod::Events);
    o.maxBroken = most;
    o.renewEvery = 15;
    BondLattice bonds = latticeOf(s.model, s.sample, alone());
    QuasiStaticFracture one(bonds, loading, o);
    one.run();
    BondLattice parts = latticeOf(s.model, s.sample, everyone());
    QuasiStaticFracture all(parts, loading, o);
    all.run();
    const FractureRecord& a = one.record();
    const FractureRecord& b = all.record();
    EXPECT_GT(a.broken.size(), 20U);
    expectSame(a, b, 0);
    ASSERT_EQ(a.curve.size(), b.curve.size());
    for (std::size_t i = 0; i < a.curve.size(); ++i)
      EXPECT_EQ(a.curve[i].stress, b.curve[i].stress);
    EXPECT_EQ(a.statistics.globalIterations, b.statistics.globalIterations);
    EXPECT_EQ(a.statistics.localCycles, b.statistics.localCycles);
    EXPECT_EQ(a.statistics.looseNodes, b.statistics.looseNodes);
    EXPECT_EQ(a.modulus, b.modulus);

    // what is left of the ranks' parts, and where it is
    EXPECT_EQ(bonds.bonds(), parts.bonds());
    const NodeField<double> u = one.displacement();
    const NodeField<double> v = all.displacement();
    const NodeLayout& l = parts.layout();
    std::int64_t other = 0;
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
        {
          const std::int64_t i = bonds.layout().index(x, y + l.start[1], z + l.start[2]);
          const std::int64_t j = l.index(x, y, z);
          for (int c = 0; c < l.dimension; ++c)
            other += u.component(c)[i] != v.component(c)[j] ? 1 : 0;
          for (int k = 0; k < static_cast<int>(parts.stencil().half().size()); ++k)
            other += bonds.kind(i, k) != parts.kind(j, k) ? 1 : 0;
        }
    EXPECT_EQ(other, 0);
  }
}

// All learn of it. Six zigzags of single nodes unfold and resist nothing.
TEST(FractureRanks, HingesHaveNoStrength)
{
  Breakable s = strip(48, 48, 1.5);
  for (std::int64_t y = 8; y < 40; ++y)
    for (std::int64_t x = 0; x < 48; ++x)
      s.sample.phase[static_cast<std::size_t>(s.sample.lattice.index(x, y))] = x % 8 == 3 + y % 2 ? 1 : 0;
  EXPECT_THROW((void)fracture(s, by(FractureMethod::Accurate), {}, everyone()), InputError);
}

} // namespace
