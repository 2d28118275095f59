// Odd boxes, large contrasts, and what must be refused.
#include "Diffusion.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace
{

using namespace lamella;
using namespace lamella::test;

TEST(Contrast, ConvergesFrom1To1000BothWays)
{
  generators::SoftwoodOptions o;
  o.size = { 240, 200, 1 };
  const auto tissue = generators::softwood(o);
  const auto random = noise(120, 150, 1, 0.5, 4);
  for (const auto* image : { &tissue, &random })
    for (const double contrast : { 1.0, 10.0, 100.0, 1000.0 })
      for (const bool strongWall : { false, true })
      {
        const std::vector<double> d =
          strongWall ? std::vector<double>{ 1.0, contrast } : std::vector<double>{ contrast, 1.0 };
        const auto r = solve(*image, d, { .tolerance = 1e-8 });
        EXPECT_EQ(r.method, lbm::Method::Multigrid);
        EXPECT_LE(r.balance, 1e-8);
        EXPECT_LE(r.iterations, 60) << contrast << " " << strongWall; // measured: at most 41
      }
}

TEST(Contrast, AMillionIsStillRight)
{
  const auto image = noise(60, 50, 1, 0.5, 4);
  for (const double contrast : { 1e6, 1e-6 })
  {
    Case s{ .tolerance = 1e-8 };
    const auto a = solve(image, { 1.0, contrast }, s);
    s.method = lbm::Method::AlgebraicMultigrid;
    const auto b = solve(image, { 1.0, contrast }, s);
    EXPECT_NEAR(a.effective[0] / b.effective[0], 1.0, 1e-9);
  }
}

/// Along x, by finite volumes. Nodes are taken out one by one, each a star that becomes a mesh: that only adds,
/// multiplies and divides positive numbers, so it is right to round-off at any contrast.
double conductanceByStars(const PhaseImage& image, const std::vector<double>& d)
{
  const auto& size = image.lattice.size;
  const auto n = static_cast<std::size_t>(image.lattice.count() + 2); // the faces are the first two
  std::vector<std::vector<double>> g(n, std::vector<double>(n, 0.0));
  const auto join = [&](std::size_t i, std::size_t j, double value) { g[i][j] = g[j][i] = g[i][j] + value; };
  for (std::int64_t i = 0; i < image.lattice.count(); ++i)
  {
    const auto node = static_cast<std::size_t>(i);
    const double k = d[image.phase[node]];
    const std::array<std::int64_t, 3> at{ i % size[0], i / size[0] % size[1], i / (size[0] * size[1]) };
    if (at[0] == 0)
      join(node + 2, 0, 2 * k);
    if (at[0] == size[0] - 1)
      join(node + 2, 1, 2 * k);
    std::size_t step = 1;
    for (std::size_t a = 0; a < 3; step *= static_cast<std::size_t>(size[a++]))
      if (at[a] + 1 < size[a])
        join(node + 2, node + step + 2, 2 / (1 / k + 1 / d[image.phase[node + step]]));
  }
  for (std::size_t k = n - 1; k > 1; --k)
  {
    double sum = 0;
    for (std::size_t i = 0; i < k; ++i)
      sum += g[k][i];
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < k; ++j)
        if (i != j)
          g[i][j] += g[k][i] / sum * g[k][j];
  }
  return g[0][1] * static_cast<double>(size[0]) / static_cast<double>(size[1] * size[2]);
}

// Above 1e15 the small fluxes are round-off, which the residual does not show and the faces do. What is told is as
// right as it says, or refused.
TEST(Contrast, BeyondDoublePrecisionIsRightOrRefused)
{
  int right = 0;
  for (unsigned seed = 1; seed <= 12; ++seed)
    for (const double contrast : { 1e-24, 1e-17, 1e6, 1e12, 1e14, 1e15, 1e16, 1e17, 1e24 })
    {
      const auto image = noise(3 + seed % 3, 3, 1, 0.5, seed);
      const std::vector<double> d{ 1.0, contrast };
      const double exact = conductanceByStars(image, d);
      try
      {
        const auto r = solve(image, d, { .tolerance = 1e-8 });
        EXPECT_NEAR(r.effective[0] / exact, 1.0, std::max(1e-7, r.solverError))
          << seed << " " << contrast << " " << lbm::name(r.method) << " " << r.iterations << " " << r.residual << " "
          << r.balance;
        ++right;
      }
      catch (const DivergenceError&)
      {
        EXPECT_GE(std::abs(std::log10(contrast)), 14) << seed;
      }
    }
  EXPECT_GE(right, 36); // all up to 1e12 at least
}

