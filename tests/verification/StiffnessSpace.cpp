// Effective stiffness of cells in space and of odd numbers of nodes.
#include "BondSamples.h"

#include "peridynamics/BondSets.h"
#include "peridynamics/PeriodicCell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::test;

BondModel periodicModel(Continuum continuum, double horizon)
{
  BondModel m = modelOf(continuum, horizon);
  m.periodic = { true, true, continuum == Continuum::Space };
  return m;
}

// Long bonds lead from the rim to beyond the layout. Reading there was the end of volumes of 52³ and more at horizon 3
// and of 48³ at 4; of smaller ones the address sanitizer tells.
TEST(StiffnessSpace, SetsStayWithinTheLayout)
{
  struct Size
  {
    std::array<std::int64_t, 3> nodes;
    double horizon;
  };
  for (const Size& s : { Size{ { 9, 10, 11 }, 2 }, Size{ { 16, 13, 12 }, 3 }, Size{ { 12, 12, 17 }, 4 },
         Size{ { 13, 11, 12 }, 5 }, Size{ { 52, 52, 52 }, 3 }, Size{ { 48, 48, 48 }, 4 }, Size{ { 128, 128, 8 }, 3 } })
  {
    SCOPED_TRACE(s.horizon);
    Sample sample = block(s.nodes[0], s.nodes[1], s.nodes[2]);
    // a slot across z, one node deep, that bonds reach over: one piece still
    for (std::int64_t i = 0; i < s.nodes[0] * s.nodes[1]; ++i)
      sample.phase[static_cast<std::size_t>(i)] = 0;
    const BondLattice bonds = latticeOf(periodicModel(Continuum::Space, s.horizon), sample, alone());
    Sets sets = joinBonds(bonds);
    const NodeLayout& l = bonds.layout();
    std::int64_t pieces = 0;
    for (std::int64_t i = 0; i < l.count(); ++i)
      pieces += bonds.solid(i) && sets.at(i) == i ? 1 : 0;
    EXPECT_EQ(pieces, 1);
  }
}

// C₁₂ = C₄₄ is 0.4 E in space, E 3/8 in plane stress, 0.4 E in plane strain, C₁₁ three times that: to round-off at
// every horizon. Without weights it was 0.487 at a horizon of 3 in space.
TEST(StiffnessSpace, AHomogeneousCellIsIsotropic)
{
  for (const Continuum continuum : { Continuum::PlaneStress, Continuum::PlaneStrain, Continuum::Space })
    for (const double horizon : { 2.0, 3.0, 4.0, 5.0 })
    {
      SCOPED_TRACE(horizon);
      BondModel m = periodicModel(continuum, horizon);
      m.micromodulus = Micromodulus::Isotropic;
      const Sample s = continuum == Continuum::Space ? block(12, 11, 10) : block(17, 20);
      const EffectiveStiffness cell = effectiveStiffness(latticeOf(m, s, alone()), {});
      const auto n = static_cast<std::size_t>(cell.components);
      const std::size_t d = n == 6 ? 3 : 2;
      const double c12 = young * (continuum == Continuum::PlaneStress ? 0.375 : 0.4);
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b)
        {
          const double exact = a == b && a < d ? 3 * c12 : a == b || (a < d && b < d) ? c12 : 0;
          EXPECT_NEAR(cell.stiffness[a * n + b], exact, 1e-12 * young) << a << b;
          EXPECT_NEAR(cell.bounds.voigt[a * n + b], exact, 1e-12 * young) << a << b;
          EXPECT_NEAR(cell.bounds.reuss[a * n + b], exact, 1e-12 * young) << a << b;
        }
      m.micromodulus = Micromodulus::Continuum;
      const double plain = effectiveStiffness(latticeOf(m, s, alone()), {}).stiffness[1] / young;
      if (continuum == Continuum::Space && horizon == 3)
        EXPECT_NEAR(plain, 0.487, 5e-4);
    }
}

/// Two phases and voids that begin again after any number of nodes.
Sample waves(std::int64_t nx, std::int64_t ny, std::int64_t nz)
{
  Sample s = block(nx, ny, nz);
  const auto turn = [](std::int64_t i, std::int64_t n)
  { return 2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n); };
  for (std::int64_t k = 0; k < nz; ++k)
    for (std::int64_t j = 0; j < ny; ++j)
      for (std::int64_t i = 0; i < nx; ++i)
      {
        const double x = turn(i, nx);
        const double y = turn(j, ny);
        const double z = nz > 1 ? turn(k, nz) : 0;
        const double wave = std::sin(x + 2 * y) + std::sin(y - z + 1) + std::sin(2 * x + y + z + 2);
        s.phase[static_cast<std::size_t>(s.lattice.index(i, j, k))] = wave < -1.6 ? 0 : wave < 0.3 ? 1 : 2;
      }
  return s;
}

std::int64_t iterationsOf(const Sample& s, double horizon)
{
  BondModel m = periodicModel(s.lattice.dimension == 3 ? Continuum::Space : Continuum::PlaneStress, horizon);
  m.pairs[{ 2, 2 }].material.youngsModulus = 10 * young;
  m.pairs[{ 1, 2 }].material.youngsModulus = 2 * young;
  const BondLattice bonds = latticeOf(m, s, everyone());
  EquilibriumOptions o;
  o.tolerance = 1e-6;
  const EffectiveStiffness c = effectiveStiffness(bonds, o);
  std::int64_t most = 0;
  for (const EquilibriumResult& r : c.solutions)
    most = std::max(most, r.iterations);
  return most;
}

// An odd number of nodes that begins again is halved as an even one is, and so takes about as many iterations, on any
// number of ranks; before, a level that could not be halved was smoothed, or factorised.
TEST(OddSides, TakeAsManyIterationsAsEvenOnes)
{
  const auto close = [](const std::array<std::int64_t, 3>& size, double horizon, std::int64_t even)
  {
    EXPECT_LE(
      static_cast<double>(iterationsOf(waves(size[0], size[1], size[2]), horizon)), 1.6 * static_cast<double>(even))
      << size[0] << " x " << size[1] << " x " << size[2] << ", horizon " << horizon;
  };
  if (everyone().parallel())
  {
    // slabs of smaller cells are not halved: they begin where shares are even
    const std::int64_t even = iterationsOf(waves(128, 128, 1), 3);
    EXPECT_LT(even, 30);
    for (const std::array<std::int64_t, 3>& size :
      { std::array<std::int64_t, 3>{ 127, 127, 1 }, { 128, 127, 1 }, { 127, 128, 1 } })
      close(size, 3, even);
    return;
  }
  for (const double horizon : { 2.0, 3.0, 5.0 })
  {
    const std::int64_t even = iterationsOf(waves(64, 64, 1), horizon);
    EXPECT_LT(even, 30);
    for (const std::array<std::int64_t, 3>& size :
      { std::array<std::int64_t, 3>{ 63, 63, 1 }, { 63, 64, 1 }, { 64, 63, 1 }, { 61, 57, 1 }, { 66, 59, 1 } })
      close(size, horizon, even);
  }
  const std::int64_t even = iterationsOf(waves(20, 20, 20), 2);
  for (const std::array<std::int64_t, 3>& size :
    { std::array<std::int64_t, 3>{ 19, 19, 19 }, { 19, 20, 20 }, { 20, 21, 20 }, { 20, 20, 21 } })
    close(size, 2, even);
}

} // namespace
