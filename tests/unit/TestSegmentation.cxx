#include "Support.h"

#include "core/Random.h"
#include "generators/Generators.h"
#include "generators/MicrographLook.h"
#include "segmentation/Segmentation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace lamella;
using namespace lamella::micrograph;

namespace
{

/// How a microscope might see a tissue.
struct Scan
{
  double lumen = 220;
  double wall = 90;
  double shading = 0;                     ///< share of the light lost in the corners
  double noise = 0;                       ///< standard deviation
  std::array<double, 3> stain{ 0, 0, 0 }; ///< colour: contrast of each channel; all 0: grey
};

PhaseImage tissue()
{
  generators::SoftwoodOptions options;
  options.size = { 420, 360, 1 };
  options.ringPosition1 = 1;
  return generators::softwood(options);
}

Picture scanOf(const PhaseImage& image, const Scan& scan)
{
  Picture picture;
  picture.lattice = image.lattice;
  const auto [nx, ny, nz] = image.lattice.size;
  const Random random(7);
  const bool colour = scan.stain[0] + scan.stain[1] + scan.stain[2] > 0;
  const auto seen = [&](double level, std::int64_t x, std::int64_t y, int channel)
  {
    const double u = 2 * static_cast<double>(x) / static_cast<double>(nx) - 1;
    const double v = 2 * static_cast<double>(y) / static_cast<double>(ny) - 1;
    const double light = 1 - scan.shading * (u * u + v * v) / 2;
    const double noisy = level * light + scan.noise * random.normal(RandomUse::CellPlace, x, y, channel);
    return static_cast<std::uint16_t>(std::clamp(std::lround(noisy), 0L, 255L));
  };
  for (std::int64_t y = 0; y < ny; ++y)
  {
    for (std::int64_t x = 0; x < nx; ++x)
    {
      // A 3 × 3 mean stands for the lens.
      double solid = 0;
      for (std::int64_t j = -1; j <= 1; ++j)
      {
        for (std::int64_t i = -1; i <= 1; ++i)
        {
          solid += image.phase[image.lattice.index(
            std::clamp<std::int64_t>(x + i, 0, nx - 1), std::clamp<std::int64_t>(y + j, 0, ny - 1))];
        }
      }
      picture.grey.push_back(seen(scan.lumen + (scan.wall - scan.lumen) * solid / 9, x, y, 3));
      for (int channel = 0; channel < 3 && colour; ++channel)
        picture.colour.push_back(seen(220 - scan.stain[channel] * solid / 9, x, y, channel));
    }
  }
  return picture;
}

/// Intersection over union of the lumens.
double agreement(const PhaseImage& a, const std::vector<bool>& lumen)
{
  double both = 0;
  double either = 0;
  for (std::size_t i = 0; i < lumen.size(); ++i)
  {
    both += a.phase[i] == 0 && lumen[i];
    either += a.phase[i] == 0 || lumen[i];
  }
  return both / either;
}

double agreement(const PhaseImage& a, const PhaseImage& b)
{
  std::vector<bool> lumen(b.phase.size());
  std::transform(b.phase.begin(), b.phase.end(), lumen.begin(), [](std::uint8_t id) { return id == 0; });
  return agreement(a, lumen);
}

/// Lumens of at least so many pixels, connected through faces.
std::int64_t lumensOf(const PhaseImage& image, std::int64_t least)
{
  const auto [nx, ny, nz] = image.lattice.size;
  std::vector<bool> seen(image.phase.size(), false);
  std::int64_t count = 0;
  for (std::int64_t start = 0; start < nx * ny; ++start)
  {
    std::vector<std::int64_t> open{ start };
    std::int64_t area = 0;
    while (!open.empty())
    {
      const std::int64_t node = open.back();
      open.pop_back();
      if (seen[static_cast<std::size_t>(node)] || image.phase[static_cast<std::size_t>(node)] != 0)
        continue;
      seen[static_cast<std::size_t>(node)] = true;
      ++area;
      const std::int64_t x = node % nx;
      if (x > 0)
        open.push_back(node - 1);
      if (x + 1 < nx)
        open.push_back(node + 1);
      if (node >= nx)
        open.push_back(node - nx);
      if (node + nx < nx * ny)
        open.push_back(node + nx);
    }
    count += area >= least;
  }
  return count;
}

/// A pixel of a picture n times coarser is lumen where at least half of its nodes are.
PhaseImage coarser(const PhaseImage& fine, std::int64_t n)
{
  const std::int64_t nx = fine.lattice.size[0] / n;
  const std::int64_t ny = fine.lattice.size[1] / n;
  PhaseImage image{ makeLattice(nx, ny, 1, 2, fine.lattice.spacing * static_cast<double>(n)), {}, fine.phases };
  for (std::int64_t node = 0; node < nx * ny; ++node)
  {
    std::int64_t wall = 0;
    for (std::int64_t k = 0; k < n * n; ++k)
      wall += fine.phase[fine.lattice.index(node % nx * n + k % n, node / nx * n + k / n)];
    image.phase.push_back(2 * wall > n * n ? 1 : 0);
  }
  return image;
}

} // namespace

