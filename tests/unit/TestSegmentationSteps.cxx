// What each step of the segmentation finds in a picture made for it, and what it leaves alone.
#include "Support.h"

#include "core/Random.h"
#include "outlines/LumenClasses.h"
#include "segmentation/Segmentation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <numbers>

using namespace lamella;
using namespace lamella::micrograph;

namespace
{

constexpr double lumenGrey = 230;
constexpr double wallGrey = 120;

/// A grey picture of a function of the place, averaged over 3 × 3 points a pixel and over 3 × 3 pixels for the lens.
Picture pictureOf(std::int64_t nx, std::int64_t ny, const std::function<double(double, double)>& grey)
{
  Picture picture;
  picture.lattice = makeLattice(nx, ny, 1, 2, 1);
  std::vector<double> sharp;
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      double sum = 0;
      for (int k = 0; k < 9; ++k)
        sum += grey(static_cast<double>(x) + (k % 3 + 0.5) / 3, static_cast<double>(y) + (k / 3 + 0.5) / 3) / 9;
      sharp.push_back(sum);
    }
  }
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      double sum = 0;
      for (int k = 0; k < 9; ++k)
      {
        const auto i = std::clamp<std::int64_t>(x + k % 3 - 1, 0, nx - 1);
        const auto j = std::clamp<std::int64_t>(y + k / 3 - 1, 0, ny - 1);
        sum += sharp[static_cast<std::size_t>(i + nx * j)] / 9;
      }
      picture.grey.push_back(static_cast<std::uint16_t>(std::lround(sum)));
    }
  }
  return picture;
}

/// Distance from the outline of the nearest disk of a square array of disks, negative inside.
double fromDisks(double x, double y, double pitch, double radius)
{
  const double dx = x - pitch * (std::floor(x / pitch) + 0.5);
  const double dy = y - pitch * (std::floor(y / pitch) + 0.5);
  return std::hypot(dx, dy) - radius;
}

Picture disks(double rim = 0)
{
  return pictureOf(
    320, 240,
    [&](double x, double y)
    {
      const double d = fromDisks(x, y, 40, 14);
      return std::abs(d) < rim / 2 ? 30 : d < 0 ? lumenGrey : wallGrey;
    });
}

constexpr double disksFraction = std::numbers::pi * 14 * 14 / (40.0 * 40.0);

/// Fills nodes x0 … x1 - 1, y0 … y1 - 1 of a grey picture.
void fill(Picture& picture, std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1, std::uint16_t grey)
{
  for (std::int64_t y = y0; y < y1; ++y)
    std::fill_n(picture.grey.begin() + y * picture.lattice.size[0] + x0, x1 - x0, grey);
}

bool says(const Segmentation& result, const std::string& words)
{
  return std::ranges::any_of(
    result.warnings, [&](const std::string& warning) { return warning.find(words) != std::string::npos; });
}

std::size_t marksOf(const Segmentation& result, Mark::Kind kind)
{
  return static_cast<std::size_t>(std::ranges::count(result.marks, kind, &Mark::kind));
}

/// Broad cells in files left and right of a ray whose cells are 90 long and 10 wide, in tissue of a given grey.
Picture withRay(double rayTissue)
{
  return pictureOf(
    330, 400,
    [&](double x, double y)
    {
      const double across = std::abs(x - 165);
      if (across < 15)
      {
        const double along = y - 100 * std::floor(y / 100);
        return across < 5 && along > 5 && along < 95 ? lumenGrey : rayTissue;
      }
      return fromDisks(x < 165 ? x : x - 10, y, 40, 14) < 0 ? lumenGrey : wallGrey;
    });
}

std::vector<double> logNormal(std::size_t n, double middle, double width, int seed)
{
  const Random random(static_cast<std::uint64_t>(seed));
  std::vector<double> sizes(n);
  for (std::size_t i = 0; i < n; ++i)
    sizes[i] = middle * std::exp(width * random.normal(RandomUse::CellPlace, static_cast<std::int64_t>(i), 0, 0));
  return sizes;
}

} // namespace

TEST(SegmentationSteps, EdgesLieAtHalfTheirHeight)
{
  const Segmentation result = segment(disks());
  EXPECT_EQ(result.report.lumens, 48);
  // Pixels at the outline fall in or out by half a pixel at random, 7 % of the area in all, which averages out; the
  // mean outline is told to a twentieth of a pixel: 0.7 % of the area.
  EXPECT_NEAR(result.report.lumenFraction, disksFraction, 0.01 * disksFraction);
  EXPECT_EQ(result.report.rim, 0);
}

