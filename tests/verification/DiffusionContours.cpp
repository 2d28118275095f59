// Diffusion on lattices made from outlines, against values that nobody here computed (Perrins et al. 1979 and a
// multipole expansion for the square array of disks).
#include "DiskArray.h"
#include "lbm/ContourDiffusion.h"

#include "core/Communicator.h"
#include "core/Error.h"
#include "outlines/CoarserOutlines.h"
#include "outlines/ContourEdit.h"
#include "outlines/ContourMeasures.h"
#include "outlines/PolygonFile.h"

#include "../TemporaryFolder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::lbm;
using micrograph::Contour;
using micrograph::ContourSet;
using micrograph::Point;
using test::squareOfDisk;

constexpr double cell = 1e-4; // [m]

ContourAnswer solve(const ContourSet& contours, int nodes, double lumen, double wall, int axis = 0)
{
  ContourStudyOptions options;
  options.spacing = contours.size[0] / nodes;
  options.axes = { axis };
  options.conductivity = { lumen, wall };
  return studyContours(contours, options, MPI_COMM_WORLD)[0];
}

struct Entry
{
  double fraction;
  double contrast;
  double value;
};

// references.md of the project: area fraction, conductivity of the disks (1e9: infinite), effective conductivity.
const std::vector<Entry> table{ { 0.1, 0, 0.81818 }, { 0.1, 0.1, 0.84874 }, { 0.1, 10, 1.17822 }, { 0.1, 50, 1.21259 },
  { 0.1, 1e9, 1.22223 }, { 0.3, 0, 0.53758 }, { 0.3, 0.1, 0.60531 }, { 0.3, 10, 1.65204 }, { 0.3, 50, 1.81253 },
  { 0.3, 1e9, 1.86019 }, { 0.5, 0, 0.32465 }, { 0.5, 0.1, 0.41400 }, { 0.5, 10, 2.41547 }, { 0.5, 50, 2.91459 },
  { 0.5, 1e9, 3.08020 }, { 0.7, 0, 0.13454 }, { 0.7, 0.1, 0.24620 }, { 0.7, 10, 4.06171 }, { 0.7, 50, 6.33592 },
  { 0.7, 1e9, 7.43271 } };

} // namespace

// The series that benchmarks measure by, against the table: half a unit of its last digit; with 1e9 for infinity, which
// is further from it by 1e-8 only.
TEST(DiffusionContours, MultipolesAreTheTable)
{
  for (const Entry& e : table)
  {
    EXPECT_NEAR(test::squareArrayOfDisks(e.fraction, e.contrast), e.value, 0.51e-5) << e.fraction << " " << e.contrast;
    // Keller's theorem holds for every fraction, and so does the series in the number of terms
    EXPECT_NEAR(test::squareArrayOfDisks(e.fraction, 0.004) * test::squareArrayOfDisks(e.fraction, 250), 1, 1e-12);
    EXPECT_NEAR(test::squareArrayOfDisks(e.fraction, 250, 20), test::squareArrayOfDisks(e.fraction, 250), 1e-8);
  }
}

// The hexagonal array: Perrins et al. (1979) give its expansion to f^6 and f^12, exact to their order in the
// interactions; dilute disks; Keller's theorem; and no more terms are needed.
TEST(DiffusionContours, MultipolesOfTheHexagonalArray)
{
  for (const double f : { 0.05, 0.3, 0.6, 0.8 })
  {
    SCOPED_TRACE(f);
    for (const double s : { 0.0, 0.05, 10.0, 50.0 })
    {
      const double b = (s - 1) / (s + 1);
      const double f6 = std::pow(f, 6);
      // 1 + 2 f / (1/b − f − 0.075422 b f^6 / (1 − 1.060283 b² f^12) − 0.000076 b f^12)
      const double low =
        1 + 2 * f / (1 / b - f - 0.075422 * b * f6 / (1 - 1.060283 * b * b * f6 * f6) - 0.000076 * b * f6 * f6);
      // six digits of the constants, and at 0.8 what the expansion leaves out
      EXPECT_NEAR(test::hexagonalArrayOfDisks(f, s) / low, 1, f < 0.7 ? 1e-5 : 1e-3) << s;
    }
    EXPECT_NEAR(test::hexagonalArrayOfDisks(f, 0.004) * test::hexagonalArrayOfDisks(f, 250), 1, 1e-12);
    EXPECT_NEAR(test::hexagonalArrayOfDisks(f, 250, 25), test::hexagonalArrayOfDisks(f, 250, 50), 1e-8);
  }
  // Maxwell's formula is exact to f^7: 0.1^7 times 0.15
  EXPECT_NEAR(test::hexagonalArrayOfDisks(0.1, 0), (1 - 0.1) / (1 + 0.1), 1e-7);
}

