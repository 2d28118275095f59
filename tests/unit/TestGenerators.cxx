#include "Support.h"

#include "generators/Generators.h"
#include "generators/Selection.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

using namespace lamella;
using namespace lamella::generators;
using lamella::testing::hashOf;
using lamella::testing::Piece;
using lamella::testing::piecesOf;
using lamella::testing::refusal;

namespace
{

constexpr std::uint8_t lumen = 0;
constexpr std::uint8_t wall = 1;

SoftwoodOptions flat(std::int64_t nx, std::int64_t ny, double fraction, double ring0, double ring1)
{
  SoftwoodOptions options;
  options.size = { nx, ny, 1 };
  options.solidFraction = fraction;
  options.ringPosition0 = ring0;
  options.ringPosition1 = ring1;
  return options;
}

SoftwoodOptions solid(std::int64_t n, double fraction)
{
  SoftwoodOptions options;
  options.dimension = 3;
  options.size = { n, n, n };
  options.solidFraction = fraction;
  options.tracheidLength = 90e-6; // short, so that a small box holds whole ones
  return options;
}

std::int64_t nodesOf(const PhaseImage& image, std::uint8_t phase)
{
  return std::count(image.phase.begin(), image.phase.end(), phase);
}

/// The largest piece of wall holds all wall but what the box's border cuts off.
void expectConnectedWalls(const PhaseImage& image)
{
  const auto pieces = piecesOf(image, wall, false);
  ASSERT_FALSE(pieces.empty());
  const auto largest =
    std::max_element(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.nodes < b.nodes; });
  EXPECT_GT(static_cast<double>(largest->nodes), 0.99 * static_cast<double>(nodesOf(image, wall)));
  for (const Piece& piece : pieces)
    EXPECT_TRUE(piece.nodes == largest->nodes || piece.atBorder) << piece.nodes << " nodes of wall float in a lumen";
}

/// Median length of the runs of a phase along rows, over the columns from x0 to x1.
std::int64_t medianRun(const PhaseImage& image, std::uint8_t phase, std::int64_t x0, std::int64_t x1)
{
  std::vector<std::int64_t> runs;
  for (std::int64_t y = 0; y < image.lattice.size[1]; ++y)
  {
    std::int64_t length = 0;
    bool whole = false; // the run started inside
    for (std::int64_t x = x0; x < x1; ++x)
    {
      if (image.phase[image.lattice.index(x, y)] == phase)
      {
        ++length;
      }
      else
      {
        if (whole && length > 0)
          runs.push_back(length);
        whole = true;
        length = 0;
      }
    }
  }
  std::nth_element(runs.begin(), runs.begin() + runs.size() / 2, runs.end());
  return runs.at(runs.size() / 2);
}

} // namespace

TEST(Selection, MarksAsManyAsAskedFor)
{
  const std::vector<float> keys{ 3, 1, 2, 1, 0, 1e-30F, 7e20F };
  EXPECT_EQ(markSmallest(keys, 0), (std::vector<std::uint8_t>{ 0, 0, 0, 0, 0, 0, 0 }));
  EXPECT_EQ(markSmallest(keys, 3), (std::vector<std::uint8_t>{ 0, 1, 0, 0, 1, 1, 0 })); // the first of two equal ones
  EXPECT_EQ(markSmallest(keys, 6), (std::vector<std::uint8_t>{ 1, 1, 1, 1, 1, 1, 0 }));
  EXPECT_EQ(markSmallest(keys, 7), (std::vector<std::uint8_t>{ 1, 1, 1, 1, 1, 1, 1 }));
}

TEST(Softwood, MeetsTheSolidFractionToHalfANode)
{
  for (const double fraction : { 0.12, 0.40, 0.61, 0.78, 0.95 })
  {
    for (const double ring : { 0.0, 1.0 })
    {
      const PhaseImage image = softwood(flat(203, 187, fraction, ring, ring));
      const double nodes = static_cast<double>(image.lattice.count());
      EXPECT_LE(std::abs(static_cast<double>(nodesOf(image, wall)) - fraction * nodes), 0.5) << fraction << " " << ring;
      EXPECT_EQ(image.phases.names(), (std::vector<std::string>{ "lumen", "wall" }));
    }
  }
  SoftwoodOptions thin = flat(400, 400, 0.05, 0, 0);
  thin.spacing = 0.4e-6;
  EXPECT_EQ(nodesOf(softwood(thin), wall), 8000);
  for (const double fraction : { 0.2, 0.40, 0.78 })
  {
    const PhaseImage image = softwood(solid(64, fraction));
    EXPECT_LE(std::abs(static_cast<double>(nodesOf(image, wall)) - fraction * 64 * 64 * 64), 0.5) << fraction;
  }
}

