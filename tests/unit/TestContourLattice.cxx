#include "ContourShapes.h"
#include "Support.h"
#include "outlines/ContourLattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

using namespace lamella;
using namespace lamella::micrograph;
using lamella::testing::areaOf;
using lamella::testing::honeycomb;
using lamella::testing::quarterRing;
using lamella::testing::refusal;
using lamella::testing::regularPolygon;

namespace
{

ContourLattice onLattice(const ContourSet& set, double spacing, int lines = 4, bool across = true)
{
  ContourLatticeOptions options;
  options.spacing = spacing;
  options.lines = lines;
  options.across = across;
  return contourLattice(set, options);
}

/// Stars with ragged outlines that stay apart, in a box of 10 by 8; one of them reaches over a corner of the box.
ContourSet stars()
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.45, 1);
  ContourSet set{ { 10, 8 }, {} };
  std::int32_t lumen = 0;
  for (const Point& centre :
    { Point{ 2.1, 2.2 }, Point{ 6.3, 2.4 }, Point{ 3.9, 5.9 }, Point{ 8.1, 6.3 }, Point{ 0, 8 } })
  {
    ++lumen;
    Contour star = regularPolygon(centre, 1.55, 23, lumen, 0.1 * lumen);
    for (Point& point : star.points)
    {
      const double r = share(random);
      point = { centre[0] + r * (point[0] - centre[0]), centre[1] + r * (point[1] - centre[1]) };
    }
    set.contours.push_back(star);
  }
  return set;
}

/// The lumen that a point lies in, by the even-odd rule over every edge; 0: none.
std::int32_t lumenAt(const ContourSet& set, const Point& p)
{
  for (const Contour& contour : set.contours)
  {
    bool inside = false;
    for (std::size_t i = 0; i < contour.points.size(); ++i)
    {
      const Point& a = contour.points[i];
      const Point& b = contour.points[(i + 1) % contour.points.size()];
      if ((a[1] <= p[1]) != (b[1] <= p[1]) && a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) < p[0])
        inside = !inside;
    }
    if (inside)
      return contour.lumen;
  }
  return 0;
}

