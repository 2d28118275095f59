// Areas of lumens: affine deformations to round-off, one lumen squeezed, the rim, strains of collapse, what is refused.
#include "Support.h"

#include "compression/CollapseStrain.h"
#include "compression/LumenAreas.h"
#include "core/Error.h"
#include "mpm/MaterialPoints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace
{

using namespace lamella;
using namespace lamella::compression;

/// Phases by a rule: 0 is lumen.
std::vector<std::uint8_t> phases(const Lattice& lattice, const std::function<int(int, int, int)>& rule)
{
  std::vector<std::uint8_t> phase;
  for (int z = 0; z < lattice.size[2]; ++z)
    for (int y = 0; y < lattice.size[1]; ++y)
      for (int x = 0; x < lattice.size[0]; ++x)
        phase.push_back(static_cast<std::uint8_t>(rule(x, y, z)));
  return phase;
}

/// Cells of 6 nodes with walls of 2; the rim cuts those on two sides.
int cells(int x, int y, int z)
{
  return x % 6 < 2 || y % 6 < 2 || z % 6 < 2 ? 1 : 0;
}

/// Columns as filters have them.
struct State
{
  std::vector<std::uint32_t> id;
  std::vector<double> position;
  std::vector<double> gradient;

  [[nodiscard]] PointState view() const { return { id, position, gradient }; }
};

/// A map x(X) with its gradient, 3 × 3 by rows.
using Map = std::function<void(const std::array<double, 3>& from, std::array<double, 3>& to, std::array<double, 9>& f)>;

/// The points of a lattice after a map, in an order that is not theirs.
template <int Dim>
State moved(const Lattice& lattice, const std::vector<std::uint8_t>& phase, int perNode, const Map& map)
{
  using Points = mpm::MaterialPoints<Dim>;
  const Points points = mpm::pointsFromLattice<Dim>(lattice, phase, {}, { .perNode = perNode });
  std::vector<std::uint32_t> order(points.id().begin(), points.id().end());
  std::shuffle(order.begin(), order.end(), std::mt19937_64(3));
  State state;
  for (const std::uint32_t p : order)
  {
    std::array<double, 3> from{};
    for (int i = 0; i < Dim; ++i)
      from[i] = points.column(Points::positions + i)[p];
    std::array<double, 3> to{};
    std::array<double, 9> f{};
    map(from, to, f);
    state.id.push_back(points.id()[p]);
    state.position.insert(state.position.end(), to.begin(), to.end());
    state.gradient.insert(state.gradient.end(), f.begin(), f.end());
  }
  return state;
}

Map affine(const std::array<double, 9>& a)
{
  return [=](const std::array<double, 3>& from, std::array<double, 3>& to, std::array<double, 9>& f)
  {
    f = a;
    for (std::size_t i = 0; i < 3; ++i)
      to[i] = 1e-3 * static_cast<double>(i) + a[3 * i] * from[0] + a[3 * i + 1] * from[1] + a[3 * i + 2] * from[2];
  };
}

double determinant(const std::array<double, 9>& a)
{
  return a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) + a[2] * (a[3] * a[7] - a[4] * a[6]);
}

std::vector<double> ratios(const LumenAreas& lumens, const State& state)
{
  std::vector<double> areas(lumens.lumens().size());
  lumens.areas(state.view(), areas);
  for (std::size_t i = 0; i < areas.size(); ++i)
    areas[i] /= lumens.initial()[i];
  return areas;
}