// From 64 and 128 nodes a side with one extrapolation; the error bar is what users will rely on.
TEST(DiffusionContours, SquareArrayOfDisks)
{
  int held = 0;
  std::vector<double> ratio;
  for (const Entry& e : table)
  {
    SCOPED_TRACE(::testing::Message() << "area fraction " << e.fraction << ", contrast " << e.contrast);
    const ContourAnswer a = solve(squareOfDisk(e.fraction, cell), 128, e.contrast, 1);
    const double error = std::abs(a.value / e.value - 1);
    EXPECT_LT(error, e.fraction > 0.5 ? 5e-3 : 5e-4); // asked for
    // the table has five digits after the point: that much of an error may be its own
    const double digits = 0.5e-5 / e.value;
    held += error <= a.error + digits ? 1 : 0;
    ratio.push_back(a.error / std::max(error, digits));
  }
  std::sort(ratio.begin(), ratio.end());
  EXPECT_GE(held, 18);
  EXPECT_LE(ratio[ratio.size() / 2], 4);
}

// A box of 1 by √3, which no spacing fits: the whole of it is solved on, at odd and even sizes, along both axes, and
// the bar holds.
TEST(DiffusionContours, HexagonalArrayOfDisks)
{
  int held = 0;
  int cases = 0;
  std::vector<double> ratio;
  for (const double fraction : { 0.3, 0.6 })
    for (const double contrast : { 0.0, 0.05, 50.0 })
      for (const int nodes : { 42, 43, 64, 65, 128, 129 })
        for (const int axis : { 0, 1 })
        {
          SCOPED_TRACE(
            ::testing::Message() << fraction << ", " << contrast << ", " << nodes << " nodes, axis " << axis);
          const double exact = test::hexagonalArrayOfDisks(fraction, contrast);
          const ContourAnswer a = solve(test::hexagonsOfDisks(fraction, cell), nodes, contrast, 1, axis);
          EXPECT_NEAR(static_cast<double>(a.fine.nodes), nodes * nodes * std::sqrt(3.0), 8 * nodes);
          EXPECT_EQ(a.fine.nodes, 4 * a.coarse.nodes);
          EXPECT_EQ(a.pictureError, 0); // polygons are taken as they are
          EXPECT_EQ(a.error, a.latticeError);
          const double error = std::abs(a.value / exact - 1);
          EXPECT_LT(error, nodes > 100 ? 1e-3 : 5e-3); // three times the worst measured
          held += error <= a.error ? 1 : 0;
          ++cases;
          ratio.push_back(a.error / error);
        }
  std::sort(ratio.begin(), ratio.end());
  EXPECT_GE(held, 0.95 * cases);
  EXPECT_LE(ratio[ratio.size() / 2], 4);
}

namespace
{

/// Lumens as slots from the bottom to the top of the box: layers across x. Both chains of a slot are open.
ContourSet slots(double from, double to, int count)
{
  ContourSet set{ { cell, cell }, {} };
  for (int k = 0; k < count; ++k)
  {
    const double left = (k + from) * cell / count;
    const double right = (k + to) * cell / count;
    set.contours.push_back({ { Point{ left, cell }, Point{ left, 0 } }, false, k + 1 });
    set.contours.push_back({ { Point{ right, 0 }, Point{ right, cell } }, false, k + 1 });
  }
  return set;
}

ContourSet turned(ContourSet set)
{
  for (Contour& c : set.contours)
    for (Point& p : c.points)
      p = { set.size[1] - p[1], p[0] };
  std::swap(set.size[0], set.size[1]);
  return set;
}

/// Stretched along y.
ContourSet higher(ContourSet set, double stretch)
{
  set.size[1] *= stretch;
  for (Contour& c : set.contours)
    for (Point& p : c.points)
      p[1] *= stretch;
  return set;
}

} // namespace

