// Contours of shapes whose area and normals are known.
#include "generators/Generators.h"
#include "outlines/ContourBorder.h"
#include "outlines/ContourCheck.h"
#include "outlines/ContourExtraction.h"
#include "outlines/ContourMeasures.h"
#include "outlines/PolygonFile.h"
#include "pictures/Picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numbers>
#include <random>

using namespace lamella;
using namespace lamella::micrograph;

namespace
{

constexpr double pi = std::numbers::pi;

/// A shape by its distance, above 0 inside.
struct Shape
{
  double area = 0;
  std::function<double(double, double)> inside;
};

Shape disk(double r)
{
  return { pi * r * r, [=](double x, double y) { return r - std::hypot(x, y); } };
}

Shape ellipse(double a)
{
  const double b = 0.6 * a;
  // To second order in the distance, which is all that is looked at.
  return { pi * a * b,
    [=](double x, double y)
    {
      const double f = 1 - x * x / (a * a) - y * y / (b * b);
      return f / std::max(2 * std::hypot(x / (a * a), y / (b * b)), 1e-9);
    } };
}

Shape hexagon(double r)
{
  return { 1.5 * std::sqrt(3.0) * r * r,
    [=](double x, double y)
    {
      double least = 1e300;
      for (int k = 0; k < 6; ++k)
      {
        const double a = pi / 3 * (k + 0.5);
        least = std::min(least, r * std::cos(pi / 6) - x * std::cos(a) - y * std::sin(a));
      }
      return least;
    } };
}

struct Errors
{
  double mean = 0;     ///< of the area [pixels²]
  double rms = 0;      ///< of the area [pixels²]
  double farthest = 0; ///< of a point from the shape, mean over the trials [pixels]
  double turn = 0;     ///< of the segments' directions, rms [degrees]
};

/// The same shape at random places and turns.
Errors measure(const Shape& shape, double r, int trials, bool useLevel)
{
  std::mt19937 random(11);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  Errors errors;
  double turns = 0;
  double length = 0;
  for (int trial = 0; trial < trials; ++trial)
  {
    const auto n = static_cast<std::int64_t>(2 * r) + 8;
    PhaseImage image;
    image.lattice = makeLattice(n, n, 1, 2, 1.0);
    image.phases = PhaseTable({ "lumen", "wall" });
    const double cx = static_cast<double>(n) / 2 + uniform() - 0.5;
    const double cy = static_cast<double>(n) / 2 + uniform() - 0.5;
    const double turn = 2 * pi * uniform();
    const auto at = [&](double x, double y)
    {
      const double dx = x - cx;
      const double dy = y - cy;
      return shape.inside(std::cos(turn) * dx + std::sin(turn) * dy, std::cos(turn) * dy - std::sin(turn) * dx);
    };
    std::vector<float> level;
    for (std::int64_t j = 0; j < n; ++j)
    {
      for (std::int64_t i = 0; i < n; ++i)
      {
        const double d = at(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5);
        image.phase.push_back(d > 0 ? 0 : 1);
        level.push_back(static_cast<float>(d));
      }
    }
    const Extraction e = extractContours(image, 0, useLevel ? level : std::vector<float>{});
    EXPECT_EQ(e.report.lumens, 1);
    EXPECT_TRUE(validate(e.contours).empty());
    const std::vector<Point>& p = e.contours.contours.at(0).points;
    const double wrong = polygonArea(p) - shape.area;
    errors.mean += wrong / trials;
    errors.rms += wrong * wrong / trials;
    double farthest = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
    {
      const Point& q = p[(i + 1) % p.size()];
      farthest = std::max(farthest, std::abs(at(p[i][0], p[i][1])));
      const double mx = (p[i][0] + q[0]) / 2;
      const double my = (p[i][1] + q[1]) / 2;
      const double h = 1e-4;
      const double gx = at(mx + h, my) - at(mx - h, my);
      const double gy = at(mx, my + h) - at(mx, my - h);
      const double dx = q[0] - p[i][0];
      const double dy = q[1] - p[i][1];
      const double l = std::hypot(dx, dy);
      const double angle = std::asin(std::clamp((gx * dx + gy * dy) / (std::hypot(gx, gy) * l), -1.0, 1.0)) * 180 / pi;
      turns += angle * angle * l;
      length += l;
    }
    errors.farthest += farthest / trials;
  }
  errors.rms = std::sqrt(errors.rms);
  errors.turn = std::sqrt(turns / length);
  return errors;
}

std::optional<std::filesystem::path> realData()
{
  const char* folder = std::getenv("LAMELLA_REAL_DATA");
  return folder == nullptr ? std::nullopt : std::optional<std::filesystem::path>(folder);
}

/// A label picture, grey `lumen` as phase 0.
PhaseImage labels(const std::filesystem::path& path, int lumen, double spacing)
{
  ReadOptions options;
  options.pixelSize = spacing;
  const Picture picture = readPicture(path, options);
  GreyMap map;
  map.phaseOfGrey[lumen] = "void";
  map.other = "wall";
  return map.apply(picture.lattice, picture.grey);
}

} // namespace