TEST(SegmentationSteps, RimsArePassedToTheirMiddle)
{
  for (const double rim : { 2.0, 3.0 })
  {
    const Picture picture = disks(rim);
    const Segmentation result = segment(picture);
    EXPECT_GT(result.report.rimDepth, 0.2);
    EXPECT_EQ(result.report.rimChannel, "grey");
    // The darkest line of the blurred rim lies between its middle and half a pixel outside.
    const double radius = 40 * std::sqrt(result.report.lumenFraction / std::numbers::pi);
    EXPECT_GT(radius, 14) << rim;
    EXPECT_LT(radius, 14.6) << rim;
    SegmentOptions options;
    options.rim = 0;
    const double without = 40 * std::sqrt(segment(picture, options).report.lumenFraction / std::numbers::pi);
    EXPECT_LT(without, 14 - rim / 2 + 0.3) << rim; // the rim's inner flank
    options.rim = 2;
    EXPECT_EQ(segment(picture, options).report.rim, 2);
  }
}

TEST(SegmentationSteps, ALayerOfTheWallIsNoRim)
{
  // Dark secondary walls, five pixels thick, with a bright middle lamella.
  const Segmentation result = segment(pictureOf(320, 240,
    [](double x, double y)
    {
      const double d = fromDisks(x, y, 40, 10);
      return d < 0 ? lumenGrey : d < 6 ? 50 : wallGrey;
    }));
  EXPECT_EQ(result.report.rim, 0);
}

TEST(SegmentationSteps, OutlinesThatMoveDoNotMeet)
{
  const Picture picture = disks();
  SegmentOptions options;
  options.rim = 15; // the walls are 12 wide between two disks
  const Segmentation result = segment(picture, options);
  EXPECT_EQ(result.report.lumens, 48);
  EXPECT_GT(result.report.lumenFraction, 0.9);
}

TEST(SegmentationSteps, NecksClose)
{
  // Pits two pixels wide join all disks of a row.
  const Picture picture = pictureOf(320, 240,
    [](double x, double y)
    {
      const double row = std::abs(y - 40 * (std::floor(y / 40) + 0.5));
      return fromDisks(x, y, 40, 14) < 0 || row < 1.2 ? lumenGrey : wallGrey;
    });
  SegmentOptions options;
  options.opening = 0;
  EXPECT_EQ(segment(picture, options).report.lumens, 6);
  options.opening = 2;
  const Segmentation result = segment(picture, options);
  EXPECT_EQ(result.report.lumens, 48);
  EXPECT_GT(result.report.neckNodes, 500);
}

TEST(SegmentationSteps, TornRaysAreWallAndWholeRaysAreNot)
{
  const Segmentation torn = segment(withRay(60));
  EXPECT_EQ(torn.report.rays, 4);
  EXPECT_EQ(marksOf(torn, Mark::Kind::Ray), 4U);
  EXPECT_NEAR(static_cast<double>(torn.report.rayNodes), 4 * 90 * 10, 400);
  EXPECT_TRUE(says(torn, "4 gaps in rays"));
  const Segmentation whole = segment(withRay(wallGrey));
  EXPECT_EQ(whole.report.rays, 0);
  EXPECT_EQ(whole.report.lumens, torn.report.lumens + 4);
  SegmentOptions keep;
  keep.raySlenderness = 0;
  EXPECT_EQ(segment(withRay(60), keep).report.lumens, whole.report.lumens);
}

// Two slender cells may well be dark by chance: nothing is lost for that.
TEST(SegmentationSteps, TwoSlenderCellsInDarkTissueAreLeft)
{
  const auto only = [](int cells)
  {
    const Picture ray = withRay(60);
    return pictureOf(330, 400,
      [&](double x, double y)
      {
        const auto pixel = ray.grey[static_cast<std::size_t>(y) * 330 + static_cast<std::size_t>(x)];
        return std::abs(x - 165) < 5 && y > 100 * cells ? 60.0 : static_cast<double>(pixel);
      });
  };
  EXPECT_EQ(segment(only(2)).report.rays, 0);
  EXPECT_EQ(segment(only(4)).report.rays, 4);
}

