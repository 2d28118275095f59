// Outlines of generated tissues against the same tissues on lattices.
#include "Support.h"

#include "generators/TissueTruth.h"
#include "outlines/ContourMeasures.h"
#include "outlines/LumenClasses.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

using namespace lamella;
using namespace lamella::generators;
using lamella::testing::refusal;
using micrograph::Contour;
using micrograph::ContourSet;
using micrograph::Point;

namespace
{

double cross(const Point& a, const Point& b)
{
  return (a[0] * b[1] - b[0] * a[1]) / 2;
}

/// Place along the border, counter-clockwise from the lower left corner.
double along(const ContourSet& set, const Point& p)
{
  const auto [w, h] = set.size;
  return p[1] == 0 ? p[0] : p[0] == w ? w + p[1] : p[1] == h ? w + h + (w - p[0]) : 2 * w + h + (h - p[1]);
}

/// Closes open chains along the border as Contour.h says: polygons whose insides are the lumens.
std::vector<std::vector<Point>> closed(const ContourSet& set)
{
  const auto [w, h] = set.size;
  const double round = 2 * (w + h);
  const std::array<Point, 4> corners{ Point{ w, 0 }, Point{ w, h }, Point{ 0, h }, Point{ 0, 0 } };
  const std::array<double, 4> cornerAt{ w, w + h, 2 * w + h, round };
  std::vector<std::vector<Point>> all;
  std::vector<bool> used(set.contours.size(), false);
  for (std::size_t i = 0; i < set.contours.size(); ++i)
  {
    if (set.contours[i].closed)
    {
      all.push_back(set.contours[i].points);
      continue;
    }
    std::vector<Point> polygon;
    for (std::size_t chain = i; !used[chain];)
    {
      used[chain] = true;
      const auto& points = set.contours[chain].points;
      polygon.insert(polygon.end(), points.begin(), points.end());
      // Counter-clockwise along the border to where the lumen's next chain begins.
      const double from = along(set, points.back());
      double best = 2 * round;
      for (std::size_t k = 0; k < set.contours.size(); ++k)
      {
        if (!set.contours[k].closed && set.contours[k].lumen == set.contours[i].lumen)
        {
          double to = along(set, set.contours[k].points.front());
          to += to < from ? round : 0;
          if (to < best)
          {
            best = to;
            chain = k;
          }
        }
      }
      for (int turn = 0; turn < 8; ++turn)
      {
        const double at = cornerAt[static_cast<std::size_t>(turn % 4)] + (turn / 4) * round;
        if (at > from && at < best)
          polygon.push_back(corners[static_cast<std::size_t>(turn % 4)]);
      }
    }
    if (!polygon.empty())
      all.push_back(polygon);
  }
  return all;
}

double areaOf(const std::vector<Point>& polygon)
{
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    area += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  return area;
}

/// 0 lumen, 1 wall, by scanning every row of nodes through the polygons.
std::vector<std::uint8_t> rasterised(const ContourSet& set, const Lattice& lattice)
{
  std::vector<std::uint8_t> phase(static_cast<std::size_t>(lattice.count()), 1);
  for (const auto& polygon : closed(set))
  {
    double low = 1;
    double high = 0;
    for (const Point& p : polygon)
    {
      low = std::min(low, p[1]);
      high = std::max(high, p[1]);
    }
    for (std::int64_t y = std::max<std::int64_t>(0, static_cast<std::int64_t>(low / lattice.spacing) - 1);
         y < std::min(lattice.size[1], static_cast<std::int64_t>(high / lattice.spacing) + 1); ++y)
    {
      const double at = (static_cast<double>(y) + 0.5) * lattice.spacing;
      std::vector<double> hits;
      for (std::size_t i = 0; i < polygon.size(); ++i)
      {
        const Point& a = polygon[i];
        const Point& b = polygon[(i + 1) % polygon.size()];
        if ((a[1] <= at) != (b[1] <= at))
          hits.push_back(a[0] + (b[0] - a[0]) * (at - a[1]) / (b[1] - a[1]));
      }
      std::sort(hits.begin(), hits.end());
      for (std::size_t k = 0; k + 1 < hits.size(); k += 2)
        for (std::int64_t x = std::llround(hits[k] / lattice.spacing);
             x < std::min<std::int64_t>(lattice.size[0], std::llround(hits[k + 1] / lattice.spacing)); ++x)
          phase[static_cast<std::size_t>(lattice.index(x, y))] = 0;
    }
  }
  return phase;
}

void expectSound(const ContourSet& set)
{
  for (const Contour& c : set.contours)
  {
    ASSERT_GE(c.points.size(), c.closed ? 3U : 2U);
    for (std::size_t i = 0; i < c.points.size(); ++i)
    {
      const Point& p = c.points[i];
      ASSERT_TRUE(p[0] >= 0 && p[1] >= 0 && p[0] <= set.size[0] && p[1] <= set.size[1]);
      const bool atBorder = p[0] == 0 || p[1] == 0 || p[0] == set.size[0] || p[1] == set.size[1];
      EXPECT_EQ(atBorder, !c.closed && (i == 0 || i + 1 == c.points.size())) << c.lumen << " " << i;
    }
    if (c.closed)
      EXPECT_GT(areaOf(c.points), 0);
  }
}

double lumenShare(const ContourSet& set)
{
  double area = 0;
  for (const auto& polygon : closed(set))
    area += areaOf(polygon);
  return area / (set.size[0] * set.size[1]);
}

/// Share of the nodes that are not what the outlines say.
double disagreement(const PhaseImage& image, const ContourSet& set)
{
  const auto phase = rasterised(set, image.lattice);
  double wrong = 0;
  for (std::size_t i = 0; i < phase.size(); ++i)
    wrong += phase[i] != image.phase[i];
  return wrong / static_cast<double>(phase.size());
}

} // namespace

