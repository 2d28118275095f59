// A load that turns round: what is elastic has no hysteresis, cracks close and open, nothing heals, and what a cycle
// takes went with the breaks.
#include "../TemporaryFolder.h"
#include "FractureSamples.h"

#include "core/Error.h"
#include "peridynamics/fracture/FractureStudy.h"

#include <gtest/gtest.h>

namespace
{

using namespace lamella;
using namespace lamella::test;
using lamella::testing::TemporaryFolder;

constexpr double tight = 1e-9;

FractureOptions turning(std::vector<double> points, bool contact = false, std::vector<KnownBond> cracks = {})
{
  FractureOptions o = by(FractureMethod::Accurate);
  o.turningPoints = std::move(points);
  o.contact = contact;
  o.cracks = std::move(cracks);
  o.tolerance = tight;
  return o;
}

double modulus(const Breakable& s, const std::vector<KnownBond>& cracks = {})
{
  BondLattice bonds = latticeOf(s.model, s.sample, alone());
  bonds.breakBonds(bondsOf(cracks));
  FractureOptions o = by(FractureMethod::Accurate);
  o.tolerance = tight;
  return QuasiStaticFracture(bonds, {}, o).record().modulus;
}

/// A weak plane of bonds across: they alone break.
Breakable weakPlane(double horizon = 2)
{
  Breakable s = strip(16, 40, horizon);
  for (std::size_t i = 0; i < s.sample.phase.size() / 2; ++i)
    s.sample.phase[i] = 2;
  s.model.pairs[{ 1, 1 }] = s.model.pairs[{ 2, 2 }] = { BondMaterial{ .youngsModulus = young } };
  s.model.pairs[{ 1, 2 }] = { BondMaterial{ .youngsModulus = young, .criticalStretch = 0.01 } };
  return s;
}

TEST(FractureCycles, WhatIsElasticHasNoHysteresis)
{
  const Breakable s = strip(16, 40);
  const double e = modulus(s);
  const FractureRecord r = fracture(s, turning({ 4e-3, -4e-3, 2e-3, 0, 4e-3, -1e-3 }));
  EXPECT_EQ(r.end, FractureEnd::LastTurn);
  EXPECT_TRUE(r.broken.empty());
  ASSERT_EQ(r.branches.size(), 6U);
  for (const CurvePoint& p : r.curve)
    EXPECT_NEAR(p.stress, e * p.strain, 100 * tight * e * 4e-3);
  for (const LoadBranch& b : r.branches)
  {
    const double most = 0.5 * e * 4e-3 * 4e-3;
    EXPECT_NEAR(b.work, 0.5 * e * (b.to * b.to - b.from * b.from), 100 * tight * most);
    EXPECT_NEAR(b.released, 0, 1e-13 * most); // round-off
    EXPECT_EQ(b.broken, 0);
  }
  EXPECT_TRUE(std::isnan(r.branches[3].modulus));
}

// Closed forms: pulled, the slope is that of the sample with its crack, pressed that without.
TEST(FractureCycles, CrackedBarHasTwoSlopes)
{
  const Breakable s = strip(32, 48, 2);
  const BondLattice bonds = latticeOf(s.model, s.sample, alone());
  const std::vector<KnownBond> crack = crossing(bonds, 1, [](double x, double) { return x < 12; });
  const double whole = modulus(s);
  const double cracked = modulus(s, crack);
  const double a = 1e-3;
  const double b = 2e-3;
  for (const bool contact : { true, false })
  {
    FractureOptions o = turning({ a, -b, a, -b, 0 }, contact, crack);
    BondLattice cut = latticeOf(s.model, s.sample, alone());
    cut.breakBonds(bondsOf(crack));
    QuasiStaticFracture f(cut, {}, o);
    EXPECT_EQ(f.run(), FractureEnd::LastTurn);
    const FractureRecord& r = f.record();
    EXPECT_TRUE(r.broken.empty());
    const double pressed = contact ? whole : cracked;
    const double most = pressed * b * b;
    ASSERT_EQ(r.branches.size(), 5U);
    EXPECT_NEAR(r.branches[0].modulus / cracked, 1, 100 * tight);
    EXPECT_NEAR(r.branches[1].modulus / pressed, 1, 100 * tight);
    EXPECT_NEAR(r.branches[2].modulus / cracked, 1, 100 * tight);
    EXPECT_NEAR(r.branches[0].work, 0.5 * cracked * a * a, 100 * tight * most);
    EXPECT_NEAR(r.branches[1].work, 0.5 * (pressed * b * b - cracked * a * a), 100 * tight * most);
    EXPECT_NEAR(r.branches[2].work, 0.5 * (cracked * a * a - pressed * b * b), 100 * tight * most);
    for (const LoadBranch& branch : r.branches)
      EXPECT_NEAR(branch.released, 0, 1e-13 * most);
    EXPECT_NEAR(r.trough.stress, -pressed * b, 100 * tight * pressed * b);
  }
}

// Pulled asunder a bar bears nothing, pressed it is whole again; without contact it is at its end.
TEST(FractureCycles, PulledAsunderAndPressed)
{
  const Breakable s = weakPlane();
  const double whole = modulus(s);
  const FractureRecord r = fracture(s, turning({ 0.05, -1e-3, 0.05, -1e-3 }, true));
  EXPECT_EQ(r.end, FractureEnd::LastTurn);
  ASSERT_EQ(r.branches.size(), 4U);
  EXPECT_GT(r.branches[0].broken, 40);
  EXPECT_EQ(r.branches[0].stress, 0);
  for (const std::size_t pressed : { 1U, 3U })
  {
    EXPECT_EQ(r.branches[pressed].broken, 0);
    EXPECT_NEAR(r.branches[pressed].modulus / whole, 1, 100 * tight);
  }
  EXPECT_EQ(r.branches[2].stress, 0);
  EXPECT_NEAR(r.branches[2].released, 0, 1e-13 * r.branches[0].released);
  EXPECT_EQ(fracture(s, turning({ 0.05, -1e-3 })).end, FractureEnd::Severed);
}

// To a turning point the run is the one whose strain rises to there.
TEST(FractureCycles, FirstBranchIsAPull)
{
  const Breakable s = walls(48, 5);
  for (const double sign : { 1.0, -1.0 })
  {
    Loading loading;
    loading.strain = 1e-3 * sign;
    FractureOptions pull = turning({});
    pull.stopShare = 0;
    pull.maxBroken = 80;
    const FractureRecord to = fracture(s, pull, loading);
    const double strain = to.curve.back().strain * (1 + 1e-9);
    pull.maxBroken = FractureOptions{}.maxBroken;
    pull.maxStrain = strain;
    FractureRecord a = fracture(s, pull, loading);
    FractureRecord b = fracture(s, turning({ strain }), loading);
    EXPECT_GE(a.broken.size(), 80U);
    EXPECT_EQ(b.end, FractureEnd::LastTurn);
    b.end = a.end;
    expectSame(a, b, 1e-9);
    EXPECT_EQ(a.peak.stress, b.peak.stress);
    const std::vector<FractureCurvePoint> ofA = fractureCurve(a);
    const std::vector<FractureCurvePoint> ofB = fractureCurve(b);
    for (std::size_t i = 0; i < ofA.size(); ++i)
      EXPECT_NEAR(ofA[i].stress, ofB.at(i).stress, 1e-9 * a.peak.stress);
  }
}

// What went with the breaks, by the energies of all bonds before and after each, is the work of cycles that end
// unloaded. The next pull to the same strain breaks nothing, nor does any unloading.
TEST(FractureCycles, WorkOfAClosedCycle)
{
  const Breakable s = walls(48, 5);
  Loading loading;
  loading.strain = -1e-3; // which it bears while more and more breaks
  loading.rigid = true;   // so that work is force times movement
  FractureOptions o = turning({});
  o.stopShare = 0;
  o.maxBroken = 40;
  const FractureRecord pull = fracture(s, o, loading);
  const double half = pull.broken[20].strain;
  const double most = 1.1 * pull.curve.back().strain;
  o = turning({ half, 0, half, 0, most, 0 });
  const FractureRecord all = fracture(s, o, loading);
  ASSERT_EQ(all.branches.size(), 6U);
  EXPECT_GE(all.branches[0].broken, 20);
  EXPECT_EQ(all.branches[1].broken + all.branches[2].broken + all.branches[3].broken, 0);
  EXPECT_GT(all.branches[4].broken, 0);
  EXPECT_EQ(all.branches[5].broken, 0);

  BondLattice bonds = latticeOf(s.model, s.sample, alone());
  QuasiStaticFracture f(bonds, loading, o);
  const LoadedSample& sample = f.sample();
  const double dx = s.sample.lattice.spacing;
  const double volume = static_cast<double>(sample.highLayers[0] - sample.lowLayers[1] + 1) * dx *
    static_cast<double>(s.sample.lattice.size[0]) * dx;
  double before = 0; // of all bonds, over the square of the strain
  double released = 0;
  for (std::size_t k = 0; k <= all.broken.size(); ++k)
  {
    if (k > 0)
    {
      f.setLimits(FractureOptions{}.maxStrain, static_cast<std::int64_t>(k));
      ASSERT_EQ(f.run(), FractureEnd::MaxBroken);
    }
    const double strain = f.strain();
    const double now =
      k > 0 ? elasticEnergy(bonds, f.displacement(), false) / (strain * strain) : 0.5 * f.record().modulus * volume;
    released += k > 0 ? (before - now) * strain * strain : 0;
    before = now;
  }
  double work = 0;
  for (const LoadBranch& b : all.branches)
    work += b.work;
  EXPECT_NEAR(work * volume / released, 1, 1e-5); // walls bend: 1e4 tolerances
  EXPECT_GT(released, 0);
}

// Cracks of a pull close when pressed, and what breaks then was not broken before; nothing breaks on the way to 0.
TEST(FractureCycles, NothingHeals)
{
  const Breakable s = walls(48, 5);
  FractureOptions o = turning({});
  o.stopShare = 0;
  o.maxBroken = 40;
  const double a = fracture(s, o).curve.back().strain;
  const FractureRecord r = fracture(s, turning({ a, -3 * a, a, -3 * a, a }, true));
  ASSERT_EQ(r.branches.size(), 5U);
  std::set<Bond> broken;
  for (const BrokenBond& b : r.broken)
    EXPECT_TRUE(broken.insert(b.bond).second);
  EXPECT_LE(r.branches[2].modulus, r.branches[0].modulus * (1 + 1e-6));
  EXPECT_LE(r.branches[3].modulus, r.branches[1].modulus * (1 + 1e-6));
  EXPECT_GT(r.branches[1].modulus, r.branches[0].modulus);
  const auto first = r.broken.begin() + r.branches[0].broken;
  for (auto b = first; b != first + r.branches[1].broken; ++b)
    EXPECT_LT(b->strain, 0);
  for (const LoadBranch& b : r.branches)
    EXPECT_GE(b.released, -1e-9 * r.branches[0].work);
}

TEST(FractureCycles, GoesOnInTheMiddleOfACycle)
{
  const TemporaryFolder folder;
  const Breakable s = walls(48, 5);
  FractureOptions o = turning({});
  o.stopShare = 0;
  o.maxBroken = 30;
  const double a = fracture(s, o).curve.back().strain;
  o = turning({ a, -2.2 * a, a, -2.4 * a, 0 }, true);
  o.renewEvery = 5;
  const FractureRecord straight = fracture(s, o);
  ASSERT_EQ(straight.branches.size(), 5U);
  const auto all = static_cast<std::int64_t>(straight.broken.size());
  ASSERT_GT(straight.branches[1].broken, 5);
  for (const std::int64_t stop : { straight.branches[0].broken + 5, all - 2 })
  {
    FractureOptions first = o;
    first.checkpoint.path = folder.path() / "run.h5";
    first.maxBroken = stop;
    (void)fracture(s, first);
    FractureOptions second = o;
    second.continueFrom = first.checkpoint.path;
    const FractureRecord resumed = fracture(s, second);
    expectSame(straight, resumed, 0);
    ASSERT_EQ(resumed.branches.size(), 5U);
    for (std::size_t k = 0; k < 5; ++k)
    {
      EXPECT_EQ(straight.branches[k].work, resumed.branches[k].work);
      EXPECT_EQ(straight.branches[k].released, resumed.branches[k].released);
      EXPECT_EQ(straight.branches[k].broken, resumed.branches[k].broken);
    }
    EXPECT_EQ(straight.trough.stress, resumed.trough.stress);
    ASSERT_EQ(straight.curve.size(), resumed.curve.size());
    second.turningPoints[0] = 0.5 * a;
    EXPECT_THROW((void)fracture(s, second), InputError);
  }
}

TEST(FractureCycles, Refusals)
{
  const Breakable s = strip(16, 40, 2);
  FractureOptions o = turning({ 1e-3, 0 });
  o.method = FractureMethod::Events;
  EXPECT_THROW((void)fracture(s, o), ParameterError);
  o = turning({ 1e-3, 0 });
  o.maxStrain = 1e-2;
  EXPECT_THROW((void)fracture(s, o), ParameterError);
  o = turning({ 1e-3, 0 });
  o.strainStep = 1e-4;
  EXPECT_THROW((void)fracture(s, o), ParameterError);
  EXPECT_THROW((void)fracture(s, turning({ 0, 1e-3 })), ParameterError);
  EXPECT_THROW((void)fracture(s, turning({ 1e-3, 1e-3 })), ParameterError);
  EXPECT_THROW((void)fracture(s, turning({ std::nan("") })), ParameterError);
}

} // namespace