// A corner is then the same point, whichever point of whichever node carries it: areas are exact to round-off, those of
// lumens that the rim cuts as well. 1e-11: places are 2 mm from the origin, known to 4e-19 m, and a lumen is 4 µm wide.
TEST(LumenAreas, AffineDeformationIsExact)
{
  const Lattice lattice = makeLattice(25, 22, 1, 2, 1e-6);
  const std::vector<std::uint8_t> phase = phases(lattice, [](int x, int y, int) { return cells(x, y, 3); });
  const LumenAreas lumens(lattice, phase, {});
  ASSERT_EQ(lumens.lumens().size(), 16U);
  EXPECT_NEAR(lumens.initial()[0], 16e-12, 1e-24);
  EXPECT_EQ(std::ranges::count_if(lumens.lumens(), [](const pores::Pore& p) { return p.touches != 0; }), 4);
  for (const int perNode : { 1, 2, 3 })
    for (const std::array<double, 9>& f : { std::array<double, 9>{ 1, 0, 0, 0, 0.4, 0, 0, 0, 1 },
           std::array<double, 9>{ 1.1, 0.3, 0, -0.2, 0.7, 0, 0, 0, 1 },
           std::array<double, 9>{ std::cos(0.7), -std::sin(0.7), 0, std::sin(0.7), std::cos(0.7), 0, 0, 0, 1 } })
      for (const double ratio : ratios(lumens, moved<2>(lattice, phase, perNode, affine(f))))
        EXPECT_NEAR(ratio, determinant(f), 1e-11);
}

TEST(LumenAreas, AffineDeformationIsExactInSpace)
{
  const Lattice lattice = makeLattice(13, 12, 9, 3, 2e-6);
  const std::vector<std::uint8_t> phase = phases(lattice, cells);
  const LumenAreas lumens(lattice, phase, {});
  ASSERT_EQ(lumens.lumens().size(), 8U);
  EXPECT_NEAR(lumens.initial()[0], 64 * 8e-18, 1e-27);
  const double c = std::cos(0.4);
  const double s = std::sin(0.4);
  for (const int perNode : { 1, 2 })
    for (const std::array<double, 9>& f : { std::array<double, 9>{ 1, 0, 0, 0, 1, 0, 0, 0, 0.3 },
           std::array<double, 9>{ 1.1, 0.3, 0.1, -0.2, 0.7, 0, 0.2, 0, 0.9 },
           std::array<double, 9>{ c, -s * c, s * s, s, c * c, -s * c, 0, s, c } })
      for (const double ratio : ratios(lumens, moved<3>(lattice, phase, perNode, affine(f))))
        EXPECT_NEAR(ratio, determinant(f), 1e-11);
}

// x = X, y = Y − a sin²: smooth, so that areas are those of ∫ dy/dY over the lumen but for the polygon's sides, which
// are chords, and for what is not linear within a pixel: of second order.
TEST(LumenAreas, SmoothDeformationConvergesAsTheSquareOfTheSpacing)
{
  const auto worst = [](int n)
  {
    const Lattice lattice = makeLattice(4 * n, 4 * n, 1, 2, 1.0 / n);
    const std::vector<std::uint8_t> phase = phases(lattice,
      [n](int x, int y, int) { return x >= n && x < 3 * n && y >= n && y < 3 * n ? 0 : 1; }); // a square from 1 to 3
    const Map map = [](const std::array<double, 3>& from, std::array<double, 3>& to, std::array<double, 9>& f)
    {
      to = { from[0], from[1] + 0.1 * std::sin(from[1]) * from[0] * from[0], 0 };
      f = { 1, 0, 0, 0.2 * std::sin(from[1]) * from[0], 1 + 0.1 * std::cos(from[1]) * from[0] * from[0], 0, 0, 0, 1 };
    };
    const LumenAreas lumens(lattice, phase, {});
    std::vector<double> area(1);
    lumens.areas(moved<2>(lattice, phase, 2, map).view(), area);
    // ∫₁³∫₁³ 1 + 0.1 x² cos y
    return std::abs(area[0] - (4 + 0.1 * 26.0 / 3 * (std::sin(3.0) - std::sin(1.0))));
  };
  const double coarse = worst(10);
  EXPECT_LT(coarse, 2e-3);
  EXPECT_NEAR(std::log2(coarse / worst(20)), 2, 0.1);
}

