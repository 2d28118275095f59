#include "ContourShapes.h"
#include "Support.h"
#include "outlines/MiddleLamella.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace lamella;
using namespace lamella::micrograph;
using lamella::testing::honeycomb;
using lamella::testing::quarterRing;
using lamella::testing::refusal;
using lamella::testing::regularPolygon;

namespace
{

constexpr double kDegrees = 180 / std::numbers::pi;

struct Sample
{
  ContourSet set;
  ContourLattice lattice;
  WallDirections directions;

  Sample(ContourSet contours, double spacing)
    : set(std::move(contours))
  {
    ContourLatticeOptions options;
    options.spacing = spacing;
    options.lines = 0;
    lattice = contourLattice(set, options);
    directions = wallDirections(set, lattice);
  }
  [[nodiscard]] Point at(std::size_t node) const
  {
    const Lattice& nodes = lattice.image.lattice;
    const auto nx = static_cast<std::size_t>(nodes.size[0]);
    return { (static_cast<double>(node % nx) + 0.5) * nodes.spacing,
      (static_cast<double>(node / nx) + 0.5) * nodes.spacing };
  }
  [[nodiscard]] MiddleLamella grow(double thickness, double radius, LamellaMethod method = LamellaMethod::Growth) const
  {
    LamellaOptions options;
    options.method = method;
    options.thickness = thickness;
    options.radius = radius;
    return middleLamella(lattice, directions, options);
  }
};

/// Angle between two directions without sign [degrees].
double between(const std::array<float, 2>& axis, const Point& truth)
{
  const double cosine = std::abs(static_cast<double>(axis[0]) * truth[0] + static_cast<double>(axis[1]) * truth[1]) /
    std::hypot(truth[0], truth[1]);
  return std::acos(std::min(1.0, cosine)) * kDegrees;
}

double distanceTo(const Contour& contour, const Point& p)
{
  double best = 1e300;
  const std::size_t n = contour.points.size();
  for (std::size_t i = 0; i + (contour.closed ? 0 : 1) < n; ++i)
  {
    const Point& a = contour.points[i];
    const Point& b = contour.points[(i + 1) % n];
    const Point way{ b[0] - a[0], b[1] - a[1] };
    const double t =
      std::clamp(((p[0] - a[0]) * way[0] + (p[1] - a[1]) * way[1]) / (way[0] * way[0] + way[1] * way[1]), 0.0, 1.0);
    best = std::min(best, std::hypot(p[0] - a[0] - t * way[0], p[1] - a[1] - t * way[1]));
  }
  return best;
}

} // namespace

TEST(WallDirections, DistancesAreThoseToEverySegment)
{
  const Sample sample(honeycomb(130, 100, 24, 5, 7), 0.9);
  std::size_t walls = 0;
  for (std::size_t node = 0; node < sample.lattice.image.phase.size(); ++node)
  {
    if (sample.lattice.image.phase[node] == 0)
      continue;
    ++walls;
    std::vector<std::pair<double, std::int32_t>> all;
    for (const Contour& contour : sample.set.contours)
      all.emplace_back(distanceTo(contour, sample.at(node)), contour.lumen);
    std::sort(all.begin(), all.end());
    // In 32 bits.
    ASSERT_NEAR(sample.directions.nearest[node], all[0].first, 1e-5);
    ASSERT_NEAR(sample.directions.second[node], all[1].first, 1e-5);
    if (all[1].first - all[0].first > 1e-9)
      ASSERT_EQ(sample.directions.grain[node], all[0].second);
    if (all[2].first - all[1].first > 1e-9 && all[1].first - all[0].first > 1e-9)
      ASSERT_EQ(sample.directions.neighbour[node], all[1].second);
  }
  EXPECT_GT(walls, 4000U);
}

TEST(WallDirections, FollowARing)
{
  // Both outlines are polygons of 48 pieces a quarter, 1.9° each, between two open chains. The tangents turn evenly
  // along them, which leaves an error of second order in the pieces; without it the mean error would be 0.47°.
  const Sample sample(quarterRing(100, 40, 70, 48), 0.5);
  double sum = 0;
  double most = 0;
  int count = 0;
  for (std::size_t node = 0; node < sample.lattice.image.phase.size(); ++node)
  {
    if (sample.lattice.image.phase[node] != 0)
    {
      const Point p = sample.at(node);
      const double error = between(sample.directions.axis[node], { -p[1], p[0] });
      sum += error;
      most = std::max(most, error);
      ++count;
      EXPECT_NEAR(sample.directions.nearest[node] + sample.directions.second[node], 30, 0.02);
    }
  }
  RecordProperty("mean_degrees", std::to_string(sum / count));
  EXPECT_LT(sum / count, 0.05) << "mean";
  EXPECT_LT(most, 1.0) << "at the border, where the outline's next piece is not known, half a piece's turn";
}

