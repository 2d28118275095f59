// Sizes of cracks by the number of their broken bonds, against those of the surfaces that cut them.
#include "CrackCuts.h"

#include <gtest/gtest.h>

namespace
{

using namespace lamella;
using namespace lamella::test;

// A plane that cuts all bonds is exactly as large as its counted bonds say, but for the anisotropy of the weights and
// for what the lattice rounds at its rim, which is of the order of the horizon over the length.
TEST(BondCount, StraightCracksAtAllAngles)
{
  for (const double h : { 2.0, 3.0, 4.0, 8.0 })
  {
    const BondCount count(2, h);
    const Lattice lattice = square(220);
    for (int angle = 0; angle < 180; angle += 9)
    {
      const double t = angle * pi / 180;
      constexpr double half = 90;
      const Place c{ 109.63, 109.71 };
      const Line line{ { c[0] - half * std::cos(t), c[1] - half * std::sin(t) },
        { c[0] + half * std::cos(t), c[1] + half * std::sin(t) } };
      const std::vector<CutBond> bonds = cut(lattice, h, line);
      EXPECT_NEAR(count.size(bonds) / (2 * half), 1, count.anisotropy() + 0.005) << h << " " << angle;
      // with the direction known the count is exact: one bond of each step crosses each |ξ · n| of the line
      const CrackPaths found = pathsOf(lattice, h, bonds);
      ASSERT_EQ(found.paths.size(), 1U);
      EXPECT_NEAR(found.paths[0].countedLength() / (2 * half), 1, 0.005) << h << " " << angle;
      // the mean normal, from the same counts; of an isotropic half stencil exactly n ⊗ n
      const std::array<double, 9> n = count.normals(bonds);
      EXPECT_NEAR(n[0] + n[4], 1, 1e-9);
      if (h > 2)
        EXPECT_LT(turn(std::atan2(2 * n[1], n[0] - n[4]) / 2, t + pi / 2), 5 * pi / 180) << h << " " << angle;
    }
  }
}

// Anisotropy of the weights on lattices of few directions.
TEST(BondCount, AnisotropyFallsWithTheHorizon)
{
  for (const int dimension : { 2, 3 })
  {
    double last = 1;
    for (const double h : { 1.0, 2.0, 3.0, 4.0, 6.0 })
    {
      const double anisotropy = BondCount(dimension, h).anisotropy();
      EXPECT_LT(anisotropy, last) << h;
      last = anisotropy;
    }
    EXPECT_LT(last, 0.012);
  }
}

/// Bonds that a surface cuts: those between a node inside and one outside.
std::vector<CutBond> between(
  const Lattice& lattice, double h, const std::function<bool(double, double, double)>& inside)
{
  const peridynamics::Stencil stencil(3, h);
  std::vector<CutBond> bonds;
  const auto in = [&](std::int64_t x, std::int64_t y, std::int64_t z)
  { return inside(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)); };
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < lattice.size[0]; ++x)
        for (const peridynamics::Offset& o : stencil.half())
          if (in(x, y, z) != in(x + o.step[0], y + o.step[1], z + o.step[2]))
            bonds.push_back({ { x, y, z }, o.step, 0, 0, {}, false });
  return bonds;
}

TEST(BondCount, ASphereAndAPlaneInSpace)
{
  const Lattice lattice = makeLattice(48, 48, 48, 3, 1);
  for (const double h : { 2.0, 3.0 })
  {
    const BondCount count(3, h);
    constexpr double r = 17;
    const auto sphere =
      between(lattice, h, [](double x, double y, double z) { return std::hypot(x - 23.6, y - 23.3, z - 23.8) < r; });
    // all directions: the anisotropy cancels. Bonds of length h find the sphere smaller by (h/2r)²/3 or so
    EXPECT_NEAR(count.size(sphere) / (4 * pi * r * r), 1, 0.01) << h;
    const std::array<double, 9> round = count.normals(sphere);
    for (const std::size_t i : { 0, 4, 8 })
      EXPECT_NEAR(round[i], 1.0 / 3, 0.02);

    // a plane through the whole box, nodes at both ends of bonds outside it counted too
    const Place n{ 0.36, 0.48 }; // and 0.8
    const auto plane = between(lattice, h,
      [&](double x, double y, double z) { return (x - 23.7) * n[0] + (y - 23.2) * n[1] + (z - 23.4) * 0.8 < 0; });
    EXPECT_NEAR(count.size(plane) * 0.8 / (48 * 48), 1, count.anisotropy() + 0.01) << h;
    const std::array<double, 9> tensor = count.normals(plane);
    EXPECT_NEAR(tensor[0] + tensor[4] + tensor[8], 1, 1e-9);
    EXPECT_NEAR(tensor[8], 0.64, 0.1) << h;
    EXPECT_NEAR(tensor[5], 0.48 * 0.8, 0.1) << h;
  }
}

} // namespace
