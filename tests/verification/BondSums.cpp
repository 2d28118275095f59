// The sums over implicit bonds against a plain double loop over pairs of nodes: random phases, voids, grains, notches,
// 2D and 3D, all numbers of kinds, periodic or not; on any number of ranks and threads, with every instruction set.
#include "Bonds.h"

#include "core/Error.h"
#include "peridynamics/kernels/RowKernels.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>

namespace
{

using namespace lamella;
using namespace lamella::test;

struct Case
{
  const char* name;
  Lattice lattice;
  double horizon;
  int phases;
  double voids;
  int grains;
  std::array<bool, 3> periodic{ false, false, false };
  bool correction = false;
  bool notch = false;
  Continuum continuum = Continuum::PlaneStress;
  Micromodulus micromodulus = Micromodulus::Continuum;
};

constexpr double spacing = 2e-6;

Lattice plane(std::int64_t nx, std::int64_t ny)
{
  return makeLattice(nx, ny, 1, 2, spacing);
}
Lattice space(std::int64_t nx, std::int64_t ny, std::int64_t nz)
{
  return makeLattice(nx, ny, nz, 3, spacing);
}

BondModel modelOf(const Case& c)
{
  BondModel m;
  m.continuum = c.lattice.dimension == 3 ? Continuum::Space : c.continuum;
  m.horizon = c.horizon;
  m.micromodulus = c.micromodulus;
  m.periodic = c.periodic;
  m.surfaceCorrection = c.correction;
  m.pairByGrain = c.grains > 0;
  for (int a = 1; a <= c.phases; ++a)
    for (int b = a; b <= c.phases; ++b)
    {
      PhasePair pair{ BondMaterial{ .youngsModulus = 1e9 * (1 + a + 0.3 * b * b), .criticalStretch = 0.01 * (a + b) } };
      if (c.grains > 0)
        pair.betweenGrains = BondMaterial{ .youngsModulus = 0.4e9 * (a + b), .criticalStretch = 0.004 };
      m.pairs[{ static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b) }] = pair;
    }
  if (c.notch) // off the nodes, so that no rule for ties is needed
    m.notches = { { { 2.31 * spacing, 7.77 * spacing, 0 }, { 9.1 * spacing, 4.33 * spacing, 0 }, {} },
      { { 20.2 * spacing, -3 * spacing, 0 }, { 0.4 * spacing, 15.1 * spacing, 0 }, {} } };
  return m;
}

// Up to three ranks share the slowest axis: three times the horizon at least.
const std::vector<Case>& cases()
{
  static const std::vector<Case> list{ { "one kind", plane(37, 30), 3, 1, 0, 0 },
    { "voids", plane(40, 31), 3.015, 1, 0.3, 0 }, { "long rows, uniform runs", plane(300, 19), 3, 1, 0.0003, 0 },
    { "three kinds", plane(33, 29), 3, 2, 0.2, 0 }, { "two kinds by grain", plane(33, 29), 3, 1, 0.1, 3 },
    { "six kinds, periodic", plane(29, 33), 4, 3, 0.2, 0, { true, true, false } },
    { "twelve kinds by grain", plane(35, 30), 3, 3, 0.2, 4 },
    { "notches", plane(36, 30), 3, 1, 0.1, 0, {}, false, true },
    { "notches, periodic in x, corrected", plane(36, 30), 3, 2, 0.1, 0, { true, false, false }, true, true },
    { "corrected", plane(80, 30), 3, 2, 0.1, 0, { false, true, false }, true },
    { "horizon 1", plane(20, 22), 1, 1, 0.1, 0, { true, true, false } }, { "horizon 2", plane(20, 22), 2, 3, 0.1, 0 },
    { "horizon 5, plane strain", plane(40, 31), 5, 2, 0.1, 0, { false, false, false }, false, false,
      Continuum::PlaneStrain },
    { "horizon 6", plane(40, 31), 6, 1, 0.05, 2, { true, false, false } },
    { "horizon 8, four words", plane(64, 40), 8, 2, 0.1, 0, { true, true, false } },
    { "space", space(13, 11, 14), 2, 2, 0.2, 0 },
    { "space, horizon 3, periodic", space(12, 10, 12), 3, 1, 0.1, 3, { true, true, true } },
    { "space, corrected", space(20, 9, 12), 3.015, 3, 0.2, 0, { false, true, false }, true },
    { "space, horizon 4", space(10, 11, 13), 4, 1, 0, 0, { true, false, true } },
    { "isotropic", plane(40, 31), 2, 1, 0.1, 0, { true, false, false }, false, false, Continuum::PlaneStress,
      Micromodulus::Isotropic },
    { "isotropic, corrected, six kinds", plane(33, 29), 5, 3, 0.1, 0, {}, true, false, Continuum::PlaneStrain,
      Micromodulus::Isotropic },
    { "space, isotropic", space(20, 9, 12), 3, 2, 0.2, 0, { false, true, false }, false, false, Continuum::Space,
      Micromodulus::Isotropic },
    { "space, isotropic, corrected", space(12, 10, 12), 3, 1, 0.1, 0, { true, true, true }, true, false,
      Continuum::Space, Micromodulus::Isotropic } };
  return list;
}