// The spacing is halved until the bar is short enough: the bar halves with it, and holds the table's value.
TEST(DiffusionContours, ATargetIsReached)
{
  const Entry& e = table[5];
  ContourStudyOptions options;
  options.spacing = cell / 16;
  options.axes = { 1 };
  options.conductivity = { e.contrast, 1 };
  const ContourSet disk = squareOfDisk(e.fraction, cell);
  const ContourAnswer pair = studyContours(disk, options, MPI_COMM_WORLD)[0];
  ASSERT_EQ(pair.steps.size(), 2U);
  options.targetError = pair.error / 6;
  const ContourAnswer answer = studyContours(disk, options, MPI_COMM_WORLD)[0];
  EXPECT_LE(answer.error, options.targetError);
  EXPECT_GT(answer.error, options.targetError / 4); // and no further than that
  ASSERT_GE(answer.steps.size(), 4U);
  EXPECT_EQ(answer.steps[0].value, pair.coarse.value);
  EXPECT_EQ(answer.steps[1].value, pair.fine.value);
  EXPECT_EQ(answer.steps.back().value, answer.fine.value);
  for (std::size_t i = 1; i < answer.steps.size(); ++i)
    EXPECT_EQ(answer.steps[i].nodes, 4 * answer.steps[i - 1].nodes);
  EXPECT_NEAR(answer.value, e.value, answer.error * e.value + 0.5e-5);
  options.mostNodes = 5000; // 64² is the last that fits
  int told = 0;
  options.plan = [&](const ContourPlan& plan)
  {
    ++told;
    EXPECT_GT(plan.nodes, 4096);
    EXPECT_EQ(plan.pictureError, 0);
  };
  EXPECT_EQ(studyContours(disk, options, MPI_COMM_WORLD)[0].fine.nodes, 4096);
  EXPECT_EQ(told, 1);
  options.targetError = std::nan("");
  EXPECT_THROW((void)studyContours(disk, options, MPI_COMM_WORLD), ParameterError);
}

namespace
{

/// Square or hexagonal disks at some place in a box of 1 by 0.8, 2.7 of them across.
ContourSet plate(double fraction, bool hexagonal, double x0, double y0)
{
  const double distance = 1 / 2.7;
  const double row = distance * (hexagonal ? std::sqrt(3.0) / 2 : 1);
  const double radius = std::sqrt(fraction * distance * row / std::numbers::pi);
  ContourSet set{ { 1, 0.8 }, {} };
  for (int j = -1; j < 6; ++j)
    for (int i = -1; i < 6; ++i)
    {
      const Point centre{ (i + x0 + (hexagonal && j % 2 != 0 ? 0.5 : 0)) * distance, (j + y0) * row };
      Contour disk{ {}, true, static_cast<std::int32_t>(set.contours.size()) + 1 };
      for (int k = 0; k < 300; ++k)
        disk.points.push_back({ centre[0] + radius * std::cos(k * std::numbers::pi / 150),
          centre[1] + radius * std::sin(k * std::numbers::pi / 150) });
      if (std::abs(centre[0] - 0.5) < 0.5 + radius && std::abs(centre[1] - 0.4) < 0.4 + radius)
        set.contours.push_back(disk);
    }
  return set;
}

PhaseImage maskOf(const ContourSet& set, int pixels)
{
  micrograph::ContourLatticeOptions make;
  make.spacing = set.size[0] / pixels;
  make.lines = 0;
  make.grain = false;
  return micrograph::contourLattice(set, make).image;
}

} // namespace

