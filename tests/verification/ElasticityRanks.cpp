// Elements on several ranks: the same bits as on one, of every kind of side, material and size, fields included.
#include "elasticity/Materials.h"
#include "elasticity/VoxelStiffness.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::elasticity;

// Cells with thin walls along the last axis, cut by walls every few planes; phases 0: void, 1, 2: walls and lumps.
std::vector<std::uint8_t> cells(const Lattice& lattice, bool voids)
{
  std::vector<std::uint8_t> phase;
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < lattice.size[0]; ++x)
      {
        const bool wall = x % 9 < 2 || y % 8 < 2 || (lattice.dimension == 3 && z % 11 < 2);
        const bool lump = (x / 9 + y / 8 + z / 11) % 3 == 0;
        phase.push_back(wall ? 1 : lump ? 2 : voids ? 0 : 3);
      }
  return phase;
}

struct Case
{
  std::string name;
  std::array<std::int64_t, 3> size;
  StiffnessSides sides = StiffnessSides::Periodic;
  std::array<double, 4> moduli{ 0, 1e9, 4e8, 1e8 }; ///< by phase; 0: a void
  bool turns = false;                               ///< phase 1 follows an axis
  bool rigid = false;                               ///< phase 2 is
  double tolerance = 1e-6;
  std::array<double, 3> aspect{ 1, 1, 1 };
  bool estimateError = false;
  double poisson = 0.3;
};

Case withError(Case c)
{
  c.estimateError = true;
  return c;
}
Case nearlyIncompressible(Case c)
{
  c.poisson = 0.49;
  return c;
}

VoxelStiffness study(const Case& c, const Communicator& ranks, std::vector<double>& fields)
{
  const int dimension = c.size[2] == 1 ? 2 : 3;
  Lattice lattice = makeLattice(c.size[0], c.size[1], c.size[2], dimension, 1e-6);
  lattice.aspect = c.aspect;
  const Continuum continuum = dimension == 3 ? Continuum::Space : Continuum::PlaneStress;
  const std::vector<std::uint8_t> phase = cells(lattice, c.moduli[3] == 0);
  std::vector<VoxelMaterial> materials(4);
  for (std::size_t id = 0; id < materials.size(); ++id)
  {
    materials[id].stiffness =
      c.moduli[id] == 0 ? voidStiffness(continuum) : isotropicStiffness(continuum, c.moduli[id], c.poisson);
    materials[id].expansion.assign(dimension == 3 ? 6 : 3, 0.0);
    materials[id].expansion[0] = 1e-5 * static_cast<double>(id);
  }
  std::vector<std::array<float, 3>> axis;
  if (c.turns)
  {
    materials[1].axial = axialModuli(continuum, { 8e9, 6e9, 0.2, 0.25, 2e9 });
    materials[1].stiffness = isotropicStiffness(continuum, 8e9, 0.3);
    materials[1].expansion = { 1e-6, 3e-5 };
    for (std::size_t i = 0; i < phase.size(); ++i)
      axis.push_back({ static_cast<float>(std::cos(0.01 * static_cast<double>(i))),
        static_cast<float>(std::sin(0.01 * static_cast<double>(i))), 0 });
  }
  if (c.rigid)
  {
    materials[2] = {};
    materials[2].rigid = true;
  }
  VoxelStiffnessOptions options;
  options.sides = c.sides;
  options.ranks = ranks;
  options.tolerance = c.tolerance;
  options.estimateError = c.estimateError;
  options.load = VoxelLoad{};
  options.load->strain.assign(dimension == 3 ? 6 : 3, std::nan(""));
  options.load->strain[0] = 1e-3;
  options.load->change = between(c.sides) ? 0 : 2;
  const auto components = static_cast<std::size_t>(dimension == 3 ? 6 : 3);
  fields.assign(phase.size() * (components + static_cast<std::size_t>(dimension)), 0.0);
  options.fields = [&](std::int64_t row, std::int64_t plane, const double* const* displacement, const double* const*,
                     const double* const* stress)
  {
    const auto first =
      static_cast<std::size_t>(lattice.index(0, dimension == 3 ? row : plane, dimension == 3 ? plane : 0));
    for (std::size_t i = 0; i < static_cast<std::size_t>(c.size[0]); ++i)
    {
      for (std::size_t k = 0; k < components; ++k)
        fields[(first + i) + k * phase.size()] = stress[k][i];
      for (std::size_t k = 0; k < static_cast<std::size_t>(dimension); ++k)
        fields[(first + i) + (components + k) * phase.size()] = displacement[k][i];
    }
  };
  return studyVoxelStiffness(lattice, phase, materials, axis, options);
}

