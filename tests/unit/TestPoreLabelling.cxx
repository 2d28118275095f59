// Pores of pictures and volumes: against a flood fill node by node, and shapes whose pores are known.
#include "PoreImages.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>

namespace
{

using namespace lamella;
using namespace lamella::pores;
using test::drawn;
using test::noise;
using test::PoreImage;

struct Answer
{
  std::vector<Pore> pores;
  std::vector<std::int32_t> labels;
  std::vector<float> sizes;
  PoreSummary summary;
};

Answer answer(const PoreImage& image, const LabelOptions& options, std::uint8_t wanted = 0)
{
  const PoreLabelling labelling(image.lattice, Communicator(), image.phase, wanted, options);
  Answer result{ { labelling.pores().begin(), labelling.pores().end() },
    std::vector<std::int32_t>(image.phase.size(), -1), std::vector<float>(image.phase.size(), -1),
    labelling.summary() };
  labelling.labels(result.labels);
  labelling.sizes(result.sizes);
  return result;
}

const ForEach threads = [](int count, const std::function<void(int)>& body)
{
  std::vector<std::thread> all;
  for (int i = 0; i < count; ++i)
    all.emplace_back(body, i);
  for (std::thread& thread : all)
    thread.join();
};

void expectSame(const Pore& found, const Pore& expected, const std::string& what)
{
  EXPECT_EQ(found.size, expected.size) << what;
  EXPECT_EQ(found.first, expected.first) << what;
  EXPECT_EQ(found.low, expected.low) << what;
  EXPECT_EQ(found.high, expected.high) << what;
  EXPECT_EQ(int{ found.touches }, int{ expected.touches }) << what;
  EXPECT_EQ(int{ found.percolates }, int{ expected.percolates }) << what;
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_DOUBLE_EQ(found.centre[axis], expected.centre[axis]) << what << " along " << axis;
}

void compare(const PoreImage& image, const LabelOptions& options, std::uint8_t wanted, const std::string& what)
{
  const test::Flooded expected = test::flood(image, wanted, options);
  const Answer found = answer(image, options, wanted);
  ASSERT_EQ(found.labels, expected.labels) << what;
  ASSERT_EQ(found.pores.size(), expected.pores.size()) << what;
  std::int64_t total = 0;
  for (std::size_t i = 0; i < expected.pores.size(); ++i)
  {
    expectSame(found.pores[i], expected.pores[i], what + ", pore " + std::to_string(i + 1));
    total += expected.pores[i].size;
  }
  for (std::size_t i = 0; i < found.sizes.size(); ++i)
  {
    const std::int32_t label = found.labels[i];
    ASSERT_TRUE(label == 0
        ? std::isnan(found.sizes[i])
        : found.sizes[i] == static_cast<float>(expected.pores[static_cast<std::size_t>(label - 1)].size))
      << what;
  }
  EXPECT_EQ(found.summary.count, static_cast<std::int64_t>(expected.pores.size())) << what;
  EXPECT_EQ(found.summary.total, total) << what;
  EXPECT_EQ(found.summary.phaseNodes, std::count(image.phase.begin(), image.phase.end(), wanted)) << what;
  EXPECT_EQ(found.summary.phaseNodes - found.summary.droppedNodes, total) << what;
}

std::string text(const PoreImage& image, const LabelOptions& options, int wanted)
{
  std::string words;
  for (std::size_t axis = 0; axis < 3; ++axis)
    words += std::to_string(image.lattice.size[axis]) + (options.periodic[axis] ? "p " : " ");
  return words + "connectivity " + std::to_string(options.connectivity) + ", slabs " + std::to_string(options.slabs) +
    ", from " + std::to_string(options.minimumSize) + ", phase " + std::to_string(wanted);
}

// Widths around the words of 64 nodes, one-layered boxes, every connectivity, periodic axes, phase, order.
TEST(PoreLabelling, IsTheFloodFillNodeByNode)
{
  const std::vector<std::array<std::int64_t, 3>> pictures{ { 1, 1, 1 }, { 1, 17, 1 }, { 23, 1, 1 }, { 2, 2, 1 },
    { 3, 5, 1 }, { 63, 9, 1 }, { 64, 11, 1 }, { 65, 10, 1 }, { 130, 21, 1 } };
  const std::vector<std::array<std::int64_t, 3>> volumes{ { 1, 1, 3 }, { 2, 1, 2 }, { 5, 4, 3 }, { 9, 8, 7 },
    { 66, 5, 4 }, { 1, 6, 9 } };
  unsigned seed = 1;
  for (const int dimension : { 2, 3 })
  {
    for (const auto& size : dimension == 2 ? pictures : volumes)
    {
      for (const double porosity : { 0.15, 0.35, 0.6, 0.9 })
      {
        const PoreImage image = noise(size, dimension, porosity, ++seed);
        for (const int connectivity : dimension == 2 ? std::vector<int>{ 4, 8 } : std::vector<int>{ 6, 18, 26 })
        {
          for (unsigned axes = 0; axes < (dimension == 2 ? 4U : 8U); ++axes)
          {
            LabelOptions options;
            options.connectivity = connectivity;
            options.periodic = { (axes & 1U) != 0, (axes & 2U) != 0, (axes & 4U) != 0 };
            options.slabs = 1 + static_cast<int>((seed + axes) % 4);
            options.sortBySize = (seed + axes) % 2 == 0;
            options.minimumSize = (seed + axes) % 3 == 0 ? 3 : 1;
            const auto wanted = static_cast<std::uint8_t>(axes % 3);
            compare(image, options, wanted, text(image, options, wanted));
          }
        }
      }
    }
  }
}

TEST(PoreLabelling, DoesNotDependOnThreads)
{
  for (const int dimension : { 2, 3 })
  {
    const PoreImage image = dimension == 2 ? noise({ 200, 90, 1 }, 2, 0.55, 7) : noise({ 70, 20, 16 }, 3, 0.3, 8);
    LabelOptions options;
    options.connectivity = dimension == 2 ? 8 : 26;
    options.periodic = { true, false, dimension == 3 };
    const Answer alone = answer(image, options);
    for (const int slabs : { 2, 3, 5, 64, 1000 })
    {
      options.slabs = slabs;
      options.forEach = slabs > 64 ? ForEach() : threads;
      const Answer found = answer(image, options);
      EXPECT_EQ(found.labels, alone.labels) << slabs;
      ASSERT_EQ(found.pores.size(), alone.pores.size()) << slabs;
      for (std::size_t i = 0; i < found.pores.size(); ++i)
        expectSame(found.pores[i], alone.pores[i], std::to_string(slabs) + " slabs");
    }
  }
}

TEST(PoreLabelling, CheckerboardIsOnePoreOverCorners)
{
  for (const std::int64_t n : { 8, 64, 130 })
  {
    PoreImage image{ makeLattice(n, n, 1, 2, 1), {} };
    for (std::int64_t i = 0; i < n * n; ++i)
      image.phase.push_back(static_cast<std::uint8_t>((i % n + i / n) % 2));
    LabelOptions options;
    const Answer sides = answer(image, options);
    EXPECT_EQ(sides.summary.count, n * n / 2);
    EXPECT_EQ(sides.summary.largest, 1);
    options.connectivity = 8;
    const Answer corners = answer(image, options);
    EXPECT_EQ(corners.summary.count, 1);
    EXPECT_EQ(corners.summary.largest, n * n / 2);
    EXPECT_EQ(int{ corners.summary.percolates }, 3);
  }
}

TEST(PoreLabelling, CornersMeetOverTheEndsOfPeriodicAxes)
{
  const PoreImage image = drawn({ "####", //
    ".###",                               //
    "###.",                               //
    "####" });
  LabelOptions options;
  options.connectivity = 8;
  EXPECT_EQ(answer(image, options).summary.count, 2);
  options.periodic[0] = true;
  const Answer joined = answer(image, options);
  ASSERT_EQ(joined.summary.count, 1);
  EXPECT_EQ(joined.pores[0].low, (std::array<std::int32_t, 3>{ 3, 1, 0 }));
  EXPECT_EQ(joined.pores[0].high, (std::array<std::int32_t, 3>{ 4, 2, 0 })); // goes on over the side
  EXPECT_DOUBLE_EQ(joined.pores[0].centre[0], -0.5);                         // half way between columns 3 and 4, or 0
  EXPECT_EQ(int{ joined.pores[0].percolates }, 0);
  options.connectivity = 4;
  EXPECT_EQ(answer(image, options).summary.count, 2);
}

TEST(PoreLabelling, APoreAcrossThePeriodicSideIsPutTogetherForItsCentre)
{
  const PoreImage image = drawn({ "..######.." });
  LabelOptions options;
  options.periodic[0] = true;
  const Answer found = answer(image, options);
  ASSERT_EQ(found.summary.count, 1);
  EXPECT_DOUBLE_EQ(found.pores[0].centre[0], -0.5);
  EXPECT_EQ(found.pores[0].low[0], 8);
  EXPECT_EQ(found.pores[0].high[0], 11);
  EXPECT_EQ(int{ found.pores[0].percolates & 1 }, 0);
}

TEST(PoreLabelling, AHelixPercolatesAlongBothAxes)
{
  // One row down every time it goes round: meets itself a period further along x and y.
  const PoreImage image = drawn({ ".###", //
    "#.##",                               //
    "##.#",                               //
    "###." });
  LabelOptions options;
  options.connectivity = 8;
  EXPECT_EQ(int{ answer(image, options).pores[0].percolates }, 3); // corner to corner
  options.periodic = { true, true, false };
  const Answer found = answer(image, options);
  ASSERT_EQ(found.summary.count, 1);
  EXPECT_EQ(int{ found.pores[0].percolates }, 3);
  EXPECT_DOUBLE_EQ(found.pores[0].centre[0], 1.5);
  options.periodic = { true, false, false };
  EXPECT_EQ(int{ answer(image, options).pores[0].percolates }, 2); // from top to bottom, but it never closes along x
}

TEST(PoreLabelling, ShapesThatUniteLate)
{
  // A comb whose teeth meet in the last row in memory, U shapes within each other, a spiral.
  const PoreImage comb = drawn({ ".............", ".#.#.#.#.#.#.", ".#.#.#.#.#.#.", ".#.#.#.#.#.#." });
  EXPECT_EQ(answer(comb, {}).summary.count, 1);
  EXPECT_EQ(answer(comb, {}).summary.largest, 13 + 3 * 7);
  const PoreImage nested = drawn({ ".........", //
    ".#######.",                                //
    ".#.....#.",                                //
    ".#.###.#.",                                //
    ".#.#.#.#.",                                //
    ".#.###.#.",                                //
    ".#.....#.",                                //
    ".#######.",                                //
    "........." });
  const Answer rings = answer(nested, {});
  ASSERT_EQ(rings.summary.count, 3);
  EXPECT_EQ(rings.pores[0].size, 32);
  EXPECT_EQ(rings.pores[1].size, 16);
  EXPECT_EQ(rings.pores[2].size, 1);
  const PoreImage spiral = drawn({ ".......", //
    "######.",                                //
    ".....#.",                                //
    ".###.#.",                                //
    ".#...#.",                                //
    ".#####.",                                //
    "......." });
  EXPECT_EQ(answer(spiral, {}).summary.count, 1);
  // The widest comb there is room for: every tooth is a run of its own until the last row.
  std::vector<std::string> rows(40, std::string(1000, '.'));
  for (std::size_t y = 1; y < rows.size(); ++y)
    for (std::size_t x = 1; x < rows[y].size(); x += 2)
      rows[y][x] = '#';
  EXPECT_EQ(answer(drawn(rows), {}).summary.count, 1);
}

TEST(PoreLabelling, OrderOfTheLabels)
{
  LabelOptions options;
  const PoreImage row = drawn({ ".#...#..#." });
  const Answer bySize = answer(row, options);
  EXPECT_EQ(bySize.labels, (std::vector<std::int32_t>{ 3, 0, 1, 1, 1, 0, 2, 2, 0, 4 }));
  options.sortBySize = false;
  EXPECT_EQ(answer(row, options).labels, (std::vector<std::int32_t>{ 1, 0, 2, 2, 2, 0, 3, 3, 0, 4 }));
  options.minimumSize = 2;
  const Answer some = answer(row, options);
  EXPECT_EQ(some.labels, (std::vector<std::int32_t>{ 0, 0, 1, 1, 1, 0, 2, 2, 0, 0 }));
  EXPECT_EQ(some.summary.dropped, 2);
  EXPECT_EQ(some.summary.droppedNodes, 2);
  EXPECT_EQ(some.summary.largestDropped, 1);
  EXPECT_DOUBLE_EQ(some.summary.mean(), 2.5);
}

// Small sizes are counted into place and large ones sorted: both in one picture, each size several times.
TEST(PoreLabelling, LargeAndSmallPoresAreNumberedTogether)
{
  constexpr std::int64_t n = 512;
  constexpr std::int64_t tile = 128;
  constexpr std::array<std::int64_t, 4> sides{ 30, 95, 110, 95 }; // 95 x 95 and 110 x 110 are beyond 8192
  PoreImage image{ makeLattice(n, n, 1, 2, 1), std::vector<std::uint8_t>(n * n, 1) };
  for (std::int64_t y = 0; y < n; ++y)
    for (std::int64_t x = 0; x < n; ++x)
    {
      const std::int64_t side = sides[static_cast<std::size_t>((x / tile + 3 * (y / tile)) % 4)];
      const bool square = x % tile < side && y % tile < side;
      const bool single = x % tile > side && y % tile > side && x % 3 == 0 && y % 2 == 0;
      const bool pair = x % tile > side && y % tile < side && x % 3 != 0 && y % 2 == 0;
      if (square || single || pair)
        image.phase[static_cast<std::size_t>(image.lattice.index(x, y))] = 0;
    }
  for (const std::int64_t least : { 1, 2, 9000, 10000 })
    for (const int slabs : { 1, 3 })
    {
      LabelOptions options;
      options.minimumSize = least;
      options.slabs = slabs;
      compare(image, options, 0, "at least " + std::to_string(least) + " in slabs: " + std::to_string(slabs));
    }
}

TEST(PoreLabelling, OpenAndClosedPores)
{
  const PoreImage image = drawn({ "#####", //
    "#.#.#",                               //
    "###.#",                               //
    "###.#" });
  LabelOptions options;
  const Answer found = answer(image, options);
  EXPECT_EQ(found.summary.touching, 1);
  EXPECT_EQ(found.summary.openNodes, 3);
  EXPECT_EQ(int{ found.pores[0].touches }, 4); // y = 0, which is the bottom row
  options.periodic[1] = true;                  // that side is no border any more
  EXPECT_EQ(answer(image, options).summary.touching, 0);
}

TEST(PoreLabelling, AbsentPhaseAndDroppedPoresAreCountedAsNothing)
{
  const PoreImage image = drawn({ "##", "##" });
  const Answer none = answer(image, {});
  EXPECT_EQ(none.summary.count, 0);
  EXPECT_EQ(none.summary.phaseNodes, 0);
  EXPECT_EQ(none.summary.mean(), 0);
  EXPECT_EQ(none.labels, std::vector<std::int32_t>(4, 0));
  EXPECT_TRUE(sizeDistribution(none.pores).empty());
}

TEST(PoreLabelling, RefusesInWords)
{
  const PoreImage picture = drawn({ ".#.#.#." });
  const auto refused = [&](const LabelOptions& options)
  {
    try
    {
      (void)answer(picture, options);
    }
    catch (const Error& error)
    {
      return std::string(error.what()) + " | " + error.hint();
    }
    return std::string();
  };
  LabelOptions options;
  options.connectivity = 6;
  EXPECT_EQ(refused(options), "connectivity 6 does not fit a picture | use 4 (sides) or 8 (and corners)");
  options.connectivity = 4;
  options.minimumSize = -2;
  EXPECT_NE(refused(options).find("a minimum size of -2 is below 0"), std::string::npos);
  options.minimumSize = 1;
  options.mostLabels = 3;
  EXPECT_EQ(refused(options),
    "there are 4 pores; 3 can be told apart by their labels | give a minimum size, which leaves the smallest out, or "
    "cut out a part of the image");
  options.mostLabels = 4;
  EXPECT_EQ(refused(options), "");
  options.progress = [](double) { return false; };
  EXPECT_EQ(refused(options).substr(0, 11), "interrupted");
  for (const int connectivity : { 4, 6, 8, 18, 26, 0, 5 })
  {
    EXPECT_EQ(fits(connectivity, 2), connectivity == 4 || connectivity == 8);
    EXPECT_EQ(fits(connectivity, 3), connectivity == 6 || connectivity == 18 || connectivity == 26);
  }
}

TEST(SizeDistribution, ClassesDouble)
{
  std::vector<Pore> pores;
  for (const std::int64_t size : { 2, 3, 4, 7, 7, 30 })
    pores.push_back({ size, 0, {}, {}, {}, 0, 0 });
  const std::vector<SizeClass> classes = sizeDistribution(pores);
  ASSERT_EQ(classes.size(), 4U);
  const std::vector<std::array<std::int64_t, 4>> expected{ { 2, 3, 2, 5 }, { 4, 7, 3, 18 }, { 8, 15, 0, 0 },
    { 16, 31, 1, 30 } };
  for (std::size_t i = 0; i < classes.size(); ++i)
    EXPECT_EQ((std::array{ classes[i].low, classes[i].high, classes[i].count, classes[i].nodes }), expected[i]);
}

TEST(EquivalentDiameter, OfACircleAndASphere)
{
  EXPECT_DOUBLE_EQ(equivalentDiameter(std::numbers::pi * 25, 2e-6, 2), 20e-6);            // radius 5 nodes
  EXPECT_DOUBLE_EQ(equivalentDiameter(4.0 / 3 * std::numbers::pi * 125, 2e-6, 3), 20e-6); // the same
}

} // namespace