// Pictures of lumens 14 to 60 pixels across: what their outlines conduct is off by up to per cents, which no lattice
// sees; the picture's error does. The truth is that of the disks.
TEST(DiffusionContours, BarsOfMasks)
{
  int held = 0;
  int ofLattices = 0;
  int cases = 0;
  std::vector<double> ratio;
  // Values of one plate are not independent: every size of pixels has its own.
  for (const bool hexagonal : { false, true })
    for (const double contrast : { 0.05, 10.0 })
      for (const int pixels : { 50, 80, 110 })
      {
        const ContourSet disks = plate(0.5, hexagonal, 0.123 + 0.01 * pixels, 0.777 + 0.017 * pixels);
        const PhaseImage mask = maskOf(disks, pixels);
        ContourStudyOptions options;
        options.conductivity = { contrast, 1 };
        options.spacing = 1.0 / 320;
        const auto truth = studyContours(disks, options, MPI_COMM_WORLD);
        options.spacing = 0.01;
        options.coarser = micrograph::coarserOutlines(mask, 0);
        options.pixel = mask.lattice.spacing;
        ASSERT_EQ(options.coarser.size(), 2U);
        const ContourSet outlines = micrograph::extractContours(mask, 0).contours;
        for (const ContourAnswer& a : studyContours(outlines, options, MPI_COMM_WORLD))
        {
          SCOPED_TRACE(::testing::Message() << hexagonal << ", " << contrast << ", axis " << a.axis << ", " << pixels);
          EXPECT_NEAR(a.error, std::hypot(a.latticeError, a.pictureError), 1e-12);
          EXPECT_GT(a.pictureError, 0);
          const double error = std::abs(a.value / truth[static_cast<std::size_t>(a.axis)].value - 1);
          held += error <= a.error ? 1 : 0;
          ofLattices += error <= a.latticeError ? 1 : 0;
          ++cases;
          ratio.push_back(a.error / error);
        }
      }
  std::sort(ratio.begin(), ratio.end());
  EXPECT_GE(held, 0.8 * cases);          // of 24, fewer than 20 hold by chance once in a hundred where 94 % do
  EXPECT_LT(ofLattices, 0.7 * cases);    // which is why there is the other
  EXPECT_LE(ratio[ratio.size() / 2], 8); // of 24; four in the benchmark's many
}

// Standard deviations of a value whose variance grows with the pixel's third power.
TEST(DiffusionContours, ErrorOfOutlines)
{
  EXPECT_NEAR(outlineError(2, std::vector<SubsampleValues>{ { 2, { 2.2, 1.8, 2.2, 1.8 } } }, 1.9),
    1.9 * 0.1 / std::sqrt(7), 1e-12);
  EXPECT_NEAR(outlineError(2, std::vector<SubsampleValues>{ { 2, { 2.2, 1.8 } }, { 3, { 2.0, 0.0 } } }, 1.5),
    1.5 * std::sqrt(0.75 * 0.01 / 7 + 0.25 * 0.5 / 26), 1e-12);
  EXPECT_EQ(outlineError(2, std::vector<SubsampleValues>{ { 2, { 2, 2 } }, { 3, {} } }, 1), 0);
  EXPECT_TRUE(std::isnan(outlineError(2, std::vector<SubsampleValues>{ { 2, { 2.1 } }, { 3, { 2, 3 } } }, 1)));
}

// More of them where lumens or walls are narrow. Twice the area of disks over the length of their outlines is their
// radius.
TEST(DiffusionContours, DeviationsOfOutlines)
{
  const ContourSet disk = test::squareOfDisk(0.3, 1);
  const double radius = std::sqrt(0.3 / std::numbers::pi);
  EXPECT_NEAR(micrograph::leastWidth(disk), radius, 1e-5); // a polygon of 2000 corners
  EXPECT_NEAR(outlineDeviations(disk, radius / 2, false), 1.4 + 6.0 / 4, 1e-4);
  EXPECT_NEAR(outlineDeviations(disk, radius / 20, false), 1.4 + 6.0 / 400, 1e-4);
  EXPECT_EQ(outlineDeviations(disk, 4 * radius, false), 7.4);
  EXPECT_EQ(outlineDeviations(disk, radius / 2, true), 1);
}