class BondSums : public testing::TestWithParam<int>
{
protected:
  BondSums()
    : c(cases()[static_cast<std::size_t>(GetParam())])
    , model(modelOf(c))
    , sample(randomSample(c.lattice, c.phases, c.voids, c.grains, 7U + static_cast<unsigned>(GetParam())))
    , plain(plainBonds(model, sample))
    , bonds(latticeOf(model, sample, everyone()))
  {
  }
  const Case& c;
  BondModel model;
  Sample sample;
  std::vector<PlainBond> plain;
  BondLattice bonds;
  // Sums of up to 200 (2D) or 256 (3D) terms in another order: round-off of some 1e-15 of the greatest term each. The
  // shares of the surface correction are kept in single precision.
  double roundOff = c.correction ? 2e-7 : 1e-12;
};

TEST_P(BondSums, CountBonds)
{
  SCOPED_TRACE(c.name);
  EXPECT_EQ(2 * bonds.bonds(), static_cast<std::int64_t>(plain.size()));
}

TEST_P(BondSums, Forces)
{
  SCOPED_TRACE(c.name);
  const RowKernels* sets[3];
  const int n = rowKernelSets(sets);
  // strains of 1e-3 take the series throughout; 0.05 and 0.5 both ways, in one vector
  for (const double size : { 1e-3, 0.05, 0.5 })
  {
    const Field u = randomField(sample, size * spacing, 3);
    const Field linear = plainForce(plain, u, false);
    const Field nonlinear = plainForce(plain, u, true);
    std::int64_t critical = 0;
    double energy = 0;
    for (const PlainBond& b : plain)
    {
      const PlainState s(b, u, true);
      critical += s.stretch > b.s0 ? 1 : 0;
      energy += 0.25 * b.k * s.stretch * s.stretch * s.length;
    }
    for (int k = 0; k < n; ++k)
    {
      SCOPED_TRACE(sets[k]->name);
      bonds.use(*sets[k]);
      const NodeField<double> v = scatter<double>(bonds, sample, u);
      NodeField<double> f(bonds.layout());
      f.fill(99); // what was there does not matter
      linearForce(bonds, v, f);
      EXPECT_LT(difference(f, sample, linear), roundOff);
      const CriticalBonds found = nonlinearForce(bonds, v, f, true);
      EXPECT_LT(difference(f, sample, nonlinear), roundOff);
      EXPECT_EQ(2 * everyone().sum(found.count), critical);
      EXPECT_EQ(static_cast<std::int64_t>(found.bonds.size()), found.count);
      // in single precision, with the strain's digits kept however small it is
      const NodeField<float> w = scatter<float>(bonds, sample, u);
      NodeField<float> g(bonds.layout());
      linearForce(bonds, w, g);
      EXPECT_LT(difference(g, sample, linear), 1e-5);
      EXPECT_NEAR(elasticEnergy(bonds, v, true), energy, roundOff * energy);
      EXPECT_NEAR(elasticEnergy(bonds, w, true), energy, 1e-5 * energy);
      (void)nonlinearForce(bonds, w, g);
      EXPECT_LT(difference(g, sample, nonlinear), 1e-5);
    }
  }
}

