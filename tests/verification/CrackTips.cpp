// Tips of ideal cracks: where they began, which end is farthest, how long the way is.
#include "CrackCuts.h"

#include "cracks/CrackTip.h"

#include <gtest/gtest.h>

namespace
{

using namespace lamella;
using namespace lamella::test;

// The line of a crack is known to half a spacing, and its ends to half a spacing along it.
constexpr double near = 0.71;

/// Bonds of several lines, each with an event of its own.
std::vector<CutBond> grown(const Lattice& lattice, double horizon, std::initializer_list<std::pair<Line, int>> lines)
{
  std::vector<CutBond> all;
  for (const auto& [line, event] : lines)
    for (CutBond bond : cut(lattice, horizon, line))
    {
      bond.event = event;
      all.push_back(bond);
    }
  return all;
}

double gap(const Place& a, const Place& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

CrackTip tipOf(const Lattice& lattice, double horizon, std::vector<CutBond> bonds)
{
  const CrackPaths found = pathsOf(lattice, horizon, std::move(bonds));
  return found.cracks.empty() ? CrackTip() : crackTip(found, 0, horizon);
}

// As one grows from a notch: whatever of it is there, the tip is the end that moves.
TEST(CrackTips, TheTipIsTheEndThatMoves)
{
  const Lattice lattice = square(100);
  const Line line{ { 20.3, 40.2 }, { 35, 42.1 }, { 50.2, 44.2 }, { 64.8, 46.1 }, { 80.1, 48.3 } };
  for (const double h : { 2.0, 3.0, 5.0 })
    for (std::size_t pieces = 2; pieces < line.size(); ++pieces) // of one alone nobody knows where it began
    {
      const Line part(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(pieces) + 1);
      const CrackTip tip = tipOf(lattice, h, cut(lattice, h, part)); // an event a piece
      ASSERT_TRUE(tip.found) << h;
      EXPECT_LT(gap(tip.start, line.front()), near) << h << ", " << pieces;
      EXPECT_LT(gap(tip.tip, part.back()), near) << h << ", " << pieces;
      EXPECT_EQ(tip.end, ChainEnd::Tip);
      EXPECT_NEAR(tip.extension, lengthOf(part), 1) << h << ", " << pieces; // half a spacing at either end
    }
}

// From the middle both ways: the farther end, and the way to it from where the first bonds broke. These tell a stretch
// of eight spacings.
TEST(CrackTips, FromTheMiddleTheFartherEnd)
{
  const Lattice lattice = square(100);
  constexpr double h = 3;
  const Place left{ 20.2, 50.3 };
  const Place right{ 90.4, 50.3 };
  const auto bonds = grown(lattice, h,
    { { { { 36, 50.3 }, { 44, 50.3 } }, 1 }, { { left, { 36, 50.3 } }, 2 }, { { { 44, 50.3 }, right }, 3 } });
  const CrackTip tip = tipOf(lattice, h, bonds);
  ASSERT_TRUE(tip.found);
  EXPECT_LT(gap(tip.tip, right), near);
  EXPECT_NEAR(tip.start[0], 36, 1 + h / 2); // bonds of the next stretch reach over by half their length
  EXPECT_NEAR(tip.extension, tip.tip[0] - tip.start[0], 1e-2);
}

// Along branches: arms of 35, 20 and 30 spacings, of which the last one broke first.
TEST(CrackTips, AlongBranches)
{
  const Lattice lattice = square(110);
  constexpr double h = 3;
  const Place joint{ 50.2, 49.7 };
  const auto end = [&](double degrees, double length) {
    return Place{ joint[0] + length * std::cos(degrees * pi / 180), joint[1] + length * std::sin(degrees * pi / 180) };
  };
  const Place start = end(180, 30);
  const auto bonds = grown(lattice, h,
    { { { joint, end(30, 35) }, 3 }, { { joint, end(-30, 20) }, 4 }, { { end(180, 15), joint }, 2 },
      { { start, end(180, 15) }, 1 } });
  const CrackTip tip = tipOf(lattice, h, bonds);
  ASSERT_TRUE(tip.found);
  EXPECT_LT(gap(tip.start, start), near);
  EXPECT_LT(gap(tip.tip, end(30, 35)), near);
  EXPECT_NEAR(tip.extension, 65, 1.5); // half a spacing at the ends, and where the arms meet
}

TEST(CrackTips, FromSideToSideTheSideAndOfALoopNone)
{
  const Lattice lattice = square(60);
  const Line across{ { -1, 20.3 }, { 30, 20.3 }, { 61, 20.3 } };
  const CrackTip tip = tipOf(lattice, 3, cut(lattice, 3, across));
  ASSERT_TRUE(tip.found);
  EXPECT_EQ(tip.end, ChainEnd::Border);
  EXPECT_NEAR(tip.start[0], -0.5, 1e-9);
  EXPECT_NEAR(tip.tip[0], 59.5, 1e-9);
  EXPECT_NEAR(tip.extension, 60, 0.01);
  EXPECT_FALSE(tipOf(lattice, 3, cut(lattice, 3, arc({ 30.2, 29.7 }, 12))).found);
}

} // namespace