// A target below the picture's error: the lattice is refined until its part is half of the picture's, no further, and
// what it would take is told before.
TEST(DiffusionContours, ATargetBelowThePicture)
{
  const PhaseImage mask = maskOf(plate(0.5, true, 0.3, 0.1), 60);
  ContourStudyOptions options;
  options.spacing = 1.0 / 20;
  options.axes = { 0 };
  options.conductivity = { 0.05, 1 };
  options.coarser = micrograph::coarserOutlines(mask, 0);
  options.pixel = mask.lattice.spacing;
  const ContourSet outlines = micrograph::extractContours(mask, 0).contours;
  options.targetError = 1e-4;
  int told = 0;
  options.plan = [&](const ContourPlan& plan)
  {
    ++told;
    EXPECT_EQ(plan.target, 1e-4);
    EXPECT_GT(plan.pictureError, plan.target);
    EXPECT_GE(plan.nodes, 20 * 16);
  };
  const ContourAnswer a = studyContours(outlines, options, MPI_COMM_WORLD)[0];
  EXPECT_LE(told, 1);
  EXPECT_GT(a.error, options.targetError);
  EXPECT_LE(a.latticeError, 0.5 * a.pictureError);
}

// In series and in parallel, wherever they lie between the nodes and whichever conducts better: that lumens lead across
// is seen, where rules for tissue (walls hang together, lumens do not) would count rows of nodes and call that exact.
TEST(DiffusionContours, Layers)
{
  const ContourSet layers = slots(0.237, 0.651, 3);
  const double share = 0.651 - 0.237;
  for (const int nodes : { 16, 40 })
    for (const double lumen : { 250.0, 1 / 250.0, 1e6, 1e-6 })
    {
      SCOPED_TRACE(::testing::Message() << nodes << " nodes, " << lumen);
      const double series = 1 / (share / lumen + (1 - share));
      const double parallel = share * lumen + (1 - share);
      const ContourAnswer a = solve(layers, nodes, lumen, 1);
      EXPECT_NEAR(a.fine.value / series, 1, 1e-7); // ten times the solver's tolerance
      EXPECT_NEAR(solve(turned(layers), nodes, lumen, 1, 1).fine.value / a.fine.value, 1, 1e-7);
      EXPECT_NEAR(solve(layers, nodes, lumen, 1, 1).fine.value / parallel, 1, 1e-7);
    }
}

// In boxes that no spacing fits cells are not square, and layers are exact all the same: along x and y, across and
// along.
TEST(DiffusionContours, LayersInAnyBox)
{
  const double share = 0.651 - 0.237;
  for (const double height : { 0.613, 0.731, 1.2345 })
    for (const int nodes : { 16, 17, 43 })
    {
      SCOPED_TRACE(::testing::Message() << nodes << " nodes, height " << height);
      const double series = 1 / (share / 250 + (1 - share));
      const double parallel = share * 250 + (1 - share);
      const ContourSet layers = higher(slots(0.237, 0.651, 3), height);
      EXPECT_NEAR(solve(layers, nodes, 250, 1, 0).value / series, 1, 1e-7);
      EXPECT_NEAR(solve(layers, nodes, 250, 1, 1).value / parallel, 1, 1e-7);
      EXPECT_NEAR(solve(turned(layers), nodes, 250, 1, 1).value / series, 1, 1e-7);
      EXPECT_NEAR(solve(turned(layers), nodes, 250, 1, 0).value / parallel, 1, 1e-7);
    }
}

// A doubt about where walls begin: slots wider by it on both sides, ends still on the border; its effect is in the
// picture's error.
TEST(DiffusionContours, DoubtOfWalls)
{
  const ContourSet layers = slots(0.237, 0.651, 3);
  const double doubt = 0.01 * cell;
  const ContourSet wider = micrograph::movedOutlines(layers, doubt);
  const double share = 0.651 - 0.237;
  const double moved = share + 6 * 0.01;
  EXPECT_NEAR(solve(wider, 16, 5, 1, 1).value / (5 * moved + 1 - moved), 1, 1e-6); // shares are floats
  ContourStudyOptions options;
  options.spacing = cell / 16;
  options.axes = { 1 };
  options.conductivity = { 5, 1 };
  options.moved = wider;
  const ContourAnswer a = studyContours(layers, options, MPI_COMM_WORLD)[0];
  EXPECT_NEAR(a.moved, (5 * moved + 1 - moved) / (5 * share + 1 - share) - 1, 1e-6);
  EXPECT_NEAR(a.pictureError, a.moved, 1e-12);
  // a closed one: a square of 2 by 2 becomes one of 2 + 2 d / √2, as its corners move along the diagonals
  ContourSet square{ { 4, 4 }, { { { { 1, 1 }, { 3, 1 }, { 3, 3 }, { 1, 3 } }, true, 1 } } };
  for (const double d : { 0.1, -0.1 })
    EXPECT_NEAR(micrograph::movedOutlines(square, d).contours[0].points[2][0], 3 + d / std::sqrt(2), 1e-12);
}