TEST_P(BondSums, Measures)
{
  SCOPED_TRACE(c.name);
  const Field u = randomField(sample, 0.05 * spacing, 4);
  const Field p = randomField(sample, spacing, 5);
  const NodeField<double> v = scatter<double>(bonds, sample, u);
  const double volume = std::pow(spacing, c.lattice.dimension);
  const bool flat = c.lattice.dimension == 2;
  for (const bool nonlinear : { false, true })
  {
    double energy = 0;
    double ratio = 0;
    std::vector<std::array<double, 6>> stress(sample.phase.size());
    std::vector<std::array<double, 1>> density(sample.phase.size());
    Field tangent(sample.phase.size());
    for (const PlainBond& b : plain)
    {
      const PlainState s(b, u, nonlinear);
      energy += 0.25 * b.k * s.stretch * s.stretch * s.length;
      density[b.i][0] += 0.25 * b.k * s.stretch * s.stretch * s.length / volume;
      ratio = std::max(ratio, s.stretch / b.s0);
      const auto add = [&](std::size_t at, std::size_t r, std::size_t q)
      { stress[b.i][at] += 0.5 * s.force[r] * s.zeta[q] / volume; };
      add(0, 0, 0);
      add(1, 1, 1);
      if (flat)
        add(2, 0, 1);
      else
      {
        add(2, 2, 2);
        add(3, 0, 1);
        add(4, 1, 2);
        add(5, 0, 2);
      }
    }
    EXPECT_NEAR(elasticEnergy(bonds, v, nonlinear), energy, roundOff * energy);
    NodeField<double> sigma(bonds.layout(), flat ? 3 : 6);
    nodalStress(bonds, v, sigma, nonlinear);
    EXPECT_LT(difference(sigma, sample, stress), roundOff);
    NodeField<double> w(bonds.layout(), 1);
    energyDensity(bonds, v, w, nonlinear);
    EXPECT_LT(difference(w, sample, density), roundOff);
    const StretchMaximum most = largestStretch(bonds, v, nonlinear);
    EXPECT_NEAR(most.ratio, ratio, roundOff * ratio);
    ASSERT_TRUE(most.bond.has_value());
  }
  // the tangent against a difference of forces: second order, so the error goes as the square of the step
  NodeField<double> q(bonds.layout());
  tangentProduct(bonds, v, scatter<double>(bonds, sample, p), q);
  const double step = 1e-5;
  Field up = u;
  Field down = u;
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
    {
      up[i][a] += step * p[i][a];
      down[i][a] -= step * p[i][a];
    }
  Field slope = plainForce(plain, up, true);
  const Field low = plainForce(plain, down, true);
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      slope[i][a] = (slope[i][a] - low[i][a]) / (2 * step);
  EXPECT_LT(difference(q, sample, slope), std::max(1e-8, roundOff));

  std::vector<std::array<double, 6>> blocks(sample.phase.size());
  for (const PlainBond& b : plain)
  {
    const double length = std::hypot(b.xi[0], b.xi[1], b.xi[2]);
    const double k = b.k / (length * length * length);
    const auto& x = b.xi;
    const std::array<double, 6> ee = flat
      ? std::array<double, 6>{ x[0] * x[0], x[1] * x[1], x[0] * x[1] }
      : std::array<double, 6>{ x[0] * x[0], x[1] * x[1], x[2] * x[2], x[0] * x[1], x[1] * x[2], x[0] * x[2] };
    for (std::size_t k6 = 0; k6 < 6; ++k6)
      blocks[b.i][k6] += k * ee[k6];
  }
  NodeField<double> diagonal(bonds.layout(), flat ? 3 : 6);
  diagonalBlocks(bonds, diagonal);
  EXPECT_LT(difference(diagonal, sample, blocks), roundOff);
}

// The bits of a sum do not depend on how the rows are shared out.
TEST_P(BondSums, SameBitsOnAnyThreadsAndRanks)
{
  SCOPED_TRACE(c.name);
  const Field u = randomField(sample, 0.05 * spacing, 6);
  const BondLattice whole = latticeOf(model, sample, alone());
  const NodeField<double> vWhole = scatter<double>(whole, sample, u);
  const NodeField<double> v = scatter<double>(bonds, sample, u);
  const int before = omp_get_max_threads();
  for (const bool nonlinear : { false, true })
  {
    const auto force = [&](const BondLattice& b, const NodeField<double>& x, NodeField<double>& f)
    { nonlinear ? (void)nonlinearForce(b, x, f) : linearForce(b, x, f); };
    omp_set_num_threads(1);
    NodeField<double> expected(whole.layout());
    force(whole, vWhole, expected);
    for (const int threads : { 1, 2, 5 })
    {
      omp_set_num_threads(threads);
      NodeField<double> f(bonds.layout());
      force(bonds, v, f);
      const NodeLayout& l = bonds.layout();
      std::int64_t different = 0;
      for (int k = 0; k < l.dimension; ++k)
        for (std::int64_t z = 0; z < l.size[2]; ++z)
          for (std::int64_t y = 0; y < l.size[1]; ++y)
            for (std::int64_t x = 0; x < l.size[0]; ++x)
              different += f.at(k, x, y, z) != expected.at(k, x + l.start[0], y + l.start[1], z + l.start[2]) ? 1 : 0;
      EXPECT_EQ(different, 0) << threads << " threads";
      // nothing is left in the rim
      double rim = 0;
      for (int k = 0; k < l.dimension; ++k)
        for (std::int64_t i = 0; i < l.count(); ++i)
          if (!l.ownedNode(l.node(i)))
            rim = std::max(rim, std::abs(f.component(k)[i]));
      EXPECT_EQ(rim, 0);
    }
  }
  omp_set_num_threads(before);
}

