// Elements on any number of ranks: the cycle is that of one rank, so iterations are equal, and values, columns of the
// tensor, fields and derivatives agree to what is asked for; whatever the sides, odd sizes, voids, and shapes of
// blocks.
#include "Diffusion.h"

#include "core/Error.h"
#include "lbm/DirectedLinks.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::test;
using lbm::Sides;

struct Shape
{
  std::string name;
  std::array<std::int64_t, 3> size;
  std::array<double, 3> aspect{ 1, 1, 1 };
  double voids = 0.15;
  bool directed = true;
  bool tensors = false; ///< each voxel has its own
};

void PrintTo(const Shape& s, std::ostream* out)
{
  *out << s.name;
}

MPI_Comm world()
{
  int initialized = 0;
  MPI_Initialized(&initialized);
  return initialized != 0 ? MPI_COMM_WORLD : MPI_COMM_SELF;
}

struct Scene
{
  PhaseImage image;
  lbm::DirectedDiffusivity diffusivity;
};

// Phase b conducts nothing; each voxel has an axis of its own.
Scene sceneOf(const Shape& shape)
{
  const auto& n = shape.size;
  Scene scene{ noise(n[0], n[1], n[2], shape.voids, 7), { { 3, 0 }, { shape.directed ? 0.5 : 3, 0 }, {} } };
  scene.image.lattice = makeLattice(n[0], n[1], n[2], n[2] > 1 ? 3 : 2, 1.0, shape.aspect);
  for (std::size_t i = 0; i < scene.image.phase.size(); ++i)
  {
    const auto k = static_cast<float>(i % 31);
    scene.diffusivity.axis.push_back({ std::cos(0.2F * k), std::sin(0.3F * k), 0.4F * std::cos(0.1F * k) });
  }
  if (shape.tensors)
  {
    using Source = lbm::DirectedDiffusivity::Source;
    scene.diffusivity.source = { Source::Node, Source::Axial };
    for (std::size_t i = 0; i < scene.image.phase.size(); ++i)
    {
      const auto k = static_cast<float>(i % 29);
      scene.diffusivity.ofNode.push_back({ 1 + 0.5F * std::cos(k), 2, 1 + 0.3F * std::sin(k), 0.4F * std::sin(2 * k),
        n[2] > 1 ? 0.3F : 0, n[2] > 1 ? 0.2F * std::cos(3 * k) : 0 });
    }
    scene.diffusivity.takeTensors(scene.image.lattice, scene.image.phase);
  }
  return scene;
}

struct Solved
{
  lbm::SteadyResult result;
  lbm::ConductivityDerivatives derivatives;
  std::vector<double> value, flux;
};

