#include "core/Error.h"
#include "outlines/ContourBorder.h"
#include "outlines/ContourCheck.h"
#include "outlines/ContourEdit.h"
#include "outlines/ContourExtraction.h"
#include "outlines/ContourMeasures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

using namespace lamella;
using namespace lamella::micrograph;

namespace
{

/// Rows from the top, '.' lumen and '#' wall, nodes 1 m apart.
PhaseImage drawn(const std::vector<std::string>& rows)
{
  PhaseImage image;
  const auto ny = static_cast<std::int64_t>(rows.size());
  const auto nx = static_cast<std::int64_t>(rows.front().size());
  image.lattice = makeLattice(nx, ny, 1, 2, 1.0);
  image.phases = PhaseTable({ "lumen", "wall" });
  for (auto row = rows.rbegin(); row != rows.rend(); ++row)
    for (const char c : *row)
      image.phase.push_back(c == '.' ? 0 : 1);
  return image;
}

std::vector<Point> ngon(double x, double y, double r, int n)
{
  std::vector<Point> points;
  for (int k = 0; k < n; ++k)
  {
    const double a = 2 * std::numbers::pi * k / n;
    points.push_back({ x + r * std::cos(a), y + r * std::sin(a) });
  }
  return points;
}

ContourSet setOf(std::vector<Contour> contours, double w = 10, double h = 10)
{
  return { { w, h }, std::move(contours) };
}

bool has(const ContourSet& set, ContourFault fault)
{
  const auto found = validate(set);
  return std::any_of(found.begin(), found.end(), [&](const ContourFinding& f) { return f.fault == fault; });
}

} // namespace

TEST(Contours, APixelIsALumenOfItsArea)
{
  const Extraction e = extractContours(drawn({ "###", "#.#", "###" }), 0);
  ASSERT_EQ(e.contours.contours.size(), 1U);
  EXPECT_TRUE(e.contours.contours[0].closed);
  EXPECT_NEAR(polygonArea(e.contours.contours[0].points), 1.0, 1e-12); // counter-clockwise, too
  EXPECT_TRUE(validate(e.contours).empty());
}

TEST(Contours, LumensThatTouchAtACornerArePartedByWall)
{
  const Extraction e = extractContours(drawn({ "####", "#.##", "##.#", "####" }), 0);
  EXPECT_EQ(e.report.lumens, 2);
  const Extraction walls = extractContours(drawn({ "######", "#....#", "#.#..#", "#..#.#", "#....#", "######" }), 0);
  EXPECT_EQ(walls.report.islands, 1); // the diagonal wall hangs together through corners
}

TEST(Contours, ALumenCutByTheBorderIsOpenAndHasItsLumenOnTheLeft)
{
  const Extraction e = extractContours(drawn({ "####", "####", "#..#", "#..#" }), 0);
  ASSERT_EQ(e.contours.contours.size(), 1U);
  const Contour& c = e.contours.contours[0];
  EXPECT_FALSE(c.closed);
  EXPECT_EQ(c.points.front()[1], 0.0); // exactly on the border
  EXPECT_EQ(c.points.back()[1], 0.0);
  EXPECT_GT(c.points.front()[0], c.points.back()[0]); // up the right side, down the left one
  EXPECT_NEAR(wallFraction(e.contours), 0.75, 1e-12);
}

TEST(Contours, ChainsOfOneLumenShareItsNumber)
{
  const Extraction e = extractContours(drawn({ "###.#", ".....", ".....", "#####", "....." }), 0);
  // The upper lumen touches the border three times: three chains; the lower one has one.
  EXPECT_EQ(e.report.lumens, 2);
  EXPECT_EQ(e.report.openLumens, 2);
  ASSERT_EQ(e.contours.contours.size(), 4U);
  EXPECT_TRUE(validate(e.contours).empty());
  EXPECT_NEAR(wallFraction(e.contours), 9.0 / 25, 1e-12);
}