class ElasticityRanks : public testing::TestWithParam<Case>
{
};

TEST_P(ElasticityRanks, AsOnOne)
{
  const Communicator world(MPI_COMM_WORLD);
  std::vector<double> fields;
  std::vector<double> fieldsOfOne;
  const VoxelStiffness several = study(GetParam(), world, fields);
  const VoxelStiffness one = study(GetParam(), Communicator(MPI_COMM_SELF), fieldsOfOne);
  EXPECT_EQ(several.stiffness, one.stiffness);
  EXPECT_EQ(several.expansion, one.expansion);
  EXPECT_EQ(several.solverError, one.solverError);
  EXPECT_EQ(several.error.components, one.error.components);
  EXPECT_EQ(several.loaded->stress, one.loaded->stress);
  EXPECT_EQ(several.loaded->energy, one.loaded->energy);
  ASSERT_EQ(several.steps.size(), one.steps.size());
  for (std::size_t k = 0; k < one.steps.size(); ++k)
  {
    EXPECT_EQ(several.steps[k].iterations, one.steps[k].iterations);
    EXPECT_EQ(several.steps[k].nodes, one.steps[k].nodes);
  }
  const auto& size = GetParam().size;
  const Lattice lattice = makeLattice(size[0], size[1], size[2], size[2] == 1 ? 2 : 3, 1);
  const auto [first, last] = fieldPlanes(lattice, GetParam().sides, world);
  const bool split = last - first < lattice.size[static_cast<std::size_t>(lattice.dimension - 1)];
  EXPECT_EQ(split, world.parallel() && GetParam().name != "small");
  if (split)
    world.sum(fields); // of every rank's rows
  EXPECT_EQ(fields, fieldsOfOne);
}

INSTANTIATE_TEST_SUITE_P(Cases, ElasticityRanks,
  testing::Values(Case{ "tissue", { 36, 32, 66 } }, withError({ "even", { 18, 16, 44 } }),
    nearlyIncompressible({ "nearly_incompressible", { 27, 16, 45 } }),
    Case{ "three_phases", { 27, 16, 47 }, StiffnessSides::Periodic, { 1e8, 1e9, 4e8, 3e7 } },
    Case{ "uniform_strain", { 18, 17, 34 }, StiffnessSides::UniformStrain },
    Case{ "uniform_stress", { 18, 17, 33 }, StiffnessSides::UniformStress, { 1e8, 1e9, 4e8, 3e7 } },
    Case{ "straight", { 20, 16, 36 }, StiffnessSides::Straight }, Case{ "grip", { 18, 16, 35 }, StiffnessSides::Grip },
    Case{ "axes", { 18, 16, 34 }, StiffnessSides::Periodic, { 0, 1e9, 4e8, 0 }, true },
    Case{ "stiff_lumps", { 27, 24, 33 }, StiffnessSides::Periodic, { 1e6, 1e6, 1e9, 1e6 } },
    Case{ "rigid_lumps", { 27, 24, 33 }, StiffnessSides::Periodic, { 1e8, 1e9, 4e8, 1e8 }, false, true },
    Case{ "to_the_end", { 18, 16, 33 }, StiffnessSides::Periodic, { 0, 1e9, 4e8, 0 }, false, false, 1e-10 },
    Case{
      "flat_voxels", { 18, 16, 40 }, StiffnessSides::Periodic, { 0, 1e9, 4e8, 0 }, false, false, 1e-6, { 1, 1, 3 } },
    withError({ "picture", { 90, 120, 1 } }), Case{ "odd_picture", { 163, 201, 1 }, StiffnessSides::UniformStrain },
    Case{ "picture_axes", { 90, 120, 1 }, StiffnessSides::Periodic, { 0, 1e9, 4e8, 0 }, true },
    Case{ "small", { 9, 8, 11 } }),
  [](const auto& test) { return test.param.name; });

} // namespace