/// @param layerwise  the field layer by layer, with other calls on other ranks
Solved solved(const Scene& scene, int axis, Sides sides, MPI_Comm comm, bool layerwise)
{
  const Lattice& lattice = scene.image.lattice;
  const Block block = decompose(lattice, comm);
  lbm::SteadyOptions o =
    optionsOf(scene.image, { .axis = axis, .sides = sides, .tolerance = sides == Sides::Periodic ? 1e-6 : 1e-12 });
  o.fieldTolerance = 1e-6;
  o.stencil = lbm::Stencil::Q1;
  auto directed = std::make_shared<lbm::DirectedDiffusivity>(scene.diffusivity);
  directed->axis.clear();
  directed->ofNode.clear();
  for (std::int64_t z = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      for (std::int64_t x = 0; x < block.size[0]; ++x)
      {
        const auto at = static_cast<std::size_t>(lattice.index(x, block.start[1] + y, block.start[2] + z));
        directed->axis.push_back(scene.diffusivity.axis[at]);
        if (!scene.diffusivity.ofNode.empty())
          directed->ofNode.push_back(scene.diffusivity.ofNode[at]);
      }
  o.directed = directed;
  lbm::SteadyDiffusion solver(lattice, block, lbm::blockOf(scene.image, block), scene.diffusivity.larger(), o, comm);
  Solved s{ solver.solve(axis), {}, {}, {} };
  s.value.resize(static_cast<std::size_t>(block.count()));
  s.flux.resize(3 * s.value.size());
  if (layerwise)
  {
    solver.value({}, { 0, 0 });
    const auto layer = static_cast<std::size_t>(block.size[0] * block.size[1]);
    for (std::int64_t z = 0; z < block.size[2]; ++z)
    {
      const std::size_t from = layer * static_cast<std::size_t>(z);
      solver.flux(std::span(s.flux).subspan(3 * from, 3 * layer), { z, z + 1 });
      solver.value(std::span(s.value).subspan(from, layer), { z, z + 1 });
    }
  }
  else
  {
    solver.value(s.value);
    solver.flux(s.flux);
  }
  s.derivatives = solver.derivatives();
  return s;
}

class ElementsOnRanks : public testing::TestWithParam<Shape>
{
};

TEST_P(ElementsOnRanks, GiveWhatOneGives)
{
  const Scene scene = sceneOf(GetParam());
  const Lattice& lattice = scene.image.lattice;
  const Block block = decompose(lattice, world());
  for (const auto sides : { Sides::Insulated, Sides::Mixed, Sides::Periodic })
    for (int axis = 0; axis < lattice.dimension; ++axis)
    {
      SCOPED_TRACE(std::to_string(static_cast<int>(sides)) + " " + std::to_string(axis));
      const Solved one = solved(scene, axis, sides, MPI_COMM_SELF, false);
      const Solved all = solved(scene, axis, sides, world(), axis == 1);
      const double value = one.result.effective[static_cast<std::size_t>(axis)];
      // directions are in single precision: near the last place of the energy the order of sums may tip the end
      EXPECT_LE(std::abs(all.result.iterations - one.result.iterations), 1);
      EXPECT_EQ(all.result.stored, one.result.stored);
      EXPECT_NEAR(all.result.effective[static_cast<std::size_t>(axis)], value, 1e-10 * value);
      EXPECT_NEAR(all.result.inletFlux, value, 1e-9 * value);
      EXPECT_NEAR(all.result.outletFlux, value, 1e-9 * value);
      // fields, and what depends on them to first order, to the root of the value's error
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_NEAR(all.result.effective[a], one.result.effective[a], 3e-6 * value);
      EXPECT_NEAR(all.derivatives.along[0], one.derivatives.along[0], 3e-6 * value);
      EXPECT_TRUE(std::isnan(all.derivatives.along[1]));
      std::size_t i = 0;
      double worst = 0;
      double worstFlux = 0;
      const double unit = value / lattice.length(axis);
      for (std::int64_t z = 0; z < block.size[2]; ++z)
        for (std::int64_t y = 0; y < block.size[1]; ++y)
          for (std::int64_t x = 0; x < block.size[0]; ++x, ++i)
          {
            const auto at = static_cast<std::size_t>(lattice.index(x, y + block.start[1], z + block.start[2]));
            EXPECT_EQ(std::isnan(all.value[i]), std::isnan(one.value[at]));
            if (!std::isnan(all.value[i]))
              worst = std::max(worst, std::abs(all.value[i] - one.value[at]));
            for (std::size_t a = 0; a < 3; ++a)
              worstFlux = std::max(worstFlux, std::abs(all.flux[3 * i + a] - one.flux[3 * at + a]) / unit);
          }
      EXPECT_LT(worst, 3e-6);
      EXPECT_LT(worstFlux, 1e-5);
    }
}

// Blocks cut along z, along y, along both; slabs of y and z; last coarse elements half as long; more levels than one
// before what is left is gathered; too small to be shared out, or too thin for four ranks.
INSTANTIATE_TEST_SUITE_P(All, ElementsOnRanks,
  testing::Values(Shape{ "cube", { 24, 24, 24 } }, Shape{ "odd", { 21, 17, 23 } },
    Shape{ "wide", { 9, 39, 19 }, { 1, 2, 0.5 } }, Shape{ "flat", { 30, 66, 4 } }, Shape{ "deep", { 8, 7, 97 } },
    Shape{ "fine", { 40, 32, 36 }, { 1, 1, 1 }, 0, false }, Shape{ "picture", { 71, 65, 1 } },
    Shape{ "large_picture", { 130, 131, 1 }, { 1, 1, 1 }, 0.1, false }, Shape{ "small", { 9, 8, 7 } },
    Shape{ "rod", { 300, 5, 5 }, { 1, 1, 1 }, 0.02 },
    Shape{ "tensors", { 21, 17, 23 }, { 1, 2, 0.5 }, 0.1, true, true },
    Shape{ "tensor_picture", { 71, 65, 1 }, { 1, 1, 1 }, 0.1, true, true }),
  [](const auto& shape) { return shape.param.name; });

// What people ask for: the same steps, however many work at them.
TEST(ElementRanks, TakeTheIterationsOfOne)
{
  for (const Shape& shape : { Shape{ "", { 24, 26, 22 } }, Shape{ "", { 90, 81, 1 } } })
  {
    const Scene scene = sceneOf(shape);
    const Lattice& lattice = scene.image.lattice;
    for (const auto sides : { Sides::Insulated, Sides::Mixed, Sides::Periodic })
    {
      const auto iterations = [&](MPI_Comm comm)
      {
        const Block block = decompose(lattice, comm);
        lbm::SteadyOptions o = optionsOf(scene.image, { .sides = sides, .tolerance = 1e-4 });
        o.fieldTolerance = std::numeric_limits<double>::infinity();
        o.stencil = lbm::Stencil::Q1;
        lbm::SteadyDiffusion solver(
          lattice, block, lbm::blockOf(scene.image, block), std::vector{ 3.0, 0.01 }, o, comm);
        return solver.solve(0).iterations;
      };
      EXPECT_EQ(iterations(world()), iterations(MPI_COMM_SELF)) << static_cast<int>(sides);
    }
  }
}

// What the memory check divides by.
TEST(ElementRanks, ShareWhatHasTwoLayersARank)
{
  const Lattice rod = makeLattice(300, 5, 6, 3, 1.0);
  EXPECT_EQ(lbm::ranksSharing(rod, lbm::Stencil::Q1, 1), 1);
  EXPECT_EQ(lbm::ranksSharing(rod, lbm::Stencil::Q1, 3), 3);
  EXPECT_EQ(lbm::ranksSharing(rod, lbm::Stencil::Q1, 4), 1);
  EXPECT_EQ(lbm::ranksSharing(rod, lbm::Stencil::D3Q7, 4), 4);
  EXPECT_EQ(lbm::ranksSharing(makeLattice(300, 40, 1, 2, 1.0), lbm::Stencil::Q1, 4), 4);
}

TEST(ElementRanks, ABlockThatTheFaceDoesNotReachIsNoPath)
{
  Scene scene = sceneOf({ "", { 12, 20, 24 } });
  for (std::size_t i = 0; i < scene.image.phase.size(); ++i)
    scene.image.phase[i] = i / (12 * 20) == 17 ? 1 : 0; // a layer of voids across z
  EXPECT_THROW((void)solved(scene, 2, Sides::Insulated, world(), false), NoPathError);
  EXPECT_NO_THROW((void)solved(scene, 0, Sides::Insulated, world(), false));
}

TEST(ElementRanks, WhatOneRankLacksAllRefuse)
{
  Scene scene = sceneOf({ "", { 12, 20, 24 } });
  scene.diffusivity.axis[0] = { 0, 0, 0 };
  scene.image.phase[0] = 0;
  EXPECT_THROW((void)solved(scene, 0, Sides::Insulated, world(), false), ParameterError);
}

} // namespace