// The wall above one of three lumens comes down; all others stay.
TEST(LumenAreas, OnlyTheLumenThatIsSqueezedGivesWay)
{
  const Lattice lattice = makeLattice(20, 8, 1, 2, 1e-6);
  const auto rule = [](int x, int y, int) { return x % 6 < 2 || y < 2 || y >= 6 ? 1 : 0; };
  const std::vector<std::uint8_t> phase = phases(lattice, rule);
  const LumenAreas lumens(lattice, phase, {});
  ASSERT_EQ(lumens.lumens().size(), 3U);
  CollapseStrain collapse(3, 0.6);
  for (const double down : { 1e-6, 2e-6 })
  {
    const Map map = [&](const std::array<double, 3>& from, std::array<double, 3>& to, std::array<double, 9>& f)
    {
      f = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
      to = from;
      if (from[1] > 6e-6 && from[0] > 7.9e-6 && from[0] < 12.1e-6)
        to[1] -= down;
    };
    const std::vector<double> found = ratios(lumens, moved<2>(lattice, phase, 2, map));
    const auto middle = static_cast<std::size_t>(lumens.labels()[lattice.index(10, 4)]) - 1;
    for (std::size_t i = 0; i < 3; ++i)
      if (i == middle)
        // its two upper corners are shared with two nodes that stay, and go a third of the way: a trapezium
        EXPECT_NEAR(found[i], 1 - down / 4e-6 * (2 + 2 * 2.0 / 3) / 4, 1e-9);
      else
        EXPECT_NEAR(found[i], 1, 1e-9);
    collapse.add(0.1 * down / 1e-6, found);
  }
  // Ratios of 19/24 and 14/24 at 0.1 and 0.2: 0.6 between them.
  EXPECT_EQ(collapse.collapsed(), 1U);
  const auto strains = collapse.strain();
  EXPECT_EQ(std::ranges::count_if(
              strains, [](double s) { return std::isnan(s); }),
    2);
  EXPECT_NEAR(*std::ranges::find_if(strains, [](double s) { return !std::isnan(s); }),
    0.1 + 0.1 * (19.0 / 24 - 0.6) / (5.0 / 24), 1e-9);
}

// Platens and sides that stay straight, and move as they like between: what the rim cuts closes on them.
TEST(LumenAreas, RimClosesOnStraightPlatens)
{
  const Lattice lattice = makeLattice(12, 12, 1, 2, 1e-6);
  // a post in the middle and stubs on all sides: one lumen that touches everything, corners of the box included
  const auto rule = [](int x, int y, int) { return (x == 5 || x == 6 || y == 5 || y == 6) ? 1 : 0; };
  const std::vector<std::uint8_t> phase = phases(lattice, rule);
  const LumenAreas lumens(lattice, phase, {});
  ASSERT_EQ(lumens.lumens().size(), 4U);
  EXPECT_TRUE(lumens.cut(0));
  // height to 0.75, straight, while walls bulge along x by nothing at the platens and within
  const auto state = moved<2>(lattice, phase, 2, affine({ 1, 0, 0, 0, 0.75, 0, 0, 0, 1 }));
  for (const double ratio : ratios(lumens, state))
    EXPECT_NEAR(ratio, 0.75, 1e-9);
  // a side that no wall touches cannot be closed
  const std::vector<std::uint8_t> open = phases(lattice, [](int x, int, int) { return x < 3 ? 1 : 0; });
  const LumenAreas half(lattice, open, {});
  EXPECT_TRUE(std::isnan(ratios(half, moved<2>(lattice, open, 2, affine({ 1, 0, 0, 0, 1, 0, 0, 0, 1 })))[0]));
}

