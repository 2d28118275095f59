// Energy that a crack sets free while it grows: a straight front in a strip, and a penny-shaped crack in space.
#include "FractureSamples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::test;

constexpr double horizon = 2;
constexpr double critical = 0.01;

/// Two halves that do not break, and bonds between them that do: a crack stays in the plane.
Breakable weakPlane(std::int64_t nx, std::int64_t ny, std::int64_t nz)
{
  Breakable w{ block(nx, ny, nz), modelOf(Continuum::Space, horizon) };
  w.model.micromodulus = Micromodulus::Isotropic;
  const BondMaterial solid{ .youngsModulus = young };
  w.model.pairs = { { { 1, 1 }, { solid } }, { { 2, 2 }, { solid } },
    { { 1, 2 }, { BondMaterial{ .youngsModulus = young, .criticalStretch = critical } } } };
  for (std::int64_t i = 0; i < w.sample.lattice.count(); ++i)
    w.sample.phase[static_cast<std::size_t>(i)] = i / (nx * ny) < nz / 2 ? 1 : 2;
  return w;
}

/// Bonds that cross the plane at a node of it.
int bondsANode()
{
  const Stencil stencil(3, horizon);
  int count = 0;
  for (const Offset& o : stencil.half())
    count += std::abs(o.step[2]);
  return count;
}

struct Growth
{
  double released = 0; ///< energy set free, each bond at the strain that it just breaks at [J]
  double inBonds = 0;  ///< of the broken bonds when they were just critical [J]
  double lost = 0;     ///< stiffness times volume, energy over half a squared strain [J]
};

/// While bonds number `from` to `to` break, of those after a crack was cut where `cracked` says.
Growth growth(const Breakable& w, const std::function<bool(double, double)>& cracked, std::int64_t from,
  std::int64_t to, FractureMethod method)
{
  BondLattice bonds = latticeOf(w.model, w.sample, alone());
  const BondLattice whole = latticeOf(w.model, w.sample, alone());
  cut(bonds, 2, cracked);
  FractureOptions o = by(method, 0);
  o.maxBroken = to + 1;
  o.tolerance = 1e-7;
  QuasiStaticFracture f(bonds, { .rigid = true }, o); // so that work is force times movement
  f.run();
  const std::vector<BrokenBond>& broken = f.record().broken;
  const NodeLayout& l = bonds.layout();
  const std::int64_t height = f.sample().highLayers[0] - f.sample().lowLayers[1] + 1;
  const double volume = static_cast<double>(l.size[0] * l.size[1] * height) * std::pow(spacing, 3);
  const auto stiffness = [&](std::size_t i) { return broken[i].stress / broken[i].strain; };
  Growth g;
  for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i)
  {
    const double strain = broken[i].criticalStrain;
    g.released += 0.5 * strain * strain * (stiffness(i) - stiffness(i + 1)) * volume;
    const Bond& b = broken[i].bond;
    const double elongation = critical * bonds.stencil().half()[static_cast<std::size_t>(b.offset)].length * spacing;
    g.inBonds +=
      0.5 * whole.springConstant(l.index(b.node[0], b.node[1], b.node[2]), b.offset) * elongation * elongation;
    g.lost += (stiffness(i) - stiffness(i + 1)) * volume;
  }
  return g;
}

/// A straight front that goes on by two spacings along an axis, far from where it began.
Growth straightFront(std::int64_t ny)
{
  Breakable strip = weakPlane(38, ny, 14);
  strip.model.periodic = { false, true, false };
  const std::int64_t row = ny * bondsANode();
  return growth(
    strip, [](double x, double) { return x < 12; }, 4 * row, 6 * row, FractureMethod::Accurate);
}

// In a strip between platens a crack that is longer than the strip is high takes away what the strip ahead of it bore
// (J. R. Rice, J. Appl. Mech. 35 (1968) 379): the front has forgotten where it began.
TEST(GrowingCracks, StraightFrontIsSteady)
{
  const std::int64_t ny = 5;
  const Growth g = straightFront(ny);
  const double area = 2.0 * static_cast<double>(ny) * spacing * spacing;
  Breakable endless = weakPlane(16, ny, 14); // without a crack
  endless.model.periodic = { true, true, false };
  BondLattice bonds = latticeOf(endless.model, endless.sample, alone());
  const double modulus = QuasiStaticFracture(bonds, { .rigid = true }, by(FractureMethod::Accurate)).record().modulus;
  const double height = (14 - 2 * 2 + 1) * spacing;
  EXPECT_NEAR(g.lost / (modulus * area * height), 1, 0.02);
}

// What a lattice takes for an area of crack is what a straight front in it takes: more than its bonds hold when they
// are just critical, for their neighbours spring back. A penny-shaped crack takes that, too, in whatever direction it
// grows.
TEST(GrowingCracks, PennyTakesWhatAStraightFrontTakes)
{
  const Growth straight = straightFront(5);
  const std::int64_t n = 24;
  const double centre = 0.5 * static_cast<double>(n - 1);
  const auto bonds = [](double radius)
  { return static_cast<std::int64_t>(std::numbers::pi * radius * radius * bondsANode()); };
  const Growth penny = growth(
    weakPlane(n, n, n), [&](double x, double y) { return std::hypot(x - centre, y - centre) < 5; }, 0,
    bonds(7) - bonds(5), FractureMethod::Events);
  EXPECT_NEAR(straight.released / straight.inBonds, 1.288, 0.005);                               // of this lattice
  EXPECT_NEAR(penny.released / penny.inBonds / (straight.released / straight.inBonds), 1, 0.02); // 1.3 % less
}

} // namespace