TEST(Contours, AreasFromALevelAreOfSecondOrder)
{
  // Linear interpolation of a smooth level: relative error (1/R)². Over four doublings the order is 2 to within the
  // few per cent that the smallest shape is off the asymptote; corners of polygons cost O(1) pixel² each: order 2 too,
  // as far as six trials know it.
  for (Shape (*make)(double) : { &disk, &ellipse, &hexagon })
  {
    const Errors coarse = measure(make(8), 8, 40, true);
    const Errors fine = measure(make(128), 128, 6, true);
    const double order = std::log2(coarse.rms / 64 / (fine.rms / (128.0 * 128.0))) / 4;
    std::printf("level: area error %.4f px2 at R 8, %.4f at 128, order %.2f; directions %.2f, %.2f deg\n", coarse.rms,
      fine.rms, order, coarse.turn, fine.turn);
    EXPECT_GT(order, 1.75);
    EXPECT_LT(fine.rms, 1.0);
  }
}

TEST(Contours, AreasFromAMaskHaveNoBiasAndScatterAsTheMaskDoes)
{
  // The area of a disk of R pixels is the number of its pixels: exact in the mean over centres, with a scatter of about
  // 0.7 √R pixels² (Kendall, Quarterly J. Math. 19, 1948, 1–26), relative order 3/2. No contour through the same mask
  // can know more of a single one. The mean of `trials` is off by its standard error, three of them at most; of shapes
  // with straight sides the scatter grows up to half an order faster.
  struct Case
  {
    const char* name;
    Shape (*make)(double);
    double order;
  };
  for (const auto& [name, make, order] :
    { Case{ "disk", &disk, 1.5 }, Case{ "ellipse", &ellipse, 1.5 }, Case{ "hexagon", &hexagon, 1.3 } })
  {
    double first = 0;
    for (const double r : { 8.0, 32.0, 128.0 })
    {
      const int trials = r > 100 ? 24 : 100;
      const Errors e = measure(make(r), r, trials, false);
      std::printf("mask, %s of %3.0f px: area error mean %6.3f, rms %6.3f px2, farthest %.3f px, directions %.2f deg\n",
        name, r, e.mean, e.rms, e.farthest, e.turn);
      EXPECT_LT(std::abs(e.mean), 3 * e.rms / std::sqrt(trials)) << name << r;
      EXPECT_LT(e.farthest, 1.0) << name << r; // nodes hold contours within a pixel
      if (r == 8)
      {
        first = e.rms / 64;
      }
      else
      {
        // 24 trials know the scatter to 15 %, which is 0.1 of an order over two doublings and less over four.
        EXPECT_GT(std::log2(first / (e.rms / (r * r))) / std::log2(r / 8), order - 0.2) << name << r;
      }
    }
  }
}

TEST(Contours, DirectionsFromAMaskAreFarBetterThanItsSteps)
{
  // The half-way chain is 18.7° off (rms), whatever the size; a Gaussian of 1 pixel leaves 5.9°, and rounds corners.
  for (const double r : { 8.0, 32.0, 128.0 })
  {
    const Errors e = measure(disk(r), r, 12, false);
    EXPECT_LT(e.turn, r < 10 ? 4.0 : 2.0) << r; // half of the angle between segments comes on top for small ones
    EXPECT_LT(e.farthest, 0.5) << r;
  }
}

TEST(Contours, TissuesKeepTheirMaskAndDoNotCross)
{
  generators::SoftwoodOptions options;
  options.size = { 500, 400, 1 };
  options.ringPosition1 = 1;
  const PhaseImage image = generators::softwood(options);
  const Extraction e = extractContours(image, 0);
  EXPECT_TRUE(validate(e.contours).empty());
  EXPECT_EQ(e.report.islands, 0);
  EXPECT_NEAR(wallFraction(e.contours), image.fractions()[1], 1e-12);
}

TEST(Contours, SpruceLabels)
{
  const auto folder = realData();
  if (!folder)
    GTEST_SKIP() << "LAMELLA_REAL_DATA does not name the folder of real pictures";
  // 0.1997 and 0.6094 are these pictures' solid fractions; 133 and 104 lumens counted with 4 neighbours.
  for (const auto& [name, solid, lumens] :
    { std::tuple("spruce_EW_labels_0.5um.png", 0.1997, 104), std::tuple("spruce_LW_labels_0.5um.png", 0.6094, 133) })
  {
    const PhaseImage image = labels(*folder / name, 0, 0.5e-6);
    const Extraction e = extractContours(image, 0);
    EXPECT_NEAR(wallFraction(e.contours), solid, 5e-5) << name; // the digits given
    EXPECT_NEAR(wallFraction(e.contours), image.fractions()[1], 1e-12) << name;
    EXPECT_EQ(e.report.lumens, lumens);
    EXPECT_TRUE(validate(e.contours).empty());
  }
}