// Rows of other ranks that come while this rank's are summed: the same sums to round-off, the same critical bonds.
TEST_P(BondSums, ExchangeMeanwhile)
{
  SCOPED_TRACE(c.name);
  const Field u = randomField(sample, 0.05 * spacing, 7);
  const NodeField<double> v = scatter<double>(bonds, sample, u);
  const NodeLayout& l = bonds.layout();
  const int before = omp_get_max_threads();
  for (const bool nonlinear : { false, true })
    for (const int threads : { 1, 3 })
    {
      omp_set_num_threads(threads);
      NodeField<double> stale = v;
      for (int k = 0; k < l.dimension; ++k)
        for (std::int64_t i = 0; i < l.count(); ++i)
          if (!l.ownedNode(l.node(i)))
            stale.component(k)[i] = 0;
      NodeField<double> f(l);
      f.fill(99);
      if (nonlinear)
      {
        const CriticalBonds found = exchangeAndNonlinearForce(bonds, stale, f, true);
        NodeField<double> g(l);
        EXPECT_EQ(found.bonds, nonlinearForce(bonds, v, g, true).bonds);
        EXPECT_EQ(found.count, static_cast<std::int64_t>(found.bonds.size()));
      }
      else
        exchangeAndLinearForce(bonds, stale, f);
      EXPECT_LT(difference(f, sample, plainForce(plain, u, nonlinear)), roundOff);
    }
  omp_set_num_threads(before);
}

// Breaking: the sums after it are those without these bonds, on all ranks and across periodic sides.
TEST_P(BondSums, Breaking)
{
  SCOPED_TRACE(c.name);
  const Field u = randomField(sample, 0.05 * spacing, 8);
  NodeField<double> v = scatter<double>(bonds, sample, u);
  NodeField<double> f(bonds.layout());
  const CriticalBonds found = nonlinearForce(bonds, v, f, true);
  const std::int64_t critical = everyone().sum(found.count);
  ASSERT_GT(critical, 0);
  const std::int64_t before = bonds.bonds();
  EXPECT_EQ(bonds.breakBonds(found.bonds), critical);
  EXPECT_EQ(bonds.breakBonds(found.bonds), 0); // they are no more
  EXPECT_EQ(bonds.bonds(), before - critical);
  std::erase_if(plain, [&](const PlainBond& b) { return PlainState(b, u, true).stretch > b.s0; });
  EXPECT_EQ(2 * bonds.bonds(), static_cast<std::int64_t>(plain.size()));
  EXPECT_EQ(nonlinearForce(bonds, v, f).count, 0);
  EXPECT_LT(difference(f, sample, plainForce(plain, u, true)), roundOff);
  linearForce(bonds, v, f);
  EXPECT_LT(difference(f, sample, plainForce(plain, u, false)), roundOff);
}

// What a solver builds its coarse levels from.
TEST_P(BondSums, BondByBond)
{
  SCOPED_TRACE(c.name);
  const NodeLayout& l = bonds.layout();
  double halves = 0;
  double springs = 0;
  for (std::int64_t z = -l.ghostZ(); z < l.size[2] + l.ghostZ(); ++z)
    for (std::int64_t y = -l.ghost; y < l.size[1] + l.ghost; ++y)
      bonds.forEachBond(y, z,
        [&](std::int64_t i, std::int64_t j, int offset, int kind)
        {
          EXPECT_GT(kind, 0);
          const int ends = (l.ownedNode(l.node(i)) ? 1 : 0) + (l.ownedNode(l.node(j)) ? 1 : 0);
          EXPECT_GT(ends, 0);
          halves += 0.5 * ends;
          springs += 0.5 * ends * bonds.springConstant(i, offset);
        });
  EXPECT_EQ(everyone().sum(halves), static_cast<double>(bonds.bonds()));
  double expected = 0;
  for (const PlainBond& b : plain)
    expected += 0.5 * b.k / std::hypot(b.xi[0], b.xi[1], b.xi[2]);
  // up to 400 000 terms one after another
  EXPECT_NEAR(everyone().sum(springs), expected, 10 * roundOff * expected);
}

INSTANTIATE_TEST_SUITE_P(All, BondSums, testing::Range(0, static_cast<int>(cases().size())));

} // namespace