TEST(WallDirections, FollowAHoneycombAndTurnSmoothlyAtItsCorners)
{
  const double across = 30;
  const double wall = 5;
  for (const int pieces : { 1, 17 })
  {
    const Sample sample(honeycomb(180, 156, across, wall, pieces), 0.5);
    double sum = 0;
    double sumOutside = 0;
    int count = 0;
    int outside = 0;
    double jump = 0;
    const std::int64_t nx = sample.lattice.image.lattice.size[0];
    for (std::size_t node = 0; node < sample.lattice.image.phase.size(); ++node)
    {
      const std::int32_t first = sample.directions.grain[node];
      const std::int32_t second = sample.directions.neighbour[node];
      if (sample.lattice.image.phase[node] == 0)
        continue;
      // Between two cells the wall runs across the line between their centres.
      Point centre[2]{};
      for (const int i : { 0, 1 })
      {
        const Contour& c = sample.set.contours[static_cast<std::size_t>((i == 0 ? first : second) - 1)];
        for (const Point& p : c.points)
        {
          centre[i][0] += p[0] / static_cast<double>(c.points.size());
          centre[i][1] += p[1] / static_cast<double>(c.points.size());
        }
      }
      const Point truth{ centre[0][1] - centre[1][1], centre[1][0] - centre[0][0] };
      const Point p = sample.at(node);
      const double along = std::abs((p[0] - (centre[0][0] + centre[1][0]) / 2) * truth[0] +
                             (p[1] - (centre[0][1] + centre[1][1]) / 2) * truth[1]) /
        std::hypot(truth[0], truth[1]);
      const double error = between(sample.directions.axis[node], truth);
      sum += error;
      ++count;
      if (along < across / std::sqrt(3) / 2 - wall)
      {
        sumOutside += error;
        ++outside;
      }
      // Steps between neighbouring nodes. Where three walls meet there is one point without a direction, as in any
      // field that follows three walls; around it the steps are large.
      for (const std::size_t next : { node + 1, node + static_cast<std::size_t>(nx) })
      {
        if (next < sample.lattice.image.phase.size() && sample.lattice.image.phase[next] != 0 &&
          (next != node + 1 || next % static_cast<std::size_t>(nx) != 0) && sample.directions.nearest[node] > 1 &&
          std::hypot(
            along - across / std::sqrt(12), (sample.directions.second[node] - sample.directions.nearest[node]) / 2) > 2)
        {
          const std::array<float, 2>& other = sample.directions.axis[next];
          jump = std::max(jump, between(sample.directions.axis[node], { other[0], other[1] }));
        }
      }
    }
    RecordProperty("mean_degrees", std::to_string(sum / count));
    RecordProperty("outside_corners", std::to_string(sumOutside / outside));
    RecordProperty("largest_step", std::to_string(jump));
    EXPECT_LT(sum / count, 1.0);
    EXPECT_LT(jump, 20) << "half a unit's step";
    EXPECT_LT(sumOutside / outside, 0.02) << "straight walls";
  }
}

TEST(WallDirections, OneLumenGivesItsOwnTangent)
{
  const Sample sample({ { 10, 10 }, { regularPolygon({ 5, 5 }, 3, 200, 4) } }, 0.25);
  for (std::size_t node = 0; node < sample.lattice.image.phase.size(); ++node)
  {
    EXPECT_EQ(sample.directions.grain[node], 4);
    if (sample.lattice.image.phase[node] != 0)
    {
      const Point p = sample.at(node);
      ASSERT_LT(between(sample.directions.axis[node], { 5 - p[1], p[0] - 5 }), 0.5)
        << "less than a quarter of a piece's turn";
      ASSERT_EQ(sample.directions.neighbour[node], 0);
    }
  }
  EXPECT_NE(refusal<InputError>([&] { static_cast<void>(sample.grow(0.1, 0)); }).first.find("fewer than two"),
    std::string::npos);
}