/// Lumen's share of a straight line, from its crossings with every edge.
double shareOf(const ContourSet& set, const Point& from, const Point& to)
{
  std::vector<double> cuts{ 0, 1 };
  const Point way{ to[0] - from[0], to[1] - from[1] };
  for (const Contour& contour : set.contours)
  {
    for (std::size_t i = 0; i < contour.points.size(); ++i)
    {
      const Point& a = contour.points[i];
      const Point& b = contour.points[(i + 1) % contour.points.size()];
      const Point edge{ b[0] - a[0], b[1] - a[1] };
      const double determinant = way[0] * edge[1] - way[1] * edge[0];
      const double t = ((a[0] - from[0]) * edge[1] - (a[1] - from[1]) * edge[0]) / determinant;
      const double u = ((a[0] - from[0]) * way[1] - (a[1] - from[1]) * way[0]) / determinant;
      if (t > 0 && t < 1 && u >= 0 && u < 1)
        cuts.push_back(t);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  double share = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
  {
    const double t = (cuts[i] + cuts[i + 1]) / 2;
    share += lumenAt(set, { from[0] + t * way[0], from[1] + t * way[1] }) > 0 ? cuts[i + 1] - cuts[i] : 0;
  }
  return share;
}

/// Ends of the cell of link i of row (column) j along one axis: [axis][low, high].
std::array<std::array<double, 2>, 2> linkCell(const Lattice& lattice, int axis, std::int64_t link)
{
  const std::int64_t columns = lattice.size[0] + (axis == 0 ? 1 : 0);
  const std::array<std::int64_t, 2> at{ link % columns, link / columns };
  std::array<std::array<double, 2>, 2> cell{};
  for (const int a : { 0, 1 })
  {
    const auto i = static_cast<double>(at[a]);
    cell[a] = a == axis
      ? std::array<double, 2>{ std::max(0.0, i - 0.5), std::min(static_cast<double>(lattice.size[a]), i + 0.5) }
      : std::array<double, 2>{ i, i + 1 };
    cell[a] = { cell[a][0] * lattice.spacing, cell[a][1] * lattice.spacing };
  }
  return cell;
}

} // namespace

TEST(ContourLattice, PixelsHaveTheArea)
{
  // Disks inside the box: the pixels' shares add up to the outlines' area, to round-off in sums of double precision and
  // to that of 32 bits a pixel in the array (6e-8 each, of either sign).
  ContourSet set{ { 3, 2 },
    { regularPolygon({ 0.7, 0.8 }, 0.5, 200, 1), regularPolygon({ 2.1, 1.1 }, 0.6, 31, 2, 0.3) } };
  const double area = areaOf(set.contours[0]) + areaOf(set.contours[1]);
  for (const double spacing : { 0.9, 0.1, 3.0 / 97, 0.00731 })
  {
    const ContourLattice lattice = onLattice(set, spacing, 0);
    // What is cropped at the top is wall; a spacing as large as a lumen is no obstacle.
    const double box = lattice.image.lattice.length(0) * lattice.image.lattice.length(1);
    if (lattice.cropped < 0.3)
      EXPECT_NEAR(lattice.lumenFraction * box, area, 1e-12) << spacing;
    const double sum = std::accumulate(lattice.lumenShare.begin(), lattice.lumenShare.end(), 0.0);
    EXPECT_NEAR(sum / static_cast<double>(lattice.image.lattice.count()), lattice.lumenFraction, 1e-7);
  }
}

TEST(ContourLattice, OutlinesAreClippedByTheBox)
{
  // A square about each corner and side of the box, and one about all of it but a rim.
  ContourSet set{ { 1, 1 }, {} };
  std::int32_t lumen = 0;
  for (const Point& c : { Point{ 0, 0 }, Point{ 1, 0 }, Point{ 1, 1 }, Point{ 0, 1 }, Point{ 0.5, 0 }, Point{ 1, 0.5 },
         Point{ 0.5, 1 }, Point{ 0, 0.5 } })
  {
    set.contours.push_back({ { { c[0] - 0.1, c[1] - 0.1 }, { c[0] + 0.1, c[1] - 0.1 }, { c[0] + 0.1, c[1] + 0.1 },
                               { c[0] - 0.1, c[1] + 0.1 } },
      true, ++lumen });
  }
  const ContourLattice lattice = onLattice(set, 1.0 / 17);
  EXPECT_NEAR(lattice.lumenFraction, 4 * 0.01 + 4 * 0.02, 1e-14);
  // Symmetric under a quarter turn, to the bit of each float's rounding.
  for (std::int64_t y = 0; y < 17; ++y)
  {
    for (std::int64_t x = 0; x < 17; ++x)
    {
      EXPECT_NEAR(lattice.lumenShare[static_cast<std::size_t>(x + 17 * y)],
        lattice.lumenShare[static_cast<std::size_t>(16 - y + 17 * x)], 1e-6);
    }
  }
}

TEST(ContourLattice, OpenChainsAreClosedAlongTheBorder)
{
  const ContourSet ring = quarterRing(1, 0.4, 0.7, 300);
  const ContourLattice open = onLattice(ring, 0.01);
  // The inner lumen as a closed chain about the corner, which the box clips.
  const ContourSet disk{ { 1, 1 }, { regularPolygon({ 0, 0 }, 0.4, 1200, 1) } };
  const ContourLattice closed = onLattice(disk, 0.01);
  const double segment = 0.25 * std::numbers::pi * 0.7 * 0.7;
  EXPECT_NEAR(open.lumenFraction, closed.lumenFraction + 1 - segment, 1e-5); // 300 pieces: π²/(6 · 600²) of the area
  for (std::int64_t y = 0; y < 100; ++y)
  {
    for (std::int64_t x = 0; x < 100; ++x)
    {
      const auto node = static_cast<std::size_t>(open.image.lattice.index(x, y));
      const double r = std::hypot((static_cast<double>(x) + 0.5) * 0.01, (static_cast<double>(y) + 0.5) * 0.01);
      if (std::abs(r - 0.4) > 1e-5 && std::abs(r - 0.7) > 1e-5)
      {
        EXPECT_EQ(open.grain[node], r < 0.4 ? 1 : r > 0.7 ? 2 : 0);
        EXPECT_EQ(open.image.phase[node], r < 0.4 || r > 0.7 ? 0 : 1);
      }
    }
  }
}

TEST(ContourLattice, NodesAndLinksAreWhatEveryEdgeSays)
{
  const ContourSet set = stars();
  for (const double spacing : { 0.5, 0.2, 0.11 })
  {
    const ContourLattice lattice = onLattice(set, spacing, 3);
    const Lattice& nodes = lattice.image.lattice;
    for (std::int64_t i = 0; i < nodes.count(); ++i)
    {
      const Point p{ (static_cast<double>(i % nodes.size[0]) + 0.5) * nodes.spacing,
        (static_cast<double>(i / nodes.size[0]) + 0.5) * nodes.spacing };
      ASSERT_EQ(lattice.grain[static_cast<std::size_t>(i)], lumenAt(set, p));
    }
    for (const int axis : { 0, 1 })
    {
      const LinkCuts& cuts = lattice.links[static_cast<std::size_t>(axis)];
      ASSERT_TRUE(std::is_sorted(cuts.link.begin(), cuts.link.end()));
      std::size_t cut = 0;
      const std::int64_t links = (nodes.size[0] + (axis == 0)) * (nodes.size[1] + (axis == 1));
      double area = 0;
      for (std::int64_t link = 0; link < links; ++link)
      {
        const auto cell = linkCell(nodes, axis, link);
        const double size = (cell[0][1] - cell[0][0]) * (cell[1][1] - cell[1][0]);
        const bool listed = cut < cuts.link.size() && cuts.link[cut] == link;
        if (!listed)
        {
          // Nothing passes: all of the cell is as its middle.
          const double share =
            lumenAt(set, { (cell[0][0] + cell[0][1]) / 2, (cell[1][0] + cell[1][1]) / 2 }) > 0 ? 1 : 0;
          area += share * size;
          ASSERT_EQ(shareOf(set, { cell[0][0], cell[1][0] }, { cell[0][1], cell[1][1] }), share);
          continue;
        }
        area += static_cast<double>(cuts.area[cut]) * size;
        for (std::size_t k = 0; k < 3; ++k)
        {
          for (const bool across : { false, true })
          {
            const int along = across ? 1 - axis : axis;
            Point from{ cell[0][0], cell[1][0] };
            Point to{ cell[0][1], cell[1][1] };
            const double place = cell[1 - along][0] + cuts.place[k] * (cell[1 - along][1] - cell[1 - along][0]);
            from[1 - along] = to[1 - along] = place;
            // 32 bits, and a few of them added.
            ASSERT_NEAR((across ? cuts.across : cuts.share)[3 * cut + k], shareOf(set, from, to), 5e-7);
          }
        }
        ++cut;
      }
      EXPECT_EQ(cut, cuts.link.size());
      const double box = nodes.length(0) * nodes.length(1);
      EXPECT_NEAR(area / box, lattice.lumenFraction, 1e-7) << "link cells fill the box";
    }
  }
}

TEST(ContourLattice, AStraightInterfaceIsInSeriesOrInParallel)
{
  // Lumen left of x = 3.2 and right of 7.9 in a box of 8: one link in the middle is cut, and one half link at the side.
  ContourSet set{ { 8, 4 }, { { { { 3.2, 0 }, { 3.2, 4 } }, false, 1 }, { { { 7.9, 4 }, { 7.9, 0 } }, false, 2 } } };
  const ContourLattice lattice = onLattice(set, 1);
  const LinkCuts& x = lattice.links[0];
  ASSERT_EQ(x.link.size(), 8U);
  for (std::size_t row = 0; row < 4; ++row)
  {
    EXPECT_EQ(x.link[2 * row], static_cast<std::int64_t>(3 + 9 * row));
    EXPECT_NEAR(x.area[2 * row], 0.7, 1e-7);
    EXPECT_NEAR(x.harmonicAlong(2 * row, 10, 1), 1 / (0.7 / 10 + 0.3), 1e-6);
    EXPECT_EQ(x.normal[2 * row], (std::array<float, 2>{ 1, 0 }));
    EXPECT_EQ(x.link[2 * row + 1], static_cast<std::int64_t>(8 + 9 * row));
    EXPECT_NEAR(x.area[2 * row + 1], 0.2, 1e-6);
    EXPECT_NEAR(x.harmonicAlong(2 * row + 1, 10, 1), 1 / (0.2 / 10 + 0.8), 1e-6);
    EXPECT_EQ(x.normal[2 * row + 1], (std::array<float, 2>{ -1, 0 }));
  }
  const LinkCuts& y = lattice.links[1];
  ASSERT_EQ(y.link.size(), 10U);
  for (std::size_t cut = 0; cut < 10; cut += 2)
  {
    EXPECT_NEAR(y.area[cut], 0.2, 1e-6);
    EXPECT_NEAR(y.harmonicAcross(cut, 10, 1), 0.2 * 10 + 0.8, 1e-5);
  }
}

TEST(ContourLattice, GaussRulesAreExactForPolynomials)
{
  for (int count = 1; count <= 16; ++count)
  {
    const LineRule rule = gaussRule(count);
    for (int degree = 0; degree < 2 * count; ++degree)
    {
      double sum = 0;
      for (std::size_t k = 0; k < rule.place.size(); ++k)
        sum += rule.weight[k] * std::pow(rule.place[k], degree);
      EXPECT_NEAR(sum, 1.0 / (degree + 1), 1e-14);
    }
  }
}

TEST(ContourLattice, TheSpacingFitsTheWidth)
{
  const Lattice exact = latticeOf({ 200e-6, 100e-6 }, 0.5e-6);
  EXPECT_EQ(exact.size[0], 400);
  EXPECT_EQ(exact.size[1], 200);
  const Lattice fine = latticeOf({ 200e-6, 101e-6 }, 0.3e-6);
  EXPECT_EQ(fine.size[0], 667); // 666.7
  EXPECT_EQ(fine.size[1], 336); // 336.8 fit
  EXPECT_LT(fine.length(1), 101e-6);
}

// Whatever the size, in multiples: nothing is cropped, and what is stretched is told.
TEST(ContourLattice, AFittedPictureIsCoveredWhole)
{
  for (const double height : { 1.0, 0.731, std::sqrt(3.0), 1.2345 })
    for (const int nodes : { 41, 42, 43, 64, 127 })
      for (const int multiple : { 1, 2, 4 })
      {
        SCOPED_TRACE(::testing::Message() << height << ", " << nodes << " nodes, multiples of " << multiple);
        ContourSet set{ { 1, height }, {} };
        set.contours.push_back({ { { 0.2, 0.1 * height }, { 0.8, 0.1 * height }, { 0.5, 0.9 * height } }, true, 1 });
        const FittedContours fitted = fitContours(set, 1.0 / nodes, multiple);
        const Lattice& lattice = fitted.lattice;
        EXPECT_EQ(lattice.size[0] % multiple, 0);
        EXPECT_EQ(lattice.size[1] % multiple, 0);
        EXPECT_NEAR(static_cast<double>(lattice.size[0]), nodes, multiple / 2.0);
        EXPECT_DOUBLE_EQ(lattice.length(0), 1);
        EXPECT_DOUBLE_EQ(lattice.length(1), height * fitted.stretch);
        EXPECT_LE(std::abs(fitted.stretch - 1), multiple / (2.0 * static_cast<double>(lattice.size[1])) * 1.1);
        EXPECT_DOUBLE_EQ(fitted.contours.size[1], lattice.length(1));
        EXPECT_DOUBLE_EQ(fitted.contours.contours[0].points[2][1], 0.9 * height * fitted.stretch);
        const ContourLattice made = onLattice(fitted.contours, lattice.spacing);
        EXPECT_EQ(made.image.lattice.size, lattice.size);
        EXPECT_LE(made.cropped, 1e-12);
        EXPECT_NEAR(made.lumenFraction, 0.24, 1e-7); // shares are floats
      }
  const auto none = refusal<ParameterError>([] { (void)fitContours({ { 1, 1 }, {} }, 0.1, 0); });
  EXPECT_NE(none.first.find("multiples of 0"), std::string::npos);
}

TEST(ContourLattice, ThinWallsAreReported)
{
  const ContourSet set = honeycomb(200e-6, 150e-6, 25e-6, 3e-6, 8);
  const ContourLattice coarse = onLattice(set, 2e-6);
  EXPECT_NEAR(coarse.thickness.low, 3e-6, 1e-9);
  ASSERT_EQ(coarse.warnings.size(), 1U);
  EXPECT_NE(coarse.warnings[0].find("1.5 nodes thick"), std::string::npos) << coarse.warnings[0];
  EXPECT_TRUE(onLattice(set, 1e-6).warnings.empty());
}

TEST(ContourLattice, NoLumenAndOnlyLumen)
{
  const ContourLattice wall = onLattice({ { 1, 1 }, {} }, 0.1);
  EXPECT_EQ(wall.lumenFraction, 0);
  EXPECT_TRUE(wall.links[0].link.empty());
  const ContourLattice lumen =
    onLattice({ { 1, 1 }, { { { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } }, true, 5 } } }, 0.1);
  EXPECT_NEAR(lumen.lumenFraction, 1, 1e-15);
  EXPECT_EQ(*std::min_element(lumen.grain.begin(), lumen.grain.end()), 5);
}