TEST(LumenAreas, BytesOfAnEdge)
{
  const Lattice flat = makeLattice(200, 200, 1, 2, 1e-6);
  const LumenAreas plane(flat, phases(flat, [](int x, int y, int) { return x % 20 < 4 || y % 20 < 4 ? 1 : 0; }), {});
  EXPECT_EQ(plane.edges(), 100U * 64);
  EXPECT_NEAR(static_cast<double>(plane.bytes()) / static_cast<double>(plane.edges()), 30, 2);
  const Lattice deep = makeLattice(60, 60, 60, 3, 1e-6);
  const LumenAreas space(
    deep, phases(deep, [](int x, int y, int z) { return x % 20 < 4 || y % 20 < 4 || z % 20 < 4 ? 1 : 0; }), {});
  EXPECT_EQ(space.edges(), 27U * 6 * 256);
  EXPECT_NEAR(static_cast<double>(space.bytes()) / static_cast<double>(space.edges()), 47, 2);
}

TEST(LumenAreas, WhatDoesNotFitIsRefusedInWords)
{
  const Lattice lattice = makeLattice(12, 12, 1, 2, 1e-6);
  const std::vector<std::uint8_t> phase = phases(
    lattice, [](int x, int y, int) { return cells(x, y, 3); });
  const auto made = [&](const std::vector<std::uint8_t>& p, const LumenOptions& options)
  { return lamella::testing::refusal<InputError>([&] { (void)LumenAreas(lattice, p, options); }).first; };
  EXPECT_EQ(made({ 0, 1 }, {}), "2 phases for 144 nodes");
  EXPECT_EQ(made(std::vector<std::uint8_t>(144, 0), {}), "all 144 nodes are lumen");
  EXPECT_EQ(made(std::vector<std::uint8_t>(144, 1), {}), "no node is lumen");
  EXPECT_EQ(made(phase, { .minimumSize = 17 }), "all 4 lumens are smaller than 17 nodes");
  EXPECT_NE(
    lamella::testing::refusal<ParameterError>([&] { (void)LumenAreas(lattice, phase, { .connectivity = 6 }); }).first,
    "");

  const LumenAreas lumens(lattice, phase, {});
  const State good = moved<2>(lattice, phase, 2, affine({ 1, 0, 0, 0, 1, 0, 0, 0, 1 }));
  const auto bad = [&](const std::function<void(State&)>& spoil)
  {
    State state = good;
    spoil(state);
    return lamella::testing::refusal<InputError>([&] { (void)ratios(lumens, state); }).first;
  };
  EXPECT_EQ(bad([](State&) {}), "");
  EXPECT_EQ(bad([](State& s) { s.gradient.pop_back(); }),
    "320 ids, 960 numbers of positions and 2879 of deformation gradients");
  EXPECT_EQ(bad([](State& s) { s.id[3] = s.id[7]; }).substr(0, 23), "two points have the id ");
  EXPECT_EQ(bad([](State& s) { s.id[3] = 320; }), "the id 320 of a point among 320");
  EXPECT_NE(bad([](State& s) { std::ranges::fill(s.position, std::numeric_limits<double>::quiet_NaN()); })
              .find("is not finite"),
    std::string::npos);
  EXPECT_EQ(bad(
              [](State& s)
              {
                s.id.pop_back();
                s.position.resize(3 * s.id.size());
                s.gradient.resize(9 * s.id.size());
              }),
    "319 points for 80 nodes of the wall are 3.9875 a node, not 1, 4 or 9");
  EXPECT_NE(lamella::testing::refusal<ParameterError>([] { CollapseStrain(1, 1.5); }).first, "");
  CollapseStrain collapse(1);
  collapse.add(0.1, std::vector<double>{ 0.9 });
  EXPECT_EQ(lamella::testing::refusal<InputError>([&] { collapse.add(0.1, std::vector<double>{ 0.4 }); }).first,
    "a state with a strain of 0.1 after one of 0.1");
  // in the first state already: between it and the start
  CollapseStrain early(1);
  early.add(0.1, std::vector<double>{ 0.25 });
  EXPECT_NEAR(early.strain()[0], 0.1 * 0.5 / 0.75, 1e-15);
}

} // namespace