TEST(TissueTruth, HardwoodOutlinesLeaveTheSolidFraction)
{
  for (const double fraction : { 0.25, 0.38, 0.6 })
  {
    HardwoodOptions options;
    options.solidFraction = fraction;
    const TissueTruth truth = hardwoodTruth(options);
    expectSound(truth.lumens);
    expectSound(truth.cells);
    EXPECT_NEAR(1 - lumenShare(truth.lumens), fraction, 1e-6); // the tolerance of the wall's search
    EXPECT_NEAR(lumenShare(truth.cells), 1, 2e-3);             // the cells tile but for slivers along bent rays
  }
}

TEST(TissueTruth, SoftwoodOutlinesLeaveTheSolidFraction)
{
  for (const double ring : { 0.0, 1.0 })
  {
    SoftwoodOptions options;
    options.size = { 300, 260, 1 };
    options.ringPosition0 = options.ringPosition1 = ring;
    options.solidFraction = ring > 0 ? 0.78 : 0.40;
    const TissueTruth truth = softwoodTruth(options);
    expectSound(truth.lumens);
    expectSound(truth.cells);
    EXPECT_NEAR(1 - lumenShare(truth.lumens), options.solidFraction, 1e-6);
    EXPECT_NEAR(lumenShare(truth.cells), 1, 5e-3);
    EXPECT_TRUE(std::count(truth.kinds.begin(), truth.kinds.end(), CellKind::Ray) > 0);
  }
}

TEST(TissueTruth, LatticesApproachTheOutlines)
{
  // The nodes of deepest key that are wall differ from the exact outline's by what the nodes along it happen to sum to:
  // some nodes in ten thousand at any spacing, where one in ten lies along an outline.
  for (const int finer : { 1, 2, 4 })
  {
    HardwoodOptions options;
    options.size = { 300 * finer, 300 * finer, 1 };
    options.spacing = 1e-6 / finer;
    const double wrong = disagreement(hardwood(options), hardwoodTruth(options).lumens);
    EXPECT_LT(wrong, 1e-3) << finer;
  }
  for (const int finer : { 1, 2, 4 })
  {
    SoftwoodOptions options;
    options.size = { 250 * finer, 250 * finer, 1 };
    options.spacing = 1e-6 / finer;
    const double wrong = disagreement(softwood(options), softwoodTruth(options).lumens);
    EXPECT_LT(wrong, 1e-3) << finer;
  }
}