TEST(Contours, WallInsideLumensIsTakenOutWithWhatItHolds)
{
  const Extraction e = extractContours(drawn({
                                         "#########",
                                         "#.......#",
                                         "#.###...#",
                                         "#.#.#.#.#",
                                         "#.###...#",
                                         "#.......#",
                                         "#########",
                                       }),
    0);
  EXPECT_EQ(e.report.islands, 2);
  EXPECT_EQ(e.report.nestedLumens, 1);
  EXPECT_EQ(e.report.lumens, 1);
  EXPECT_NEAR(e.report.islandArea, 10.0, 1e-12);
  EXPECT_NEAR(wallFraction(e.contours), 1 - 35.0 / 63, 1e-12);
  EXPECT_EQ(e.warnings.size(), 1U); // a third of all wall went
}

TEST(Contours, NoisePicturesNeverCross)
{
  // Half of the nodes lumen at random: walls and lumens one pixel thin in every way there is.
  std::mt19937 random(7);
  for (int trial = 0; trial < 20; ++trial)
  {
    PhaseImage image;
    image.lattice = makeLattice(60, 50, 1, 2, 1e-6);
    image.phases = PhaseTable({ "lumen", "wall" });
    image.phase.resize(3000);
    std::generate(image.phase.begin(), image.phase.end(),
      [&] { return static_cast<std::uint8_t>(random() % 100U < 30U + 2U * static_cast<unsigned>(trial) ? 1 : 0); });
    ExtractOptions options;
    options.tolerance = 0.02 * trial; // up to coarse simplification
    const Extraction e = extractContours(image, 0, {}, options);
    const auto found = validate(e.contours);
    EXPECT_TRUE(found.empty()) << found.front().text();
    // Islands apart, the contours enclose exactly what the mask has.
    const double islands = e.report.islandArea / (60e-6 * 50e-6);
    EXPECT_LE(wallFraction(e.contours), image.fractions()[1] + 1e-9);
    EXPECT_GE(wallFraction(e.contours), image.fractions()[1] - islands - 1e-9);
  }
}

TEST(Contours, PicturesWithoutLumenOrWallAreRefused)
{
  EXPECT_THROW(static_cast<void>(extractContours(drawn({ "##", "##" }), 0)), InputError);
  EXPECT_THROW(static_cast<void>(extractContours(drawn({ "..", ".." }), 0)), InputError);
  EXPECT_THROW(static_cast<void>(extractContours(drawn({ "...", ".#.", "..." }), 0)), InputError); // one fills all
  EXPECT_THROW(static_cast<void>(extractContours(drawn({ "#.", "##" }), 2)), ParameterError);
  const PhaseImage image = drawn({ "###", "#.#", "###" });
  const std::vector<float> shortLevel(3);
  EXPECT_THROW(static_cast<void>(extractContours(image, 0, shortLevel)), ParameterError);
  std::vector<float> level(9, -1.0F);
  level[4] = std::nanf("");
  EXPECT_THROW(static_cast<void>(extractContours(image, 0, level)), ParameterError);
  ExtractOptions options;
  options.wavelength = 1;
  EXPECT_THROW(static_cast<void>(extractContours(image, 0, {}, options)), ParameterError);
  options = {};
  options.smallestArea = 2;
  EXPECT_THROW(static_cast<void>(extractContours(image, 0, {}, options)), InputError); // none is left
}

TEST(Contours, ALevelThatContradictsThePhasesYields)
{
  // The level puts everything into wall; the mask's node stays lumen, its crossings as near as they may come.
  const std::vector<float> level(9, -1.0F);
  const Extraction e = extractContours(drawn({ "###", "#.#", "###" }), 0, level);
  EXPECT_EQ(e.report.lumens, 1);
  EXPECT_TRUE(validate(e.contours).empty());
}