TEST(Softwood, WallsAreConnectedAndLumensClosed)
{
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
  {
    for (const double fraction : { 0.15, 0.40, 0.78 })
    {
      SoftwoodOptions options = flat(300, 300, fraction, 0, seed % 2 == 0 ? 0.0 : 1.0);
      options.seed = seed;
      const PhaseImage image = softwood(options);
      SCOPED_TRACE(fmt::format("seed {}, fraction {}", seed, fraction));
      expectConnectedWalls(image);
      // Even through corners a lumen is no larger than one cell: a ray cell is 2.6 tracheids long on average, a
      // tracheid at most twice its mean diameter across.
      for (const Piece& piece : piecesOf(image, lumen, true))
      {
        EXPECT_LT(piece.extent(0), 2.6 * 36 * 2);
        EXPECT_LT(piece.extent(1), 2 * 30);
      }
    }
  }
}

TEST(Softwood, HasAsManyCellsAsTheDiametersSay)
{
  SoftwoodOptions options = flat(900, 900, 0.40, 0, 0);
  options.rayEvery = 0;
  const auto whole = piecesOf(softwood(options), lumen, false);
  // The border cuts cells in two, which adds about half of those along it; tips add 3.5 %, narrow files a few more.
  const double expected = 900.0 * 900.0 / (30.0 * 36.0) + 0.5 * (2 * 30 + 2 * 25);
  EXPECT_NEAR(static_cast<double>(whole.size()), expected * 1.06, 0.08 * expected);
}

TEST(Softwood, IsRegularWithoutScatter)
{
  SoftwoodOptions options = flat(420, 420, 0.40, 0, 0);
  options.rayEvery = 0;
  options.scatter = 0;
  std::vector<std::int64_t> areas;
  for (const Piece& piece : piecesOf(softwood(options), lumen, false))
    if (!piece.atBorder)
      areas.push_back(piece.nodes);
  const auto [least, most] = std::minmax_element(areas.begin(), areas.end());
  // A lumen's outline is some 90 nodes long; each may fall on either side.
  EXPECT_LT(*most - *least, 45);
}

TEST(Softwood, RadialDiametersScatterAsAskedFor)
{
  for (const double scatter : { 0.06, 0.12, 0.2 })
  {
    SoftwoodOptions options = flat(900, 900, 0.40, 0, 0);
    options.rayEvery = 0;
    options.scatter = scatter;
    double sum = 0;
    double squares = 0;
    double count = 0;
    for (const Piece& piece : piecesOf(softwood(options), lumen, false))
    {
      if (!piece.atBorder && piece.nodes > 150) // without the tips
      {
        const double length = static_cast<double>(piece.extent(0)); // the diameter less a wall of one thickness
        sum += length;
        squares += length * length;
        ++count;
      }
    }
    const double deviation = std::sqrt(squares / count - sum * sum / count / count);
    // Slanted walls add to it, the least distance between two walls takes from it: a quarter either way.
    EXPECT_NEAR(deviation, scatter * 36, 0.25 * scatter * 36) << scatter;
  }
}

TEST(Softwood, RingRunsFromWideThinWalledToFlatThickWalledCells)
{
  const PhaseImage ring = softwood(flat(1000, 500, 0.40, 0, 1));
  const std::int64_t earlyLumen = medianRun(ring, lumen, 0, 250);
  const std::int64_t lateLumen = medianRun(ring, lumen, 850, 1000);
  const std::int64_t earlyWall = medianRun(ring, wall, 0, 250);
  const std::int64_t lateWall = medianRun(ring, wall, 850, 1000);
  EXPECT_GT(earlyLumen, 3 * lateLumen);
  EXPECT_GE(2 * lateWall, 3 * earlyWall);
  // Gradual: the solid fraction rises from fifth to fifth.
  double before = 0;
  for (std::int64_t part = 0; part < 5; ++part)
  {
    const PhaseImage piece = crop(ring, { { part * 200, 0, 0 }, { 200, 500, 0 } });
    EXPECT_GT(piece.fractions()[wall], before - 0.01);
    before = piece.fractions()[wall];
  }
}