// In these tissues a ray's middle lies within the lower border, or just beyond it; below it was wall.
TEST(TissueTruth, TissueGoesOnBelowTheFirstRay)
{
  for (const std::uint64_t seed : { 987042U, 323U, 1976U })
  {
    SoftwoodOptions options;
    options.size = { 320, 240, 1 };
    options.spacing = 0.5e-6;
    options.seed = seed;
    const TissueTruth truth = softwoodTruth(options);
    EXPECT_NEAR(lumenShare(truth.cells), 1, 5e-3) << seed;
    EXPECT_LT(disagreement(softwood(options), truth.lumens), 1e-3) << seed;
  }
  for (std::uint64_t seed = 1; seed <= 8; ++seed) // rays as near to each other as they can be
  {
    SoftwoodOptions options;
    options.size = { 200, 240, 1 };
    options.rayEvery = 60e-6;
    options.seed = seed;
    const TissueTruth truth = softwoodTruth(options);
    EXPECT_NEAR(lumenShare(truth.cells), 1, 1e-2) << seed;                  // bent rays leave slivers
    EXPECT_LT(disagreement(softwood(options), truth.lumens), 5e-3) << seed; // a strip of ray would be 3e-2
  }
}

TEST(TissueTruth, DoesNotDependOnTheSpacing)
{
  HardwoodOptions coarse;
  coarse.size = { 250, 250, 1 };
  HardwoodOptions fine = coarse;
  fine.size = { 800, 800, 1 };
  fine.spacing = 250e-6 / 800;
  const TissueTruth a = hardwoodTruth(coarse);
  const TissueTruth b = hardwoodTruth(fine);
  ASSERT_EQ(a.lumens.contours.size(), b.lumens.contours.size());
  EXPECT_NEAR(a.doubleWall, b.doubleWall, 1e-11);
  for (std::size_t i = 0; i < a.lumens.contours.size(); ++i)
  {
    ASSERT_NEAR(a.lumens.contours[i].points[0][0], b.lumens.contours[i].points[0][0], 1e-9);
    ASSERT_NEAR(a.lumens.contours[i].points[0][1], b.lumens.contours[i].points[0][1], 1e-9);
  }
}

TEST(TissueTruth, LumensLieInTheirCellsAndHaveTheirNumbers)
{
  const TissueTruth truth = hardwoodTruth({});
  std::map<std::int32_t, std::vector<Point>> cell;
  for (const Contour& c : truth.cells.contours)
  {
    if (c.closed)
      cell[c.lumen] = c.points;
    EXPECT_LE(static_cast<std::size_t>(c.lumen), truth.kinds.size());
  }
  int seen = 0;
  for (const Contour& c : truth.lumens.contours)
  {
    if (c.closed && cell.contains(c.lumen))
    {
      const auto& outer = cell[c.lumen];
      for (const Point& p : c.points)
      {
        for (std::size_t i = 0; i < outer.size(); ++i)
        {
          const Point& a = outer[i];
          const Point& b = outer[(i + 1) % outer.size()];
          const double off =
            ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])) / std::hypot(b[0] - a[0], b[1] - a[1]);
          ASSERT_GT(off, 0.1 * truth.doubleWall); // left of every side: the cells are convex, their walls never thin
        }
      }
      ++seen;
    }
  }
  EXPECT_GT(seen, 200);
}