TEST(Contours, FiltersTellWhatTheyTook)
{
  ContourSet set = setOf({ { ngon(2, 2, 1.5, 40), true, 1 }, { ngon(8, 8, 0.3, 20), true, 2 },
    { { { 4, 4 }, { 8, 4 }, { 8, 4.5 }, { 4.5, 4.5 }, { 4.5, 7 }, { 4, 7 } }, true, 3 } });
  FilterReport report;
  const ContourSet left = filterLumens(set, { 1.0, 0.7 }, &report);
  EXPECT_EQ(report.small, 1);
  EXPECT_EQ(report.ragged, 1); // an L
  ASSERT_EQ(left.contours.size(), 1U);
  EXPECT_EQ(left.contours[0].lumen, 1);
  EXPECT_THROW(static_cast<void>(filterLumens(set, { -1.0, 0 })), ParameterError);
  EXPECT_THROW(static_cast<void>(filterLumens(set, { 0, 1.5 })), ParameterError);
}

TEST(Contours, SimplificationKeepsAreaAndEnds)
{
  std::vector<Point> open;
  for (int k = 0; k <= 200; ++k)
  {
    const double a = std::numbers::pi * k / 200;
    open.push_back({ 5 + 3 * std::cos(a), 3 * std::sin(a) });
  }
  open.front()[1] = open.back()[1] = 0;
  const ContourSet set = setOf({ { ngon(5, 7, 2, 500), true, 1 }, { open, false, 2 } });
  SimplifyReport report;
  const ContourSet simple = simplify(set, 0.01, &report);
  EXPECT_LT(report.after, report.before / 5);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(polygonArea(simple.contours[i].points), polygonArea(set.contours[i].points), 1e-12);
  EXPECT_EQ(simple.contours[1].points.front(), open.front());
  EXPECT_EQ(simple.contours[1].points.back(), open.back());
  // Two disks 0.02 apart: at a tolerance beyond that they would cross, and are left as they are.
  const ContourSet near = setOf({ { ngon(3, 5, 1.99, 300), true, 1 }, { ngon(7, 5, 1.99, 300), true, 2 } });
  const ContourSet coarse = simplify(near, 0.9, &report);
  EXPECT_TRUE(validate(coarse).empty());
}

TEST(Contours, MeasuresOfAnEllipse)
{
  std::vector<Point> points = ngon(0, 0, 1, 2000);
  const double turn = 0.5;
  for (Point& p : points)
  {
    const Point q{ 3 * p[0], 1.5 * p[1] };
    p = { 5 + std::cos(turn) * q[0] - std::sin(turn) * q[1], 5 + std::sin(turn) * q[0] + std::cos(turn) * q[1] };
  }
  const LumenMeasures m = measureLumens(setOf({ { points, true, 1 } })).at(0);
  const double pi = std::numbers::pi;
  // A polygon of n sides has (2π/n)²/6 less area than its curve: 1.6e-6 of it.
  EXPECT_NEAR(m.area, 4.5 * pi, 3e-5);
  EXPECT_NEAR(m.equivalentDiameter, 2 * std::sqrt(4.5), 1e-5);
  EXPECT_NEAR(m.centroid[0], 5, 1e-9);
  EXPECT_NEAR(m.major, 6, 2e-5);
  EXPECT_NEAR(m.minor, 3, 2e-5);
  EXPECT_NEAR(m.angle, turn, 1e-6);
  EXPECT_NEAR(m.solidity, 1, 1e-9);
  EXPECT_NEAR(m.perimeter, 14.5326628, 1e-4); // 4·3·E(e = √0.75)
}

TEST(Contours, MeasuresCloseOpenLumensAlongTheBorder)
{
  // The quarter of a square in the picture's upper right corner.
  const ContourSet set = setOf({ { { { 10, 6 }, { 6, 6 }, { 6, 10 } }, false, 1 } });
  EXPECT_TRUE(has(set, ContourFault::BorderOrder) || wallFraction(set) < 0.5); // this way round it is all the rest
  const ContourSet turned = setOf({ { { { 6, 10 }, { 6, 6 }, { 10, 6 } }, false, 1 } });
  const LumenMeasures m = measureLumens(turned).at(0);
  EXPECT_TRUE(m.open);
  EXPECT_NEAR(m.area, 16, 1e-12);
  EXPECT_NEAR(m.wallLength, 8, 1e-12);
  EXPECT_NEAR(m.perimeter, 16, 1e-12);
  EXPECT_NEAR(m.centroid[0], 8, 1e-12);
}