TEST(Segmentation, FindsTheTissueInAScan)
{
  const PhaseImage truth = tissue();
  // The 3 × 3 lens rounds corners: a perfect threshold of the blurred picture agrees to 0.98.
  const Segmentation result = segment(scanOf(truth, {}));
  EXPECT_GT(agreement(result.image, truth), 0.97);
  EXPECT_TRUE(result.report.brightLumen);
  EXPECT_EQ(result.report.channel, "grey");
  EXPECT_EQ(result.image.phases.names(), (std::vector<std::string>{ "lumen", "wall" }));
  EXPECT_EQ(result.image.lattice.spacing, truth.lattice.spacing);
  EXPECT_NEAR(result.report.lumenFraction, 0.60, 0.02);
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_EQ(result.report.lines().size(), 8U); // no rim, no ray, no vessels: nothing said of them
  EXPECT_EQ(result.report.rim, 0);
  EXPECT_EQ(result.report.rays, 0); // the ray cells are whole
  EXPECT_TRUE(result.marks.empty());
}

TEST(Segmentation, UnevenLightDoesNotMatter)
{
  const PhaseImage truth = tissue();
  Scan scan;
  scan.wall = 130;
  scan.shading = 0.55; // lumens in the corners are as dark as walls in the middle
  const Picture picture = scanOf(truth, scan);
  const Segmentation result = segment(picture);
  EXPECT_GT(agreement(result.image, truth), 0.95);
  EXPECT_GT(result.report.unevenness, 0.5);
  SegmentOptions even;
  even.background = 0;
  EXPECT_LT(agreement(segment(picture, even).image, truth), 0.93); // the same without flattening
}

TEST(Segmentation, NoiseIsSmoothedAndSpecksAreCleaned)
{
  const PhaseImage truth = tissue();
  Scan scan;
  scan.noise = 25;
  const Segmentation result = segment(scanOf(truth, scan));
  EXPECT_GT(agreement(result.image, truth), 0.93);
  EXPECT_GT(result.report.smoothing, 0);
  EXPECT_NEAR(result.report.noise, 25.0 / 130, 0.05);
}

TEST(Segmentation, DarkLumensAreTold)
{
  const PhaseImage truth = tissue();
  Scan scan;
  std::swap(scan.lumen, scan.wall);
  const Picture picture = scanOf(truth, scan);
  const Segmentation result = segment(picture);
  EXPECT_FALSE(result.report.brightLumen);
  EXPECT_GT(agreement(result.image, truth), 0.97);
  SegmentOptions options;
  options.lumen = LumenSide::Bright;
  EXPECT_TRUE(segment(picture, options).report.brightLumen);
  EXPECT_LT(agreement(segment(picture, options).image, truth), 0.2);
}

TEST(Segmentation, TakesTheChannelOfTheBestContrast)
{
  const PhaseImage truth = tissue();
  Scan scan;
  scan.stain = { 20, 140, 60 }; // as safranin does
  scan.noise = 12;
  const Segmentation result = segment(scanOf(truth, scan));
  EXPECT_EQ(result.report.channel, "green");
  EXPECT_GT(agreement(result.image, truth), 0.94);
}

TEST(Segmentation, SixteenBitsGiveTheSame)
{
  const PhaseImage truth = tissue();
  Picture picture = scanOf(truth, {});
  const Segmentation shallow = segment(picture);
  picture.bits = 16;
  std::transform(picture.grey.begin(), picture.grey.end(), picture.grey.begin(),
    [](std::uint16_t v) { return static_cast<std::uint16_t>(16 * v); }); // a 12-bit camera
  EXPECT_GT(agreement(segment(picture).image, shallow.image), 0.99);
}

