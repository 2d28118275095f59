#include "Support.h"

#include "generators/MicrographLook.h"

#include "generators/Generators.h"
#include "generators/LookParts.h"
#include "generators/Nearest.h"
#include "pictures/WritePicture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

using namespace lamella;
using namespace lamella::generators;
using lamella::testing::refusal;
using micrograph::Picture;

namespace
{

PhaseImage truthOf(std::int64_t pixels, int n)
{
  HardwoodOptions options;
  options.size = { pixels * n, pixels * n, 1 };
  options.spacing = 1e-6 / n;
  return hardwood(options);
}

/// Without anything that varies.
LookOptions plain(Stain stain)
{
  LookOptions o;
  o.stain = stain;
  o.cellVariation = o.wallVariation = o.lamella = o.rim = o.tint = 0;
  o.blur = o.noise = o.unevenLight = o.dirt = 0;
  return o;
}

std::uint64_t hashOf(const Picture& picture)
{
  std::vector<std::uint8_t> bytes;
  for (const auto* const values : { &picture.grey, &picture.colour })
    bytes.insert(bytes.end(), values->begin(), values->end());
  return lamella::testing::hashOf(bytes);
}

double mean(const std::vector<std::uint16_t>& values)
{
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Root mean square difference of neighbours along x.
double roughness(const Picture& picture)
{
  double sum = 0;
  for (std::size_t i = 1; i < picture.grey.size(); ++i)
  {
    const double d = static_cast<double>(picture.grey[i]) - picture.grey[i - 1];
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(picture.grey.size()));
}

} // namespace

TEST(Nearest, IsExact)
{
  constexpr std::int64_t nx = 37;
  constexpr std::int64_t ny = 29;
  const Random random(5);
  for (const double share : { 0.003, 0.05, 0.6 })
  {
    std::vector<std::uint8_t> marked(nx * ny);
    for (std::size_t i = 0; i < marked.size(); ++i)
      marked[i] = random.uniform(RandomUse::Noise, static_cast<std::int64_t>(i)) < share;
    const Nearest nearest = nearestMarked(marked, nx, ny);
    for (std::int64_t i = 0; i < nx * ny; ++i)
    {
      std::int64_t best = std::numeric_limits<std::int32_t>::max();
      for (std::int64_t k = 0; k < nx * ny; ++k)
      {
        const std::int64_t dx = k % nx - i % nx;
        const std::int64_t dy = k / nx - i / nx;
        best = marked[static_cast<std::size_t>(k)] != 0 ? std::min(best, dx * dx + dy * dy) : best;
      }
      const auto at = static_cast<std::size_t>(i);
      ASSERT_EQ(nearest.squared[at], best) << share;
      const std::int64_t to = nearest.node[at];
      ASSERT_TRUE(to >= 0 && marked[static_cast<std::size_t>(to)] != 0);
      const std::int64_t dx = to % nx - i % nx;
      const std::int64_t dy = to / nx - i / nx;
      ASSERT_EQ(dx * dx + dy * dy, best);
    }
  }
  const Nearest none = nearestMarked(std::vector<std::uint8_t>(12, 0), 4, 3);
  EXPECT_TRUE(std::all_of(none.node.begin(), none.node.end(), [](std::int32_t n) { return n == Nearest::none; }));
}

TEST(MicrographLook, DecayIsTheExponential)
{
  for (double x = 0; x < 30; x += 0.37)
    EXPECT_NEAR(decay(x), std::exp(-x), 1e-9);
  EXPECT_EQ(decay(1e6), 0);
}

TEST(MicrographLook, PixelsAreAreaFractionsOfLumen)
{
  // With one grey for lumen and one for wall a pixel lies between them by its share of lumen, and the mean of all
  // pixels tells the solid fraction, to the rounding of greys.
  const PhaseImage truth = truthOf(200, 4);
  for (const Stain stain : { Stain::Magenta, Stain::Blue, Stain::Grey })
  {
    const Picture picture = makeLook(truth, 4, plain(stain));
    EXPECT_EQ(picture.lattice.size, (std::array<std::int64_t, 3>{ 200, 200, 1 }));
    EXPECT_NEAR(picture.lattice.spacing, 1e-6, 1e-18);
    const bool grey = stain == Stain::Grey;
    EXPECT_EQ(picture.colour.empty(), grey);
    const auto [low, high] = std::minmax_element(picture.grey.begin(), picture.grey.end());
    const double share = (mean(picture.grey) - *low) / (*high - *low);
    EXPECT_NEAR(grey ? share : 1 - share, 0.38, 0.004);
    EXPECT_GT(*high - *low, 90); // walls are well seen
  }
}

TEST(MicrographLook, EachOptionDoesWhatItSays)
{
  const PhaseImage truth = truthOf(200, 2);
  const Picture none = makeLook(truth, 2, plain(Stain::Grey));
  const auto with = [&](auto change)
  {
    LookOptions o = plain(Stain::Grey);
    change(o);
    return makeLook(truth, 2, o);
  };
  EXPECT_LT(roughness(with([](auto& o) { o.blur = 1.5e-6; })), 0.6 * roughness(none));
  EXPECT_NEAR(mean(with([](auto& o) { o.blur = 1.5e-6; }).grey), mean(none.grey), 1); // light is kept
  EXPECT_GT(roughness(with([](auto& o) { o.noise = 0.1; })), 1.05 * roughness(none));
  EXPECT_NEAR(mean(with([](auto& o) { o.noise = 0.02; }).grey), mean(none.grey), 1);
  EXPECT_LT(mean(with([](auto& o) { o.unevenLight = 0.5; }).grey), 0.95 * mean(none.grey));
  EXPECT_GT(mean(with([](auto& o) { o.dirt = 500; }).grey), mean(none.grey) + 1);
  EXPECT_LT(mean(with([](auto& o) { o.tears = 500; }).grey), mean(none.grey) - 1);
  EXPECT_GT(mean(with([](auto& o) { o.rim = 0.5; }).grey), mean(none.grey) + 1);
  EXPECT_GT(mean(with([](auto& o) { o.lamella = 0.5; }).grey), mean(none.grey) + 0.5);
  EXPECT_GT(mean(with([](auto& o) { o.tint = 0.2; }).grey), mean(none.grey) + 5);
  EXPECT_LT(mean(with([](auto& o) { o.strength = 0.5; }).grey), mean(none.grey) - 5);
  for (const auto& varied :
    { with([](auto& o) { o.cellVariation = 0.3; }), with([](auto& o) { o.wallVariation = 0.3; }) })
  {
    EXPECT_NE(hashOf(varied), hashOf(none));
    EXPECT_NEAR(mean(varied.grey), mean(none.grey), 4);
  }
  const Picture bar = with([](auto& o) { o.scaleBar = 100e-6; });
  std::int64_t longest = 0;
  for (std::int64_t y = 0; y < 30; ++y)
  {
    std::int64_t run = 0;
    for (std::int64_t x = 0; x < 200; ++x)
    {
      run = bar.grey[static_cast<std::size_t>(x + 200 * y)] == 255 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  EXPECT_EQ(longest, 100); // pixels of 1 µm
}

TEST(MicrographLook, SameSeedSameBytes)
{
  const PhaseImage truth = truthOf(120, 3);
  LookOptions options;
  options.tears = 100;
  options.dirt = 100;
  // Pinned: another value means that every published picture has changed.
  EXPECT_EQ(hashOf(makeLook(truth, 3, options)), 9005202756214581137ULL);
  options.stain = Stain::Grey;
  EXPECT_EQ(hashOf(makeLook(truth, 3, options)), 6214858690243235207ULL);
  LookOptions other = options;
  other.seed = 2;
  EXPECT_NE(hashOf(makeLook(truth, 3, other)), hashOf(makeLook(truth, 3, options)));
}

TEST(MicrographLook, IsReadBackAsItWasWritten)
{
  const auto folder = std::filesystem::temp_directory_path() / "lamella_look";
  std::filesystem::create_directories(folder);
  for (const Stain stain : { Stain::Magenta, Stain::Grey })
  {
    LookOptions options;
    options.stain = stain;
    const Picture picture = makeLook(truthOf(60, 2), 2, options);
    const auto path = folder / "look.png";
    micrograph::writePicture(picture, path, "made for a test");
    micrograph::ReadOptions reading;
    reading.keepColour = true;
    const Picture back = micrograph::readPicture(path, reading);
    EXPECT_EQ(back.colour, picture.colour);
    EXPECT_EQ(back.lattice.size, picture.lattice.size);
    EXPECT_NEAR(back.lattice.spacing, picture.lattice.spacing, 1e-12);
    EXPECT_EQ(back.description, "made for a test");
    if (stain == Stain::Grey)
      EXPECT_EQ(back.grey, picture.grey);
  }
  const Picture picture = makeLook(truthOf(60, 1), 1, {});
  EXPECT_FALSE(refusal<ParameterError>([&] { micrograph::writePicture(picture, folder / "a.jpg"); }).second.empty());
  std::filesystem::remove_all(folder);
}

TEST(MicrographLook, RefusesWhatCannotBe)
{
  const PhaseImage truth = truthOf(60, 2);
  const auto refuses = [&](int n, auto change, const char* says)
  {
    LookOptions options;
    change(options);
    const auto [what, hint] = refusal<ParameterError>([&] { (void)makeLook(truth, n, options); });
    EXPECT_NE(what.find(says), std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos);
    EXPECT_FALSE(hint.empty());
  };
  const auto nothing = [](auto&) {};
  refuses(0, nothing, "pixels of 0");
  refuses(7, nothing, "pixels of 7");
  refuses(
    2, [](auto& o) { o.blur = -1; }, "blur of -1");
  refuses(
    2, [](auto& o) { o.blur = 1e-3; }, "blur of 0.001");
  refuses(
    2, [](auto& o) { o.noise = std::nan(""); }, "noise of nan");
  refuses(
    2, [](auto& o) { o.unevenLight = 1; }, "uneven light of 1");
  refuses(
    2, [](auto& o) { o.dirt = -3; }, "dirt of -3");
  refuses(
    2, [](auto& o) { o.tears = 1e9; }, "tears");
  refuses(
    2, [](auto& o) { o.strength = 0; }, "strength");
  refuses(
    2, [](auto& o) { o.scaleBar = 1; }, "scale bar of 1 m");
  refuses(
    2, [](auto& o) { o.scaleBar = 20e-6; }, "60 × 60 pixels");
  const auto [what, hint] = refusal<ParameterError>([&] { (void)makeLook(softwood({ 3, { 40, 40, 5 } }), 1); });
  EXPECT_NE(what.find("volume"), std::string::npos);
}