TEST(ContourLattice, RefusesWhatIsNoOutline)
{
  const auto message = [](const ContourSet& set)
  { return refusal<InputError>([&] { static_cast<void>(onLattice(set, 0.1)); }).first; };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Contour good = regularPolygon({ 0.5, 0.5 }, 0.2, 9, 1);
  EXPECT_EQ(message({ { 1, 1 }, { good, { { { 0.1, 0.1 } }, true, 1 } } }), "contour 2 is closed and has 1 points");
  EXPECT_NE(message({ { 1, 1 }, { { { { 0.1, 0.1 }, { nan, 0.2 }, { 0.1, 0.3 } }, true, 1 } } }).find("nan"),
    std::string::npos);
  EXPECT_NE(message({ { 1, 1 }, { { { { 0, 0.1 }, { 0.2, 0.2 }, { 0.1, 0.3 } }, false, 1 } } }).find("from the border"),
    std::string::npos);
  EXPECT_NE(message({ { 1, 1 },
                      { { { { 0, 0.1 }, { 0.2, 0.2 }, { 0, 0.3 } }, false, 1 },
                        { { { 0, 0.8 }, { 0.2, 0.7 }, { 0, 0.6 } }, false, 2 } } })
              .find("instead of"),
    std::string::npos);
  EXPECT_NE(message({ { 1, 1 }, { regularPolygon({ 0.5, 0.5 }, 0.2, 9, 0) } }).find("lumen 0"), std::string::npos);

  const ContourSet set{ { 1, 1 }, { good } };
  const auto refused = [&](double spacing)
  { return !refusal<ParameterError>([&] { static_cast<void>(onLattice(set, spacing)); }).first.empty(); };
  EXPECT_TRUE(refused(0));
  EXPECT_TRUE(refused(nan));
  EXPECT_TRUE(refused(3));
  EXPECT_FALSE(refusal<MemoryError>([&] { static_cast<void>(onLattice(set, 1e-7)); }).first.empty());
  EXPECT_FALSE(refusal<MemoryError>([&] { static_cast<void>(onLattice(set, 1e-12)); }).first.empty());
}