// Rows of disks that end a quarter of a pixel before the lower border: the picture shows that the border cuts them, the
// strip of wall there leads from side to side. What it conducts is in the picture's error.
TEST(DiffusionContours, LumensThatEndAtTheBorder)
{
  const int pixels = 60;
  const double radius = 0.15;
  ContourSet disks{ { 1, 0.8 }, {} };
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i)
    {
      Contour disk{ {}, true, static_cast<std::int32_t>(disks.contours.size()) + 1 };
      for (int k = 0; k < 400; ++k)
        disk.points.push_back({ (i + 0.5) / 3 + radius * std::cos(k * std::numbers::pi / 200),
          radius + 0.25 / pixels + 0.33 * j + radius * std::sin(k * std::numbers::pi / 200) });
      disks.contours.push_back(disk);
    }
  const double truth = solve(disks, 480, 0.001, 1, 0).value;
  const PhaseImage mask = maskOf(disks, pixels);
  const ContourSet outlines = micrograph::extractContours(mask, 0).contours;
  const ContourSet sealed = micrograph::sealedOutlines(outlines, mask.lattice.spacing);
  EXPECT_EQ(std::count_if(
              outlines.contours.begin(), outlines.contours.end(), [](auto& c) { return !c.closed; }),
    3);
  EXPECT_EQ(std::count_if(sealed.contours.begin(), sealed.contours.end(), [](auto& c) { return !c.closed; }), 0);
  ContourStudyOptions options;
  options.spacing = 1.0 / pixels;
  options.axes = { 0 };
  options.conductivity = { 0.001, 1 };
  options.coarser = micrograph::coarserOutlines(mask, 0);
  options.pixel = mask.lattice.spacing;
  const ContourAnswer open = studyContours(outlines, options, MPI_COMM_WORLD)[0];
  options.sealed = sealed;
  const ContourAnswer a = studyContours(outlines, options, MPI_COMM_WORLD)[0];
  EXPECT_GT(a.sealed, 0); // a strip of wall more
  EXPECT_NEAR(a.pictureError, std::hypot(open.pictureError, a.sealed), 1e-12);
  EXPECT_EQ(a.value, open.value);
  EXPECT_LE(std::abs(a.value / truth - 1), a.error);
  EXPECT_GT(std::abs(a.value / truth - 1), open.error); // which is why there is the other
}

// Only lumens that may end there: half a disk goes on beyond the border, and one within has nothing to do with it. A
// segment that no more of a disk than a pixel's thickness lies beyond of, does.
TEST(DiffusionContours, WhichLumensMayEndAtTheBorder)
{
  const double pixel = 0.01;
  const auto disk = [](double y)
  {
    std::vector<Point> points;
    for (int k = 0; k < 400; ++k)
      points.push_back(
        { 0.5 + 0.2 * std::cos(k * std::numbers::pi / 200), y + 0.2 * std::sin(k * std::numbers::pi / 200) });
    return points;
  };
  const auto sealed = [&](double y) {
    return micrograph::sealedOutlines(micrograph::clipToWindow({ disk(y) }, { 0, 0 }, { 1, 1 }), pixel);
  };
  EXPECT_TRUE(sealed(0.0).contours.empty());
  EXPECT_TRUE(sealed(0.17).contours.empty()); // by three pixels
  EXPECT_TRUE(sealed(0.21).contours.empty()); // within
  for (const double y : { 0.195, 0.805 })
  {
    const ContourSet set = sealed(y);
    ASSERT_EQ(set.contours.size(), 1U);
    EXPECT_TRUE(set.contours[0].closed);
    double nearest = 1;
    for (const Point& p : set.contours[0].points)
      nearest = std::min({ nearest, p[1], 1 - p[1] });
    EXPECT_NEAR(nearest, pixel / 2, 1e-12);
  }
}