TEST(Contours, SprucePolygonsInTheFrameOfTheirPictures)
{
  const auto folder = realData();
  if (!folder)
    GTEST_SKIP() << "LAMELLA_REAL_DATA does not name the folder of real pictures";
  struct Case
  {
    const char* tissue;
    std::array<double, 4> window; ///< [µm], y up; where the pixels' centres fit best, at every 0.05 µm and mirror image
    double solid;                 ///< of the picture
    double within;
  };
  // The pictures' lumens are larger than the polygons by 0.01 µm all around (1.4 % of a pixel; the polygons sampled at
  // the pixels' centres give 0.2005 and 0.6106): 0.5 % of thin walls, 0.2 % of thick ones.
  for (const Case& c :
    { Case{ "EW", { 60, 20, 440, 410 }, 0.19966, 0.006 }, Case{ "LW", { 12, 22, 388, 245 }, 0.60941, 0.003 } })
  {
    PolygonReadOptions options;
    options.window = c.window;
    const PolygonFile f = readPolygons(*folder / (std::string("spruce_") + c.tissue + "_polygons.json.gz"), options);
    EXPECT_TRUE(validate(f.lumens).empty());
    ASSERT_TRUE(f.cells);
    EXPECT_NEAR(wallFraction(f.lumens) / c.solid, 1, c.within) << c.tissue;

    // Their picture at half and a quarter of the pixel, made of the polygons: the contours' fraction is stable.
    for (const double spacing : { 0.5e-6, 0.25e-6, 0.125e-6 })
    {
      PhaseImage image;
      image.lattice =
        makeLattice(std::llround(f.lumens.size[0] / spacing), std::llround(f.lumens.size[1] / spacing), 1, 2, spacing);
      image.phases = PhaseTable({ "lumen", "wall" });
      image.phase.assign(static_cast<std::size_t>(image.lattice.count()), 1);
      for (const Outline& outline : outlines(f.lumens))
      {
        // Even-odd along each row of pixel centres.
        std::vector<std::vector<double>> crossings(static_cast<std::size_t>(image.lattice.size[1]));
        for (std::size_t i = 0; i < outline.points.size(); ++i)
        {
          Point a = outline.points[i];
          Point b = outline.points[(i + 1) % outline.points.size()];
          if (a[1] > b[1])
            std::swap(a, b);
          const auto from = static_cast<std::int64_t>(std::ceil(a[1] / spacing - 0.5));
          for (std::int64_t j = std::max<std::int64_t>(from, 0);
               j < image.lattice.size[1] && (static_cast<double>(j) + 0.5) * spacing < b[1]; ++j)
          {
            const double y = (static_cast<double>(j) + 0.5) * spacing;
            crossings[static_cast<std::size_t>(j)].push_back(a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]));
          }
        }
        for (std::int64_t j = 0; j < image.lattice.size[1]; ++j)
        {
          auto& x = crossings[static_cast<std::size_t>(j)];
          std::sort(x.begin(), x.end());
          for (std::size_t k = 0; k + 1 < x.size(); k += 2)
          {
            const auto last = std::min<std::int64_t>(
              static_cast<std::int64_t>(std::ceil(x[k + 1] / spacing - 0.5)), image.lattice.size[0]);
            for (auto i = static_cast<std::int64_t>(std::ceil(x[k] / spacing - 0.5)); i < last; ++i)
              image.phase[static_cast<std::size_t>(image.lattice.index(i, j))] = 0;
          }
        }
      }
      const Extraction e = extractContours(image, 0);
      std::printf("%s at %.3f um: %.5f of contours, %.5f of polygons\n", c.tissue, spacing * 1e6,
        wallFraction(e.contours), wallFraction(f.lumens));
      // Sampling 100 to 140 lumens: 0.7 √R pixels² each, 1e-4 of the picture at 0.5 µm.
      EXPECT_NEAR(wallFraction(e.contours) / wallFraction(f.lumens), 1, 0.003) << c.tissue << spacing;
      EXPECT_TRUE(validate(e.contours).empty());
    }
  }
}

TEST(Contours, ConiferMask)
{
  const auto folder = realData();
  if (!folder)
    GTEST_SKIP() << "LAMELLA_REAL_DATA does not name the folder of real pictures";
  const PhaseImage image = labels(*folder / "conifer_roxas_lumen_mask.png", 255, 0.441e-6);
  const auto lumen = image.phases.find("void");
  ASSERT_TRUE(lumen);
  const Extraction e = extractContours(image, *lumen);
  EXPECT_EQ(e.report.lumens, 251); // the expert's count
  EXPECT_TRUE(validate(e.contours).empty());
  EXPECT_NEAR(wallFraction(e.contours), 1 - 0.6562, 1e-4);
}
