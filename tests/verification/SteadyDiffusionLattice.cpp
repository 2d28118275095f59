// The discrete system: the same whichever way it is solved. That lattice Boltzmann with two relaxation times comes to
// rest in it is LatticeBoltzmannRest.cpp's.
#include "Diffusion.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <tuple>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::test;

TEST(Methods, AgreeOnEveryLatticeAndSide)
{
  struct
  {
    std::int64_t nx, ny, nz;
  } const sizes[] = { { 97, 61, 1 }, { 64, 96, 1 }, { 33, 40, 41 }, { 32, 24, 40 }, { 1, 50, 1 }, { 300, 1, 1 },
    { 5, 400, 1 }, { 2, 3, 200 } };
  for (const auto& n : sizes)
    for (const bool diagonal : { false, true })
      for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Periodic, lbm::Sides::Mixed })
        for (const int axis : { 0, 1 })
        {
          const auto image = noise(n.nx, n.ny, n.nz, 0.5, 5);
          Case s{ .axis = axis, .sides = sides, .diagonal = diagonal };
          const auto a = solve(image, { 0.1, 1.0 }, s);
          s.method = lbm::Method::AlgebraicMultigrid;
          const auto b = solve(image, { 0.1, 1.0 }, s);
          // across the direction the mean flux errs like the field; between insulated sides nobody needs it, and there
          // the iteration ends as soon as the field's relative error is below 3e-6, the root of the tolerance
          for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(a.effective[i], b.effective[i],
              (i == axis || sides == lbm::Sides::Periodic ? 1e-9 : 3e-6) * b.effective[axis])
              << n.nx << " x " << n.ny << " x " << n.nz << " diagonal " << diagonal << " axis " << axis;
          EXPECT_LE(a.balance, 1e-11);
        }
}

// Odd numbers of nodes that begin again are coarsened like even ones: about as many iterations, and no level is left
// that takes longer to factorise than the rest to solve. Of 50³, halved once and then left at 25³, that took 95 % of
// the time.
TEST(Methods, OddPeriodicSidesTakeAsManyIterations)
{
  for (const bool diagonal : { false, true })
  {
    const Case s{ .axis = 0, .sides = lbm::Sides::Periodic, .diagonal = diagonal, .method = lbm::Method::Multigrid };
    const auto iterations = [&](std::int64_t nx, std::int64_t ny, std::int64_t nz) {
      return static_cast<double>(solve(noise(nx, ny, nz, 0.5, 5), { 0.1, 1.0 }, s).iterations);
    };
    const double flat = iterations(256, 256, 1);
    for (const auto& [nx, ny] : { std::pair{ 255, 255 }, { 257, 256 }, { 256, 255 }, { 250, 243 }, { 254, 3 } })
      EXPECT_LE(iterations(nx, ny, 1), 1.3 * flat + 1) << nx << " x " << ny;
    const double space = iterations(48, 48, 48);
    for (const auto& [nx, ny, nz] :
      { std::tuple{ 50, 50, 50 }, { 49, 49, 49 }, { 47, 48, 48 }, { 48, 47, 48 }, { 48, 48, 47 }, { 50, 5, 49 } })
      EXPECT_LE(iterations(nx, ny, nz), 1.3 * space + 1) << nx << " x " << ny << " x " << nz;
  }
}

TEST(Methods, ThreadsGiveTheSame)
{
  const auto image = noise(80, 60, 1, 0.5, 6);
  const auto volume = noise(32, 30, 28, 0.5, 6);
  for (const auto* picture : { &image, &volume })
  {
    const auto one = solve(*picture, { 0.05, 1.0 }, { .axis = 1 });
    const auto two = solve(*picture, { 0.05, 1.0 }, { .axis = 1, .threads = 2 });
    EXPECT_EQ(one.iterations, two.iterations);
    EXPECT_NEAR(one.effective[1], two.effective[1], 1e-13 * one.effective[1]);
  }
}

TEST(Fields, MeanFluxIsTheEffectiveColumn)
{
  for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Periodic, lbm::Sides::Mixed })
    for (const double weak : { 0.1, 0.0 })
      for (const bool diagonal : { false, true })
      {
        const auto image = noise(24, 32, 1, 0.75, 9);
        const Block block = decompose(image.lattice, MPI_COMM_SELF);
        Case s{ .axis = 1, .sides = sides, .diagonal = diagonal };
        const std::vector<double> d{ weak, 2.0 };
        lbm::SteadyDiffusion solver(image.lattice, block, image.phase, d, optionsOf(image, s));
        const auto r = solver.solve(1);
        std::vector<double> flux(3 * image.phase.size());
        std::vector<double> value(image.phase.size());
        solver.flux(flux);
        solver.value(value);
        for (std::size_t i = 0; i < 2; ++i)
        {
          double mean = 0;
          for (std::size_t node = 0; node < value.size(); ++node)
            mean += flux[3 * node + i];
          mean *= image.lattice.length(1) / static_cast<double>(value.size());
          EXPECT_NEAR(mean, r.effective[i], 1e-9 * r.effective[1]);
        }
        for (std::size_t node = 0; node < value.size(); ++node)
          if (weak == 0.0 && image.phase[node] == 0)
          {
            EXPECT_TRUE(std::isnan(value[node]));
            EXPECT_EQ(flux[3 * node + 1], 0.0);
          }
          else if (sides == lbm::Sides::Insulated && !std::isnan(value[node]))
          {
            EXPECT_GE(value[node], -1e-9); // maximum principle
            EXPECT_LE(value[node], 1 + 1e-9);
          }
      }
}