TEST(SegmentationSteps, ScaleBarsTextAndMarginsAreFoundAndPaintedOver)
{
  const Segmentation clean = segment(disks());
  EXPECT_TRUE(clean.marks.empty());
  Picture picture = disks();
  fill(picture, 200, 20, 280, 26, 0); // a bar
  for (const std::int64_t x : { 220, 230, 240 })
  {
    fill(picture, x, 32, x + 2, 44, 0); // three letters: H H H
    fill(picture, x + 5, 32, x + 7, 44, 0);
    fill(picture, x, 37, x + 7, 39, 0);
  }
  fill(picture, 0, 0, 3, 240, 255); // a white margin
  const Segmentation result = segment(picture);
  ASSERT_EQ(result.marks.size(), 3U);
  EXPECT_EQ(marksOf(result, Mark::Kind::Bar), 1U);
  EXPECT_EQ(marksOf(result, Mark::Kind::Text), 1U);
  EXPECT_EQ(marksOf(result, Mark::Kind::Margin), 1U);
  for (const Mark& mark : result.marks)
    if (mark.kind == Mark::Kind::Bar)
      EXPECT_EQ((std::array{ mark.x0, mark.y0, mark.x1, mark.y1 }), (std::array{ 200, 20, 280, 26 }));
  EXPECT_TRUE(says(result, "1 margin, 1 scale bar, 1 line(s) of text"));
  // What is painted over is a guess, the rest is as it was: nine tenths of the nodes within the bar's two cells.
  std::size_t other = 0;
  for (std::size_t i = 0; i < result.image.phase.size(); ++i)
    other += result.image.phase[i] != clean.image.phase[i];
  EXPECT_LT(other, static_cast<std::size_t>(1.5 * result.report.graphicsShare * 320 * 240));
  SegmentOptions keep;
  keep.graphics = false;
  EXPECT_TRUE(segment(picture, keep).marks.empty());
}

TEST(SegmentationSteps, SaturatedPartsAreToldWithTheirShare)
{
  Picture picture = disks();
  fill(picture, 160, 0, 320, 240, 255);
  const Segmentation white = segment(picture);
  EXPECT_TRUE(says(white, "50 % of the picture is plain white"));
  fill(picture, 160, 0, 320, 240, 0);
  EXPECT_TRUE(says(segment(picture), "50 % of the picture is plain black"));
  EXPECT_FALSE(says(segment(disks()), "plain"));
}

TEST(SegmentationSteps, OneLumenThatFillsThePictureIsTold)
{
  const Segmentation result = segment(
    pictureOf(200, 200, [](double x, double y) { return std::hypot(x - 100, y - 100) < 40 ? wallGrey : lumenGrey; }),
    []
    {
      SegmentOptions options;
      options.lumen = LumenSide::Bright;
      return options;
    }());
  EXPECT_TRUE(says(result, "one lumen fills 87 %"));
  EXPECT_EQ(result.report.background, 0); // the disk passed for a shadow
}

TEST(SegmentationSteps, NoiseAloneIsHardToTellApart)
{
  const Random random(3);
  Picture picture;
  picture.lattice = makeLattice(200, 150, 1, 2, 1);
  for (std::int64_t i = 0; i < 200 * 150; ++i)
  {
    picture.grey.push_back(
      static_cast<std::uint16_t>(std::lround(128 + 10 * random.normal(RandomUse::CellPlace, i, 0, 0))));
  }
  EXPECT_TRUE(says(segment(picture), "hard to tell apart"));
}

TEST(SegmentationSteps, AColourCanBeAskedFor)
{
  Picture picture = disks();
  SegmentOptions options;
  options.channel = Channel::Red;
  EXPECT_THROW((void)segment(picture, options), ParameterError);
  // Only blue shows the walls; green shows some of them, with noise that red shows too: less red, it is clean.
  const Random random(5);
  for (std::size_t i = 0; i < picture.grey.size(); ++i)
  {
    const double dirt = 25 * random.normal(RandomUse::CellPlace, static_cast<std::int64_t>(i), 0, 0);
    const double red = std::clamp(128 + dirt, 0.0, 255.0);
    const double green = std::clamp(0.5 * picture.grey[i] + 60 + dirt, 0.0, 255.0);
    picture.colour.push_back(static_cast<std::uint16_t>(red));
    picture.colour.push_back(static_cast<std::uint16_t>(green));
    picture.colour.push_back(128);
  }
  const Segmentation mixed = segment(picture);
  EXPECT_EQ(mixed.report.channel, "stain");
  EXPECT_NEAR(mixed.report.weights[0] / mixed.report.weights[1], -1, 0.2); // the classes are mixed a little
  EXPECT_EQ(mixed.report.lumens, 48);
  options.channel = Channel::Green;
  const Segmentation green = segment(picture, options);
  EXPECT_EQ(green.report.channel, "green");
  EXPECT_LT(green.report.separability, mixed.report.separability);
}

