// A disk that splits between two jaws, against the stresses in it and against a strip of the same material.
#include "FractureSamples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::test;

constexpr double critical = 0.01; // stretch

struct Split
{
  double first = 0;  ///< 2 P/(π D t) at the first break, over E s₀
  double peak = 0;   ///< likewise the largest before the disk has split
  double across = 0; ///< of the first bond from the axis of loading [spacings]
  double along = 0;  ///< along the axis from the centre, over the radius
};

/// @param angle half of what a jaw covers [°]
/// @param breakable up to which height the disk's bonds break, over the radius
Split split(double radius, double angle, double breakable)
{
  const double half = radius * std::sin(angle * std::numbers::pi / 180);
  const auto n = static_cast<std::int64_t>(2 * radius) + 12;
  Breakable s{ block(n, n), modelOf(Continuum::PlaneStress, 3) };
  s.model.micromodulus = Micromodulus::Isotropic;
  s.model.pairs[{ 1, 2 }] = s.model.pairs[{ 2, 2 }] = { BondMaterial{ .youngsModulus = young } };
  const double centre = 0.5 * static_cast<double>(n - 1);
  for (std::int64_t y = 0; y < n; ++y)
    for (std::int64_t x = 0; x < n; ++x)
    {
      const double across = std::abs(static_cast<double>(x) - centre);
      const double along = std::abs(static_cast<double>(y) - centre);
      const bool disk = std::hypot(across, along) < radius;
      s.sample.phase[static_cast<std::size_t>(s.sample.lattice.index(x, y))] =
        static_cast<std::uint8_t>(disk && along <= breakable * radius ? 1
            : disk || across < half                                   ? 2
                                                                      : 0);
    }
  FractureOptions o = by(FractureMethod::Events, 0.5);
  o.maxBroken = static_cast<std::int64_t>(20 * radius); // half of the bonds that cross the axis
  const FractureRecord r = fracture(s, o, { .strain = -1e-3, .smooth = true });
  const double share = static_cast<double>(n) / (std::numbers::pi * radius) / (young * critical);
  const Bond& b = r.broken.front().bond;
  return { r.first.stress * share, r.peak.stress * share, static_cast<double>(b.node[0]) - centre,
    std::abs(static_cast<double>(b.node[1]) - centre) / radius };
}

struct Greatest
{
  double strain = 0; ///< times E over 2 P/(π D t)
  double along = 0;  ///< from the centre, over the radius
};

/// Of the strain across the axis of loading of a disk under a pressure over an arc, by its stresses after G. Hondros,
/// Aust. J. Appl. Sci. 10 (1959) 243.
Greatest greatestStrain(double angle)
{
  const double a = angle * std::numbers::pi / 180;
  const double nu = 1.0 / 3;
  Greatest g;
  for (double r = 0; r < 0.999; r += 0.001)
  {
    const double r2 = r * r;
    const double one = (1 - r2) * std::sin(2 * a) / (1 - 2 * r2 * std::cos(2 * a) + r2 * r2);
    const double two = std::atan((1 + r2) / (1 - r2) * std::tan(a));
    const double strain = (one - two + nu * (one + two)) / a; // σ across less ν σ along
    if (strain > g.strain)
      g = { strain, r };
  }
  return g;
}

// Bonds break by their stretch, and the pressure along the axis stretches those across it too: with ν = 1/3 the disk
// splits at half of the tensile strength or less, and its crack begins where the strain is greatest, between centre and
// jaw: at 0.67 of the radius where jaws cover 20°. A jaw that does not give presses more with its edges than an even
// pressure does, and the disk bears 10 % more; a jaw a tenth wider would make that 5 %.
TEST(BrazilianDisk, SplitsWhereTheStrainIsGreatest)
{
  const double angle = 10;
  const Greatest exact = greatestStrain(angle);
  EXPECT_NEAR(exact.along, 0.675, 0.001);
  for (const double radius : { 24.0, 48.0 })
  {
    const Split s = split(radius, angle, 0.8);
    EXPECT_LT(std::abs(s.across), 1.1) << radius; // a bond's first node; its middle is on the axis
    EXPECT_NEAR(s.along, exact.along, 0.06) << radius;
    EXPECT_NEAR(s.first * exact.strain, 1.1, 0.03) << radius;
    EXPECT_NEAR(s.peak / s.first, 1, 1e-6) << radius; // and it runs at once
    // where all may break bonds beside the jaws do before, which the strength does not mind
    const Split all = split(radius, angle, 1);
    EXPECT_LT(all.first, 0.95 * s.first) << radius;
    EXPECT_NEAR(all.peak / s.peak, 1, 0.004) << radius;
  }
  // of a strip some bonds are stretched more than its mean, whatever its width
  Breakable bar = strip(48, 96, 3);
  bar.model.micromodulus = Micromodulus::Isotropic;
  const double direct = fracture(bar, by(FractureMethod::Events, 0.5), { .smooth = true }).peak.stress;
  EXPECT_NEAR(direct / (young * critical), 0.936, 0.005);
}

} // namespace