// Walls that no node lies in still part the lumens on both sides.
TEST(DiffusionContours, ThinSheets)
{
  const ContourSet sheets = slots(0.001, 0.999, 3);
  for (const double lumen : { 1e4, 1e-4 })
  {
    // shares are floats, and a sheet takes a hundredth of a link
    EXPECT_NEAR(solve(sheets, 16, lumen, 1).fine.value * (0.998 / lumen + 0.002), 1, 1e-5);
    EXPECT_NEAR(solve(sheets, 16, lumen, 1, 1).fine.value / (0.998 * lumen + 0.002), 1, 1e-5);
  }
}

// Walls of a hundredth of a node about lumens of three nodes: two lattices differ by less than both err, and the value
// lies above the parallel bound. 0.6353 is that of 500 nodes across (0.6353 of 200, 0.6351 of 100).
TEST(DiffusionContours, WhatLiesOutsideOfTheBoundsIsDoubted)
{
  const std::array<const char*, 5> columns{ "rrtr", "rtt ", "tttr", "rrtr", "trtr" }; // rectangles and triangles
  std::string rings;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 4; ++y)
    {
      const char kind = columns[static_cast<std::size_t>(x)][y];
      if (kind == ' ')
        continue;
      const double left = 10 * x + 0.0216884;
      const double low = 10 * y + 0.0216884;
      constexpr double side = 9.9566232;
      rings += fmt::format("{}[[{}, {}], [{}, {}], ", rings.empty() ? "" : ", ", left, low, left + side, low);
      if (kind == 'r')
        rings += fmt::format("[{}, {}], ", left + side, low + side);
      rings += fmt::format("[{}, {}]]", left, low + side);
    }
  const lamella::testing::TemporaryFolder folder;
  std::ofstream(folder / "cells.json") << R"({"units": "um", "lumens": [)" << rings << "]}";
  const ContourSet cells = micrograph::readPolygons(folder / "cells.json").lumens;
  const ContourAnswer a = solve(cells, 17, 0.542199, 0.950929, 1);
  EXPECT_GT(a.value, 0.66);
  EXPECT_LE(std::abs(a.value - 0.6353), a.error * a.value);
}

// The means of the phases, handed over link by link, are the phases' own lattice; a table is as good on any number of
// ranks, and with links that do not conduct.
TEST(DiffusionContours, TableOfPhases)
{
  for (const bool closed : { false, true })
  {
    SCOPED_TRACE(closed);
    const ContourSet disk = squareOfDisk(0.6, cell);
    micrograph::ContourLatticeOptions make;
    make.spacing = cell / 37;
    make.lines = 1;
    make.across = true;
    const micrograph::ContourLattice lattice = micrograph::contourLattice(disk, make);
    const std::vector<double> k{ closed ? 0 : 0.1, 1 };
    const std::int64_t nx = lattice.image.lattice.size[0];
    const auto at = [&](std::int64_t x, std::int64_t y)
    { return k[lattice.image.phase[static_cast<std::size_t>(x + nx * y)]]; };
    const auto mean = [](double a, double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; };
    auto table = std::make_shared<LinkTable>(nx, nx);
    for (std::int64_t j = 0; j < nx; ++j)
      for (std::int64_t i = 0; i <= nx; ++i)
      {
        const std::int64_t low = std::max<std::int64_t>(i - 1, 0);
        const std::int64_t high = std::min(i, nx - 1);
        table->x[static_cast<std::size_t>(i + (nx + 1) * j)] = mean(at(low, j), at(high, j));
        table->y[static_cast<std::size_t>(j + nx * i)] = mean(at(j, low), at(j, high));
      }
    const auto value = [&](std::shared_ptr<const LinkTable> links, MPI_Comm comm, int axis)
    {
      SteadyOptions options;
      options.links = std::move(links);
      options.tolerance = 1e-12;
      const Block block = decompose(lattice.image.lattice, comm);
      return SteadyDiffusion(lattice.image.lattice, block, blockOf(lattice.image, block), k, options, comm)
        .solve(axis)
        .effective[static_cast<std::size_t>(axis)];
    };
    for (const int axis : { 0, 1 })
    {
      const auto exact = std::make_shared<LinkTable>(linksOf(lattice, k, axis));
      EXPECT_NEAR(value(table, MPI_COMM_WORLD, axis), value(nullptr, MPI_COMM_SELF, axis), 1e-10);
      EXPECT_NEAR(value(exact, MPI_COMM_WORLD, axis), value(exact, MPI_COMM_SELF, axis), 1e-10);
    }
  }
}