TEST(SegmentationSteps, LumensAreNumberedAndMeasured)
{
  const Segmentation result = segment(disks());
  ASSERT_EQ(result.shapes.size(), 48U);
  ASSERT_EQ(result.vessel.size(), 48U);
  EXPECT_EQ(*std::max_element(result.lumen.begin(), result.lumen.end()), 48);
  const LumenShape& shape = result.shapes[static_cast<std::size_t>(result.lumen[20 * 320 + 20]) - 1];
  EXPECT_NEAR(shape.x, 19.5, 0.1); // a pixel's place is its middle
  EXPECT_NEAR(shape.y, 19.5, 0.1);
  EXPECT_NEAR(shape.length, 28, 0.5);
  EXPECT_NEAR(shape.width, 28, 0.5);
  EXPECT_FALSE(shape.cut);
  for (std::size_t i = 0; i < result.lumen.size(); ++i)
    EXPECT_EQ(result.lumen[i] == 0, result.image.phase[i] == 1);
}

TEST(SegmentationSteps, ThreeMegapixelsTakeAboutASecond)
{
  const Picture picture =
    pictureOf(2000, 1500, [](double x, double y) { return fromDisks(x, y, 40, 14) < 0 ? lumenGrey : wallGrey; });
  const auto begin = std::clock();
  const Segmentation result = segment(picture);
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  EXPECT_EQ(result.report.lumens, 50 * 38);
  EXPECT_LT(seconds, 5); // 0.8 measured; loaded and debugging machines are slower
}

TEST(LumenClasses, VesselsAreToldFromFibres)
{
  std::vector<double> sizes = logNormal(600, 50, 0.35, 1);
  const std::vector<double> vessels = logNormal(60, 2000, 0.4, 2);
  sizes.insert(sizes.end(), vessels.begin(), vessels.end());
  const LumenClasses classes = classifyLumens(sizes);
  ASSERT_TRUE(classes.two);
  EXPECT_EQ(classes.vessels, 60U); // the classes are ten deviations apart
  EXPECT_GT(classes.threshold, 50 * std::exp(3 * 0.35));
  EXPECT_LT(classes.threshold, 2000 / std::exp(2 * 0.4));
  EXPECT_NEAR(classes.ratio, 40, 6); // the mean logarithms' errors: 0.4/sqrt(60) is 5 %
  for (std::size_t i = 0; i < sizes.size(); ++i)
    EXPECT_EQ(classes.vessel[i], i >= 600);
}

TEST(LumenClasses, OneKindOfCellIsOneClass)
{
  for (const double width : { 0.1, 0.4, 0.8 })
  {
    for (const int seed : { 1, 2, 3 })
    {
      const LumenClasses classes = classifyLumens(logNormal(400, 1000, width, seed));
      EXPECT_FALSE(classes.two) << width << ' ' << seed;
      EXPECT_EQ(classes.vessels, 0U);
    }
  }
  std::vector<double> uniform; // from 100 to 10 000
  for (int i = 0; i < 300; ++i)
    uniform.push_back(100 * std::pow(100.0, i / 299.0));
  EXPECT_FALSE(classifyLumens(uniform).two);
  // A few fibres among many vessels are no fibres.
  std::vector<double> mostlyLarge = logNormal(300, 1000, 0.3, 4);
  const std::vector<double> small = logNormal(20, 20, 0.3, 5);
  mostlyLarge.insert(mostlyLarge.end(), small.begin(), small.end());
  EXPECT_FALSE(classifyLumens(mostlyLarge).two);
}

TEST(LumenClasses, FewLumensAndBadSizes)
{
  EXPECT_FALSE(classifyLumens({}).two);
  EXPECT_FALSE(classifyLumens(std::vector<double>{ 1, 1, 100, 100 }).two);
  EXPECT_FALSE(classifyLumens(std::vector<double>(50, 7.0)).two);
  EXPECT_THROW((void)classifyLumens(std::vector<double>{ 1, 0 }), ParameterError);
  EXPECT_THROW((void)classifyLumens(std::vector<double>{ 1, std::nan("") }), ParameterError);
}