TEST(Segmentation, OptionsAreObeyed)
{
  const PhaseImage truth = tissue();
  const Picture picture = scanOf(truth, {});
  SegmentOptions options;
  options.grow = 2;
  const double grown = segment(picture, options).report.lumenFraction;
  options.grow = -2;
  const double shrunk = segment(picture, options).report.lumenFraction;
  const double plain = segment(picture).report.lumenFraction;
  EXPECT_GT(grown, plain + 0.05);
  EXPECT_LT(shrunk, plain - 0.05);
  options = {};
  options.threshold = 100;
  EXPECT_EQ(segment(picture, options).report.threshold, 100);
  options = {};
  options.smallestLumen = 100000000;
  const Segmentation nothing = segment(picture, options);
  EXPECT_EQ(nothing.report.lumenFraction, 0);
  ASSERT_FALSE(nothing.warnings.empty());
  EXPECT_NE(nothing.warnings.back().find("no lumen"), std::string::npos);
  options.smallestLumen = 0;
  options.smallestWall = 0;
  const Segmentation raw = segment(picture, options);
  EXPECT_EQ(raw.report.nodesChanged, 0);
}

TEST(Segmentation, RefusesWhatCannotBe)
{
  Picture picture;
  picture.lattice = makeLattice(4, 4, 1, 2, 1);
  picture.grey.assign(16, 77);
  const auto [what, hint] = lamella::testing::refusal<InputError>([&] { (void)segment(picture); });
  EXPECT_NE(what.find("one single grey, 77"), std::string::npos) << what;
  picture.grey[0] = 3;
  SegmentOptions options;
  options.threshold = 300;
  EXPECT_THROW((void)segment(picture, options), ParameterError);
  options = {};
  options.smoothing = -1;
  EXPECT_THROW((void)segment(picture, options), ParameterError);
  options = {};
  options.background = std::nan("");
  EXPECT_THROW((void)segment(picture, options), ParameterError);
  options = {};
  options.smallestLumen = -5;
  EXPECT_THROW((void)segment(picture, options), ParameterError);
  picture.lattice = makeLattice(4, 2, 2, 3, 1);
  EXPECT_THROW((void)segment(picture), ParameterError);
}

TEST(Segmentation, TinyPicturesAreNoTrouble)
{
  for (const auto& [nx, ny] : { std::pair<std::int64_t, std::int64_t>{ 2, 1 }, { 1, 7 }, { 3, 3 }, { 5000, 1 } })
  {
    Picture picture;
    picture.lattice = makeLattice(nx, ny, 1, 2, 1);
    picture.grey.assign(static_cast<std::size_t>(nx * ny), 20);
    picture.grey.back() = 200;
    EXPECT_EQ(segment(picture).image.phase.size(), picture.grey.size());
  }
}

TEST(Segmentation, GeneratedMicrographsAreFoundAgain)
{
  // A tissue four times as fine as the picture, and as it is on the picture's own pixels.
  const auto softwood = [](std::int64_t width, std::int64_t height, double solid, double late, std::int64_t finer)
  {
    generators::SoftwoodOptions o;
    o.size = { width * finer, height * finer, 1 };
    o.spacing = 0.5e-6 / static_cast<double>(finer);
    o.solidFraction = solid;
    o.ringPosition0 = o.ringPosition1 = late;
    return generators::softwood(o);
  };
  const auto hardwood = [](std::int64_t finer)
  {
    generators::HardwoodOptions o;
    o.size = { 800 * finer, 600 * finer, 1 };
    o.spacing = 0.5e-6 / static_cast<double>(finer);
    return generators::hardwood(o);
  };
  struct Case
  {
    PhaseImage fine, truth;
    double least;
  };
  // Measured over six seeds: earlywood 0.984 to 0.994, poplar 0.980 to 0.987, latewood 0.968 to 0.976. Its lumens are
  // six pixels wide: a pixel in four is at an outline.
  const std::array cases{ Case{ softwood(500, 400, 0.4, 0, 4), softwood(500, 400, 0.4, 0, 1), 0.98 },
    Case{ softwood(384, 364, 0.78, 1, 4), softwood(384, 364, 0.78, 1, 1), 0.97 },
    Case{ hardwood(4), hardwood(1), 0.975 } };
  for (std::size_t which = 0; which < cases.size(); ++which)
  {
    const auto& [fine, truth, least] = cases[which];
    for (const auto stain : { generators::Stain::Magenta, generators::Stain::Blue, generators::Stain::Grey })
    {
      generators::LookOptions look;
      look.stain = stain;
      look.dirt = 20;
      const Segmentation result = segment(generators::makeLook(fine, 4, look));
      EXPECT_GT(agreement(result.image, truth), least) << which << ' ' << static_cast<int>(stain);
      // No bias: what is left is pixels that fall in or out at random.
      double walls = 0;
      for (const std::uint8_t id : truth.phase)
        walls += id != 0;
      walls /= static_cast<double>(truth.phase.size());
      EXPECT_NEAR(1 - result.report.lumenFraction, walls, which == 2 ? 0.012 : 0.004) << which;
      EXPECT_EQ(result.report.brightLumen, stain != generators::Stain::Grey);
      EXPECT_EQ(result.report.vesselsFound, which == 2);
      EXPECT_EQ(result.report.rays, 0); // whole cells
    }
  }
}

