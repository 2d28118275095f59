// One equilibrium a break: the same bonds in the same order on any number of ranks.
#include "FractureSamples.h"

#include "core/Error.h"

#include <gtest/gtest.h>

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

// One that asks for it is enough; none waits for the others.
TEST(FractureRanks, OneStopsTheFirstEquilibriumOfAll)
{
  const Breakable s = walls(64);
  FractureOptions o = by(FractureMethod::Accurate);
  const int last = everyone().size() - 1;
  o.progress = [last](const FractureProgress&) { return everyone().rank() == last; };
  EXPECT_THROW((void)fracture(s, o, {}, everyone()), Cancelled);
}

TEST(FractureRanks, EventsStayOnOne)
{
  if (!everyone().parallel())
    GTEST_SKIP() << "on several ranks";
  EXPECT_THROW((void)fracture(walls(64), by(FractureMethod::Events), {}, everyone()), ParameterError);
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
