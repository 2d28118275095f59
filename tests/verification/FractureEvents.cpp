// Fracture by local corrections against one equilibrium a break; what any of both must give; what is refused.
#include "FractureSamples.h"

#include "core/Error.h"
#include "peridynamics/Fragments.h"
#include "peridynamics/fracture/EventHierarchy.h"
#include "peridynamics/fracture/SlowMotions.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <limits>

namespace
{

using namespace lamella;
using namespace lamella::test;

// The figures: peak within 0.05 %, at least 98 % of the broken bonds the same.
void compare(const Breakable& s, double stop, std::int64_t maxBroken = 1000000, const Loading& loading = {})
{
  FractureOptions o = by(FractureMethod::Accurate, stop);
  o.maxBroken = maxBroken;
  const FractureRecord accurate = fracture(s, o, loading);
  o.method = FractureMethod::Events;
  const FractureRecord events = fracture(s, o, loading);
  EXPECT_EQ(accurate.end, maxBroken < 1000000 ? FractureEnd::MaxBroken : FractureEnd::StressFell)
    << describe(accurate.end);
  EXPECT_EQ(events.end, accurate.end) << describe(events.end);
  EXPECT_GT(accurate.broken.size(), 30U);
  EXPECT_NEAR(events.peak.stress, accurate.peak.stress, 5e-4 * accurate.peak.stress);
  EXPECT_NEAR(events.peak.strain, accurate.peak.strain, 5e-4 * accurate.peak.strain);
  EXPECT_NEAR(events.modulus, accurate.modulus, 1e-4 * accurate.modulus);
  EXPECT_GE(inCommon(accurate, events), 0.98);
  EXPECT_LE(static_cast<double>(events.broken.size()), 1.03 * static_cast<double>(accurate.broken.size()));
}

TEST(FractureEvents, CementedGrainsAsOneEquilibriumABreak)
{
  compare(cementedGrains(64, 0.5), 0.05);
}

TEST(FractureEvents, FilledGapsAsOneEquilibriumABreak)
{
  compare(cementedGrains(48, 1), 0.5);
}

TEST(FractureEvents, WoodAsOneEquilibriumABreak)
{
  compare(walls(64), 0.05);
}

TEST(FractureEvents, SpaceAsOneEquilibriumABreak)
{
  Breakable s{ aggregate(12, 12, 16), aggregateModel(3) };
  compare(s, 0.5, 150);
}

// Large enough for the first coarse level to be packed in 16 bits.
TEST(FractureEvents, PackedLevelsAsOneEquilibriumABreak)
{
  Breakable s{ aggregate(32, 32, 36), aggregateModel(3) };
  compare(s, 0.5, 32);
}

// Under shear the platens do work across: the force that counts is another component.
TEST(FractureEvents, ShearAsOneEquilibriumABreak)
{
  Loading shear;
  shear.load = LoadCase::Shear;
  compare({ aggregate(40, 40), aggregateModel(2) }, 0.05, 60, shear);
}

// A uniform strip breaks at E s0. Only its middle can break, away from the platens' corners; its sides are softer, over
// a layer as thick as the horizon, so that what is missing falls like the inverse of its width.
TEST(FractureEvents, StripBreaksAtTheStrengthOfTheBulk)
{
  const double s0 = 0.01;
  const double bulk = latticeModuli(Stencil(2, 3), Continuum::PlaneStress).youngsModulus * young * s0;
  Loading smooth;
  smooth.smooth = true;
  std::vector<double> missing;
  for (const std::int64_t width : { 24, 48, 96 })
    for (const FractureMethod method : { FractureMethod::Accurate, FractureMethod::Events })
    {
      Breakable s = strip(width, 96);
      for (std::int64_t y = 0; y < 96; ++y)
        if (y < 32 || y >= 64)
          std::fill_n(s.sample.phase.begin() + y * width, width, std::uint8_t{ 2 });
      s.model.pairs[{ 1, 2 }] = s.model.pairs[{ 2, 2 }] = { BondMaterial{ .youngsModulus = young } };
      FractureOptions o = by(method, 0.5);
      o.maxBroken = 5;
      const FractureRecord r = fracture(s, o, smooth);
      EXPECT_NEAR(r.first.strain, s0, 2e-3 * s0); // the platens are felt that far
      EXPECT_EQ(r.peak.stress, r.first.stress);   // what breaks first takes the rest with it
      const double short_ = 1 - r.peak.stress / bulk;
      if (method == FractureMethod::Accurate)
        missing.push_back(short_);
      else
        EXPECT_NEAR(short_, missing.back(), 1e-4);
    }
  EXPECT_LT(missing[2], 0.015);
  EXPECT_NEAR(missing[0] / missing[1], 2, 0.2);
  EXPECT_NEAR(missing[1] / missing[2], 2, 0.2);
}

// Batches take more bonds along after the peak, but the strength is that of strict breaking to 1 %.
TEST(FractureEvents, BatchesBreakAtTheSameStress)
{
  const Breakable s = cementedGrains(64, 0.5);
  FractureOptions o = by(FractureMethod::Accurate, 0.3);
  const FractureRecord strict = fracture(s, by(FractureMethod::Events, 0.3));
  o.breaking = Breaking::Batched;
  const FractureRecord batched = fracture(s, o);
  EXPECT_NEAR(batched.peak.stress, strict.peak.stress, 0.01 * strict.peak.stress);
  EXPECT_LT(batched.statistics.events, static_cast<std::int64_t>(batched.broken.size()));
  EXPECT_EQ(batched.broken.back().event, batched.statistics.events);
}

// In steps of the strain bonds break at its multiples alone. A step may pass the peak by as much as itself and no more:
// between two breaks the stress rises in proportion.
TEST(FractureEvents, StepsOfStrain)
{
  const Breakable s = cementedGrains(48, 0.6);
  FractureOptions o = by(FractureMethod::Accurate, 0.3);
  o.breaking = Breaking::Batched;
  const FractureRecord exact = fracture(s, o);
  const double step = 0.03 * exact.peak.strain;
  o.strainStep = step;
  const FractureRecord stepped = fracture(s, o);
  for (const BrokenBond& b : stepped.broken)
  {
    EXPECT_NEAR(std::remainder(b.strain, step), 0, 1e-9 * step);
    EXPECT_LE(b.criticalStrain, b.strain);
  }
  EXPECT_NEAR(stepped.peak.stress, exact.peak.stress, 0.03 * exact.peak.stress);
  EXPECT_LT(stepped.statistics.events, exact.statistics.events);
  o.maxStrain = 30.5 * step; // the next would be beyond
  const FractureRecord ended = fracture(s, o);
  EXPECT_EQ(ended.end, FractureEnd::MaxStrain);
  ASSERT_FALSE(ended.broken.empty());
  EXPECT_LT(ended.broken.back().strain, 30.01 * step);
}

// The strain never falls; a bond breaks at or beyond the strain at which it is critical; the curve goes from event to
// event, and what is broken is broken once.
TEST(FractureEvents, RecordHoldsTogether)
{
  const FractureRecord r = fracture(cementedGrains(64, 0.5), by(FractureMethod::Events));
  std::set<Bond> seen;
  double strain = 0;
  for (std::size_t i = 0; i < r.broken.size(); ++i)
  {
    EXPECT_TRUE(seen.insert(r.broken[i].bond).second);
    EXPECT_EQ(r.broken[i].event, static_cast<std::int64_t>(i) + 1);
    EXPECT_GE(r.broken[i].strain, strain);
    EXPECT_LE(r.broken[i].criticalStrain, r.broken[i].strain);
    strain = r.broken[i].strain;
  }
  EXPECT_EQ(r.broken.front().criticalStrain, r.broken.front().strain);
  EXPECT_NEAR(r.first.stress, r.modulus * r.first.strain, 1e-6 * r.first.stress);
  for (std::size_t i = 1; i < r.curve.size(); ++i)
  {
    EXPECT_GE(r.curve[i].strain, r.curve[i - 1].strain);
    EXPECT_GE(r.curve[i].broken, r.curve[i - 1].broken);
    EXPECT_LE(r.curve[i].stress, r.peak.stress);
    // the secant stiffness never rises
    EXPECT_LE(r.curve[i].stress / r.curve[i].strain, 1.001 * r.curve[i - 1].stress / r.curve[i - 1].strain);
  }
  EXPECT_EQ(r.curve.back().broken, static_cast<std::int64_t>(r.broken.size()));
  EXPECT_LE(r.curve.back().stress, 0.05 * r.peak.stress);
}

TEST(FractureEvents, NothingLooseIsLeft)
{
  const Breakable s = walls(64, 3);
  BondLattice bonds = latticeOf(s.model, s.sample, alone());
  QuasiStaticFracture f(bonds, {}, by(FractureMethod::Events, 0.01));
  f.run();
  for (const Fragment& piece : findFragments(bonds, &f.sample().fixed).pieces)
    EXPECT_TRUE(piece.fixed != 0 || piece.nodes == 1) << piece.nodes;
  const FractureStatistics& t = f.record().statistics;
  EXPECT_EQ(latticeOf(s.model, s.sample, alone()).bonds() - bonds.bonds(),
    static_cast<std::int64_t>(f.record().broken.size()) + t.looseBonds);
}

// With four neighbours a node one bond a column crosses a weak interface: when all of them have gone, nothing holds.
TEST(FractureEvents, SeveredAlongAWeakInterface)
{
  for (const FractureMethod method : { FractureMethod::Accurate, FractureMethod::Events })
  {
    Breakable s = strip(20, 40, 1);
    std::fill(s.sample.phase.begin() + 20 * 20, s.sample.phase.end(), std::uint8_t{ 2 });
    s.model.pairs[{ 2, 2 }] = s.model.pairs[{ 1, 1 }];
    s.model.pairs[{ 1, 2 }] = { BondMaterial{ .youngsModulus = young, .criticalStretch = 0.001 } };
    const FractureRecord r = fracture(s, by(method, 0));
    EXPECT_EQ(r.end, FractureEnd::Severed) << describe(r.end);
    EXPECT_EQ(r.broken.size(), 20U);
    EXPECT_EQ(r.statistics.looseNodes, 0);
    const BondLattice bonds = latticeOf(s.model, s.sample, alone());
    for (const BondEnds& e : endsOf(bonds, r.broken, s.sample.phase, {}))
    {
      EXPECT_EQ(e.low, 1);
      EXPECT_EQ(e.high, 2);
      EXPECT_FALSE(e.betweenGrains);
    }
  }
}

TEST(FractureEvents, ThreadsDoNotMatter)
{
  const Breakable s = cementedGrains(112, 0.6); // large enough for threads to be used
  FractureOptions o = by(FractureMethod::Events);
  o.maxBroken = 60;
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const FractureRecord one = fracture(s, o);
  omp_set_num_threads(3);
  const FractureRecord three = fracture(s, o);
  omp_set_num_threads(before);
  expectSame(one, three, 0);
  EXPECT_EQ(one.peak.stress, three.peak.stress);
}

TEST(FractureEvents, GoesOnAfterAnInterruption)
{
  const Breakable s = walls(64);
  for (const FractureMethod method : { FractureMethod::Accurate, FractureMethod::Events })
  {
    FractureOptions o = by(method, 0.3);
    const FractureRecord whole = fracture(s, o);
    double share = 0;
    int calls = 0;
    o.progress = [&](const FractureProgress& p)
    {
      EXPECT_GE(p.share, share);
      EXPECT_LE(p.share, 1);
      share = p.share;
      if (p.broken == 0)
        return false; // the first equilibrium
      EXPECT_EQ(p.equilibrium, 1);
      EXPECT_EQ(p.broken, ++calls);
      return calls % 7 == 0;
    };
    BondLattice bonds = latticeOf(s.model, s.sample, alone());
    QuasiStaticFracture f(bonds, {}, o);
    int interruptions = 0;
    while (f.run() == FractureEnd::Interrupted)
      ++interruptions;
    EXPECT_GT(interruptions, 1);
    expectSame(whole, f.record(), 0);
    EXPECT_EQ(whole.curve.size(), f.record().curve.size());
  }
}

// It is told of by and by, and ends the run when asked to: no bond is broken then, and a run after it breaks the same
// bonds as one that nobody stopped.
TEST(FractureEvents, TheFirstEquilibriumCanBeStopped)
{
  const Breakable s = walls(64);
  for (const FractureMethod method : { FractureMethod::Accurate, FractureMethod::Events })
  {
    FractureOptions o = by(method, 0.3);
    o.maxBroken = 20;
    const FractureRecord whole = fracture(s, o);
    std::vector<double> shares;
    std::size_t most = 0; // calls, and then it stops
    o.progress = [&](const FractureProgress& p)
    {
      if (p.broken > 0)
        return false;
      EXPECT_EQ(p.share, 0);
      shares.push_back(p.equilibrium);
      return shares.size() == most;
    };
    expectSame(whole, fracture(s, o), 0);
    ASSERT_GT(shares.size(), 5U);
    EXPECT_LT(shares.front(), 0.5);
    EXPECT_GT(shares.back(), 0.9);
    BondLattice bonds = latticeOf(s.model, s.sample, alone());
    const std::int64_t before = bonds.bonds();
    shares.clear();
    most = 3;
    EXPECT_THROW(QuasiStaticFracture(bonds, {}, o), Cancelled);
    EXPECT_EQ(shares.size(), most);
    EXPECT_EQ(bonds.bonds(), before);
    most = 0;
    QuasiStaticFracture again(bonds, {}, o);
    again.run();
    expectSame(whole, again.record(), 0);
  }
}

// The displacements that are handed out are those of an equilibrium, and the next bond's elongation is its limit.
TEST(FractureEvents, DisplacementIsAnEquilibrium)
{
  const Breakable s = cementedGrains(48, 0.6);
  BondLattice bonds = latticeOf(s.model, s.sample, alone());
  FractureOptions o = by(FractureMethod::Events);
  o.maxBroken = 40;
  QuasiStaticFracture f(bonds, {}, o);
  EXPECT_EQ(f.run(), FractureEnd::MaxBroken);
  const NodeField<double> u = f.displacement();
  LoadedSample loaded = applyLoading(bonds, {});
  Equilibrium check(bonds, loaded.fixed, with(EquilibriumSolver::Multigrid, 1e-9));
  check.solve(loaded.displacement);
  double worst = 0;
  double largest = 0;
  NodeField<double> a(bonds.layout(), 3);
  NodeField<double> b(bonds.layout(), 3);
  nodalStress(bonds, u, a, false);
  nodalStress(bonds, loaded.displacement, b, false);
  const double scale = f.strain() / 1e-3;
  for (int c = 0; c < 3; ++c)
    for (std::int64_t i = 0; i < a.layout().count(); ++i)
    {
      worst = std::max(worst, std::abs(a.component(c)[i] - scale * b.component(c)[i]));
      largest = std::max(largest, std::abs(a.component(c)[i]));
    }
  EXPECT_LT(worst, 1e-3 * largest); // of residuals of 1e-6
  f.setLimits(std::numeric_limits<double>::infinity(), 45);
  EXPECT_EQ(f.run(), FractureEnd::MaxBroken);
  EXPECT_EQ(f.record().broken.size(), 45U);
}

// Broken bonds as changes of rank one: residuals of all levels agree, and matrices are those made anew. Both hold to
// the digits of single precision, a few times 1e-7, times the few tens of terms of a sum.
TEST(FractureEvents, WindowsAreNoWiderThanTheirVectors)
{
  for (const std::int64_t size : { 5, 8, 30, 64, 71 })
  {
    const NodeLayout l = NodeLayout::make(2, 2, { size, 40, 1 }, {}, { size, 40, 1 }, false);
    const std::int64_t end = (size + eventLanes - 1) / eventLanes * eventLanes; // of the row's last vector
    for (std::int64_t low = 0; low < size; ++low)
      for (std::int64_t high = low + 1; high <= size; ++high)
        for (const int by : { 0, 1, 6 })
        {
          const Box box{ { low, 12, 0 }, { high, 15, 1 } };
          const Box b = grown(box, by, l);
          ASSERT_LE(b.low[0], std::max<std::int64_t>(0, low - by));
          ASSERT_GE(b.high[0], std::min(size, high + by));
          ASSERT_GE(b.low[0], 0);
          ASSERT_LE(b.high[0], end);
          ASSERT_EQ(b.low[0] % 2, 0);
          ASSERT_EQ((b.high[0] - b.low[0]) % eventLanes, 0);
          ASSERT_LE(b.high[0] - b.low[0], high - low + 2 * by + eventLanes); // a node for the even beginning
          ASSERT_EQ(b.low[1], 12 - by);
          ASSERT_EQ(b.high[1], 15 + by);
        }
  }
}

TEST(FractureEvents, LevelsStayGalerkinProducts)
{
  for (const bool space : { false, true })
  {
    const Sample s = space ? aggregate(16, 14, 20) : aggregate(60, 70);
    BondLattice bonds = latticeOf(aggregateModel(space ? 3 : 2), s, alone());
    const LoadedSample loaded = applyLoading(bonds, {});
    EventHierarchy state(bonds, loaded.fixed, loaded.displacement, 1e-6);
    BondMultigrid levels(bonds, loaded.fixed);
    std::mt19937 random(5);
    const NodeLayout& l = bonds.layout();
    const std::array<std::int64_t, 3> centre{ l.size[0] / 2, l.size[1] / 2, l.size[2] / 2 };
    int broken = 0;
    for (int k = 0; k < 400; ++k)
    {
      std::array<std::int64_t, 3> n = centre;
      for (std::size_t a = 0; a < static_cast<std::size_t>(l.dimension); ++a)
        n[a] += static_cast<std::int64_t>(random() % 5) - 2;
      const std::int64_t i = l.index(n[0], n[1], n[2]);
      const int o = static_cast<int>(random() % bonds.stencil().half().size());
      if (bonds.kind(i, o) == 0)
        continue;
      ++broken;
      const SpringWeights weights = levels.weights(i, o);
      state.breakBond(i, o);
      levels.subtract(weights);
      if (k % 20 == 0)
        state.correct({ n, { n[0] + 1, n[1] + 1, n[2] + 1 } }, 6, 4, 0, 2);
    }
    EXPECT_GT(broken, 100);
    EXPECT_LT(state.inconsistency(), 1e-4);
    const BondMultigrid anew(bonds, loaded.fixed);
    for (std::size_t k = 1; k < levels.levelCount(); ++k)
    {
      const Level& a = levels.level(k);
      const Level& b = anew.level(k);
      double worst = 0;
      double largest = 0;
      for (std::int64_t i = 0; i < a.layout.count(); ++i)
      {
        if (!a.layout.ownedNode(a.layout.node(i)))
          continue;
        for (int e = 0; e < a.entries(); ++e)
        {
          largest = std::max(largest, std::abs(static_cast<double>(b.diagonal.component(e)[i])));
          worst =
            std::max(worst, std::abs(static_cast<double>(a.diagonal.component(e)[i] - b.diagonal.component(e)[i])));
        }
        for (int c = 0; c < static_cast<int>(a.half.size()) * a.entries(); ++c)
          worst = std::max(worst, std::abs(static_cast<double>(a.block(c, i) - b.block(c, i))));
      }
      EXPECT_LT(worst, 1e-5 * largest) << "level " << k;
    }
  }
}

// In 16 bits a number is within half a unit of the exact one, on coarser levels within a few, for these are products of
// rounded ones, and a product within what half a unit of each number makes of it; a translation costs what it does
// without rounding, to single precision, since diagonal blocks make up for it. That holds after bonds have broken, too,
// whether these are still remembered apart (400 do not fill the list) or packed with the rest.
TEST(FractureEvents, PackedLevelsAreGalerkinProductsToHalfAUnit)
{
  BondLattice bonds = latticeOf(aggregateModel(3), aggregate(16, 14, 20), alone());
  const LoadedSample loaded = applyLoading(bonds, {});
  MultigridOptions options;
  options.packFrom = 1;
  BondMultigrid packed(bonds, loaded.fixed, options);
  ASSERT_GT(packed.levelCount(), 2U);
  std::mt19937 random(5);
  const auto check = [&](const std::string& when)
  {
    const BondMultigrid exact(bonds, loaded.fixed);
    for (std::size_t k = 1; k < packed.levelCount(); ++k)
    {
      const Level& a = packed.level(k);
      const Level& b = exact.level(k);
      ASSERT_TRUE(a.packed());
      const NodeLayout& l = a.layout;
      NodeField<float> u(l);
      NodeField<float> one(l);
      forOwnRows(l,
        [&](std::int64_t y, std::int64_t z)
        {
          for (std::int64_t x = 0; x < l.size[0]; ++x)
            for (int c = 0; c < 3; ++c)
            {
              u.component(c)[l.index(x, y, z)] = static_cast<float>(random() % 1000) * 1e-3F;
              one.component(c)[l.index(x, y, z)] = 1;
            }
        });
      NodeField<float> f(l);
      NodeField<float> g(l);
      NodeField<float> still(l);
      NodeField<float> held(l);
      subtractProduct(a, u, f);
      subtractProduct(b, u, g);
      subtractProduct(a, one, still);
      subtractProduct(b, one, held);
      double most = 0; // of a node's numbers, in units
      forOwnRows(l,
        [&](std::int64_t y, std::int64_t z)
        {
          for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
            for (int c = 0; c < 3; ++c)
            {
              // scales of neighbours are alike but for a phase ten times as stiff
              const double unit = 10 * std::pow(static_cast<double>(a.scale.component(0)[i]), 2);
              const double sums = unit * 0.5 * 124 * 3;
              EXPECT_LE(std::abs(static_cast<double>(f.component(c)[i] - g.component(c)[i])), 2 * sums) << when << k;
              const double digits = 3e-5 * static_cast<double>(b.diagonal.component(c)[i]);
              EXPECT_NEAR(still.component(c)[i], held.component(c)[i], digits) << when << k;
              if (unit > 0)
                most = std::max(most, static_cast<double>(b.diagonal.component(c)[i]) / unit);
            }
        });
      EXPECT_GT(most, 1000);
      // at a horizon of two no bond goes two steps along two axes: 22 of 62 blocks are not there
      EXPECT_EQ(a.half.size(), 40U);
      for (int c = 0; when.empty() && c < static_cast<int>(b.half.size()) * 6; ++c)
        for (std::int64_t z = 0; z < l.size[2]; ++z)
          for (std::int64_t y = 0; y < l.size[1]; ++y)
            for (std::int64_t x = 0; x < l.size[0]; ++x)
            {
              const auto& s = b.half[static_cast<std::size_t>(c / 6)];
              const auto place = std::find(a.half.begin(), a.half.end(), s);
              if (x + s[0] < 0 || x + s[0] >= l.size[0] || y + s[1] < 0 || y + s[1] >= l.size[1] ||
                z + s[2] >= l.size[2])
                continue;
              const std::int64_t i = l.index(x, y, z);
              if (place == a.half.end())
              {
                EXPECT_EQ(b.value(c, i), 0);
                continue;
              }
              const std::int64_t j = l.index(x + s[0], y + s[1], z + s[2]);
              const int component = static_cast<int>(place - a.half.begin()) * 6 + c % 6;
              const float unit = a.scale.component(0)[i] * a.scale.component(0)[j];
              const double levels = static_cast<double>(k); // coarser ones are products of rounded ones
              EXPECT_NEAR(
                a.value(component, i), b.value(c, i), (k == 1 ? 0.501 : 8 * levels) * static_cast<double>(unit));
            }
    }
  };
  check("");
  const NodeLayout& l = bonds.layout();
  const auto breakSome = [&](int count)
  {
    const auto near = [&](std::int64_t from) { return from + static_cast<std::int64_t>(random() % 6); };
    while (count > 0)
    {
      const std::int64_t i = l.index(near(5), near(4), near(7));
      const int o = static_cast<int>(random() % bonds.stencil().half().size());
      if (bonds.kind(i, o) == 0)
        continue;
      const SpringWeights weights = packed.weights(i, o);
      const Bond bond = bonds.bond(i, o);
      bonds.breakBonds({ &bond, 1 });
      packed.subtract(weights);
      --count;
    }
  };
  breakSome(400);
  EXPECT_EQ(packed.level(1).broken.size(), 400U);
  check("remembered ");
  breakSome(112);
  EXPECT_TRUE(packed.level(1).broken.empty());
  check("packed ");
}

// A lean hierarchy answers as one that keeps the finest level's residual and direction, also after bonds have broken:
// in another order of sums, to a few of the digits of single precision.
TEST(FractureEvents, LeanCyclesAreTheSame)
{
  for (const bool space : { false, true })
  {
    const Sample s = space ? aggregate(16, 14, 20) : aggregate(60, 70);
    BondLattice bonds = latticeOf(aggregateModel(space ? 3 : 2), s, alone());
    const LoadedSample loaded = applyLoading(bonds, {});
    MultigridOptions options;
    options.lean = true;
    BondMultigrid lean(bonds, loaded.fixed, options);
    BondMultigrid full(bonds, loaded.fixed);
    const std::int64_t vectors = 2 * bonds.dimension() * bonds.layout().count() * 4;
    EXPECT_EQ(full.bytes() - lean.bytes(), vectors);
    const NodeLayout& l = bonds.layout();
    std::mt19937 random(3);
    for (int round = 0; round < 2; ++round)
    {
      NodeField<float> r(l);
      forOwnRows(l,
        [&](std::int64_t y, std::int64_t z)
        {
          for (std::int64_t x = 0; x < l.size[0]; ++x)
            for (int c = 0; c < l.dimension; ++c)
              r.component(c)[l.index(x, y, z)] = static_cast<float>(random() % 1000) - 500;
        });
      const NodeField<float>& a = lean.apply(r);
      const NodeField<float>& b = full.apply(r);
      double worst = 0;
      double largest = 0;
      for (int c = 0; c < l.dimension; ++c)
        for (std::int64_t i = 0; i < l.count(); ++i)
        {
          worst = std::max(worst, std::abs(static_cast<double>(a.component(c)[i] - b.component(c)[i])));
          largest = std::max(largest, std::abs(static_cast<double>(b.component(c)[i])));
        }
      EXPECT_GT(largest, 0);
      EXPECT_LT(worst, 1e-5 * largest);
      const std::int64_t i = l.index(l.size[0] / 2, l.size[1] / 2, l.size[2] / 2);
      for (int o = 0; round == 0 && o < static_cast<int>(bonds.stencil().half().size()); ++o)
        if (bonds.kind(i, o) != 0)
        {
          const SpringWeights weights = full.weights(i, o);
          const Bond bond = bonds.bond(i, o);
          bonds.breakBonds({ &bond, 1 });
          full.subtract(weights);
          lean.subtract(weights);
        }
    }
  }
}

// The force of any combination of the motions is answered with that combination, also after bonds have broken; to the
// digits of a product in single precision.
TEST(FractureEvents, SlowMotionsAnswerTheirOwnForces)
{
  for (const bool space : { false, true })
  {
    const Sample s = space ? aggregate(16, 14, 20) : aggregate(60, 70);
    BondLattice bonds = latticeOf(aggregateModel(space ? 3 : 2), s, alone());
    const NodeLayout& l = bonds.layout();
    std::mt19937 random(7);
    const LayerShare layers(layersOf(bonds.layout()), alone());
    SlowMotions slow(bonds, layers);
    NodeField<float> work(l);
    NodeField<float> sum(l);
    for (int motion = 0; motion < 10; ++motion) // two more than there is room for
    {
      NodeField<float> u(l);
      const float share = 0.5F + static_cast<float>(motion);
      forOwnRows(l,
        [&](std::int64_t y, std::int64_t z)
        {
          for (std::int64_t x = 0; x < l.size[0]; ++x)
            for (int c = 0; c < l.dimension; ++c)
              u.component(c)[l.index(x, y, z)] = static_cast<float>(random() % 1000) * 1e-9F;
        });
      slow.keep(u, work);
      for (int c = 0; motion >= 2 && c < l.dimension; ++c)
        for (std::int64_t i = 0; i < l.count(); ++i)
          sum.component(c)[i] += share * u.component(c)[i];
    }
    for (int k = 0; k < 60; ++k)
    {
      const std::int64_t i = l.index(l.size[0] / 2 + k % 5, l.size[1] / 2, l.size[2] / 2);
      const int o = static_cast<int>(random() % bonds.stencil().half().size());
      if (bonds.kind(i, o) == 0)
        continue;
      const double stiffness = bonds.springConstant(i, o);
      const Bond bond = bonds.bond(i, o);
      bonds.breakBonds({ &bond, 1 });
      slow.breakBond(i, o, stiffness);
    }
    NodeField<float> force(l);
    linearForce(bonds, sum, force); // −A u
    NodeField<float> answer(l);
    slow.answer(force, answer);
    double worst = 0;
    double largest = 0;
    for (int c = 0; c < l.dimension; ++c)
      for (std::int64_t i = 0; i < l.count(); ++i)
      {
        worst = std::max(worst, std::abs(static_cast<double>(answer.component(c)[i] + sum.component(c)[i])));
        largest = std::max(largest, std::abs(static_cast<double>(sum.component(c)[i])));
      }
    EXPECT_GT(largest, 0);
    EXPECT_LT(worst, 1e-4 * largest) << (space ? "space" : "plane");
  }
}

void refused(const std::function<void()>& act, const std::string& words)
{
  try
  {
    act();
    FAIL() << "not refused: " << words;
  }
  catch (const Error& e)
  {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    EXPECT_FALSE(e.hint().empty());
  }
}

TEST(FractureEvents, RefusesWhatHasNoMeaning)
{
  const Breakable good = strip(24, 32);
  const FractureOptions o = by(FractureMethod::Events);
  for (const double s0 : { 0.0, -0.01, std::nan("") })
  {
    Breakable s = good;
    s.model.pairs[{ 1, 1 }].material.criticalStretch = s0;
    refused([&] { fracture(s, o); }, "critical stretch");
  }
  Breakable cut = good;
  for (std::size_t i = 0; i < static_cast<std::size_t>(24 * 4); ++i)
    cut.sample.phase[24 * 14 + i] = 0;
  refused([&] { fracture(cut, o); }, "no piece of the sample reaches");
  Loading loading;
  loading.load = LoadCase::Traction;
  loading.traction = 1;
  refused([&] { fracture(good, o, loading); }, "traction");
  loading = {};
  loading.strain = 0;
  refused([&] { fracture(good, o, loading); }, "no direction");
  Breakable periodic = good;
  periodic.model.periodic = { true, false, false };
  refused([&] { fracture(periodic, o); }, "periodic");
  const auto with = [&](const auto& change, const std::string& words)
  {
    FractureOptions bad = o;
    change(bad);
    refused([&] { fracture(good, bad); }, words);
  };
  with([](FractureOptions& b) { b.breaking = Breaking::Batched; }, "batches");
  with([](FractureOptions& b) { b.stopShare = 1; }, "share of the peak");
  with([](FractureOptions& b) { b.maxStrain = 0; }, "largest strain");
  with([](FractureOptions& b) { b.maxBroken = 0; }, "bonds are to break");
  with([](FractureOptions& b) { b.strainStep = -1e-5; }, "in steps of -1e-05");
  with([](FractureOptions& b) { b.tolerance = 0; }, "tolerance");
  with([](FractureOptions& b) { b.events.radius = 1; }, "radius");
  with([](FractureOptions& b) { b.events.maxCycles = 0; }, "cycles");
  with([](FractureOptions& b) { b.events.reduction = 2; }, "reduction");
  with([](FractureOptions& b) { b.events.globalTolerance = std::nan(""); }, "global tolerance");
}

TEST(FractureEvents, EndsWhereItIsTold)
{
  for (const FractureMethod method : { FractureMethod::Accurate, FractureMethod::Events })
  {
    Breakable s = cementedGrains(48, 0.6);
    FractureOptions o = by(method);
    o.maxStrain = 1e-5;
    FractureRecord r = fracture(s, o);
    EXPECT_EQ(r.end, FractureEnd::MaxStrain);
    EXPECT_TRUE(r.broken.empty());
    EXPECT_GT(r.modulus, 0);
    o.maxStrain = std::numeric_limits<double>::infinity();
    o.maxBroken = 3;
    r = fracture(s, o);
    EXPECT_EQ(r.end, FractureEnd::MaxBroken);
    EXPECT_EQ(r.broken.size(), 3U);
    for (auto& [pair, material] : s.model.pairs)
    {
      material.material.criticalStretch.reset(); // nothing is known of when it breaks: never
      if (material.betweenGrains)
        material.betweenGrains->criticalStretch.reset();
    }
    r = fracture(s, by(method));
    EXPECT_EQ(r.end, FractureEnd::NothingBreaks);
    EXPECT_TRUE(r.broken.empty());
  }
}

// A hundred nodes have no coarser level to correct on: the events are solved for one by one.
TEST(FractureEvents, TinySamples)
{
  const Breakable s = strip(8, 12, 1.5);
  const FractureRecord a = fracture(s, by(FractureMethod::Accurate, 0.5));
  const FractureRecord e = fracture(s, by(FractureMethod::Events, 0.5));
  EXPECT_NEAR(a.peak.stress, e.peak.stress, 1e-4 * a.peak.stress);
}

// Under compression along y the sample is stretched across and splits; strains count along the load.
TEST(FractureEvents, Compression)
{
  Loading down;
  down.strain = -1e-3;
  FractureOptions o = by(FractureMethod::Events);
  o.maxBroken = 10;
  const FractureRecord e = fracture(cementedGrains(48, 0.6), o, down);
  o.method = FractureMethod::Accurate;
  const FractureRecord a = fracture(cementedGrains(48, 0.6), o, down);
  EXPECT_GT(e.modulus, 0);
  EXPECT_GT(e.first.stress, 0);
  EXPECT_NEAR(e.first.strain, a.first.strain, 1e-3 * a.first.strain);
  EXPECT_EQ(e.broken.front().bond, a.broken.front().bond);
}

} // namespace
