// What a doubt about surfaces does to a strength.
#include "Bonds.h"

#include "core/Error.h"
#include "peridynamics/fracture/SurfaceStrength.h"

#include <gtest/gtest.h>

namespace
{

using namespace lamella;
using namespace lamella::peridynamics;
using namespace lamella::test;

constexpr double young = 1e9;
constexpr double critical = 1e-2;

/// A bar of so many columns, between voids, or as wide as the sample.
Sample bar(std::int64_t first, std::int64_t last, std::int64_t nx = 20, std::int64_t ny = 30)
{
  const Lattice lattice = makeLattice(nx, ny, 1, 2, 1e-4);
  Sample s{ lattice, std::vector<std::uint8_t>(static_cast<std::size_t>(lattice.count()), 0), {} };
  for (std::int64_t y = 0; y < ny; ++y)
    for (std::int64_t x = first; x < last; ++x)
      s.phase[static_cast<std::size_t>(lattice.index(x, y))] = 1;
  return s;
}

BondModel model(double horizon)
{
  BondModel m;
  m.horizon = horizon;
  m.pairs[{ 1, 1 }].material = { .youngsModulus = young, .criticalStretch = critical };
  return m;
}

FractureStudyOptions exact()
{
  FractureStudyOptions o;
  o.fracture.tolerance = 1e-9;
  o.threads = 1;
  return o;
}

double peak(const BondModel& m, const Sample& s)
{
  FractureStudyOptions o = exact();
  o.displacement = false;
  return studyFracture(m, s.lattice, s.phase, {}, o, alone()).peak.stress;
}

// Bonds along the axes only: each column carries by itself, and a bar of 6 carries by 2 δ/6 more where both its sides
// move out by δ. To the solver's tolerance.
TEST(SurfaceStrength, AStraightBarCarriesByItsWidth)
{
  const BondModel m = model(1);
  const Sample s = bar(7, 13);
  const double own = peak(m, s);
  for (const double doubt : { 0.1, 0.25 })
  {
    const SurfaceStrengths moved = surfaceStrengths(m, s.lattice, s.phase, {}, exact(), doubt);
    EXPECT_DOUBLE_EQ(moved.step, doubt);
    EXPECT_NEAR(moved.grown / own, 1 + 2 * doubt / 6, 1e-7);
    EXPECT_NEAR(moved.shrunk / own, 1 - 2 * doubt / 6, 1e-7);
    EXPECT_NEAR(strengthDoubt(own, moved, doubt) / own, weakestPlace * 2 * doubt / 6, 1e-6);
  }
}

// Longer bonds: against bars that are a column wider and narrower on either side, which break in their middle only,
// where platens are far. A wider bar has the same sides and more inside, so what it carries more is that of the inside;
// bonds that are stiffer in the sides do the same but for what these then contract less: 5 %.
TEST(SurfaceStrength, LongerBondsCarryLikeWiderBars)
{
  for (const double horizon : { 2.0, 3.0, 4.0 })
  {
    SCOPED_TRACE(horizon);
    BondModel m = model(horizon);
    m.pairs[{ 2, 2 }] = m.pairs[{ 1, 1 }];
    m.pairs[{ 1, 1 }].material.criticalStretch.reset();
    m.pairs[{ 1, 2 }] = m.pairs[{ 1, 1 }];
    const auto tall = [](std::int64_t first, std::int64_t last)
    {
      Sample s = bar(first, last, 24, 80);
      for (std::size_t i = 24U * 35; i < 24U * 45; ++i)
        s.phase[i] = static_cast<std::uint8_t>(2 * s.phase[i]);
      return s;
    };
    const double slope = (peak(m, tall(5, 19)) - peak(m, tall(7, 17))) / 2;
    const Sample s = tall(6, 18);
    const SurfaceStrengths moved = surfaceStrengths(m, s.lattice, s.phase, {}, exact(), 0.05);
    EXPECT_NEAR((moved.grown - moved.shrunk) / 0.1 / slope, 1, 0.05);
  }
}

// Surfaces that lie off by more than a third of a node are moved by a third, and the change counts in proportion.
TEST(SurfaceStrength, LargeDoubts)
{
  const BondModel m = model(1);
  const Sample s = bar(7, 13);
  const SurfaceStrengths moved = surfaceStrengths(m, s.lattice, s.phase, {}, exact(), 2);
  EXPECT_DOUBLE_EQ(moved.step, 1.0 / 3);
  const double own = peak(m, s);
  EXPECT_NEAR(strengthDoubt(own, moved, 2) / own, weakestPlace * 2 * 2 / 6.0, 1e-6);
}

TEST(SurfaceStrength, ASurfaceIsNeeded)
{
  const BondModel m = model(3);
  const Sample s = bar(0, 20);
  try
  {
    (void)surfaceStrengths(m, s.lattice, s.phase, {}, exact(), 0.1);
    FAIL() << "a sample without voids was taken";
  }
  catch (const ParameterError& error)
  {
    EXPECT_STREQ(error.what(), "a segmentation error of a strength without a surface between solid and void");
  }
}

} // namespace