// Voxels of two phases in turns: what planes of nodes carry is round-off of the good conductor's fluxes there, and the
// lean methods' balance of planes once chose by it (11 % off with no warning).
TEST(Contrast, LeanMethodsAreRightOrRefusedToo)
{
  PhaseImage image;
  image.lattice = makeLattice(3, 7, 4, 3, 1e-6);
  for (std::int64_t i = 0; i < image.lattice.count(); ++i)
    image.phase.push_back(static_cast<std::uint8_t>((i % 3 + i / 3 % 7 + i / 21) % 2));
  int right = 0;
  for (const auto method : { lbm::Method::LeanMultigrid, lbm::Method::PieceMultigrid })
    for (int decade = -17; decade <= 17; ++decade)
    {
      const std::vector<double> d{ 1.0, std::pow(10.0, decade) };
      try
      {
        const auto r = solve(image, d, { .method = method, .tolerance = 1e-7 });
        EXPECT_NEAR(r.effective[0] / conductanceByStars(image, d), 1.0, std::max(1e-7, r.solverError)) << decade;
        ++right;
      }
      catch (const ParameterError&) // beyond single precision
      {
        EXPECT_GT(std::abs(decade), 8);
      }
    }
  EXPECT_EQ(right, 34);
}

// Three phases over up to 16 decades: a mode that two iterations know nothing of (4.6 times the value, told right to
// 5e-7).
TEST(Contrast, ThreePhasesAreRightOrRefused)
{
  std::mt19937_64 random(5);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  int right = 0;
  for (int trial = 0; trial < 80; ++trial)
  {
    PhaseImage image = noise(8, 14, 1, 0.3 + 0.3 * uniform(), static_cast<unsigned>(trial));
    const PhaseImage other = noise(8, 14, 1, 0.5 * uniform(), static_cast<unsigned>(1000 + trial));
    for (std::size_t i = 0; i < image.phase.size(); ++i)
      image.phase[i] = other.phase[i] != 0 ? 2 : image.phase[i];
    const double decades = 16 * uniform();
    const std::vector<double> d{ 1.0, std::pow(10.0, decades * uniform()), std::pow(10.0, decades) };
    for (const auto method :
      { lbm::Method::Auto, lbm::Method::Multigrid, lbm::Method::LeanMultigrid, lbm::Method::PieceMultigrid })
      try
      {
        const auto r = solve(image, d, { .method = method, .tolerance = 1e-6 });
        EXPECT_NEAR(r.effective[0] / conductanceByStars(image, d), 1.0, std::max(1e-6, r.solverError))
          << trial << " " << lbm::name(r.method) << " " << d[1] << " " << d[2];
        ++right;
      }
      catch (const ParameterError&) // beyond single precision
      {
        EXPECT_GT(decades, 8);
      }
      catch (const DivergenceError&) // blocks are for mild contrasts, pieces for every one that is not so mean
      {
        EXPECT_GT(decades,
          method == lbm::Method::LeanMultigrid      ? 1
            : method == lbm::Method::PieceMultigrid ? 4
                                                    : 11)
          << trial << " " << lbm::name(method) << " " << d[1] << " " << d[2];
      }
  }
  EXPECT_GE(right, 180);
}

// With nothing left of a residual but round-off the iteration once went on for ever.
TEST(Contrast, SmallPeriodicVolumesEnd)
{
  for (unsigned seed = 1; seed <= 20; ++seed)
    for (const std::int64_t n : { 1, 2, 3, 5 })
    {
      const auto image = noise(n, n, n > 1 ? n : 2, 0.5, seed);
      try
      {
        const auto r =
          solve(image, { 1e-5, 1e12 }, { .sides = lbm::Sides::Periodic, .diagonal = true, .tolerance = 1e-8 });
        EXPECT_GT(r.effective[0], 0);
      }
      catch (const DivergenceError&)
      {
      }
    }
}