TEST(TissueTruth, HoldsItsToleranceAndRefusesNonsense)
{
  // A coarse outline is inscribed in the fine one: area is lost, at most tolerance times length.
  HardwoodOptions options;
  options.size = { 150, 150, 1 };
  const auto area = [&](double tolerance)
  {
    const auto truth = hardwoodTruth(options, tolerance);
    return truth.doubleWall;
  };
  const double exact = area(1e-10);
  EXPECT_NEAR(area(2e-9), exact, 2e-9);
  EXPECT_NEAR(area(1e-7), exact, 1e-7);
  EXPECT_FALSE(refusal<ParameterError>([&] { (void)hardwoodTruth(options, 0); }).second.empty());
  EXPECT_FALSE(refusal<ParameterError>([&] { (void)hardwoodTruth(options, std::nan("")); }).second.empty());
  SoftwoodOptions solid;
  solid.dimension = 3;
  solid.size = { 60, 60, 20 };
  EXPECT_FALSE(refusal<ParameterError>([&] { (void)softwoodTruth(solid); }).second.empty());
}

// By the lengths of their lumens alone. A lumen that the border cuts may be short of what it would take. Eight vessels
// among 542 lumens are the fewest here.
TEST(TissueTruth, VesselsAreToldFromFibresAndRays)
{
  for (const std::uint64_t seed : { 1, 2, 3, 4, 5, 6 })
  {
    HardwoodOptions options;
    options.size = { 1000, 800, 1 };
    options.spacing = 0.5e-6;
    options.seed = seed;
    const TissueTruth truth = hardwoodTruth(options, 1e-7);
    std::vector<micrograph::LumenExtent> extents;
    std::vector<CellKind> kinds;
    for (const micrograph::LumenMeasures& m : micrograph::measureLumens(truth.lumens))
    {
      extents.push_back({ m.major, m.minor, !m.open });
      kinds.push_back(truth.kinds[static_cast<std::size_t>(m.lumen - 1)]);
    }
    const micrograph::LumenClasses classes = micrograph::tellVessels(extents);
    ASSERT_TRUE(classes.two) << seed;
    int vessels = 0;
    int missed = 0;
    int wrong = 0;
    int cut = 0; // by the border, and what is seen is as large as a vessel, in area
    for (std::size_t i = 0; i < kinds.size(); ++i)
    {
      const bool is = kinds[i] == CellKind::Vessel;
      vessels += is && extents[i].whole;
      missed += is && extents[i].whole && !classes.vessel[i];
      wrong += !is && classes.vessel[i];
      const double seen = extents[i].length * extents[i].width * std::numbers::pi / 4;
      cut += is && !extents[i].whole && seen > classes.threshold && !classes.vessel[i];
    }
    EXPECT_GE(vessels, 8) << seed;
    EXPECT_EQ(missed, 0) << seed;
    EXPECT_EQ(wrong, 0) << seed;
    EXPECT_EQ(cut, 0) << seed;
  }
}

// Most of latewood is slender; the few broad lumens and the tips of tracheids between them are no two kinds of cell.
TEST(TissueTruth, SoftwoodHasNoVessels)
{
  for (const std::uint64_t seed : { 1, 3 })
  {
    for (const auto& [start, end, solid] : { std::array{ 0.0, 0.0, 0.4 }, { 1.0, 1.0, 0.78 }, { 0.0, 1.0, 0.5 } })
    {
      SoftwoodOptions options;
      options.size = { 600, 500, 1 };
      options.spacing = 0.5e-6;
      options.seed = seed;
      options.ringPosition0 = start;
      options.ringPosition1 = end;
      options.solidFraction = solid;
      std::vector<micrograph::LumenExtent> extents;
      for (const micrograph::LumenMeasures& m : micrograph::measureLumens(softwoodTruth(options, 1e-7).lumens))
        extents.push_back({ m.major, m.minor, !m.open });
      EXPECT_FALSE(micrograph::tellVessels(extents).two) << seed << ' ' << solid;
    }
  }
}
