// Any number of ranks gives the answer of one: to round-off with geometric multigrid, whose cycle does not depend on
// the decomposition; within the tolerance with algebraic multigrid, whose aggregates do.
#include "Diffusion.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace
{

using namespace lamella;
using namespace lamella::test;

void compare(const PhaseImage& image, const std::vector<double>& d, Case s)
{
  int initialized = 0;
  MPI_Initialized(&initialized);
  const MPI_Comm world = initialized ? MPI_COMM_WORLD : MPI_COMM_SELF;
  const auto one = solve(image, d, s);
  const auto all = solve(image, d, s, world);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(all.effective[i], one.effective[i], 1e-10 * one.effective[s.axis]);
  EXPECT_EQ(all.stored, one.stored);

  // and the field, node by node
  const Block whole = decompose(image.lattice, MPI_COMM_SELF);
  const Block block = decompose(image.lattice, world);
  lbm::SteadyDiffusion a(image.lattice, whole, image.phase, d, optionsOf(image, s));
  lbm::SteadyDiffusion b(image.lattice, block, lbm::blockOf(image, block), d, optionsOf(image, s), world);
  a.solve(s.axis);
  b.solve(s.axis);
  std::vector<double> va(static_cast<std::size_t>(whole.count()));
  std::vector<double> vb(static_cast<std::size_t>(block.count()));
  a.value(va);
  b.value(vb);
  std::size_t i = 0;
  double worst = 0;
  for (std::int64_t z = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      for (std::int64_t x = 0; x < block.size[0]; ++x, ++i)
      {
        const double expected =
          va[static_cast<std::size_t>(image.lattice.index(x, y + block.start[1], z + block.start[2]))];
        EXPECT_EQ(std::isnan(expected), std::isnan(vb[i]));
        if (!std::isnan(expected))
          worst = std::max(worst, std::abs(expected - vb[i]));
      }
  EXPECT_LT(worst, 1e-9);
}

// Planes across z are contiguous and are swept in one pass: where two splits have equal halos, z is cut.
TEST(Ranks, CutCubesAcrossZ)
{
  int initialized = 0;
  MPI_Initialized(&initialized);
  int ranks = 1;
  if (initialized != 0)
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  if (ranks > 3)
    GTEST_SKIP() << "four ranks have less to exchange in two rows of two";
  const Block block = decompose(noise(24, 24, 24, 0.5, 1).lattice, initialized ? MPI_COMM_WORLD : MPI_COMM_SELF);
  EXPECT_EQ(block.size[0], 24);
  EXPECT_EQ(block.size[1], 24);
  EXPECT_EQ(block.size[2], 24 / ranks);
}

TEST(Ranks, GiveTheSame2D)
{
  for (const bool diagonal : { false, true })
    for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Periodic, lbm::Sides::Mixed })
      for (const int axis : { 0, 1 })
      {
        compare(noise(64, 96, 1, 0.5, 3), { 0.1, 1.0 }, { .axis = axis, .sides = sides, .diagonal = diagonal });
        compare(noise(64, 97, 1, 0.8, 3), { 0.0, 1.0 }, { .axis = axis, .sides = sides, .diagonal = diagonal });
      }
  compare(noise(61, 47, 1, 0.5, 3), { 0.1, 1.0 }, { .axis = 1 });
  compare(noise(61, 147, 1, 0.5, 3), { 0.1, 1.0 }, { .axis = 1, .sides = lbm::Sides::Periodic });
}

TEST(Ranks, GiveTheSame3D)
{
  for (const bool diagonal : { false, true })
    for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Periodic, lbm::Sides::Mixed })
      for (const int axis : { 0, 2 })
      {
        compare(noise(24, 32, 40, 0.5, 3), { 0.1, 1.0 }, { .axis = axis, .sides = sides, .diagonal = diagonal });
        compare(noise(13, 12, 11, 0.6, 3), { 0.0, 1.0 }, { .axis = axis, .sides = sides, .diagonal = diagonal });
      }
  compare(noise(20, 2, 33, 0.5, 3), { 0.1, 1.0 }, { .axis = 1 });
  compare(noise(25, 31, 45, 0.5, 3), { 0.1, 1.0 }, { .axis = 1, .sides = lbm::Sides::Periodic });
}

// In one rank's block alone: told by all, or the others would wait for it.
TEST(Ranks, APhaseWithoutConductivityIsRefusedByAll)
{
  int initialized = 0;
  MPI_Initialized(&initialized);
  const MPI_Comm world = initialized != 0 ? MPI_COMM_WORLD : MPI_COMM_SELF;
  PhaseImage image = noise(8, 24, 24, 0.5, 3);
  image.phase.back() = 2;
  EXPECT_THROW((void)solve(image, { 0.1, 1.0 }, {}, world), ParameterError);
}

// Links by the axis, too: lean methods within what they are asked for.
TEST(Ranks, MembranesOfVoxelsWithUnlikeEdges)
{
  int initialized = 0;
  MPI_Initialized(&initialized);
  PhaseImage image = noise(24, 32, 40, 0.4, 5);
  image.lattice.aspect = { 1, 1.5, 0.75 };
  for (const auto method : { lbm::Method::LeanMultigrid, lbm::Method::PieceMultigrid, lbm::Method::Multigrid,
         lbm::Method::AlgebraicMultigrid })
    for (const int axis : { 0, 1, 2 })
    {
      lbm::StudyOptions o;
      o.axes = { axis };
      o.steady = optionsOf(image, { .sides = lbm::Sides::Periodic, .method = method, .tolerance = 1e-7 });
      o.steady.fieldTolerance = std::numeric_limits<double>::infinity();
      o.estimateError = false;
      o.derivatives = true;
      o.membranes = { { 0, 1, 0.5 } };
      const std::vector<double> d{ 1, 20 };
      const auto one = lbm::studyDiffusion(image, d, o, MPI_COMM_SELF).front();
      const auto all = lbm::studyDiffusion(image, d, o, initialized != 0 ? MPI_COMM_WORLD : MPI_COMM_SELF).front();
      const double value = one.result.effective[static_cast<std::size_t>(axis)];
      EXPECT_EQ(all.result.method, method);
      EXPECT_NEAR(all.result.effective[static_cast<std::size_t>(axis)] / value, 1, 2e-7) << lbm::name(method);
      // as exact as the root of the tolerance
      EXPECT_NEAR(all.derivatives.membranes[0] / one.derivatives.membranes[0], 1, 5e-4) << lbm::name(method);
    }
}

} // namespace