TEST(Percolation, IsCheckedBeforeSolving)
{
  auto image = noise(20, 20, 1, 1.1, 1);
  for (std::int64_t y = 0; y < 20; ++y)
    image.phase[static_cast<std::size_t>(image.lattice.index(10, y))] = 0; // a cut across x
  EXPECT_THROW(solve(image, { 0.0, 1.0 }, { .axis = 0 }), NoPathError);
  EXPECT_NEAR(solve(image, { 0.0, 1.0 }, { .axis = 1 }).effective[1], 0.95, 1e-10);
  const Block block = decompose(image.lattice, MPI_COMM_SELF);
  lbm::SteadyDiffusion solver(image.lattice, block, image.phase, std::vector<double>{ 0.0, 1.0 }, optionsOf(image, {}));
  EXPECT_FALSE(solver.percolates(0));
  EXPECT_TRUE(solver.percolates(1));
}

TEST(Percolation, PeriodicPathsMustWind)
{
  // A diagonal stripe that joins itself only round both sides: it leads across x and y at once.
  PhaseImage image = noise(16, 16, 1, -1.0, 1); // all a
  for (std::int64_t i = 0; i < 16; ++i)
  {
    image.phase[static_cast<std::size_t>(image.lattice.index(i, i))] = 1;
    image.phase[static_cast<std::size_t>(image.lattice.index((i + 1) % 16, i))] = 1;
  }
  const auto r = solve(image, { 0.0, 1.0 }, { .axis = 0, .sides = lbm::Sides::Periodic });
  // One path of 32 links in series carries the drop of one box length: k = 16 / 32 / 16 a column, and as much along y.
  EXPECT_NEAR(r.effective[0], 1.0 / 32, 1e-10);
  EXPECT_NEAR(r.effective[1], 1.0 / 32, 1e-10);
  // An island does not lead anywhere, even where it crosses the side.
  PhaseImage island = noise(16, 16, 1, -1.0, 1);
  for (const std::int64_t x : { 14, 15, 0, 1 })
    island.phase[static_cast<std::size_t>(island.lattice.index(x, 5))] = 1;
  EXPECT_THROW(solve(island, { 0.0, 1.0 }, { .axis = 0, .sides = lbm::Sides::Periodic }), NoPathError);
}

TEST(BadInput, IsNamedWithARemedy)
{
  const auto image = noise(8, 8, 1, 0.5, 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : { -1.0, nan, infinity })
    EXPECT_THROW(solve(image, { bad, 1.0 }, {}), ParameterError);
  EXPECT_THROW(solve(image, { 0.0, 0.0 }, {}), NoPathError);
  EXPECT_THROW(solve(image, { 1.0 }, {}), ParameterError);
  EXPECT_THROW(solve(image, { 1.0, 1.0 }, { .axis = 2 }), ParameterError);
  EXPECT_THROW(solve(image, { 1.0, 1.0 }, { .tolerance = 0.0 }), ParameterError);
  try
  {
    solve(image, { 1.0, -2.5 }, {});
    FAIL();
  }
  catch (const Error& e)
  {
    EXPECT_NE(std::string(e.what()).find("-2.5"), std::string::npos);
    EXPECT_FALSE(e.hint().empty());
  }
  Lattice volume = makeLattice(4, 4, 4, 3, 1.0);
  lbm::SteadyOptions options; // d2q5
  const std::vector<std::uint8_t> phase(64, 0);
  const Block block = decompose(volume, MPI_COMM_SELF);
  EXPECT_THROW(lbm::SteadyDiffusion(volume, block, phase, std::vector<double>{ 1.0 }, options), ParameterError);
}

TEST(Cancel, StopsTheSolve)
{
  const auto image = noise(100, 100, 1, 0.5, 1);
  auto options = optionsOf(image, {});
  int calls = 0;
  options.progress = [&](double, const char*) { return ++calls < 3; };
  const Block block = decompose(image.lattice, MPI_COMM_SELF);
  lbm::SteadyDiffusion solver(image.lattice, block, image.phase, std::vector<double>{ 0.1, 1.0 }, options);
  EXPECT_THROW(solver.solve(0), Cancelled);
}

} // namespace