// A line that is too faint to be seen once it is blurred still takes half a pixel from every lumen; what cannot be seen
// cannot be found.
TEST(Segmentation, AFaintLineAlongTheEdgesCostsLittle)
{
  generators::SoftwoodOptions softwood;
  softwood.size = { 1200, 1000, 1 };
  softwood.spacing = 0.25e-6;
  const PhaseImage tissue = generators::softwood(softwood);
  generators::LookOptions look;
  look.rim = 0.4;
  const Picture picture = generators::makeLook(tissue, 2, look);
  const PhaseImage truth = coarser(tissue, 2);
  const Segmentation result = segment(picture);
  EXPECT_GT(agreement(result.image, truth), 0.95);
  EXPECT_EQ(result.report.rim, 0);          // nor is the middle lamella one, though it is the darkest
  EXPECT_FALSE(result.report.vesselsFound); // nor are cells of rays vessels, though they are long
  SegmentOptions options;
  options.rim = 0.5; // told, it is put right
  EXPECT_GT(agreement(segment(picture, options).image, truth), 0.98);
}

TEST(Segmentation, AgreesWithAnExpertOnARealScan)
{
  const char* const data = std::getenv("LAMELLA_REAL_DATA");
  if (data == nullptr)
    GTEST_SKIP() << "LAMELLA_REAL_DATA is not set";
  ReadOptions read;
  read.keepColour = true;
  const Picture picture = readPicture(std::filesystem::path(data) / "conifer_roxas_scan.jpg", read);
  const Picture mask = readPicture(std::filesystem::path(data) / "conifer_roxas_lumen_mask.png");
  std::vector<bool> lumen(mask.grey.size());
  std::transform(mask.grey.begin(), mask.grey.end(), lumen.begin(), [](std::uint16_t v) { return v > 127; });
  const Segmentation result = segment(picture);
  // What the issue asks for; the measured agreement is 0.958. A threshold alone reaches 0.886.
  EXPECT_GT(agreement(result.image, lumen), 0.95);
  PhaseImage expert = result.image;
  std::transform(lumen.begin(), lumen.end(), expert.phase.begin(), [](bool inside) { return inside ? 0 : 1; });
  const auto count = static_cast<double>(lumensOf(expert, 100));
  EXPECT_EQ(count, 236);
  EXPECT_NEAR(static_cast<double>(lumensOf(result.image, 100)), count, 0.05 * count);
  EXPECT_GT(result.report.rimDepth, 0.3); // dark rims, most of all in red
  EXPECT_EQ(result.report.rimChannel, "red");
  EXPECT_NEAR(result.report.rim, 1.2, 0.2); // half the thickness of the dark line
  EXPECT_NEAR(static_cast<double>(result.report.rays), 9, 1);
  EXPECT_FALSE(result.report.vesselsFound); // softwood has none

  // What each step is worth.
  SegmentOptions plain;
  plain.rim = 0;
  plain.opening = 0;
  plain.raySlenderness = 0;
  EXPECT_LT(agreement(segment(picture, plain).image, lumen), 0.90);
  // The same from its grey alone.
  Picture grey = picture;
  grey.colour.clear();
  EXPECT_GT(agreement(segment(grey).image, lumen), 0.95);
}
