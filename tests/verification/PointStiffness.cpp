// Implicit stiffness of material points: exact values, convergence, published values, what has no stiffness.
#include "MaterialPointSamples.h"
#include "PointBox.h"
#include "PointChance.h"

#include "core/Error.h"
#include "elasticity/ElasticConstants.h"
#include "lattice/Phases.h"
#include "mpm/WallCells.h"
#include "mpm/WallMaterial.h"
#include "pictures/Picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numbers>
#include <random>

namespace
{

using namespace lamella;
using namespace lamella::mpm;
using samples::Body;
using samples::Chance;
using samples::periodicAt;
using samples::setVelocities;

constexpr double young = 1e9;

constexpr std::array periodic{ BoxSides::Periodic, BoxSides::Periodic };
constexpr std::array walls{ BoxSides::Walls, BoxSides::Walls };

std::shared_ptr<const PointLaw<2>> plain(double poissonsRatio = 1.0 / 3, double contrast = 1)
{
  const auto constants = [&](double e)
  { return isotropicConstants<2>({ .youngsModulus = e, .poissonsRatio = poissonsRatio }, PlaneState::Stress); };
  return makeLaw<2, Isotropic>({ constants(young), constants(young), constants(contrast * young) });
}

const auto full = [](const auto&) { return 1; };

// A block of one material strains evenly: exact to round-off and to the 1e-11 of the law's differences, at any angle of
// its axis, where every cell has the same points.
TEST(PointStiffness, BlockAtAnyAngle)
{
  const OrthotropicMaterial m{ .along = 8e9, .across = 2e9, .poissonsRatio = 0.3, .shearModulus = 0.7e9 };
  const auto law = makeLaw<2, Orthotropic>({ orthotropicConstants<2>(m, PlaneState::Stress) });
  for (const double degrees : { 0.0, 20.0, 45.0, 77.0, 90.0 })
  {
    const double t = degrees * std::numbers::pi / 180;
    const double c = std::cos(t);
    const double s = std::sin(t);
    const Body<2> body({ 1.0, 0.8 }, { 10, 8 }, 2, full, { { c, s } });
    const auto r = body.solve(*law, periodic);
    const auto constants = elasticity::elasticConstants(r.stiffness, 2);
    const double slant = 1 / 0.7e9 - 2 * 0.3 / 8e9;
    const auto modulus = [&](double cos, double sin)
    { return 1 / (std::pow(cos, 4) / 8e9 + std::pow(sin, 4) / 2e9 + slant * cos * cos * sin * sin); };
    EXPECT_NEAR(constants.youngsModulus[0], modulus(c, s), 1e-9 * 8e9) << degrees;
    EXPECT_NEAR(constants.youngsModulus[1], modulus(s, c), 1e-9 * 8e9) << degrees;
    EXPECT_NEAR(r.along(0).modulus, modulus(c, s), 1e-9 * 8e9);
    // shear: 1/G(t) = 1/G + 4 (1/E₁ + 1/E₂ + 2ν/E₁ − 1/G) s²c²
    const double g = 1 / (1 / 0.7e9 + 4 * (1 / 8e9 + 1 / 2e9 + 0.6 / 8e9 - 1 / 0.7e9) * s * s * c * c);
    EXPECT_NEAR(constants.shearModulus[0], g, 1e-9 * 8e9) << degrees;
    // sticky walls strain it evenly too
    const auto held = body.solve(*law, { BoxSides::StickyWalls, BoxSides::StickyWalls });
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_NEAR(held.stiffness[i], r.stiffness[i], 1e-9 * 8e9);
  }
}

TEST(PointStiffness, BlockBetweenWalls)
{
  const double nu = 0.3;
  const Body<2> body({ 1.0, 2.0 }, { 6, 12 }, 2, full);
  const auto r = body.solve(*plain(nu), walls);
  ASSERT_EQ(r.strains, (std::vector{ 0, 1 }));
  const auto straight = r.along(1);
  EXPECT_NEAR(straight.modulus, young, 1e-9 * young);
  EXPECT_NEAR(straight.strain[0], -nu, 1e-9);
  EXPECT_NEAR(straight.stress[0], 0, 1e-9 * young);
  const auto fixed = r.along(1, true);
  EXPECT_NEAR(fixed.modulus, young / (1 - nu * nu), 1e-9 * young);
  EXPECT_NEAR(fixed.stress[0], nu * young / (1 - nu * nu), 1e-9 * young);
  // free sides: nodes beyond the block that hardly anything acts on, and still exact
  const auto open = body.solve(*plain(nu), { BoxSides::Open, BoxSides::Walls });
  EXPECT_NEAR(open.along(1).modulus, young, 1e-9 * young);
  EXPECT_THROW((void)open.along(0), ParameterError);
}

TEST(PointStiffness, BlockInSpace)
{
  const OrthotropicMaterial m{
    .along = 8e9, .across = 2e9, .poissonsRatio = 0.3, .acrossRatio = 0.25, .shearModulus = 0.7e9
  };
  const auto law = makeLaw<3, Orthotropic>({ orthotropicConstants<3>(m) });
  const double s = std::sqrt(0.5);
  const Body<3> body({ 1, 1.2, 1 }, { 5, 6, 5 }, 2, full, { { s, 0, s } });
  PointStiffnessOptions<3> o = body.options({ BoxSides::Periodic, BoxSides::Periodic, BoxSides::Periodic });
  const auto c = elasticity::elasticConstants(pointStiffness(body.points, *law, o).stiffness, 3);
  const double slant = 1 / (0.25 / 8e9 + 0.25 / 2e9 + 0.25 * (1 / 0.7e9 - 0.6 / 8e9));
  EXPECT_NEAR(c.youngsModulus[0], slant, 1e-9 * 8e9);
  EXPECT_NEAR(c.youngsModulus[1], 2e9, 1e-9 * 8e9);
  EXPECT_NEAR(c.youngsModulus[2], slant, 1e-9 * 8e9);
  const Body<3> straight({ 1, 1, 1 }, { 5, 5, 5 }, 2, full, { { 0, 0, 1 } });
  o = straight.options({ BoxSides::Walls, BoxSides::Walls, BoxSides::Walls });
  const auto u = pointStiffness(straight.points, *law, o).along(2);
  EXPECT_NEAR(u.modulus, 8e9, 1e-9 * 8e9);
  EXPECT_NEAR(u.strain[0], -0.3, 1e-9);
}

constexpr OrthotropicMaterial spruce{ .along = 8e9,
  .across = 2e9,
  .poissonsRatio = 0.3,
  .acrossRatio = 0.25,
  .shearModulus = 0.7e9 };

/// Along z of a bar whose fibres are at an angle of cosine c to it.
double youngAt(double c)
{
  const double cc = c * c;
  return 1 / (cc * cc / 8e9 + (1 - cc) * (1 - cc) / 2e9 + cc * (1 - cc) * (1 / 0.7e9 - 0.6 / 8e9));
}

// 1/E = c⁴/E_a + s⁴/E_t + s²c² (1/G − 2ν/E_a), whatever the fibres' direction: exact between periods.
TEST(PointStiffness, FibresOfAnyDirectionInSpace)
{
  Chance<3> chance;
  const auto law = makeLaw<3, Orthotropic>({ orthotropicConstants<3>(spruce) });
  for (int trial = 0; trial < 6; ++trial)
  {
    const Vector<3> axis = chance.direction();
    const Body<3> body({ 1, 1.2, 1 }, { 5, 6, 5 }, 2, full, axis);
    const auto r = body.solve(*law, { BoxSides::Periodic, BoxSides::Periodic, BoxSides::Periodic });
    const auto constants = elasticity::elasticConstants(r.stiffness, 3);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(constants.youngsModulus[static_cast<std::size_t>(i)], youngAt(axis[i]), 1e-9 * 8e9) << trial;
  }
}

// A bar with free sides shears between its platens; splines there are even across a platen, which shear is not.
TEST(PointStiffness, SlantedBarBetweenPlatensInSpace)
{
  const auto law = makeLaw<3, Orthotropic>({ orthotropicConstants<3>(spruce) });
  const double c = std::cos(std::numbers::pi / 6);
  const Vector<3> axis{ { 0.3, 0.4, c } };
  std::vector<double> errors;
  for (const int cells : { 5, 10 })
  {
    const Body<3> body({ 1, 1, 1 }, { cells, cells, cells }, 2, full, axis);
    const auto bar = body.solve(*law, { BoxSides::Open, BoxSides::Open, BoxSides::Walls });
    errors.push_back(bar.along(2).modulus / youngAt(c) - 1);
  }
  // measured 1.66 and 0.84 %
  EXPECT_GT(samples::order(errors), 0.95);
  EXPECT_LT(errors.back(), 0.009);
}

// The block in motion, in periods of which one grows and two as they must: begun with the velocities of its strain it
// deforms evenly, and the period feels what is left of the stiffness where two normal stresses and all shear vanish.
TEST(PointStiffness, FibresOfAnyDirectionInMotion)
{
  Chance<3> chance;
  const auto constants = orthotropicConstants<3>(spruce);
  const auto law = makeLaw<3, Orthotropic>({ constants });
  for (int trial = 0; trial < 4; ++trial)
  {
    const Vector<3> axis = chance.direction();
    Matrix<3> C; // of normal strains
    for (int j = 0; j < 3; ++j)
    {
      Matrix<3> e{};
      e(j, j) = 1;
      const Matrix<3> t = Orthotropic::hooke(constants.data(), e, axis);
      for (int i = 0; i < 3; ++i)
        C(i, j) = t(i, i);
    }
    const Matrix<3> inverse = cofactor(C); // times det C, symmetric
    const double modulus = determinant(C) / inverse(2, 2);
    const double rate = 1e-2; // over the wave's time through it, 4e-4 s: 4e-6
    Body<3> body({ 1, 1, 1 }, { 4, 4, 4 }, 2, full, axis);
    for (double& mass : body.points.column(MaterialPoints<3>::masses))
      mass = 1500.0 / 512;
    setVelocities<3>(body.points,
      [&](const Vector<3>& x)
      {
        Vector<3> v;
        for (int i = 0; i < 3; ++i)
          v[i] = rate * inverse(i, 2) / inverse(2, 2) * x[i];
        return v;
      });
    PointDynamicsOptions<3> o;
    o.spacing = 0.25;
    for (auto& side : o.sides)
    {
      side = { periodicAt(0), periodicAt(1) };
      side[1].straight = true;
    }
    o.sides[2][1].straight = false;
    o.sides[2][1].velocity = rate;
    PointDynamics<3> block(std::move(body.points), law, o);
    ASSERT_TRUE(block.fused());
    block.advanceTo(1e-2);
    const double strain = rate * (block.time() - block.step()); // forces are those of the last step's start
    EXPECT_NEAR(-block.wall(2, 1).force / (modulus * strain), 1, 1e-7) << trial; // inertia: measured 1e-8
    double worst = 0;
    for (std::size_t p = 0; p < block.points().count(); ++p)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          worst = std::max(worst,
            std::fabs(block.points().matrix(MaterialPoints<3>::deformations, p)(i, j) - (i == j ? 1 : 0) -
              (i == j ? rate * block.time() * inverse(i, 2) / inverse(2, 2) : 0)));
    EXPECT_LT(worst, 1e-11) << trial; // of 1e-4
  }
}

// Layers without Poisson's effect. Along them strain is even: exact. Across, splines round off the kink of the
// displacement: too stiff by something in proportion to the spacing.
TEST(PointStiffness, Layers)
{
  double before = 0;
  for (const int n : { 8, 16, 32, 64 })
  {
    const Body<2> body(
      { 1, 1 }, { n, n }, 2, [](const std::array<double, 2>& x) { return x[1] > 0.25 && x[1] < 0.75 ? 2 : 1; });
    const auto c = elasticity::elasticConstants(body.solve(*plain(0, 10), periodic).stiffness, 2);
    EXPECT_NEAR(c.youngsModulus[0], 5.5 * young, 1e-8 * young);
    const double exact = 2 / (1 + 0.1) * young;
    const double error = c.youngsModulus[1] / exact - 1;
    EXPECT_GT(error, 0);
    EXPECT_LT(c.youngsModulus[1], 5.5 * young);
    if (before > 0)
      EXPECT_NEAR(std::log2(before / error), 1, 0.1) << n;
    before = error;
  }
  EXPECT_LT(before, 0.04);
}

/// Regular pattern of hexagonal cells, one apart: the offset from the centre of the cell that a place lies in.
std::array<double, 2> fromCentre(const std::array<double, 2>& x)
{
  const double height = std::numbers::sqrt3;
  std::array<double, 2> best{ 9, 9 };
  for (const auto& [cx, cy] :
    { std::array{ 0.0, 0.0 }, { 1.0, 0.0 }, { 0.5, height / 2 }, { 0.0, height }, { 1.0, height } })
    if (std::hypot(x[0] - cx, x[1] - cy) < std::hypot(best[0], best[1]))
      best = { x[0] - cx, x[1] - cy };
  return best;
}

PointStiffness<2> hexagonal(int cells, int per, const std::function<bool(const std::array<double, 2>&)>& hollow)
{
  const double height = std::numbers::sqrt3;
  const Body<2> body({ 1, height }, { cells, static_cast<int>(std::lround(height * cells)) }, per,
    [&](const std::array<double, 2>& x) { return hollow(fromCentre(x)) ? 0 : 1; });
  return body.solve(*plain(), periodic);
}

// Published to five digits (plane stress). Points follow the outline in steps, so that the error jumps about below its
// trend, which falls in proportion to the spacing or faster.
TEST(PointStiffness, PlateWithHexagonalArrayOfHoles)
{
  for (const auto& [area, exact] : { std::array{ 0.1, 0.74992 }, { 0.3, 0.42948 }, { 0.5, 0.21436 } })
  {
    const double radius = std::sqrt(area * std::numbers::sqrt3 / (2 * std::numbers::pi));
    const auto error = [&, exact = exact](int cells)
    {
      const auto r =
        hexagonal(cells, 3, [&](const std::array<double, 2>& x) { return std::hypot(x[0], x[1]) < radius; });
      return r.along(0).modulus / (exact * young) - 1;
    };
    const double coarse = std::abs(error(16));
    const double fine = std::abs(error(64));
    EXPECT_LT(coarse, 0.02) << area;
    EXPECT_LT(fine, 0.004) << area;
    EXPECT_LT(fine, coarse) << area;
  }
}

TEST(PointStiffness, Honeycomb)
{
  for (const auto& [solid, exact] : { std::array{ 0.19, 0.011558 }, { 0.36, 0.075005 }, { 0.64, 0.326779 } })
  {
    const double inner = 0.5 * std::sqrt(1 - solid);
    const auto error = [&, exact = exact](int cells)
    {
      const auto r = hexagonal(cells, 3,
        [&](const std::array<double, 2>& x)
        {
          const double slant = 0.5 * std::numbers::sqrt3 * x[1];
          return std::max({ std::abs(x[0]), std::abs(0.5 * x[0] + slant), std::abs(0.5 * x[0] - slant) }) < inner;
        });
      return r.along(0).modulus / (exact * young) - 1;
    };
    const double fine = std::abs(error(64));
    EXPECT_LT(fine, 0.015) << solid;
    EXPECT_LT(fine, std::abs(error(16))) << solid;
  }
}

// Asked every thousand rows, also while a level is coarsened: 12³ nodes have two thousand, gone through twice a level.
TEST(PointStiffness, MultigridIsAskedToStopOnTheWay)
{
  const Body<3> body({ 1, 1, 1 }, { 12, 12, 12 }, 1, [](const auto&) { return 1; });
  auto o = body.options({ BoxSides::Walls, BoxSides::Walls, BoxSides::Walls });
  o.solver = StiffnessSolver::Multigrid;
  const auto law = makeLaw<3, Orthotropic>({ orthotropicConstants<3>(
    { .along = 8e9, .across = 2e9, .poissonsRatio = 0.3, .acrossRatio = 0.25, .shearModulus = 0.7e9 }) });
  int asked = 0;
  PointStiffnessPlan plan;
  o.planned = [&](const PointStiffnessPlan& p) { plan = p; };
  o.progress = [&](double)
  {
    ++asked;
    return asked > 10;
  };
  EXPECT_THROW((void)pointStiffness(body.points, *law, o), Cancelled);
  EXPECT_GE(plan.nodes, 13 * 13 * 13);
  EXPECT_GT(plan.bytes, 125 * 76.0 * static_cast<double>(plan.nodes)); // blocks of rows
  EXPECT_LT(plan.seconds[0], plan.seconds[1]);
}

// What hangs on nothing and what hardly any material acts on leave the answer alone.
TEST(PointStiffness, LoosePiecesAndSinglePoints)
{
  const auto column = [](double x) { return x > 0.3 && x < 0.7; };
  const Body<2> alone({ 1, 1 }, { 20, 20 }, 2, [&](const auto& x) { return column(x[0]) ? 1 : 0; });
  const Body<2> loose({ 1, 1 }, { 20, 20 }, 2,
    [&](const auto& x)
    {
      const bool island = x[0] > 0.05 && x[0] < 0.15 && x[1] > 0.4 && x[1] < 0.6;
      const bool crumb = std::abs(x[0] - 0.9125) < 0.01 && std::abs(x[1] - 0.5125) < 0.01;
      return column(x[0]) || island || crumb ? 1 : 0;
    });
  EXPECT_EQ(loose.points.count(), alone.points.count() + 4 * 8 + 1);
  const std::array sides{ BoxSides::Open, BoxSides::Walls };
  const double exact = 0.4 * young;
  EXPECT_NEAR(alone.solve(*plain(), sides).along(1).modulus, exact, 1e-9 * young);
  const auto r = loose.solve(*plain(), sides);
  EXPECT_NEAR(r.along(1).modulus, exact, 1e-7 * young);
  EXPECT_LE(r.residual, 1e-7);
  auto o = loose.options(sides);
  o.solver = StiffnessSolver::ConjugateGradients;
  EXPECT_NEAR(pointStiffness(loose.points, *plain(), o).along(1).modulus, exact, 1e-7 * young);
}

TEST(PointStiffness, BothSolversAgree)
{
  const Body<2> body({ 1, 1 }, { 16, 16 }, 2,
    [](const auto& x) { return std::hypot(x[0] - 0.5, x[1] - 0.4) < 0.3 ? 0
                          : x[0] > 0.8                                  ? 2
                                                                        : 1; });
  for (const auto& sides :
    { periodic, walls, std::array{ BoxSides::Open, BoxSides::StickyWalls }, { BoxSides::Periodic, BoxSides::Walls } })
  {
    auto o = body.options(sides);
    o.tolerance = 1e-9;
    const auto law = plain(0.3, 3);
    const auto factors = pointStiffness(body.points, *law, o);
    o.solver = StiffnessSolver::ConjugateGradients;
    const auto iterated = pointStiffness(body.points, *law, o);
    ASSERT_EQ(factors.strains, iterated.strains);
    EXPECT_LE(factors.iterations[0], 3);
    // the error of the energy is the square of that of the displacement
    for (std::size_t i = 0; i < factors.stiffness.size(); ++i)
      EXPECT_NEAR(factors.stiffness[i], iterated.stiffness[i], 1e-10 * young);
  }
}

// Multigrid finds what the factors find, thin walls and periods included, in few iterations.
TEST(PointStiffness, MultigridAgrees)
{
  // walls 2 to 4 cells thick around square lumens, one of them filled by another material
  const Body<2> body({ 1, 1 }, { 60, 60 }, 2,
    [](const auto& x)
    {
      const auto inCell = [](double v) { return std::abs(10 * v - std::floor(10 * v) - 0.5) < 0.25; };
      return !inCell(x[0]) || !inCell(x[1]) ? 1 : x[0] > 0.5 && x[0] < 0.6 ? 2 : 0;
    });
  for (const auto& sides : { periodic, walls, std::array{ BoxSides::Open, BoxSides::StickyWalls } })
  {
    auto o = body.options(sides);
    o.tolerance = 1e-8;
    const auto law = plain(0.3, 3);
    o.solver = StiffnessSolver::Cholesky;
    const auto factors = pointStiffness(body.points, *law, o);
    o.solver = StiffnessSolver::Multigrid;
    const auto multigrid = pointStiffness(body.points, *law, o);
    ASSERT_EQ(factors.strains, multigrid.strains);
    EXPECT_LE(multigrid.residual, 1e-8);
    for (const std::int64_t n : multigrid.iterations)
      EXPECT_LT(n, 60); // hundreds without it
    for (std::size_t i = 0; i < factors.stiffness.size(); ++i)
      EXPECT_NEAR(
        factors.stiffness[i], multigrid.stiffness[i], 1e-10 * young); // the square of the displacement's error
  }
  // in space, against conjugate gradients without a matrix
  const Body<3> space({ 1, 1, 1 }, { 10, 10, 10 }, 2,
    [](const auto& x) { return std::hypot(x[0] - 0.5, x[1] - 0.5, x[2] - 0.5) < 0.35 ? 0 : 1; });
  const auto law = makeLaw<3, Isotropic>({ isotropicConstants<3>({ .youngsModulus = young, .poissonsRatio = 0.3 }),
    isotropicConstants<3>({ .youngsModulus = young, .poissonsRatio = 0.3 }) });
  auto o = space.options({ BoxSides::Periodic, BoxSides::Periodic, BoxSides::Walls });
  o.tolerance = 1e-7;
  o.solver = StiffnessSolver::ConjugateGradients;
  const auto plainly = pointStiffness(space.points, *law, o);
  o.solver = StiffnessSolver::Multigrid;
  const auto multigrid = pointStiffness(space.points, *law, o);
  ASSERT_EQ(plainly.stiffness.size(), multigrid.stiffness.size());
  for (std::size_t i = 0; i < plainly.stiffness.size(); ++i)
    EXPECT_NEAR(plainly.stiffness[i], multigrid.stiffness[i], 1e-9 * young);
}

// Struts that touch by a point hinge at next to no energy. Their forces outlast the energy by thousands of iterations,
// which bring the stiffness no further: it ends, says so, and has what the factors give.
TEST(PointStiffness, ThinStrutsEnd)
{
  // an open foam: what is about as far from three of some places as from the nearest of them
  std::mt19937 chance(4);
  std::array<std::array<double, 3>, 7> places{};
  for (auto& place : places)
    for (double& c : place)
      c = chance() / 4294967296.0;
  const Body<3> body({ 1, 1, 1 }, { 16, 16, 16 }, 2,
    [&](const auto& x)
    {
      std::array<double, places.size()> far{};
      for (std::size_t i = 0; i < far.size(); ++i)
        far[i] = std::hypot(x[0] - places[i][0], x[1] - places[i][1], x[2] - places[i][2]);
      std::sort(far.begin(), far.end());
      return far[2] - far[0] < 0.12 ? 1 : 0;
    });
  const auto law = makeLaw<3, Isotropic>({ isotropicConstants<3>({ .youngsModulus = young, .poissonsRatio = 0.3 }),
    isotropicConstants<3>({ .youngsModulus = young, .poissonsRatio = 0.3 }) });
  auto o = body.options({ BoxSides::Walls, BoxSides::Walls, BoxSides::Walls });
  o.solver = StiffnessSolver::Multigrid;
  const auto r = pointStiffness(body.points, *law, o);
  EXPECT_GT(r.residual, o.tolerance);
  EXPECT_GT(r.lost, 0);
  EXPECT_LT(r.lost, 1e-5);
  for (const std::int64_t n : r.iterations)
    EXPECT_LE(n, 1000);
  o.solver = StiffnessSolver::Cholesky;
  const auto factors = pointStiffness(body.points, *law, o);
  EXPECT_EQ(factors.lost, 0);
  for (std::size_t i = 0; i < r.stiffness.size(); ++i) // measured: 1.3e-6 off, where the last hundred took 2.6e-6
    EXPECT_NEAR(r.stiffness[i] / factors.stiffness[i], 1, 3 * r.lost) << i;
}

// Earlywood and latewood of real spruce, against bilinear elements on pixels, at equal spacing: platens without
// friction, sides free.
TEST(PointStiffness, RealSpruce)
{
  const char* folder = std::getenv("LAMELLA_REAL_DATA");
  if (folder == nullptr)
    GTEST_SKIP() << "LAMELLA_REAL_DATA does not name the folder of real pictures";
  struct
  {
    const char* file;
    int axis;
    double elements, tooCoarse;
  } const table[] = { { "spruce_EW_labels_0.5um.png", 1, 0.0501, 8 }, { "spruce_EW_labels_0.5um.png", 0, 0.0311, 8 },
    { "spruce_LW_labels_0.5um.png", 1, 0.3224, 16 } };
  for (const auto& row : table)
  {
    const auto picture = micrograph::readPicture(std::filesystem::path(folder) / row.file);
    GreyMap map;
    map.phaseOfGrey[0] = "void";
    map.other = "wall";
    const auto image = crop(map.apply(picture.lattice, picture.grey), Window{ { 100, 20, 0 }, { 400, 400, 0 } });
    const auto points = pointsFromLattice<2>(image.lattice, image.phase, {}, PointOptions{});
    PointStiffnessOptions<2> o;
    o.upper = { image.lattice.length(0), image.lattice.length(1) };
    o.spacing = image.lattice.spacing;
    o.sides.fill(BoxSides::Open);
    o.sides[static_cast<std::size_t>(row.axis)] = BoxSides::Walls;
    const auto r = pointStiffness(points, *plain(), o);
    EXPECT_NEAR(r.along(row.axis).modulus / young, row.elements, 0.01 * row.elements);
    EXPECT_EQ(wallWarning(wallCells(image.lattice, image.phase, 0, o.spacing)), "");
    EXPECT_NE(wallWarning(wallCells(image.lattice, image.phase, 0, row.tooCoarse * o.spacing)), "");
  }
}

// A plate with a hole between platens, its sides straight with no force: pressed slowly enough the explicit method has
// the modulus and the lateral strain of the implicit solve. 0.3 % of strain over thirty times the time that a wave
// takes from end to end, from an affine start; what still swings is evened out by the regression.
TEST(PointStiffness, SlowMotionAgrees)
{
  constexpr int cells = 20;
  constexpr double spacing = 1.0 / cells;
  constexpr double strain = 3e-3;
  constexpr double time = 30;
  auto points = samples::filled<2>(
    { cells, cells }, spacing, 2, 1.0, [](const Vector<2>& x) { return std::hypot(x[0] - 0.5, x[1] - 0.5) > 0.3; });
  const auto law = makeLaw<2, Isotropic>({ isotropicConstants<2>({ .youngsModulus = 1, .poissonsRatio = 0.3 }) });
  PointStiffnessOptions<2> o;
  o.upper = { 1, 1 };
  o.spacing = spacing;
  o.sides = walls;
  const auto exact = pointStiffness(points, *law, o).along(1);

  const double rate = strain / time;
  samples::setVelocities<2>(points,
    [&](const Vector<2>& x) {
      return Vector<2>{ { -exact.strain[0] * rate * x[0], -rate * x[1] } };
    });
  PointDynamicsOptions<2> motion;
  motion.spacing = spacing;
  motion.sides = { { { samples::wallAt(0), samples::straightAt(1) },
    { samples::wallAt(0), samples::wallAt(1, -rate) } } };
  PointDynamics<2> body(std::move(points), law, motion);
  double sums[3] = { 0, 0, 0 }; // for slopes of lines through the origin
  while (body.time() < time)
  {
    body.advance(1);
    const double e = rate * body.time();
    const double stress = 0.5 * (body.wall(1, 1).force - body.wall(1, 0).force);
    const double lateral = body.grid().axis(0).upper() - 1;
    sums[0] += e * e;
    sums[1] += e * stress;
    sums[2] += e * lateral;
  }
  EXPECT_NEAR(sums[1] / sums[0], exact.modulus, 0.01 * exact.modulus);
  EXPECT_NEAR(sums[2] / sums[0], -exact.strain[0], 0.01 * -exact.strain[0]);
}

TEST(PointStiffness, CellsAcrossWalls)
{
  // columns of solid: 1, 3 and 2 nodes wide, the last at the edge, which nothing says the width of
  Lattice l = makeLattice(10, 4, 1, 2, 2.0);
  std::vector<std::uint8_t> phase;
  for (int y = 0; y < 4; ++y)
    for (const int v : { 0, 1, 0, 1, 1, 1, 0, 0, 1, 1 })
      phase.push_back(static_cast<std::uint8_t>(v));
  const WallCells cells = wallCells(l, phase, 0, 1.0);
  EXPECT_DOUBLE_EQ(cells.median, 6);
  EXPECT_EQ(wallWarning(cells), "");
  const WallCells coarse = wallCells(l, phase, 0, 4.0);
  EXPECT_DOUBLE_EQ(coarse.median, 1.5);
  EXPECT_DOUBLE_EQ(coarse.thinShare, 4.0 / 6);
  EXPECT_EQ(wallWarning(coarse),
    "walls are 1.5 cells of the grid thick (median; 67 % of the material is thinner than 2): choose a grid spacing "
    "that "
    "is smaller");
  EXPECT_THROW((void)wallCells(l, std::span(phase).first(7), 0, 1.0), InputError);
}

template <class Exception>
std::string complaint(const std::function<void()>& act)
{
  try
  {
    act();
  }
  catch (const Exception& error)
  {
    return error.what();
  }
  return "nothing of that kind was thrown";
}

TEST(PointStiffness, RefusesWhatItCannotDo)
{
  const Body<2> gap(
    { 1, 1 }, { 20, 20 }, 2, [](const auto& x) { return x[1] < 0.7 ? 1 : 0; });
  EXPECT_EQ(complaint<NoPathError>(
              [&] {
                (void)gap.solve(*plain(), { BoxSides::Open, BoxSides::Walls });
              }),
    "nothing carries a load along y from one end of the box to the other");
  const Body<2> body({ 1, 1 }, { 6, 6 }, 2, full);
  const auto with = [&](const auto& change)
  {
    auto o = body.options(walls);
    change(o);
    return complaint<Error>([&] { (void)pointStiffness(body.points, *plain(), o); });
  };
  EXPECT_EQ(with([](auto& o) { o.spacing = 0; }), "a grid spacing of 0 m");
  EXPECT_EQ(with([](auto& o) { o.spacing = 0.5; }), "2 cells along x");
  EXPECT_EQ(with([](auto& o) { o.upper[1] = 0; }), "a box from 0 to 0 m along y");
  EXPECT_EQ(with([](auto& o) { o.lower[0] = 0.1; }), "point 0 lies at x = 0.0416667 m, outside the box");
  EXPECT_EQ(with([](auto& o) { o.sides.fill(BoxSides::Open); }), "no side of the box can be moved");
  EXPECT_EQ(with([](auto& o) { o.tolerance = 2; }), "a tolerance of 2");
  EXPECT_EQ(with([](auto& o) { o.progress = [](double) { return true; }; }), "interrupted");
  const std::string little = with(
    [](auto& o)
    {
      o.solver = StiffnessSolver::Multigrid;
      o.memory = 1000;
    });
  EXPECT_TRUE(little.starts_with("the stiffness of ") && little.ends_with(" are free")) << little;
  EXPECT_EQ(with(
              [](auto& o)
              {
                o.solver = StiffnessSolver::ConjugateGradients;
                o.sides.fill(BoxSides::StickyWalls);
                o.maximumIterations = 0;
              }),
    "nothing of that kind was thrown"); // an even strain leaves nothing to solve for
  EXPECT_THROW((void)pointStiffness(MaterialPoints<2>(), *plain(), body.options(walls)), InputError);
  const Body<2> four(
    { 1, 1 }, { 6, 6 }, 1, [](const auto&) { return 4; });
  EXPECT_EQ(complaint<ParameterError>([&] { (void)four.solve(*plain(), walls); }), "no law for phase 4");
}

} // namespace