TEST(Contours, EachFaultIsFound)
{
  const std::vector<Point> good = ngon(5, 5, 2, 12);
  EXPECT_TRUE(validate(setOf({ { good, true, 1 } })).empty());
  std::vector<Point> p = good;
  std::reverse(p.begin(), p.end());
  EXPECT_TRUE(has(setOf({ { p, true, 1 } }), ContourFault::Clockwise));
  p = good;
  p[3][0] = std::nan("");
  EXPECT_TRUE(has(setOf({ { p, true, 1 } }), ContourFault::NotFinite));
  p = good;
  p[4] = p[3];
  EXPECT_TRUE(has(setOf({ { p, true, 1 } }), ContourFault::Repeated));
  EXPECT_TRUE(has(setOf({ { { good[0], good[1] }, true, 1 } }), ContourFault::FewPoints));
  EXPECT_TRUE(has(setOf({ { ngon(9, 5, 2, 12), true, 1 } }), ContourFault::Outside));
  EXPECT_TRUE(has(setOf({ { { { 0, 2 }, { 5, 5 } }, false, 1 } }), ContourFault::EndInside));
  p = good;
  std::swap(p[3], p[8]);
  EXPECT_TRUE(has(setOf({ { p, true, 1 } }), ContourFault::Crossing));
  EXPECT_TRUE(has(setOf({ { good, true, 1 }, { ngon(6, 6, 2, 12), true, 2 } }), ContourFault::Crossing));
  EXPECT_TRUE(
    has(setOf({ { ngon(3, 5, 1, 4), true, 1 }, { ngon(5, 5, 1, 4), true, 2 } }), ContourFault::Crossing)); // touch
  EXPECT_TRUE(has(setOf({ { good, true, 1 }, { ngon(5, 5, 1, 12), true, 2 } }), ContourFault::Nested));
  EXPECT_TRUE(has(setOf({ { good, true, 1 }, { ngon(1, 1, 0.5, 12), true, 1 } }), ContourFault::LumenNumber));
  EXPECT_TRUE(
    has(setOf({ { { { 6, 0 }, { 5, 3 }, { 2, 0 } }, false, 1 }, { { { 7, 0 }, { 8, 3 }, { 9, 0 } }, false, 2 } }),
      ContourFault::BorderOrder));
  EXPECT_THROW(requireValid(setOf({ { good, true, 1 }, { ngon(5, 5, 1, 12), true, 2 } }), "test"), InputError);
}

TEST(Contours, ClippingGivesOpenChainsOnTheBorder)
{
  // A disk over the middle of the left side, one inside, one outside, one over a corner.
  const ContourSet set = clipToWindow(
    { ngon(0, 5, 2, 400), ngon(5, 5, 1, 400), ngon(20, 5, 1, 40), ngon(10, 10, 3, 400) }, { 0, 0 }, { 10, 10 });
  ASSERT_EQ(set.contours.size(), 3U);
  EXPECT_TRUE(validate(set).empty());
  const auto m = measureLumens(set);
  const double pi = std::numbers::pi; // polygons of 400 sides: 4e-5 less
  EXPECT_NEAR(m[0].area, 2 * pi, 1e-3);
  EXPECT_NEAR(m[1].area, pi, 1e-3);
  EXPECT_NEAR(m[2].area, 9 * pi / 4, 1e-3);
  // The same from shifted polygons.
  const ContourSet moved = clipToWindow({ ngon(100, 205, 2, 400) }, { 100, 200 }, { 110, 210 });
  EXPECT_NEAR(measureLumens(moved).at(0).area, m[0].area, 1e-9);
  EXPECT_THROW(static_cast<void>(clipToWindow({ ngon(5, 5, 50, 40) }, { 0, 0 }, { 10, 10 })), InputError);
}