TEST(DiffusionContours, WhatCannotBe)
{
  const ContourSet disk = squareOfDisk(0.3, cell);
  EXPECT_THROW(solve(disk, 64, -1, 1), ParameterError);
  EXPECT_THROW(solve(disk, 64, std::nan(""), 1), ParameterError);
  EXPECT_THROW(solve(disk, 64, 1, 0), NoPathError); // the disk does not reach the faces
  ContourStudyOptions options;
  options.spacing = cell / 16;
  options.conductivity = { 1 };
  EXPECT_THROW((void)studyContours(disk, options, MPI_COMM_WORLD), ParameterError);
  options.conductivity = { 0.1, 1 };
  options.spacing = 0;
  EXPECT_THROW((void)studyContours(disk, options, MPI_COMM_WORLD), ParameterError);
  // links of another lattice
  SteadyOptions steady;
  steady.links = std::make_shared<LinkTable>(4, 4);
  const Lattice five = makeLattice(5, 5, 1, 2, 1);
  const Block block = decompose(five, MPI_COMM_SELF);
  const std::vector<std::uint8_t> phase(25, 0);
  const std::vector<double> one{ 1.0 };
  EXPECT_THROW(SteadyDiffusion(five, block, phase, one, steady), ParameterError);
}

// Real spruce, the 400 x 400 pixels of 0.5 um that the project's numbers are of: the outlines' values agree with those
// at both spacings within the error bar, and with the pixels' extrapolated from once and twice the pixel.
TEST(DiffusionContours, RealSpruce)
{
  const char* folder = std::getenv("LAMELLA_REAL_DATA");
  if (folder == nullptr)
    GTEST_SKIP() << "LAMELLA_REAL_DATA does not name the folder of real pictures";
  struct
  {
    const char* tissue;
    std::array<double, 4> window; // [um]
    std::array<double, 2> once;   // finite volumes on the pixels, along x and y
    std::array<double, 2> twice;
  } const table[] = { { "EW", { 110, 200, 310, 400 }, { 0.15774, 0.15803 }, { 0.15841, 0.15893 } },
    { "LW", { 62, 35, 262, 235 }, { 0.48006, 0.44488 }, { 0.48172, 0.44713 } } };
  for (const auto& c : table)
  {
    micrograph::PolygonReadOptions read;
    read.window = c.window;
    const auto file = micrograph::readPolygons(
      std::filesystem::path(folder) / (std::string("spruce_") + c.tissue + "_polygons.json.gz"), read);
    std::array<std::vector<ContourAnswer>, 2> answers;
    for (const bool finer : { false, true })
    {
      ContourStudyOptions options;
      options.spacing = finer ? 0.25e-6 : 0.5e-6;
      options.conductivity = { 0.05, 1 };
      answers[finer ? 1 : 0] = studyContours(file.lumens, options, MPI_COMM_WORLD);
    }
    for (const std::size_t axis : { 0U, 1U })
    {
      const ContourAnswer& half = answers[0][axis];
      const ContourAnswer& quarter = answers[1][axis];
      SCOPED_TRACE(::testing::Message() << c.tissue << " axis " << axis << ": " << half.value << ", " << quarter.value);
      EXPECT_LT(half.error, 3e-3);
      EXPECT_LT(quarter.error, 1.2e-3);
      EXPECT_LT(std::abs(half.value - quarter.value), half.error * half.value);
      // the picture's lumens are larger than the polygons by 0.01 um all around: 0.5 % of the thin walls, more in them
      // that carry most; see Contours.SprucePolygonsInTheFrameOfTheirPictures
      EXPECT_NEAR(quarter.value / (2 * c.twice[axis] - c.once[axis]), 1, 0.02);
    }
  }
}
