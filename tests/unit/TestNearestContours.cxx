#include "ContourShapes.h"
#include "outlines/NearestContours.h"

#include <gtest/gtest.h>

#include <random>

using namespace lamella::micrograph;
using lamella::testing::honeycomb;

namespace
{

/// Twice as many pieces of one label as of the next, some without length, as lines between nodes can have.
std::vector<Segment> pieces(int labels)
{
  std::vector<Segment> segments = segmentsOf(honeycomb(60, 50, 12, 2, 3));
  for (std::size_t i = 0; i < segments.size(); ++i)
  {
    segments[i].label = 1 + segments[i].label % labels;
    segments[i].to = i % 11 == 0 ? segments[i].from : segments[i].to;
  }
  return segments;
}

void expectSame(const Nearest& found, const Nearest& alone, int labels, double within)
{
  for (std::size_t i = 0; i < static_cast<std::size_t>(labels); ++i)
  {
    // Farther away nothing is promised, and of the third nothing where it is far beyond the second.
    if (alone.squared[i] > within * within ||
      (i == 2 && alone.squared[2] > Nearest::kThird * Nearest::kThird * alone.squared[1]))
      break;
    ASSERT_EQ(found.squared[i], alone.squared[i]) << i;
    ASSERT_EQ(found.label[i], alone.label[i]) << i;
    ASSERT_EQ(found.segment[i], alone.segment[i]) << i;
  }
}

} // namespace

TEST(NearestContours, GroupsOfNodesFindWhatEachPointFindsAlone)
{
  for (const int labels : { 1, 2, 3 })
  {
    const NearestContours search(pieces(labels + 2), labels);
    std::mt19937 engine(1);
    // From nearly none to all of a group's nodes.
    for (const std::uint32_t each : { 60U, 3U, 1U })
    {
      std::vector<std::uint8_t> wanted(60 * 50);
      for (std::uint8_t& node : wanted)
        node = engine() % each == 0 ? 1 : 0;
      for (const double within : { 1.5, 1e3 })
      {
        std::int64_t seen = 0;
        search.atNodes(60, 50, 1, wanted, within,
          [&](std::int64_t node, const Point& point, const Nearest& nearest)
          {
            EXPECT_NE(wanted[static_cast<std::size_t>(node)], 0);
            ++seen;
            expectSame(nearest, search.at(point), labels, within);
          });
        EXPECT_EQ(seen, std::count(wanted.begin(), wanted.end(), 1));
      }
    }
  }
}

TEST(NearestContours, GroupsOfPointsFindWhatEachPointFindsAlone)
{
  const NearestContours search(pieces(4), 3);
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> step(-2, 2);
  std::vector<Point> points{ { 30, 25 } };
  while (points.size() < 2000)
    points.push_back({ points.back()[0] + step(engine), points.back()[1] + step(engine) });
  std::int64_t next = 0;
  search.atPoints(points, 6, 1e3,
    [&](std::int64_t index, const Point& point, const Nearest& nearest)
    {
      EXPECT_EQ(index, next++);
      EXPECT_EQ(point, points[static_cast<std::size_t>(index)]);
      expectSame(nearest, search.at(point), 3, 1e3);
    });
  EXPECT_EQ(next, 2000);
}