TEST(Softwood, RaysRunAcrossTheFiles)
{
  // A ray's cells are long and low; without rays there are none such.
  const auto longCells = [](double rayEvery)
  {
    SoftwoodOptions options = flat(500, 500, 0.40, 0, 0);
    options.rayEvery = rayEvery;
    const auto pieces = piecesOf(softwood(options), lumen, false);
    return std::count_if(
      pieces.begin(), pieces.end(), [](const Piece& p) { return p.extent(0) > 60 && p.extent(0) > 5 * p.extent(1); });
  };
  EXPECT_EQ(longCells(0), 0);
  EXPECT_GE(longCells(240e-6), 8); // at least two rays of 500 / (2.6 × 36) cells
  // The default picture of 200 × 200 µm has a ray with every seed.
  for (std::uint64_t seed = 1; seed < 20; ++seed)
  {
    SoftwoodOptions options;
    options.seed = seed;
    const auto pieces = piecesOf(softwood(options), lumen, false);
    EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.extent(0) > 4 * p.extent(1); }))
      << seed;
  }
}

TEST(Softwood3D, TracheidsAreClosedAtBothEnds)
{
  for (const double fraction : { 0.25, 0.78 })
  {
    SoftwoodOptions options = solid(128, fraction);
    options.tracheidLength = 70e-6;
    options.tangentialDiameter = 18e-6; // small cells, of which many lie whole inside
    options.radialDiameterEarly = 20e-6;
    options.rayEvery = 150e-6;
    const PhaseImage image = softwood(options);
    expectConnectedWalls(image);
    std::int64_t whole = 0;
    for (const Piece& piece : piecesOf(image, lumen, true))
    {
      EXPECT_LT(piece.extent(0), 128);
      EXPECT_LT(piece.extent(1), 2 * 30);
      // At most 1.3 mean lengths and the slope of one end over a wide cell's 50 nodes: no lumen is open from end to
      // end.
      EXPECT_LT(piece.extent(2), 1.3 * 70 + 0.7 * 50);
      whole += !piece.atBorder && piece.extent(2) > 35;
    }
    EXPECT_GE(whole, 3);
  }
}

TEST(Softwood3D, EndsAreStaggered)
{
  // The upper ends' heights as angles, one turn a tracheid: were they alike the mean vector would have length 1, and
  // for ends without order about 1/√(files).
  double cosines = 0;
  double sines = 0;
  double count = 0;
  for (const Piece& piece : piecesOf(softwood(solid(180, 0.40)), lumen, false))
  {
    if (piece.high[2] < 179 && piece.nodes > 2000)
    {
      const double angle = 2 * std::numbers::pi * static_cast<double>(piece.high[2]) / 90;
      cosines += std::cos(angle);
      sines += std::sin(angle);
      ++count;
    }
  }
  EXPECT_GT(count, 40);
  EXPECT_LT(std::hypot(cosines, sines) / count, 0.5);
}

TEST(Softwood, SameSeedSameBytes)
{
  // Pinned: another value means that every published sample has changed.
  EXPECT_EQ(hashOf(softwood({}).phase), 17439766886349910341ULL);
  EXPECT_EQ(hashOf(softwood(flat(211, 150, 0.78, 1, 1)).phase), 6352258808675759124ULL);
  EXPECT_EQ(hashOf(softwood(solid(48, 0.40)).phase), 10077695186081668398ULL);
  SoftwoodOptions other;
  other.seed = 2;
  EXPECT_NE(hashOf(softwood(other).phase), hashOf(softwood({}).phase));
}