TEST(MiddleLamella, HasItsThicknessAtAnySpacing)
{
  // Between flat lumens the gap is exact; the lamella of a ring is a ring about its middle, 55 ± 2.
  for (const double spacing : { 1.0, 0.5, 0.25 })
  {
    for (const LamellaMethod method : { LamellaMethod::Growth, LamellaMethod::Constant })
    {
      const Sample sample(quarterRing(100, 40, 70, 600), spacing);
      const MiddleLamella found = sample.grow(4, 2, method);
      const auto nodes = std::count(found.image.phase.begin(), found.image.phase.end(), 2);
      const double area = std::numbers::pi / 4 * (57.0 * 57 - 53 * 53);
      // Nodes in a strip whose sides cross the lattice at all angles: about the root of the nodes along the sides.
      EXPECT_NEAR(static_cast<double>(nodes) * spacing * spacing, area, 2 * spacing * std::sqrt(170 * spacing))
        << spacing;
      EXPECT_NEAR(found.across.mean * spacing, 4, 0.02 * 4 + 0.02 * spacing) << spacing;
      EXPECT_EQ(found.joined, 0);
      EXPECT_EQ(found.networks, 1);
      EXPECT_EQ(found.cellsTouched, 2);
    }
  }
}

TEST(MiddleLamella, CornersOfCellsAreCirclesOfTheLeastRadius)
{
  // A honeycomb: cells grown up to the gap g are hexagons with sides at 30/2 − g/2 of the centre. Rounded to r each of
  // their six corners of 120° loses r² (tan 30° − π/6) of area, exactly.
  const double across = 30;
  const double gap = 2;
  const double radius = 5;
  ContourSet set = honeycomb(240, 208, across, 14, 1);
  for (const double spacing : { 0.5, 0.25 })
  {
    const Sample sample(set, spacing);
    // Free growth, which is never undone, ends within the rounded corner: (15 − 7)/cos 30° + 6 < (14 − 5)/cos 30° + 5.
    const MiddleLamella sharp = sample.grow(gap, 0);
    const MiddleLamella round = sample.grow(gap, radius);
    // One cell in the middle of the box.
    const auto cell = std::min_element(set.contours.begin(), set.contours.end(),
      [](const Contour& a, const Contour& b)
      {
        const auto off = [](const Contour& c) {
          return std::hypot((c.points[0][0] + c.points[3][0]) / 2 - 120, (c.points[0][1] + c.points[3][1]) / 2 - 104);
        };
        return off(a) < off(b);
      });
    const Point centre{ (cell->points[0][0] + cell->points[3][0]) / 2, (cell->points[0][1] + cell->points[3][1]) / 2 };
    double grown = 0;
    double rounded = 0;
    double farSharp = 0;
    double farRound = 0;
    for (std::size_t node = 0; node < sharp.image.phase.size(); ++node)
    {
      const Point p = sample.at(node);
      const double r = std::hypot(p[0] - centre[0], p[1] - centre[1]);
      if (sample.directions.grain[node] != cell->lumen)
        continue;
      if (sharp.image.phase[node] != 2)
      {
        grown += spacing * spacing;
        farSharp = std::max(farSharp, r);
      }
      if (round.image.phase[node] != 2)
      {
        rounded += spacing * spacing;
        farRound = std::max(farRound, r);
      }
    }
    // The sides are not quite straight near the corners, and a node at a side counts or not: 4 % and half a unit of
    // area.
    EXPECT_NEAR(grown - rounded, 6 * radius * radius * (std::tan(std::numbers::pi / 6) - std::numbers::pi / 6), 0.8);
    EXPECT_NEAR(farRound, (across / 2 - gap / 2 - radius) / std::cos(std::numbers::pi / 6) + radius, spacing);
    EXPECT_GT(farSharp, farRound + 0.3);
  }
}

TEST(MiddleLamella, StaysInOnePieceWhenThinnerThanANode)
{
  // Walls of 6, so that none is lost on any of these lattices.
  for (const double spacing : { 2.9, 2.2, 1.3, 0.7 })
  {
    for (const LamellaMethod method : { LamellaMethod::Growth, LamellaMethod::Constant })
    {
      const MiddleLamella thin = Sample(honeycomb(240, 208, 30, 6, 5), spacing).grow(1e-3, 0, method);
      EXPECT_EQ(thin.networks, 1) << spacing;
      EXPECT_EQ(thin.cellsTouched, thin.cells) << spacing;
    }
  }
  const Sample sample(honeycomb(240, 208, 30, 6, 5), 1);
  const MiddleLamella found = sample.grow(0.05, 0);
  EXPECT_GT(found.joined, 0);
  EXPECT_EQ(found.networks, 1);
  EXPECT_EQ(found.cellsTouched, found.cells);
  EXPECT_GE(found.across.low, 0.5);
  ASSERT_FALSE(found.warnings.empty()) << "says that it is thin";
  EXPECT_NE(found.warnings[0].find("nodes thick"), std::string::npos);

  LamellaOptions options;
  options.thickness = 4;
  options.horizon = 4;
  EXPECT_NE(
    middleLamella(sample.lattice, sample.directions, options).warnings.at(0).find("horizon of 4"), std::string::npos);
}

