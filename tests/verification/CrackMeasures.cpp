// What is told of cracks: phases along them, walls that they part, the way through, growth, openings.
#include "CrackCuts.h"

#include "cracks/ThroughPath.h"

#include <gtest/gtest.h>

namespace
{

using namespace lamella;
using namespace lamella::test;

// Strips of two phases, 20 nodes wide, cut at 30°: half of the length each. Along their border it is all between them.
TEST(CrackPaths, PhasesAlongACrack)
{
  const Lattice lattice = square(120);
  const auto strips = [](std::int64_t x, std::int64_t) { return 1 + static_cast<int>(x / 20 % 2); };
  const double t = 30 * pi / 180;
  const Line line{ { 19.5, 20.2 }, { 19.5 + 80, 20.2 + 80 * std::tan(t) } };
  const CrackPaths found = findCrackPaths(lattice, 3, canonical(cut(lattice, 3, line, strips)));
  ASSERT_EQ(found.paths.size(), 1U);
  std::array<double, 3> share{}; // 1, between, 2
  for (const PairShare& s : found.paths[0].pairs)
    share[static_cast<std::size_t>(s.phases[0] + s.phases[1] - 2)] += s.length / found.length;
  // three borders and the ends, each known to the one or two pairs that the line crosses there
  EXPECT_NEAR(share[0], 0.5, 0.03);
  EXPECT_NEAR(share[2], 0.5, 0.03);
  EXPECT_NEAR(share[0] + share[1] + share[2], 1, 1e-12);

  const Line border{ { 39.5, 10.2 }, { 39.5, 100.7 } };
  const CrackPaths along = findCrackPaths(lattice, 3, canonical(cut(lattice, 3, border, strips)));
  ASSERT_EQ(along.paths.size(), 1U);
  for (const PairShare& s : along.paths[0].pairs)
    EXPECT_TRUE(s.length == 0 || s.phases == (std::array<std::uint8_t, 2>{ 1, 2 }));

  // the same with the phases from an image, the bonds knowing none
  std::vector<std::uint8_t> phase;
  for (std::int64_t i = 0; i < lattice.count(); ++i)
    phase.push_back(static_cast<std::uint8_t>(strips(i % 120, i / 120)));
  const CrackPaths image = findCrackPaths(lattice, 3, canonical(cut(lattice, 3, line)), phase);
  ASSERT_EQ(image.paths.size(), 1U);
  for (const PairShare& s : found.paths[0].pairs)
    for (const PairShare& other : image.paths[0].pairs)
      EXPECT_TRUE(s.phases != other.phases || std::abs(s.length - other.length) < 1e-9);
}

// A wall between two voids, five nodes thick, parted: shorter than the minimum, and kept.
TEST(CrackPaths, ThinWallsThatArePartedCount)
{
  const Lattice lattice = square(60);
  std::vector<std::uint8_t> solid;
  for (std::int64_t i = 0; i < lattice.count(); ++i)
    solid.push_back(std::abs(static_cast<double>(i / 60) - 30) <= 2 ? 1 : 0);
  const auto isSolid = [&](std::int64_t x, std::int64_t y) { return solid[static_cast<std::size_t>(x + 60 * y)]; };
  const std::vector<CutBond> bonds = canonical(cut(lattice, 3, { { 30.3, 10 }, { 30.6, 50 } }, isSolid));
  const CrackPaths found = findCrackPaths(lattice, 3, bonds, {}, solid, { .minimumLength = 20 });
  ASSERT_EQ(found.paths.size(), 1U);
  EXPECT_NEAR(found.length, 5, 0.1);
  EXPECT_EQ(found.paths[0].ends[0], ChainEnd::Void);
  EXPECT_EQ(found.paths[0].ends[1], ChainEnd::Void);

  const CrackPaths half = findCrackPaths(lattice, 3,
    canonical(cut(lattice, 3, { { 30.3, 10 }, { 30.5, 30.1 } }, isSolid)), {}, solid, { .minimumLength = 20 });
  EXPECT_TRUE(half.paths.empty());
  EXPECT_EQ(half.leftOut.cracks, 1);
  EXPECT_NEAR(half.leftOut.length, 3, 1); // its tip
}

// Two walls with a void between them, each parted aslant: the way leads over both and straight across the void.
TEST(CrackPaths, TheWayThroughCrossesVoids)
{
  const Lattice lattice = square(60);
  const auto isSolid = [](std::int64_t x, std::int64_t) { return x < 20 || x >= 40 ? 1 : 0; };
  std::vector<std::uint8_t> solid;
  for (std::int64_t i = 0; i < lattice.count(); ++i)
    solid.push_back(static_cast<std::uint8_t>(isSolid(i % 60, 0)));
  const Line left{ { -1, 20.3 }, { 20.5, 20.3 + 21.5 * 0.3 } };
  const Line right{ { 38.5, 35.2 }, { 61, 35.2 - 22.5 * 0.2 } };
  const Line branch{ { 50, 32.9 }, { 52, 58.4 } }; // leads nowhere
  std::vector<CutBond> bonds = cut(lattice, 3, left, isSolid);
  for (const Line& more : { right, branch })
  {
    const auto b = cut(lattice, 3, more, isSolid);
    bonds.insert(bonds.end(), b.begin(), b.end());
  }
  const CrackPaths found = findCrackPaths(lattice, 3, canonical(bonds), {}, solid);
  const ThroughPath way = throughPath(found, lattice, solid, 0);
  ASSERT_TRUE(way.found);
  const Place from{ -0.5, 20.45 };
  const Place shore{ 19.5, 26.45 };
  const Place other{ 39.5, 35.0 };
  const Place to{ 59.5, 31.0 };
  const double across = lengthOf({ shore, other });
  EXPECT_NEAR(way.inVoids, across, 0.5); // ends are known to a quarter of a spacing
  EXPECT_NEAR(way.length, lengthOf({ from, shore, other, to }), 1);
  EXPECT_NEAR(way.chord, lengthOf({ from, to }), 0.5);
  EXPECT_EQ(way.paths.size(), 3U); // the right one in two, from the branch on
  EXPECT_FALSE(throughPath(found, lattice, solid, 1).found);
  EXPECT_FALSE(throughPath(found, lattice, {}, 0).found); // without voids there is none

  // a hinge of four spacings in a wall
  std::vector<CutBond> hinged = cut(lattice, 3, left, isSolid);
  std::erase_if(hinged,
    [](const CutBond& b)
    {
      const double x = static_cast<double>(b.node[0]) + 0.5 * b.step[0];
      return x > 8 && x < 12;
    });
  const auto rest = cut(lattice, 3, right, isSolid);
  hinged.insert(hinged.end(), rest.begin(), rest.end());
  const CrackPaths held = findCrackPaths(lattice, 3, canonical(hinged), {}, solid);
  EXPECT_FALSE(throughPath(held, lattice, solid, 0).found);
  const ThroughPath over = throughPath(held, lattice, solid, 0, 6);
  ASSERT_TRUE(over.found);
  EXPECT_NEAR(over.inSolid, 4, 1.5); // its two tips
  EXPECT_NEAR(over.length, way.length, 0.5);

  // a crack of its own: all of it
  const CrackPaths whole = pathsOf(lattice, 3, cut(lattice, 3, { { -1, 20.3 }, { 30, 40.1 }, { 61, 20.2 } }));
  const ThroughPath all = throughPath(whole, lattice, {}, 0);
  ASSERT_TRUE(all.found);
  EXPECT_NEAR(all.length, whole.length, 1e-9);
  EXPECT_EQ(all.inVoids, 0);
  EXPECT_NEAR(all.tortuosity(), whole.paths[0].tortuosity(), 1e-9);
}

// A crack that grows by a spacing an event: after each its length is known to a spacing, the rate is one in 0.1 s.
TEST(CrackPaths, GrowthFollowsTheEvents)
{
  const Lattice lattice = square(100);
  Line line;
  for (int i = 0; i <= 80; ++i)
    line.push_back({ 10.0 + i * std::cos(0.2), 30.0 + i * std::sin(0.2) });
  const CrackPaths found = pathsOf(lattice, 3, cut(lattice, 3, line));
  const std::vector<Growth> rows = growth(found);
  ASSERT_GT(rows.size(), 60U);
  EXPECT_NEAR(rows.back().length, found.length, 1e-9);
  for (const Growth& row : rows)
  {
    EXPECT_NEAR(row.length, static_cast<double>(row.event), 2.5) << row.event;
    if (row.length > 12 && row.length < 68)
      EXPECT_NEAR(row.rate, 10, 1.5) << row.event;
  }
  EXPECT_EQ(growth(found, 0).size(), rows.size());
  EXPECT_TRUE(growth(found, 1).empty());
}

// Two halves moved apart by 2 µm across the crack and 1 µm along it.
TEST(CrackPaths, OpeningsOfTwoHalves)
{
  const Lattice lattice = square(80);
  const double t = 0.3;
  const Line line{ { -1, 25.2 }, { 81, 25.2 + 82 * std::tan(t) } };
  CrackPaths found = pathsOf(lattice, 3, cut(lattice, 3, line));
  std::vector<double> u(static_cast<std::size_t>(3 * lattice.count()), 0);
  for (std::int64_t y = 0; y < 80; ++y)
    for (std::int64_t x = 0; x < 80; ++x)
      if (static_cast<double>(y) > 25.2 + static_cast<double>(x + 1) * std::tan(t))
      {
        const auto at = static_cast<std::size_t>(3 * lattice.index(x, y));
        u[at] = -2e-6 * std::sin(t) + 1e-6 * std::cos(t);
        u[at + 1] = 2e-6 * std::cos(t) + 1e-6 * std::sin(t);
      }
  openings(found, lattice, u);
  ASSERT_EQ(found.paths.size(), 1U);
  for (const CrackPoint& p : found.paths[0].points)
  {
    EXPECT_NEAR(p.opening, 2e-6, 0.02e-6); // the path's direction is known to half a degree
    EXPECT_NEAR(p.sliding, 1e-6, 0.04e-6);
  }
}

} // namespace