TEST(Softwood, RefusesWhatCannotBe)
{
  const auto refuses = [](auto change)
  {
    SoftwoodOptions options;
    change(options);
    const auto [what, hint] = refusal<ParameterError>([&] { (void)softwood(options); });
    EXPECT_FALSE(what.empty());
    EXPECT_FALSE(hint.empty());
  };
  const double nan = std::nan("");
  refuses([](auto& o) { o.dimension = 1; });
  refuses([](auto& o) { o.size = { 0, 10, 1 }; });
  refuses([](auto& o) { o.size = { 10, 10, 10 }; });
  refuses([](auto& o) { o.spacing = 0; });
  refuses([&](auto& o) { o.spacing = nan; });
  refuses([](auto& o) { o.solidFraction = 0; });
  refuses([](auto& o) { o.solidFraction = 1; });
  refuses([&](auto& o) { o.solidFraction = nan; });
  refuses([](auto& o) { o.tangentialDiameter = -1; });
  refuses([](auto& o) { o.radialDiameterLate = 5e-6; });
  refuses([](auto& o) { o.ringPosition1 = 1.5; });
  refuses([](auto& o) { o.scatter = 0.5; });
  refuses([](auto& o) { o.rayEvery = 20e-6; });
  refuses(
    [](auto& o)
    {
      o.dimension = 3;
      o.size = { 9, 9, 9 };
      o.tracheidLength = 1e-6;
    });
}

TEST(Softwood, RefusesWallsTooThinToCloseAndItsHintHelps)
{
  SoftwoodOptions options = flat(200, 200, 0.05, 0, 0);
  const auto [what, hint] = refusal<ParameterError>([&] { (void)softwood(options); });
  EXPECT_NE(what.find("too little for closed walls"), std::string::npos) << what;
  const auto from = hint.find("spacing of ") + 11;
  const double spacing = std::strtod(hint.c_str() + from, nullptr);
  ASSERT_GT(spacing, 0.3e-6) << hint;
  ASSERT_LT(spacing, 1e-6) << hint;
  const double finer = options.spacing / spacing;
  options.spacing = spacing;
  options.size = { static_cast<std::int64_t>(200 * finer), static_cast<std::int64_t>(200 * finer), 1 };
  EXPECT_NO_THROW((void)softwood(options));
}

TEST(Honeycomb, MeetsTheFractionAndIsPeriodic)
{
  HoneycombOptions options;
  options.size = { 400, 346, 1 };
  for (const double fraction : { 0.1, 0.19, 0.40, 0.78 })
  {
    options.solidFraction = fraction;
    const PhaseImage image = honeycomb(options);
    EXPECT_LE(std::abs(static_cast<double>(nodesOf(image, wall)) - fraction * 400 * 346), 0.5);
    expectConnectedWalls(image);
    // Moved by one cell along x it is the same but for the nodes that equal distances leave to choose from.
    std::int64_t different = 0;
    for (std::int64_t y = 0; y < 346; ++y)
      for (std::int64_t x = 0; x < 400; ++x)
        different += image.phase[image.lattice.index(x, y)] != image.phase[image.lattice.index((x + 100) % 400, y)];
    EXPECT_LE(different, 64) << fraction;
  }
}

TEST(Honeycomb, WallsHaveTheThicknessThatTheFractionSays)
{
  // A regular hexagon of width w less a wall of thickness t: the lumen's share is (1 − t/w)².
  HoneycombOptions options;
  options.size = { 400, 346, 1 };
  const PhaseImage image = honeycomb(options);
  std::int64_t whole = 0;
  for (const Piece& piece : piecesOf(image, lumen, true))
  {
    if (!piece.atBorder)
    {
      ++whole;
      EXPECT_NEAR(static_cast<double>(piece.extent(0)), 100 * std::sqrt(0.6), 1.01);
    }
  }
  EXPECT_EQ(whole, 7); // two rows that the box does not cut, of 3 and 4 cells
}

TEST(Honeycomb, RunsAlongZIn3DAndRefusesTooFewNodes)
{
  HoneycombOptions options;
  options.size = { 60, 52, 3 };
  options.cellsAcross = 2;
  const PhaseImage image = honeycomb(options);
  EXPECT_EQ(image.lattice.dimension, 3);
  EXPECT_TRUE(std::equal(image.phase.begin(), image.phase.begin() + 60 * 52, image.phase.begin() + 2 * 60 * 52));
  options.cellsAcross = 30;
  EXPECT_THROW((void)honeycomb(options), ParameterError);
  options.cellsAcross = 0;
  EXPECT_THROW((void)honeycomb(options), ParameterError);
  options.cellsAcross = 8;
  options.solidFraction = 0.05;
  EXPECT_THROW((void)honeycomb(options), ParameterError);
}