TEST(MiddleLamella, GoesOnBeyondTheBorder)
{
  // A wall cuts off the lower left corner, another one the right edge: within the picture they never meet.
  ContourSet set = quarterRing(100, 20, 30, 60);
  set.contours[1] = { {}, false, 2 };
  Contour& middle = set.contours[1];
  for (int i = 60; i >= 0; --i)
  {
    const double angle = std::numbers::pi / 2 * i / 60;
    middle.points.push_back({ i == 60 ? 0 : 30 * std::cos(angle), i == 0 ? 0 : 30 * std::sin(angle) });
  }
  set.contours.push_back({ { { 70, 0 }, { 70, 100 } }, false, 2 });
  set.contours.push_back({ { { 80, 100 }, { 80, 0 } }, false, 3 });
  const MiddleLamella found = Sample(set, 1).grow(2, 0);
  EXPECT_EQ(found.networks, 2);
  EXPECT_EQ(found.cells, 3);
  EXPECT_EQ(found.cellsTouched, 3);
  EXPECT_EQ(found.cellsCutOff, 1) << "the corner's";
  EXPECT_TRUE(found.warnings.empty());
}

TEST(MiddleLamella, SaysHowManyCellsItDoesNotTouch)
{
  // Around cell 1 there is cell 2 alone, whose mouth on the right is too narrow for another one's wall: the lamella
  // between them is closed in itself, and so cell 1 is not on the network.
  ContourSet set{ { 140, 100 }, {} };
  set.contours.push_back(regularPolygon({ 80, 50 }, 14, 90, 1));
  Contour horseshoe{ {}, true, 2 };
  for (int i = 0; i <= 90; ++i)
  {
    const double angle = (5 + 350.0 * i / 90) / kDegrees;
    horseshoe.points.push_back({ 80 + 40 * std::cos(angle), 50 + 40 * std::sin(angle) });
  }
  for (int i = 90; i >= 0; --i)
  {
    const double angle = (10 + 340.0 * i / 90) / kDegrees;
    horseshoe.points.push_back({ 80 + 20 * std::cos(angle), 50 + 20 * std::sin(angle) });
  }
  set.contours.push_back(horseshoe);
  set.contours.push_back({ { { 25, 100 }, { 25, 0 } }, false, 3 });
  std::swap(set.contours[2].points[0], set.contours[2].points[1]);
  const MiddleLamella found = Sample(set, 0.5).grow(2, 0);
  EXPECT_EQ(found.networks, 2);
  EXPECT_EQ(found.cells, 3);
  EXPECT_EQ(found.cellsTouched, 2);
  EXPECT_EQ(found.cellsCutOff, 0);
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings.back().find("1 of 3 cells are not touched"), std::string::npos) << found.warnings.back();
}

TEST(MiddleLamella, ReadsPicturesOfThreeClasses)
{
  const Lattice lattice = makeLattice(3, 1, 1, 2, 1);
  const PhaseImage image = lamellaFromLabels(lattice, std::vector<std::uint16_t>{ 255, 0, 128 });
  EXPECT_EQ(image.phase, (std::vector<std::uint8_t>{ 1, 0, 2 }));
  EXPECT_EQ(
    lamellaFromLabels(lattice, std::vector<std::uint16_t>{ 0, 0, 255 }).phase, (std::vector<std::uint8_t>{ 0, 0, 1 }));
  EXPECT_FALSE(refusal<InputError>(
    [&] {
      static_cast<void>(lamellaFromLabels(lattice, std::vector<std::uint16_t>{ 255, 1, 128 }));
    }).first.empty());
  const std::vector<std::uint8_t> a{ 2, 2, 1, 0 };
  const std::vector<std::uint8_t> b{ 2, 1, 2, 2 };
  EXPECT_DOUBLE_EQ(overlap(a, b, 2), 2.0 / 5);
}

TEST(MiddleLamella, RefusesImpossibleOptions)
{
  const Sample sample(honeycomb(90, 78, 30, 6, 1), 1);
  for (const double thickness : { 0.0, -1.0, std::nan("") })
    EXPECT_FALSE(refusal<ParameterError>([&] { static_cast<void>(sample.grow(thickness, 0)); }).first.empty());
  EXPECT_FALSE(refusal<ParameterError>([&] { static_cast<void>(sample.grow(1, -1)); }).first.empty());
  for (const double horizon : { -1.0, std::nan(""), HUGE_VAL })
  {
    LamellaOptions options;
    options.horizon = horizon;
    EXPECT_NE(
      refusal<ParameterError>([&] { static_cast<void>(middleLamella(sample.lattice, sample.directions, options)); })
        .first.find("horizon"),
      std::string::npos);
  }
}
