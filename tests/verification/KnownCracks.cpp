// Cracks with a known solution: what a penny-shaped crack in space and a row of cracks under tension and under shear
// add to the compliance, and a slit in a disk that is pressed; from which the stress intensity follows.
#include "FractureSamples.h"

#include "peridynamics/Equilibrium.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::test;

/// Force that the high platen takes along the load.
double stiffness(const BondLattice& bonds, LoadCase load)
{
  Loading loading;
  loading.load = load;
  loading.axis = bonds.dimension() - 1;
  const Solution s = solve(bonds, loading, with(EquilibriumSolver::Multigrid, 1e-8));
  return -s.reaction.high[static_cast<std::size_t>(load == LoadCase::Shear ? 0 : loading.axis)];
}

double heightBetweenPlatens(const BondLattice& bonds)
{
  const LoadedSample s = applyLoading(bonds, {});
  return static_cast<double>(s.highLayers[0] - s.lowLayers[1] + 1);
}

// I. N. Sneddon, Proc. R. Soc. Lond. A 187 (1946) 229: at a stress σ a penny-shaped crack of radius a in an endless
// body sets 8 (1 − ν²) σ² a³/(3 E) free, and K = 2 σ √(a/π). The body is as wide as five radii, its sides periodic, so
// it is its modulus for strain along one axis, M, that falls: M/M' − 1 = 16 (1 − ν²) a³ M/(3 E V), six a³/V with the ν
// = 1/4 of bonds. The radius on the lattice is a + δ with one δ for all cracks: what is cut lies midway between nodes.
TEST(KnownCracks, PennyInSpace)
{
  const std::int64_t n = 40;
  BondModel model = modelOf(Continuum::Space, 3);
  model.periodic = { true, true, false };
  const Sample s = block(n, n, n);
  const auto bondsWith = [&](double radius)
  {
    BondLattice bonds = latticeOf(model, s, alone());
    const double centre = 0.5 * static_cast<double>(n);
    if (radius > 0)
      cut(bonds, 2, [&](double x, double y) { return std::hypot(x - centre, y - centre) < radius; });
    return bonds;
  };
  const BondLattice whole = bondsWith(0);
  const double volume = static_cast<double>(n * n) * heightBetweenPlatens(whole);
  const double sound = stiffness(whole, LoadCase::Stretch);
  std::vector<double> radii;
  for (const double radius : { 5.0, 6.5, 8.0 })
  {
    const double added = sound / stiffness(bondsWith(radius), LoadCase::Stretch) - 1;
    radii.push_back(std::cbrt(added * volume / 6)); // of the crack that adds as much
    EXPECT_NEAR(radii.back(), radius, 0.15);        // which columns of nodes a circle holds goes by leaps
  }
  // K² is the energy set free by a unit of area, Gc where the crack just grows: 1.4 % above the solution's, K 0.7 %
  const double square = (std::pow(radii[2], 3) - std::pow(radii[0], 3)) / (std::pow(8.0, 3) - std::pow(5.0, 3));
  EXPECT_NEAR(square, 1, 0.02);
  EXPECT_NEAR(std::sqrt(square), 1, 0.01);
}

// Cracks of half length a in a row W apart: K = σ √(W tan(π a/W)) under tension across them, τ in place of σ under
// shear along them (H. Tada, P. C. Paris and G. R. Irwin, The Stress Analysis of Cracks Handbook). One sets
// −2 σ² W²/(π E) ln cos(π a/W) free. Under shear bonds across the plane let go up to a spacing beyond the tip.

TEST(KnownCracks, RowUnderTensionAndShear)
{
  const std::int64_t n = 128;
  const auto width = static_cast<double>(n);
  const double nu = 1.0 / 3;
  BondModel model = modelOf(Continuum::PlaneStress, 3);
  model.periodic = { true, false, false };
  const Sample s = block(n, 2 * n);
  for (const LoadCase load : { LoadCase::Stretch, LoadCase::Shear })
  {
    const auto bondsWith = [&](double half)
    {
      BondLattice bonds = latticeOf(model, s, alone());
      if (half > 0)
        cut(bonds, 1, [&](double x, double) { return std::abs(x - 0.5 * width) < half; });
      return bonds;
    };
    const BondLattice whole = bondsWith(0);
    const double area = width * heightBetweenPlatens(whole);
    const double sound = stiffness(whole, load);
    // of strain along one axis, or of shear, over Young's
    const double modulus = load == LoadCase::Shear ? 1 / (2 * (1 + nu)) : 1 / (1 - nu * nu);
    double before = 0;
    double beforeExact = 0;
    for (const double half : { 8.0, 16.0, 24.0, 32.0 })
    {
      const double added = sound / stiffness(bondsWith(half), load) - 1;
      const double set = added * area * std::numbers::pi / (4 * modulus * width * width);
      const double exact = -std::log(std::cos(std::numbers::pi * half / width));
      const double equal = width / std::numbers::pi * std::acos(std::exp(-set)); // half length that sets as much free
      EXPECT_NEAR(equal, half, load == LoadCase::Shear ? 0.7 : 0.2);
      if (before >
        0) // mean over the growth since; 2.6 % above under shear, 0.7 % under tension, less for longer cracks
        EXPECT_NEAR(std::sqrt((set - before) / (exact - beforeExact)), 1, load == LoadCase::Shear ? 0.03 : 0.015);
      before = set;
      beforeExact = exact;
    }
  }
}

// Of a disk of radius R pressed along a slit of half length a, K = P √a N/(√π R), N of a/R tabled by C. Atkinson, R. E.
// Smelser and J. Sanchez, Int. J. Fract. 18 (1982) 279.
TEST(KnownCracks, SlitInADiskThatIsPressed)
{
  const std::int64_t n = 160;
  BondModel model = modelOf(Continuum::PlaneStress, 3);
  Sample s = block(n, n);
  const double radius = 72;
  const double centre = 0.5 * static_cast<double>(n) - 0.5;
  for (std::int64_t y = 0; y < n; ++y)
    for (std::int64_t x = 0; x < n; ++x)
    {
      const double fromX = static_cast<double>(x) - centre;
      const bool anvil = std::abs(fromX) < 4; // between disk and platens
      s.phase[static_cast<std::size_t>(s.lattice.index(x, y, 0))] =
        anvil || std::hypot(fromX, static_cast<double>(y) - centre) < radius ? 1 : 0;
    }
  const auto compliance = [&](double half)
  {
    BondLattice bonds = latticeOf(model, s, alone());
    cut(bonds, 0, [&](double y, double) { return std::abs(y - centre) < half; });
    return 1e-3 * heightBetweenPlatens(bonds) * spacing / stiffness(bonds, LoadCase::Stretch);
  };
  constexpr double tabled[] = { 1.060049, 1.135551, 1.243134 };
  double before = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double share = 0.2 + 0.1 * k;
    const double now = compliance(share * radius);
    if (k > 0)
    {
      // C = … + 4/(π E R²) ∫ a N² da, N² linear in a² between two of the table
      const double from = share - 0.1;
      const double square = tabled[k - 1] * tabled[k - 1];
      const double slope = (tabled[k] * tabled[k] - square) / (share * share - from * from);
      const double a2 = share * share - from * from;
      const double integral = 0.5 * square * a2 + 0.25 * slope * a2 * a2;
      const double exact = 4 / (std::numbers::pi * young) * integral;
      EXPECT_NEAR(std::sqrt((now - before) / exact), 1, 0.03); // 1.9 % above and 1.7 % below
    }
    before = now;
  }
}

} // namespace