TEST(Checkerboard, IsExact)
{
  const PhaseImage flatBoard = checkerboard(2, { 60, 40, 1 }, 1e-6, 4);
  EXPECT_EQ(flatBoard.fractions(), (std::vector<double>{ 0.5, 0.5 }));
  EXPECT_EQ(flatBoard.phase[flatBoard.lattice.index(14, 9)], 0);
  EXPECT_EQ(flatBoard.phase[flatBoard.lattice.index(15, 9)], 1);
  EXPECT_EQ(flatBoard.phase[flatBoard.lattice.index(15, 10)], 0);
  EXPECT_EQ(checkerboard(3, { 8, 8, 8 }, 1, 2).fractions(), (std::vector<double>{ 0.5, 0.5 }));
  const auto [what, hint] = refusal<ParameterError>([] { (void)checkerboard(2, { 200, 200, 1 }, 1, 3); });
  EXPECT_EQ(what, "200 nodes along x do not divide into 3 equal fields");
  EXPECT_EQ(hint, "take 198 or 201 nodes, or another number of fields");
}

TEST(InclusionArray, IsTheExactGeometryAtNodeCentres)
{
  // The error of counting centres falls faster than the perimeter over the nodes, here with a factor of safety.
  const PhaseImage disks = inclusionArray(2, { 512, 512, 1 }, 1, 0.5, 2);
  EXPECT_NEAR(disks.fractions()[1], 0.5, 0.002);
  const PhaseImage spheres = inclusionArray(3, { 96, 96, 96 }, 1, 0.3, 1);
  EXPECT_NEAR(spheres.fractions()[1], 0.3, 0.003);
  // Centred and symmetric.
  for (std::int64_t y = 0; y < 512; ++y)
  {
    for (std::int64_t x = 0; x < 512; ++x)
    {
      const std::uint8_t here = disks.phase[disks.lattice.index(x, y)];
      ASSERT_EQ(here, disks.phase[disks.lattice.index(511 - x, y)]);
      ASSERT_EQ(here, disks.phase[disks.lattice.index(y, x)]);
      ASSERT_EQ(here, disks.phase[disks.lattice.index((x + 256) % 512, y)]);
    }
  }
  EXPECT_EQ(disks.phase[disks.lattice.index(128, 128)], 1);
  EXPECT_EQ(disks.phase[disks.lattice.index(0, 0)], 0);
  EXPECT_EQ(inclusionArray(2, { 8, 8, 1 }, 1, 0, 1).fractions()[1], 0);
  EXPECT_THROW((void)inclusionArray(2, { 8, 8, 1 }, 1, 0.79, 1), ParameterError);
  EXPECT_THROW((void)inclusionArray(3, { 8, 8, 8 }, 1, 0.53, 1), ParameterError);
  EXPECT_THROW((void)inclusionArray(2, { 8, 9, 1 }, 1, 0.5, 1), ParameterError);
  EXPECT_THROW((void)inclusionArray(2, { 8, 8, 1 }, 1, -0.1, 1), ParameterError);
}

TEST(Laminate, HoldsTheFractionToHalfALayer)
{
  for (const double fraction : { 0.0, 0.1, 0.3, 0.5, 0.77, 1.0 })
  {
    for (const int periods : { 1, 3, 7 })
    {
      for (const int axis : { 0, 1, 2 })
      {
        const PhaseImage image = laminate(3, { 50, 50, 50 }, 1, axis, fraction, periods);
        EXPECT_LE(std::abs(image.fractions()[1] - fraction), 0.5 / 50 + 1e-12);
      }
    }
  }
  const PhaseImage layers = laminate(2, { 3, 8, 1 }, 1, 1, 0.5, 2);
  for (std::int64_t y = 0; y < 8; ++y)
    EXPECT_EQ(layers.phase[layers.lattice.index(1, y)], y % 4 >= 2);
  EXPECT_THROW((void)laminate(2, { 8, 8, 1 }, 1, 2, 0.5, 1), ParameterError);
  EXPECT_THROW((void)laminate(2, { 8, 8, 1 }, 1, 0, 1.5, 1), ParameterError);
  EXPECT_THROW((void)laminate(2, { 8, 8, 1 }, 1, 0, 0.5, 5), ParameterError);
}
