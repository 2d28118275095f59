// Pressed specimens: exact curves of blocks, what the control keeps, the implicit stiffness again, runs that go on.
#include "../TemporaryFolder.h"
#include "MaterialPointSamples.h"

#include "core/Error.h"
#include "mpm/PointCompression.h"
#include "mpm/PointStiffness.h"
#include "mpm/WallMaterial.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace
{

using namespace lamella;
using namespace lamella::mpm;
using lamella::testing::TemporaryFolder;

constexpr double young = 1e9;
constexpr double poisson = 0.25;

std::shared_ptr<const PointLaw<2>> wall()
{
  return makeLaw<2, Isotropic>({ isotropicConstants<2>(IsotropicMaterial{ young, poisson, 1 }) });
}

/// A block of 16 × 20 cells, or what is left of it.
MaterialPoints<2> block(const std::function<bool(const Vector<2>&)>& inside = [](const Vector<2>&) { return true; })
{
  return samples::filled<2>({ 16, 20 }, 1, 2, 1500, inside);
}

/// Two lumens of 6 × 5 cells.
MaterialPoints<2> lumens()
{
  return block([](const Vector<2>& x)
    { return !(x[0] > 5 && x[0] < 11 && ((x[1] > 3 && x[1] < 8) || (x[1] > 12 && x[1] < 17))); });
}

CompressionOptions<2> options(double strain = 0.1)
{
  CompressionOptions<2> o;
  o.upper = { 16, 20 };
  o.strain = strain;
  o.rows = 20;
  o.motion.spacing = 1;
  return o;
}

// A block between straight sides without force is under uniaxial stress, along which the stretch-based law is a
// straight line of nominal stress against strain while the barrier, of fourth power in the loss of area, is small. The
// stress of a row is a mean over its strains: what is left is the quadrature of the shapes, exact here, and vibration,
// which the kinetic energy bounds: its share of the stress is at most the root of the energy ratio, and averages out.
TEST(PointCompression, BlockIsHookes)
{
  CompressionOptions<2> o = options(0.02);
  o.energyRatio = 1e-4;
  o.firstSpeed = 2e-4; // sides begin at rest: they swing by what the body widens in one of their periods
  PointCompression<2> c(block(), wall(), o);
  ASSERT_TRUE(c.run());
  ASSERT_EQ(c.rows().size(), 21U);
  for (std::size_t i = 1; i + 1 < c.rows().size(); ++i)
  {
    const CompressionRow& row = c.rows()[i];
    EXPECT_NEAR(row.strain, 0.001 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR(row.stress / (young * row.strain), 1, i < 5 ? 0.06 : 0.02) << row.strain;
    EXPECT_NEAR(row.lateralStrain / (poisson * row.strain), 1, i < 5 ? 0.1 : 0.03) << row.strain;
    EXPECT_LT(row.lateral, 1e-9 * row.stress); // straight sides have no force in any step
    EXPECT_NEAR(row.work, row.elastic + row.kinetic + row.dissipated - c.rows()[0].kinetic, 1e-9 * row.work);
  }
}

TEST(PointCompression, FixedSidesFeelTheirShare)
{
  CompressionOptions<2> o = options(0.02);
  o.sides = LateralSides::Fixed;
  PointCompression<2> c(block(), wall(), o);
  ASSERT_TRUE(c.run());
  // plane stress, no strain across: E/(1 − ν²), and ν of it on the sides; the same bound as above
  const CompressionRow& row = c.rows()[15];
  EXPECT_NEAR(row.stress / (young * row.strain) * (1 - poisson * poisson), 1, 0.02);
  EXPECT_NEAR(row.lateral / row.stress, poisson, 0.03 * poisson);
  EXPECT_DOUBLE_EQ(row.lateralStrain, 0);
}

TEST(PointCompression, BothAxesAndPeriodicSides)
{
  CompressionOptions<2> o = options(0.02);
  o.axis = 0;
  o.sides = LateralSides::Periodic;
  PointCompression<2> c(block(), wall(), o);
  ASSERT_TRUE(c.run());
  EXPECT_NEAR(c.rows()[15].stress / (young * c.rows()[15].strain), 1, 0.02);
  EXPECT_NEAR(c.rows()[15].lateralStrain / (poisson * c.rows()[15].strain), 1, 0.03);
}

// The first slope is the implicit solve's; the ratio of energies is kept where it was promised.
TEST(PointCompression, SlowAndImplicitAgree)
{
  CompressionOptions<2> o = options(0.006);
  o.rows = 12;
  o.energyRatio = 1e-4;
  const MaterialPoints<2> points = lumens();
  PointCompression<2> c(points, wall(), o);
  ASSERT_TRUE(c.run());
  PointStiffnessOptions<2> s;
  s.upper = { 16, 20 };
  s.spacing = 1;
  s.sides = { BoxSides::Walls, BoxSides::Walls };
  const double modulus = pointStiffness(points, *wall(), s).along(1).modulus;
  double over = 0;
  double under = 0;
  for (std::size_t i = 1; i + 1 < c.rows().size(); ++i)
  {
    over += c.rows()[i].stress * c.rows()[i].strain;
    under += c.rows()[i].strain * c.rows()[i].strain;
  }
  EXPECT_NEAR(over / under / modulus, 1, 0.01); // the issue's; large displacement is 0.6 % at most
}

TEST(PointCompression, ControlKeepsTheRatioToTheEnd)
{
  CompressionOptions<2> o = options(0.5);
  o.rows = 50;
  PointCompression<2> c(lumens(), wall(), o);
  ASSERT_TRUE(c.run());
  const CompressionSummary s = c.summary();
  EXPECT_TRUE(s.finished);
  EXPECT_NEAR(s.strain, 0.5, 1e-9);
  EXPECT_LE(s.worstRatio, o.energyRatio) << "at " << s.worstRatioAt;
  EXPECT_LT(s.worstLateral, 1e-9);
  EXPECT_TRUE(s.warnings.empty());
  // lumens close: 30 of 320 cells each were empty
  EXPECT_NEAR(c.rows().front().porosity, 60.0 / 320, 1e-12);
  EXPECT_LT(c.rows().back().porosity, c.rows().front().porosity / 2);
}

// A wall nine cells thick that is folded flat: its outer side is stretched to half as long again, so that with 4 points
// a cell some cells keep none and the wall tears between points, on which a third of the work is lost. With 9 it holds:
// measured 0.029 lost to 0.55 (0.35 with 4).
TEST(PointCompression, FoldedWallsHoldWithNinePointsACell)
{
  constexpr double height = 64;
  CompressionOptions<2> o;
  o.upper = { 48, height };
  o.strain = 0.55;
  o.rows = 50;
  o.sides = LateralSides::Open;
  o.motion.spacing = 1;
  const auto inside = [](const Vector<2>& x)
  {
    const double middle = 14 + 3 * std::sin(3.14159265358979323846 * x[1] / height);
    return std::fabs(x[0] - middle) < 4.5 || x[1] < 4 || x[1] > height - 4;
  };
  PointCompression<2> c(samples::filled<2>({ 48, 64 }, 1, 3, 1500, inside), wall(), o);
  ASSERT_TRUE(c.run());
  EXPECT_LT(c.rows().back().dissipated, 0.05 * c.rows().back().work);
  EXPECT_LT(c.summary().worstRatio, o.energyRatio);
  EXPECT_TRUE(c.summary().warnings.empty());
}

TEST(PointCompression, AsManyThreadsAsYouLike)
{
  const auto run = [](int threads)
  {
    omp_set_num_threads(threads);
    PointCompression<2> c(lumens(), wall(), options(0.05));
    c.run();
    omp_set_num_threads(1);
    return c.rows();
  };
  const auto one = run(1);
  const auto three = run(3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i)
    EXPECT_EQ(one[i].stress, three[i].stress);
}

TEST(PointCompression, GoesOnToTheSameCurve)
{
  const TemporaryFolder folder;
  const auto with = [&](const char* name)
  {
    CompressionOptions<2> o = options(0.2);
    o.checkpoint.path = folder.path() / name;
    o.checkpoint.every = 300;
    return o;
  };
  PointCompression<2> whole(lumens(), wall(), with("whole.h5"));
  ASSERT_TRUE(whole.run());
  CompressionOptions<2> bare = with("none.h5");
  bare.checkpoint.path.clear();
  PointCompression<2> without(lumens(), wall(), bare);
  ASSERT_TRUE(without.run()); // files change nothing
  ASSERT_EQ(without.rows().size(), whole.rows().size());
  EXPECT_EQ(without.rows().back().stress, whole.rows().back().stress);
  EXPECT_EQ(without.rows().back().elastic, whole.rows().back().elastic);

  // killed, where the last file of its own rhythm stands, or stopped, where one more is written: every bit comes again,
  // from the middle of steps to the next look too
  for (const bool killed : { true, false })
    for (const int call : { 5, 7, 12 })
    {
      CompressionOptions<2> part = with("part.h5");
      int calls = 0; // under way
      part.progress = [&](double share)
      {
        calls += share > 0 ? 1 : 0;
        if (calls == call && killed)
          throw std::runtime_error("killed");
        return calls == call;
      };
      PointCompression<2> stopped(lumens(), wall(), part);
      if (killed)
        EXPECT_THROW(stopped.run(), std::runtime_error);
      else
        EXPECT_FALSE(stopped.run());
      EXPECT_LT(stopped.strain(), 0.2);

      CompressionOptions<2> rest = with("part.h5");
      rest.continueFrom = rest.checkpoint.path;
      PointCompression<2> gone(lumens(), wall(), rest);
      EXPECT_GT(gone.strain(), 0);
      ASSERT_TRUE(gone.run());
      ASSERT_EQ(gone.rows().size(), whole.rows().size());
      for (std::size_t i = 0; i < gone.rows().size(); ++i)
      {
        EXPECT_EQ(gone.rows()[i].strain, whole.rows()[i].strain) << i;
        EXPECT_EQ(gone.rows()[i].stress, whole.rows()[i].stress) << i;
        EXPECT_EQ(gone.rows()[i].elastic, whole.rows()[i].elastic) << i;
      }
    }
}

// Setting up asks, too. What was stopped before its first step has no checkpoint: there is nothing in it.
TEST(PointCompression, StopsWhileItSetsUp)
{
  const TemporaryFolder folder;
  CompressionOptions<2> o = options(0.2);
  o.checkpoint.path = folder.path() / "run.h5";
  int calls = 0;
  o.progress = [&](double share)
  {
    EXPECT_EQ(share, 0);
    ++calls;
    return false;
  };
  const PointCompression<2> made(block(), wall(), o);
  const int inSetup = calls;
  EXPECT_GE(inSetup, 24); // every pass of the iteration that takes most of it
  for (const int call : { 1, inSetup / 2, inSetup })
  {
    calls = 0;
    o.progress = [&](double) { return ++calls == call; };
    EXPECT_THROW(PointCompression<2>(block(), wall(), o), Cancelled);
    EXPECT_EQ(calls, call);
  }
  calls = 0;
  o.progress = [&](double) { return ++calls > inSetup; };
  PointCompression<2> stopped(block(), wall(), o);
  EXPECT_FALSE(stopped.run());
  EXPECT_EQ(stopped.summary().steps, 0);
  EXPECT_EQ(stopped.summary().lastCheckpoint, 0);
  EXPECT_FALSE(std::filesystem::exists(o.checkpoint.path));
}

TEST(PointCompression, ForeignCheckpointsAreRefused)
{
  const TemporaryFolder folder;
  CompressionOptions<2> o = options(0.02);
  o.checkpoint.path = folder.path() / "a.h5";
  PointCompression<2>(block(), wall(), o).run();
  o.continueFrom = o.checkpoint.path;
  EXPECT_NO_THROW(PointCompression<2>(block(), wall(), o));
  EXPECT_THROW(PointCompression<2>(lumens(), wall(), o), InputError);
  o.strain = 0.03;
  EXPECT_THROW(PointCompression<2>(block(), wall(), o), InputError);
}

std::string refusal(const CompressionOptions<2>& o, MaterialPoints<2> points = block())
{
  try
  {
    PointCompression<2>(std::move(points), wall(), o);
  }
  catch (const Error& e)
  {
    return e.what();
  }
  return {};
}

TEST(PointCompression, BadInputIsNamed)
{
  const auto with = [](const std::function<void(CompressionOptions<2>&)>& change)
  {
    CompressionOptions<2> o = options();
    change(o);
    return refusal(o);
  };
  EXPECT_EQ(refusal(options()), "");
  EXPECT_NE(with([](auto& o) { o.strain = 1; }).find("a strain of 1"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.strain = -0.1; }).find("a strain of -0.1"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.strain = std::nan(""); }).find("a strain of nan"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.axis = 2; }).find("axis 2"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.rows = 0; }).find("0 rows"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.energyRatio = 0; }).find("kinetic energy of 0"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.leastSpeed = 1; }).find("speeds of 1"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.atStrains = { 0.2 }; }).find("state at a strain of 0.2"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.motion.step = 1; }).find("unstable: the largest stable one is"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.upper[1] = 24; }).find("does not touch the upper platen: 4 m"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.lower[1] = -2; }).find("does not touch the lower platen: 2 m"), std::string::npos);
  EXPECT_NE(with([](auto& o) { o.checkpoint.path = "/nowhere/at/all.h5"; }), "");
}

} // namespace
