// Equilibrium of bond lattices on any number of ranks.
#include "BondSamples.h"

#include "peridynamics/Fragments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{

using namespace lamella;
using namespace lamella::test;

TEST(BondEquilibriumRanks, AnyNumberOfRanks)
{
  for (const int dimension : { 2, 3 })
  {
    const Sample s = dimension == 2 ? aggregate(64, 150) : aggregate(16, 18, 40);
    BondModel m = aggregateModel(dimension);
    m.periodic[0] = true;
    const BondLattice whole = latticeOf(m, s, alone());
    const BondLattice part = latticeOf(m, s, everyone());
    const Solution a = solve(whole, {}, with(EquilibriumSolver::Multigrid, 1e-12));
    const Solution b = solve(part, {}, with(EquilibriumSolver::Multigrid, 1e-12));
    const NodeLayout& l = part.layout();
    double size = 0;
    double most = 0;
    for (int c = 0; c < dimension; ++c)
      for (std::int64_t z = 0; z < l.size[2]; ++z)
        for (std::int64_t y = 0; y < l.size[1]; ++y)
          for (std::int64_t x = 0; x < l.size[0]; ++x)
          {
            const double there = a.u.at(c, x, y + l.start[1], z + l.start[2]);
            if (part.degree(l.index(x, y, z)) > 0)
              most = std::max(most, std::abs(there - b.u.at(c, x, y, z)));
            size = std::max(size, std::abs(there));
          }
    EXPECT_LT(most / size, 1e-9) << dimension;
    const auto axis = static_cast<std::size_t>(dimension - 1);
    EXPECT_NEAR(a.reaction.low[axis], b.reaction.low[axis], 1e-9 * std::abs(a.reaction.low[axis]));
    EXPECT_NEAR(largestStretch(whole, a.u, false).ratio, largestStretch(part, b.u, false).ratio,
      1e-8 * largestStretch(whole, a.u, false).ratio);
    EXPECT_EQ(findFragments(whole).pieces.size(), findFragments(part).pieces.size());
  }
}

// Multigrid needs slabs that begin at even layers. 22 layers on four ranks are 6 for one of them anyway; 42 are 11, and
// 12 where they are halved.
TEST(BondEquilibriumRanks, SlabsCanBeHalved)
{
  const Stencil stencil(2, 3);
  const std::int64_t ranks = everyone().size();
  for (const std::int64_t layers : { 22, 30, 42, 100, 1022 })
  {
    const Block b = slab(makeLattice(8, layers, 1, 2, 1e-6), stencil, everyone());
    const double even = static_cast<double>(layers) / static_cast<double>(ranks);
    EXPECT_LE(static_cast<double>(b.size[1]), std::max(std::ceil(even) + (even >= 8 ? 1 : 0), 1.04 * even)) << layers;
    EXPECT_EQ(everyone().sum(b.size[1]), layers);
    if (ranks == 4)
      EXPECT_EQ(b.start[1] % 2, 0) << layers;
  }
}

} // namespace
