// How the stress of the first break changes with the materials: against differences, and what scales.
#include "Bonds.h"

#include "core/Error.h"
#include "peridynamics/BreakSensitivity.h"
#include "peridynamics/ElasticStudy.h"
#include "peridynamics/PairTable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace
{

using namespace lamella;
using namespace lamella::peridynamics;
using namespace lamella::test;

constexpr double spacing = 1e-4;
const std::vector<std::string> names{ "void", "wall", "lamella" };

/// Two phases around voids that leave no two bonds stretched alike.
Sample specks(std::int64_t nx, std::int64_t ny, std::int64_t nz = 1)
{
  const Lattice lattice = makeLattice(nx, ny, nz, nz > 1 ? 3 : 2, spacing);
  Sample s{ lattice, std::vector<std::uint8_t>(static_cast<std::size_t>(lattice.count()), 1), {} };
  const std::array<std::array<std::int64_t, 3>, 2> voids{ { { nx / 3, ny / 3, nz / 3 },
    { 2 * nx / 3, 2 * ny / 3, 2 * nz / 3 } } };
  for (std::int64_t z = 0; z < nz; ++z)
    for (std::int64_t y = 0; y < ny; ++y)
      for (std::int64_t x = 0; x < nx; ++x)
      {
        std::uint8_t& phase = s.phase[static_cast<std::size_t>(lattice.index(x, y, z))];
        phase = x + y / 3 > nx / 2 ? 2 : 1;
        for (std::size_t v = 0; v < 2; ++v)
        {
          const std::int64_t dx = x - voids[v][0];
          const std::int64_t dy = y - voids[v][1];
          const std::int64_t dz = nz > 1 ? z - voids[v][2] : 0;
          if (dx * dx + dy * dy + dz * dz < (nz > 1 ? 6 : 17) + 4 * static_cast<std::int64_t>(v))
            phase = 0;
        }
      }
  return s;
}

/// A sample under a load, by its table.
struct Case
{
  Sample sample;
  BondModel model;
  PairTable table;
  ElasticOptions options;

  [[nodiscard]] std::vector<std::int64_t> nodes() const
  {
    std::vector<std::int64_t> count(names.size());
    for (const std::uint8_t id : sample.phase)
      ++count[id];
    return count;
  }
  [[nodiscard]] BondModel applied(const PairTable& t) const
  {
    BondModel m = model;
    applyMaterials(t, names, nodes(), spacing, m);
    return m;
  }
  [[nodiscard]] ElasticResult solve(const PairTable& t, bool sensitivity) const
  {
    ElasticOptions o = options;
    o.sensitivity = sensitivity;
    return studyElastic(applied(t), sample.lattice, sample.phase, {}, o, alone());
  }
};

Case makeCase(bool space)
{
  Case c;
  c.sample = space ? specks(11, 12, 14) : specks(26, 36);
  c.model.continuum = space ? Continuum::Space : Continuum::PlaneStress;
  c.model.micromodulus = space ? Micromodulus::Isotropic : Micromodulus::Continuum;
  c.model.horizon = space ? 2 : 3;
  c.table.young = { { "wall", 2e9 }, { "lamella", 5e9 } };
  c.table.criticalStretch = { { "wall", 2e-3 }, { "lamella", 1.5e-3 } };
  c.table.mixing = Mixing::Harmonic;
  c.options.equilibrium.tolerance = 1e-12;
  c.options.threads = 1;
  return c;
}

/// Of ∂ log σ/∂ log p for every value of the table. Differences of fourth order with steps of 1e-3 of p leave 1e-10;
/// equilibria to 1e-12 leave, over that step, 1e-9 of what is stretched least well: 1e-6 of 1 is asked for.
void compare(const Case& c)
{
  const ElasticResult r = c.solve(c.table, true);
  ASSERT_TRUE(r.sensitivity);
  const std::vector<PairNumber> numbers =
    pairNumbers(c.table, names, c.nodes(), c.sample.lattice.spacing, c.applied(c.table));
  ASSERT_FALSE(numbers.empty());
  using Values = PairTable::Values PairTable::*;
  const std::map<std::string, Values> tables{ { "young", &PairTable::young },
    { "fracture-energy", &PairTable::fractureEnergy }, { "toughness", &PairTable::toughness },
    { "critical-stretch", &PairTable::criticalStretch } };
  for (const PairNumber& number : numbers)
  {
    SCOPED_TRACE(number.name());
    const auto log = [&](double change)
    {
      PairTable t = c.table;
      (t.*tables.at(number.property))[number.pair] = number.value * std::exp(change);
      const ElasticResult other = c.solve(t, false);
      EXPECT_EQ(other.firstBreak->bond, r.firstBreak->bond); // else there is no derivative to compare
      return std::log(std::abs(other.firstBreak->stress));
    };
    constexpr double h = 1e-3;
    const double expected = (8 * (log(h) - log(-h)) - (log(2 * h) - log(-2 * h))) / (12 * h);
    EXPECT_NEAR(relativeChange(*r.sensitivity, number), expected, 1e-6);
  }
  EXPECT_NEAR(std::accumulate(r.sensitivity->stiffness.begin(), r.sensitivity->stiffness.end(), 0.0), 1, 1e-8);
  EXPECT_EQ(r.firstBreak->bond, c.solve(c.table, false).firstBreak->bond);
}

TEST(BreakSensitivity, OfDifferencesUnderEveryLoad)
{
  for (const bool space : { false, true })
    for (const LoadCase load : { LoadCase::Stretch, LoadCase::Shear, LoadCase::Biaxial, LoadCase::Traction })
      for (const bool rigid : { false, true })
      {
        if (rigid && (space || load == LoadCase::Traction)) // time; nothing is held there
          continue;
        SCOPED_TRACE(
          testing::Message() << "space " << space << ", load " << static_cast<int>(load) << ", rigid " << rigid);
        Case c = makeCase(space);
        c.options.loading.load = load;
        c.options.loading.rigid = rigid;
        c.options.loading.lateralStrain = -2e-4;
        c.options.loading.traction = 1e6;
        compare(c);
      }
}

// Compression, where the bond that breaks is stretched across; sides that are periodic, corrected surfaces.
TEST(BreakSensitivity, OfDifferencesElsewhere)
{
  Case c = makeCase(false);
  c.options.loading.strain = -1e-3;
  c.options.loading.smooth = true;
  compare(c);
  c = makeCase(false);
  c.model.periodic = { true, false, false };
  c.model.surfaceCorrection = true;
  c.model.continuum = Continuum::PlaneStrain;
  compare(c);
}

// Of a fracture energy s₀ ~ √(Gc/E), of a toughness ~ K/E; by pairs of their own, like others, as multiples.
TEST(BreakSensitivity, OfDifferencesByEveryTable)
{
  Case c = makeCase(false);
  c.table.criticalStretch.clear();
  c.table.fractureEnergy = { { "wall", 5 } };
  c.table.toughness = { { "lamella", 4e5 } };
  compare(c);
  c.table.mixing = Mixing::None;
  c.table.like = { { "wall-lamella", "lamella" } };
  c.table.young["wall-lamella"] = 1e9;
  compare(c);
  c = makeCase(false);
  c.table.young = { { "wall", 2e9 }, { "lamella", 2.5 } };
  c.table.criticalStretch = { { "wall", 2e-3 }, { "lamella", 0.7 } };
  c.table.relativeTo = "wall";
  compare(c);
  const auto numbers = pairNumbers(c.table, names, c.nodes(), spacing, c.applied(c.table));
  ASSERT_EQ(numbers.size(), 4U);
  EXPECT_EQ(numbers[1].name(), "young:wall");
  for (const double of : numbers[1].young) // all are multiples of it
    EXPECT_NEAR(of, 1, 1e-9);
}

// Two pairs of one material are one kind of bond otherwise, and two here.
TEST(BreakSensitivity, PairsOfOneMaterial)
{
  Case c = makeCase(false);
  c.table.young = { { "wall", 2e9 }, { "lamella", 2e9 } };
  c.table.criticalStretch = { { "wall", 2e-3 }, { "lamella", 2e-3 } };
  compare(c);
  EXPECT_EQ(c.solve(c.table, true).sensitivity->stiffness.size(), 3U);
}

// What no value of the table tells apart is of one kind, and comes to the same: equilibria to 1e-12 leave 1e-9.
TEST(BreakSensitivity, PairsThatChangeAlike)
{
  Case c = makeCase(false);
  c.table.mixing = Mixing::None;
  c.table.like = { { "wall-lamella", "lamella" } };
  const auto numbers = pairNumbers(c.table, names, c.nodes(), spacing, c.applied(c.table));
  const std::vector<int> groups = pairGroups(numbers);
  EXPECT_EQ(groups, (std::vector<int>{ 0, 1, 1 }));
  const auto solve = [&]
  { return studyElastic(c.applied(c.table), c.sample.lattice, c.sample.phase, {}, c.options, alone()); };
  c.options.sensitivity = true;
  const ElasticResult apart = solve();
  c.model.pairGroups = groups;
  const ElasticResult together = solve();
  ASSERT_TRUE(apart.sensitivity && together.sensitivity);
  EXPECT_EQ(together.sensitivity->stiffness[2], 0);
  EXPECT_NE(apart.sensitivity->stiffness[2], 0);
  for (const PairNumber& number : numbers)
    EXPECT_NEAR(relativeChange(*together.sensitivity, number), relativeChange(*apart.sensitivity, number), 1e-8)
      << number.name();
}

// Of one kind of bonds the stress is in proportion to its stiffness: there is nothing to solve.
TEST(BreakSensitivity, OfOneKindWithoutASolve)
{
  Case c = makeCase(false);
  c.table = {};
  c.table.young = { { "wall", 2e9 } };
  c.table.fractureEnergy = { { "wall", 5 } };
  c.table.like = { { "wall-lamella", "wall" }, { "lamella", "wall" } };
  c.model.pairGroups = pairGroups(pairNumbers(c.table, names, c.nodes(), spacing, c.applied(c.table)));
  EXPECT_EQ(c.model.pairGroups, (std::vector<int>{ 0, 0, 0 }));
  EXPECT_EQ(c.solve(c.table, true).sensitivity->iterations, 0);
  compare(c);
}

// At the tolerance that is the default: to 1e-3 of the largest, the share of the load that the adjoint's residual is
// brought below.
TEST(BreakSensitivity, AtTheDefaultTolerance)
{
  for (const bool space : { false, true })
    for (const LoadCase load : { LoadCase::Stretch, LoadCase::Shear, LoadCase::Traction })
    {
      SCOPED_TRACE(testing::Message() << "space " << space << ", load " << static_cast<int>(load));
      Case c = makeCase(space);
      c.options.loading.load = load;
      c.options.loading.traction = 1e6;
      const auto tight = c.solve(c.table, true).sensitivity->stiffness;
      c.options.equilibrium.tolerance = EquilibriumOptions{}.tolerance;
      const auto plain = c.solve(c.table, true).sensitivity->stiffness;
      double most = 0;
      for (const double t : tight)
        most = std::max(most, std::abs(t));
      for (std::size_t p = 0; p < tight.size(); ++p)
        EXPECT_NEAR(plain[p], tight[p], 1e-3 * most) << p;
    }
}

TEST(BreakSensitivity, Refused)
{
  Case c = makeCase(false);
  c.options.equilibrium.strains = Strains::Large;
  try
  {
    (void)c.solve(c.table, true);
    FAIL() << "large strains were taken";
  }
  catch (const ParameterError& error)
  {
    EXPECT_STREQ(error.what(), "a sensitivity of the first break in large strains, where none is found");
  }
  c = makeCase(false);
  c.table.criticalStretch.clear();
  EXPECT_FALSE(c.solve(c.table, true).sensitivity); // nothing breaks
}

} // namespace