/// The picture and its mirror images beyond the high sides of all axes but one.
PhaseImage mirrored(const PhaseImage& image, int axis)
{
  std::array<std::int64_t, 3> size = image.lattice.size;
  for (int a = 0; a < image.lattice.dimension; ++a)
    size[static_cast<std::size_t>(a)] *= a == axis ? 1 : 2;
  PhaseImage whole = noise(size[0], size[1], size[2], 0, 1);
  const auto back = [&](std::int64_t p, std::size_t a)
  { return p < image.lattice.size[a] ? p : 2 * image.lattice.size[a] - 1 - p; };
  std::size_t node = 0;
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x)
        whole.phase[node++] =
          image.phase[static_cast<std::size_t>(image.lattice.index(back(x, 0), back(y, 1), back(z, 2)))];
  return whole;
}

TEST(MixedSides, OfMirrorImagesAreInsulatedOnes)
{
  for (const auto& [nx, ny, nz] : { std::tuple{ 24, 31, 1 }, { 33, 20, 1 }, { 10, 13, 12 } })
    for (const double weak : { 0.1, 0.0 })
      for (const bool diagonal : { false, true })
        for (int axis = 0; axis < (nz > 1 ? 3 : 2); ++axis)
        {
          const auto image = noise(nx, ny, nz, 0.75, 3);
          Case s{ .axis = axis, .sides = lbm::Sides::Insulated, .diagonal = diagonal };
          const double insulated = solve(image, { weak, 1.0 }, s).effective[axis];
          s.sides = lbm::Sides::Mixed;
          EXPECT_NEAR(solve(mirrored(image, axis), { weak, 1.0 }, s).effective[axis], insulated, 1e-9 * insulated);
        }
}

// Pores that lead from face to face only round a side, and the same cell begun elsewhere.
TEST(MixedSides, DoNotCareWhereTheCellBegins)
{
  const std::int64_t n = 24;
  const auto stripe = [&](std::int64_t first)
  {
    PhaseImage image = noise(n, n, 1, 0, 1);
    for (std::int64_t y = 0; y < n; ++y)
      for (std::int64_t i = 0; i < 5; ++i)
        image.phase[static_cast<std::size_t>(image.lattice.index((first + y + i) % n, y))] = 1;
    return image;
  };
  EXPECT_THROW(solve(stripe(12), { 0.0, 1.0 }, { .axis = 1 }), NoPathError);
  for (const double weak : { 0.0, 0.05 })
  {
    const auto of = [&](std::int64_t first) {
      return solve(stripe(first), { weak, 1.0 }, { .axis = 1, .sides = lbm::Sides::Mixed }).effective[1];
    };
    for (const std::int64_t first : { 5, 12, 23 })
      EXPECT_NEAR(of(first), of(0), 1e-9 * of(0));
  }
}

TEST(Skipping, DeadPhasesAreNeitherStoredNorVisited)
{
  auto image = noise(60, 60, 1, 1.1, 1); // all b
  for (std::int64_t y = 0; y < 60; ++y)
    for (std::int64_t x = 0; x < 60; ++x)
      if (y % 4 >= 2)
        image.phase[static_cast<std::size_t>(image.lattice.index(x, y))] = 0; // insulating layers of two
  const auto r = solve(image, { 0.0, 3.0 }, {});
  EXPECT_EQ(r.method, lbm::Method::AlgebraicMultigrid);
  EXPECT_EQ(r.stored, 1800);
  EXPECT_EQ(r.skipped, 1800);
  EXPECT_NEAR(r.effective[0], 1.5, 1e-10); // the layers in parallel
}

TEST(Memory, MultigridKeepsToItsBudget)
{
  // Without ghosts 51 bytes a node on 7 points: phase 1, field 8, links 12, three vectors 12, weights 6.5, coarse
  // levels
  // 11. Ghost rows and padding come on top: 5 % at 200³ (53.7 measured), 16 % in this smaller box (59.3).
  const auto r = solve(noise(128, 96, 96, 0.5, 2), { 0.5, 1.0 }, { .tolerance = 1e-4 });
  EXPECT_LE(static_cast<double>(r.bytes) / static_cast<double>(r.nodes), 60.0);
}

} // namespace
