// Paths of ideal cracks against the lines that made them: length, direction, place, branches.
#include "CrackCuts.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <random>

namespace
{

using namespace lamella;
using namespace lamella::test;

class Horizons : public ::testing::TestWithParam<double>
{
};

// Where a line crosses the bond between two neighbours is known to half a spacing, and better where it meets each of
// them elsewhere: a line along an axis may lie anywhere between two rows, one at 45° anywhere within 1/√8 of a spacing
// beside the middles of the pairs. The length is that of the line but for what its tips lose or gain on the lattice, at
// most half a spacing each.
TEST_P(Horizons, StraightCracksAtAllAngles)
{
  const double h = GetParam();
  const Lattice lattice = square(120);
  constexpr double half = 45;
  double mean = 0;
  int count = 0;
  for (int angle = 0; angle<180; angle += h> 4 ? 18 : 6)
    for (const double offset : { 0.13, 0.61 })
    {
      const double t = angle * pi / 180;
      const Place c{ 59.5 + offset, 59.3 + 0.7 * offset };
      const Line line{ { c[0] - half * std::cos(t), c[1] - half * std::sin(t) },
        { c[0] + half * std::cos(t), c[1] + half * std::sin(t) } };
      const CrackPaths found = pathsOf(lattice, h, cut(lattice, h, line));
      ASSERT_EQ(found.paths.size(), 1U) << angle;
      const CrackPath& path = found.paths.front();
      EXPECT_NEAR(path.length, 2 * half, 0.01 * 2 * half) << angle;
      EXPECT_LT(turn(path.orientation.angle, t), 0.5 * pi / 180) << angle;
      EXPECT_LT(path.orientation.spread, 0.01) << angle;
      EXPECT_NEAR(path.tortuosity(), 1, 1e-4) << angle;
      EXPECT_EQ(path.ends[0], ChainEnd::Tip);
      EXPECT_EQ(path.ends[1], ChainEnd::Tip);
      for (const CrackPoint& p : path.points)
        EXPECT_LT(
          std::abs((p.place[0] - c[0]) * std::sin(t) - (p.place[1] - c[1]) * std::cos(t)), angle % 90 == 0 ? 0.5 : 0.2)
          << angle;
      EXPECT_EQ(found.leftOut.bonds, 0) << angle;
      mean += path.length / (2 * half) - 1;
      ++count;
    }
  EXPECT_NEAR(mean / count, 0, 0.003); // the scatter of 0.3 % over 20 lines or more
}

// Closed and open arcs. The chain of n pairs leaves a place free within half a spacing, so that a circle may come out
// so much larger or smaller; it is far better, 0.6 % at a radius of 7.5 spacings.
TEST_P(Horizons, CirclesAndArcs)
{
  const double h = GetParam();
  for (const double radius : { 10.0, 20.0, 40.0 })
  {
    const auto size = static_cast<std::int64_t>(2 * radius + 30);
    const Place centre{ static_cast<double>(size) / 2 + 0.13, static_cast<double>(size) / 2 - 0.37 };
    const Line circle = arc(centre, radius);
    const Lattice lattice = square(size);
    const CrackPaths closed = pathsOf(lattice, h, cut(lattice, h, circle));
    ASSERT_EQ(closed.paths.size(), 1U) << radius;
    EXPECT_EQ(closed.paths[0].ends[0], ChainEnd::None);
    EXPECT_NEAR(closed.paths[0].length, 2 * pi * radius, 0.01 * 2 * pi * radius) << radius;
    EXPECT_EQ(closed.paths[0].chord, 0);
    EXPECT_TRUE(std::isnan(closed.paths[0].tortuosity()));
    EXPECT_EQ(closed.paths[0].points.front().place, closed.paths[0].points.back().place);

    const Line part = arc(centre, radius, 0.3, 2.3);
    const CrackPaths open = pathsOf(lattice, h, cut(lattice, h, part));
    ASSERT_EQ(open.paths.size(), 1U) << radius;
    // and the tips, half a spacing each: a chord of 1.68 radii, so 1.19/1.68 of it in the tortuosity
    EXPECT_NEAR(open.paths[0].length, 2 * radius, 0.01 * 2 * radius + 1) << radius;
    EXPECT_NEAR(open.paths[0].tortuosity(), 1 / std::sin(1), 0.01 + 0.71 / radius) << radius;
    EXPECT_LT(farthest(open.paths[0], part), 1) << radius;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Horizons, ::testing::Values(2.0, 3.0, 4.0, 6.0, 8.0),
  [](const auto& p) { return std::string("h").append(std::to_string(static_cast<int>(p.param))); });

// The exact length is that of the fine polygon. What the lattice leaves open shrinks with the spacing, and a curve's
// smoothing with it: the error falls with an order of about 1.5.
TEST(CrackPaths, LengthAndTortuosityOfASineConverge)
{
  for (const double amplitude : { 10.0 / 256, 20.0 / 256 })
  {
    std::vector<double> errors;
    for (const std::int64_t n : { 64, 128, 256, 512 })
    {
      const Lattice lattice = square(n);
      const Line line = sine(n, amplitude * static_cast<double>(n));
      const CrackPaths found = pathsOf(lattice, 4, cut(lattice, 4, line));
      ASSERT_EQ(found.paths.size(), 1U);
      const CrackPath& path = found.paths[0];
      errors.push_back(std::abs(path.length / lengthOf(line) - 1));
      EXPECT_LT(farthest(path, line), 0.5) << n;
      EXPECT_EQ(path.ends[0], ChainEnd::Border);
      EXPECT_EQ(path.ends[1], ChainEnd::Border);
      EXPECT_TRUE(found.cracks[0].through[0]);
      EXPECT_FALSE(found.cracks[0].through[1]);
      EXPECT_NEAR(path.tortuosity(), lengthOf(line) / static_cast<double>(n), 0.02) << n;
    }
    EXPECT_LT(errors[0], 0.02);
    EXPECT_LT(errors[2], 0.002);
    EXPECT_LT(errors[3], 0.001);
    EXPECT_GT(std::log2(errors[0] / errors[3]) / 3, 1.2); // order, over three halvings
  }
}

// Three arms of 35 spacings. They meet within half a spacing of where they should, so their lengths are known to that
// and to the half spacing of their tips.
TEST(CrackPaths, BranchesShareAPoint)
{
  const Lattice lattice = square(100);
  for (const double h : { 2.0, 3.0, 5.0 })
  {
    const Place joint{ 50.2, 49.7 };
    std::vector<CutBond> bonds;
    for (const double degrees : { 180.0, 35.0, -25.0 })
    {
      const double t = degrees * pi / 180;
      const auto arm = cut(lattice, h, { joint, { joint[0] + 35 * std::cos(t), joint[1] + 35 * std::sin(t) } });
      bonds.insert(bonds.end(), arm.begin(), arm.end());
    }
    const CrackPaths found = pathsOf(lattice, h, bonds);
    ASSERT_EQ(found.paths.size(), 3U) << h;
    ASSERT_EQ(found.cracks.size(), 1U) << h;
    std::set<Place> shared;
    for (const CrackPath& path : found.paths)
    {
      EXPECT_NEAR(path.length, 35, 1) << h;
      ASSERT_NE(path.ends[0] == ChainEnd::Junction, path.ends[1] == ChainEnd::Junction) << h;
      shared.insert(path.ends[0] == ChainEnd::Junction ? path.points.front().place : path.points.back().place);
    }
    ASSERT_EQ(shared.size(), 1U) << h;
    EXPECT_LT(std::hypot((*shared.begin())[0] - joint[0], (*shared.begin())[1] - joint[1]), 0.5) << h;
  }
}

TEST(CrackPaths, TwoCracksALoopAndNoise)
{
  const Lattice lattice = square(128);
  constexpr double h = 3;
  const Line longer{ { 10.3, 30.2 }, { 90.7, 41.9 } };
  const Line shorter{ { 100.2, 60.1 }, { 104.1, 101.3 } };
  const Line grain = arc({ 50.2, 85.4 }, 9); // 56 spacings around
  std::vector<CutBond> bonds = cut(lattice, h, longer);
  for (const Line& more : { shorter, grain })
  {
    const auto b = cut(lattice, h, more);
    bonds.insert(bonds.end(), b.begin(), b.end());
  }
  const std::size_t cracked = bonds.size();
  // single bonds here and there: as many again
  std::mt19937 random(5);
  const peridynamics::Stencil stencil(2, h);
  const auto any = [&] { return static_cast<std::int64_t>(4 + random() % 120); };
  for (std::size_t i = 0; i < cracked; ++i)
  {
    const std::int64_t x = any();
    bonds.push_back({ { x, any(), 0 }, stencil.half()[random() % 14].step, 0, 0, {}, false });
  }
  const CrackPaths found = pathsOf(lattice, h, bonds);
  ASSERT_EQ(found.paths.size(), 3U);
  ASSERT_EQ(found.cracks.size(), 3U);
  const std::array<double, 3> lengths{ lengthOf(longer), lengthOf(grain), lengthOf(shorter) };
  for (std::size_t i = 0; i < 3; ++i)
  {
    EXPECT_NEAR(found.paths[i].length, lengths[i], 0.02 * lengths[i]) << i;
    EXPECT_EQ(found.paths[i].crack, static_cast<int>(i));
  }
  EXPECT_EQ(found.paths[1].ends[0], ChainEnd::None);
  // of the noise, what touches no crack
  EXPECT_GT(found.leftOut.bonds, static_cast<std::int64_t>(cracked) / 2);
  EXPECT_NEAR(found.length, lengths[0] + lengths[1] + lengths[2], 0.02 * found.length);
}

// A crack that half of its bonds survived is none where fewer than half of a pair's common neighbours are parted; one
// of ten surviving changes nothing.
TEST(CrackPaths, SurvivingBondsLeaveTheCrackWhole)
{
  const Lattice lattice = square(100);
  const Line line{ { 10.2, 41.3 }, { 88.9, 56.8 } };
  for (const double h : { 3.0, 4.0 })
  {
    std::vector<CutBond> bonds = cut(lattice, h, line);
    std::mt19937 random(7);
    std::erase_if(bonds, [&](const CutBond&) { return random() % 10 == 0; });
    const CrackPaths found = pathsOf(lattice, h, bonds);
    ASSERT_EQ(found.paths.size(), 1U) << h;
    EXPECT_NEAR(found.length, lengthOf(line), 0.01 * lengthOf(line) + 1) << h;
    EXPECT_NEAR(found.paths[0].countedLength() / found.length, 0.9, 0.03) << h; // their number tells
  }
}

TEST(CrackPaths, WhatCannotBeIsRefused)
{
  const Lattice lattice = square(30);
  EXPECT_THROW((void)findCrackPaths(makeLattice(9, 9, 9, 3, 1), 3, {}), ParameterError);
  EXPECT_THROW((void)findCrackPaths(lattice, 9, {}), ParameterError);
  const std::vector<CutBond> far{ { { 3, 3, 0 }, { 5, 0, 0 }, 0, 0, {}, false } };
  EXPECT_THROW((void)findCrackPaths(lattice, 3, far), ParameterError);
  const std::vector<std::uint8_t> few(5);
  EXPECT_THROW((void)findCrackPaths(lattice, 3, {}, few), InputError);
  const CrackPaths none = findCrackPaths(lattice, 3, {});
  EXPECT_TRUE(none.paths.empty());
  EXPECT_EQ(none.length, 0);
  // bonds that leave the lattice, over a periodic side, are only counted
  const std::vector<CutBond> over{ { { 29, 3, 0 }, { 2, 0, 0 }, 0, 0, {}, false } };
  EXPECT_EQ(findCrackPaths(lattice, 3, over).leftOut.bonds, 1);
}

// Each bond once, whoever tells of it and from whichever end.
TEST(CrackPaths, OrderDoesNotDependOnWhoTells)
{
  const Lattice lattice = square(60);
  const std::vector<CutBond> bonds = canonical(cut(lattice, 3, { { 5.2, 20.3 }, { 30, 33 }, { 55.4, 28.1 } }));
  std::vector<CutBond> other;
  for (const CutBond& b : bonds)
  {
    CutBond back = b;
    for (std::size_t a = 0; a < 2; ++a)
    {
      back.node[a] += b.step[a];
      back.step[a] = -b.step[a];
    }
    other.insert(other.end(), { back, b });
  }
  std::shuffle(other.begin(), other.end(), std::mt19937(1));
  other = canonical(other);
  ASSERT_EQ(other.size(), bonds.size());
  for (std::size_t i = 0; i < bonds.size(); ++i)
  {
    EXPECT_EQ(other[i].node, bonds[i].node);
    EXPECT_EQ(other[i].step, bonds[i].step);
    EXPECT_EQ(other[i].event, bonds[i].event);
  }
}

} // namespace
