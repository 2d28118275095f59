// Material points shared by ranks: the same motion on any number of them.
#include "MaterialPointIncline.h"
#include "MaterialPointShells.h"

#include "Bonds.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::mpm;
using namespace lamella::mpm::samples;
using lamella::test::alone;
using lamella::test::everyone;

/// The same motion by rank 0 alone and by all, to the round-off of sums in another order, which the motion amplifies:
/// up to 4e-11 was measured on 2 to 4 ranks.
/// @param energies whether they can be compared: of a period that grows each image has another kinetic energy
template <int Dim, class Make>
void expectSame(Make&& make, std::int64_t steps, double tolerance, bool energies)
{
  const std::unique_ptr<PointDynamics<Dim>> all = make(everyone());
  const PointEnergies begin = all->energies();
  all->advance(steps);
  const PointEnergies end = all->energies();
  const double stable = all->stableStep();
  const MaterialPoints<Dim> points = all->gather();
  if (everyone().rank() != 0)
  {
    EXPECT_EQ(points.count(), 0U);
    return;
  }
  const std::unique_ptr<PointDynamics<Dim>> one = make(alone());
  EXPECT_NEAR(begin.initial, one->energies().initial, 1e-12);
  one->advance(steps);
  ASSERT_EQ(points.count(), one->points().count()); // none lost, none twice
  for (std::size_t p = 0; p < points.count(); ++p)
    ASSERT_EQ(points.id()[p], p);
  EXPECT_LT(difference(*one, points), tolerance);
  EXPECT_NEAR(all->time(), one->time(), tolerance * one->time());
  EXPECT_NEAR(stable, one->stableStep(), tolerance * stable);
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side)
    {
      EXPECT_NEAR(all->wall(a, side).force, one->wall(a, side).force, tolerance) << a << side;
      EXPECT_NEAR(all->wall(a, side).velocity, one->wall(a, side).velocity, tolerance) << a << side;
    }
  if (energies)
  {
    const PointEnergies expected = one->energies();
    EXPECT_NEAR(end.kinetic, expected.kinetic, tolerance);
    EXPECT_NEAR(end.elastic, expected.elastic, tolerance);
    EXPECT_NEAR(end.supplied, expected.supplied, tolerance);
  }
}

template <int Dim>
void expectSameShells(int cells, int steps, bool fused, std::initializer_list<Scene> scenes)
{
  for (const Scene scene : scenes)
  {
    SCOPED_TRACE(static_cast<int>(scene));
    expectSame<Dim>([&](const Communicator& comm)
      { return shell<Dim>(LawKind::Orthotropic, scene, fused, cells, comm); },
      steps, 1e-8, scene != Scene::Periodic && scene != Scene::Torus);
  }
}

TEST(MaterialPointRanks, ShellsMoveAlike2D)
{
  expectSameShells<2>(32, 100, true, { Scene::Straight, Scene::Open, Scene::Periodic, Scene::Torus });
}

// Its round-off depends on when points are packed anew, which the cuts decide; single precision itself is off by more.
TEST(MaterialPointRanks, ShellsMoveAlikeInSinglePrecision)
{
  expectSame<2>([](const Communicator& comm)
    { return shell<2>(LawKind::Orthotropic, Scene::Straight, true, 32, comm, Precision::Single); },
    60, 5e-3, true);
}

TEST(MaterialPointRanks, ShellsMoveAlikeOnThePlainPath)
{
  expectSameShells<2>(32, 60, false, { Scene::Straight, Scene::Open, Scene::Periodic, Scene::Torus });
}

TEST(MaterialPointRanks, ShellsMoveAlike3D)
{
  expectSameShells<3>(16, 10, true, { Scene::Straight, Scene::Torus });
}

// A bar that is longest along x: the cuts are along the other axis than those of the shells.
TEST(MaterialPointRanks, BarBetweenPlatens)
{
  expectSame<2>(
    [](const Communicator& comm)
    {
      PointDynamicsOptions<2> options;
      options.spacing = 1;
      options.sides[0] = { wallAt(0), wallAt(40, -0.1) };
      options.sides[0][1].sticks = true;
      options.sides[1] = { straightAt(0), straightAt(10) };
      options.comm = comm;
      return std::make_unique<PointDynamics<2>>(
        shareOf(filled<2>({ 40, 10 }, 1, 2, 1), comm), neoHookean<2>(1, 0.3), options);
    },
    100, 1e-10, true); // measured 2e-14
}

// Friction acts line by line: the same on both sides of a cut, whether it runs along the platen or not.
TEST(MaterialPointRanks, BlockThatRubsOnPlatens)
{
  for (const int axis : { 0, 1 })
    expectSame<2>(
      [axis](const Communicator& comm)
      {
        const int along = 1 - axis;
        std::array<int, 2> cells{ 10, 40 };
        PointDynamicsOptions<2> options;
        options.spacing = 1;
        options.sides[static_cast<std::size_t>(axis)] = { wallAt(0),
          wallAt(cells[static_cast<std::size_t>(axis)], -0.1) };
        for (Side& side : options.sides[static_cast<std::size_t>(axis)])
          side.friction = 0.2;
        options.sides[static_cast<std::size_t>(along)] = { straightAt(0),
          straightAt(cells[static_cast<std::size_t>(along)]) };
        options.gravity[along] = 0.01;
        options.comm = comm;
        return std::make_unique<PointDynamics<2>>(
          shareOf(filled<2>(cells, 1, 2, 1), comm), neoHookean<2>(1, 0.3), options);
      },
      100, 1e-10, true);
}

// Coulomb's law to round-off, as on one rank: with the cuts across the slope, through the plane where the bodies meet,
// and beside it, where the slab alone crosses the rows that two ranks have.
TEST(MaterialPointRanks, BlockSlidesDownASlab)
{
  for (const bool fused : { true, false })
  {
    slidesByCoulomb<2>({ .cells = 16, .friction = 0.1, .fused = fused, .onBody = true }, everyone());
    slidesByCoulomb<2>({ .cells = 8, .friction = 0.49, .fused = fused, .onBody = true, .periods = 4 }, everyone());
  }
  slidesByCoulomb<3>({ .cells = 4, .friction = 0.3, .onBody = true, .periods = 4 }, everyone());
}

/// Three bodies that lie on each other between platens, or around a torus, sheared and pressed: two meet at 0.37 of the
/// height, which no node is at, the others at half of it, where ranks share rows. The second meeting is a wave.
template <int Dim>
std::unique_ptr<PointDynamics<Dim>> bodies(const Communicator& comm, int axis, bool around, bool fused)
{
  std::array<int, Dim> cells;
  cells.fill(Dim == 2 ? 12 : 6);
  cells[static_cast<std::size_t>(axis)] = Dim == 2 ? 40 : 20;
  const double height = cells[static_cast<std::size_t>(axis)];
  const int along = axis == 0 ? 1 : 0;
  const double width = cells[static_cast<std::size_t>(along)];
  MaterialPoints<Dim> points = filled<Dim>(cells, 1, 2, 1);
  for (std::size_t p = 0; p < points.count(); ++p)
  {
    const double y = points.column(axis)[p];
    const double wave = height / 2 + std::sin(2 * 3.14159265358979 * points.column(along)[p] / width);
    points.phase()[p] = y < 0.37 * height ? 0 : y < wave ? 1 : 2;
  }
  setVelocities<Dim>(points,
    [&](const Place<Dim>& x)
    {
      Vector<Dim> v{};
      v[along] = 0.02 * std::sin(2 * 3.14159265358979 * x[axis] / height);
      v[axis] = -0.002 * x[axis];
      return v;
    });
  PointDynamicsOptions<Dim> options;
  options.spacing = 1;
  options.fused = fused;
  for (int a = 0; a < Dim; ++a)
  {
    const double end = cells[static_cast<std::size_t>(a)];
    options.sides[static_cast<std::size_t>(a)] = { straightAt(0), straightAt(end) };
    if (a == along)
      options.sides[static_cast<std::size_t>(a)] = { periodicAt(0), periodicAt(end) };
    if (a == axis && around)
    {
      options.sides[static_cast<std::size_t>(a)] = { periodicAt(0), periodicAt(end) };
      options.sides[static_cast<std::size_t>(a)][1].velocity = -0.1;
    }
    else if (a == axis)
    {
      options.sides[static_cast<std::size_t>(a)] = { wallAt(0), wallAt(end, -0.1) };
      options.sides[static_cast<std::size_t>(a)][0].friction = 0.3;
    }
  }
  options.bodies = { 3, { 0, 1, 2 }, { 0, 0.1, 0.3, 0.1, 0, 0.2, 0.3, 0.2, 0 } };
  options.comm = comm;
  return std::make_unique<PointDynamics<Dim>>(shareOf(points, comm),
    makeLaw<Dim, Isotropic>({ isotropicConstants<Dim>({ 1, 0.3, 1 }), isotropicConstants<Dim>({ 0.5, 0.2, 1 }),
      isotropicConstants<Dim>({ 2, 0.3, 1 }) }),
    options);
}

// Measured up to 4e-13 on 2 to 4 ranks, fused and plain.
TEST(MaterialPointRanks, BodiesThatMeet2D)
{
  for (const int axis : { 0, 1 })
    for (const bool around : { false, true })
      for (const bool fused : { true, false })
      {
        SCOPED_TRACE(::testing::Message() << axis << around << fused);
        expectSame<2>(
          [&](const Communicator& comm) { return bodies<2>(comm, axis, around, fused); }, 150, 1e-11, !around);
      }
}

TEST(MaterialPointRanks, BodiesThatMeet3D)
{
  for (const bool around : { false, true })
    expectSame<3>([&](const Communicator& comm) { return bodies<3>(comm, 2, around, true); }, 30, 1e-11, !around);
}

TEST(MaterialPointRanks, BodiesGoOnOnAnotherNumberOfRanks)
{
  const auto all = bodies<2>(everyone(), 1, false, true);
  const auto one = bodies<2>(alone(), 1, false, true);
  all->advance(60);
  one->advance(60);
  io::Checkpoint ofAll;
  io::Checkpoint ofOne;
  all->keep(ofAll);
  ofAll.hold();
  one->keep(ofOne);
  ofOne.hold();
  all->takeBack(ofOne);
  if (everyone().rank() == 0)
    one->takeBack(ofAll);
  all->advance(60);
  const PointEnergies end = all->energies();
  const MaterialPoints<2> points = all->gather();
  if (everyone().rank() != 0)
    return;
  one->advance(60);
  EXPECT_LT(difference(*one, points), 1e-11);
  EXPECT_NEAR(end.dissipated(), one->energies().dissipated(), 1e-9);
}

// What only the plain path can do, GIMP, PIC and stress from what points give back, of walls that yield.
TEST(MaterialPointRanks, BarThatYields)
{
  expectSame<2>(
    [](const Communicator& comm)
    {
      PointDynamicsOptions<2> options;
      options.spacing = 1;
      options.sides[0] = { straightAt(0), straightAt(10) };
      options.sides[1] = { wallAt(0), wallAt(40, -0.1) };
      options.shape = Shape::Gimp;
      options.transfer = Transfer::Pic;
      options.update = StressUpdate::ModifiedLast;
      options.comm = comm;
      const MaterialPoints<2> points = filled<2>(
        { 10, 40 }, 1, 2, 1, [](const Place<2>&) { return true; }, Hencky::history);
      return std::make_unique<PointDynamics<2>>(
        shareOf(points, comm), makeLaw<2, Hencky>({ henckyConstants({ { 1, 0.3, 1 }, 2e-3, 0.1 }) }), options);
    },
    100, 1e-10, true);
}

TEST(MaterialPointRanks, BlockThatYieldsAlongItsAxis)
{
  expectSame<3>(
    [](const Communicator& comm)
    {
      PointDynamicsOptions<3> options;
      options.spacing = 1;
      options.sides[0] = { straightAt(0), straightAt(6) };
      options.sides[1] = { wallAt(0), wallAt(18, -0.1) };
      options.sides[2] = { straightAt(0), straightAt(5) };
      options.comm = comm;
      MaterialPoints<3> points = filled<3>(
        { 6, 18, 5 }, 1, 2, 1, [](const Place<3>&) { return true; }, Hill::history);
      for (std::size_t p = 0; p < points.count(); ++p)
      {
        points.column(MaterialPoints<3>::axes)[p] = 0.6;
        points.column(MaterialPoints<3>::axes + 1)[p] = 0.8;
        points.column(MaterialPoints<3>::axes + 2)[p] = 0;
      }
      const OrthotropicPlasticMaterial wall{ { 4, 1, 0.3, 0.3 }, 4e-3, 2e-3, {}, 0.1 };
      return std::make_unique<PointDynamics<3>>(
        shareOf(points, comm), makeLaw<3, Hill>({ hillConstants(wall) }), options);
    },
    60, 1e-10, true);
}

/// Walls two cells thick around lumens of 9 × 4, between platens, with straight sides; all points given by rank 0.
std::unique_ptr<PointDynamics<2>> tissue(const Communicator& comm)
{
  const std::array<int, 2> cells{ 35, 62 };
  PointDynamicsOptions<2> options;
  options.spacing = 1;
  options.sides[0] = { straightAt(0), straightAt(cells[0]) };
  options.sides[1] = { wallAt(0), wallAt(cells[1], -0.2) };
  options.comm = comm;
  MaterialPoints<2> points =
    filled<2>(cells, 1, 2, 1, [](const Place<2>& x) { return std::fmod(x[0], 11) < 2 || std::fmod(x[1], 6) < 2; });
  return std::make_unique<PointDynamics<2>>(
    comm.rank() == 0 ? std::move(points) : MaterialPoints<2>(), neoHookean<2>(1, 0.3), options);
}

std::vector<std::uint32_t> numbersOf(const PointDynamics<2>& body)
{
  std::vector<std::uint32_t> ids(body.points().id().begin(), body.points().id().end());
  std::sort(ids.begin(), ids.end());
  return ids;
}

TEST(MaterialPointRanks, TissueToFortyPercentOfItsHeight)
{
  const auto run = [](PointDynamics<2>& body) { body.advanceTo(0.6 * 62 / 0.2); };
  const auto all = tissue(everyone());
  all->advance(1);
  const std::vector<std::uint32_t> before = numbersOf(*all);
  const int cells = all->grid().axis(1).cells;
  run(*all);
  EXPECT_LT(all->grid().axis(1).cells, 0.45 * cells);
  const auto count = static_cast<std::int64_t>(all->points().count());
  const std::int64_t total = everyone().sum(count);
  if (everyone().parallel())
  {
    EXPECT_NE(numbersOf(*all), before);
    // whole rows of one to two hundred points, and what has gone on since points were last shared out
    EXPECT_NEAR(static_cast<double>(count * everyone().size()) / static_cast<double>(total), 1, 0.2);
  }
  const PointEnergies end = all->energies();
  const MaterialPoints<2> points = all->gather();
  if (everyone().rank() != 0)
    return;
  const auto one = tissue(alone());
  one->advance(1);
  run(*one);
  ASSERT_EQ(points.count(), one->points().count());
  EXPECT_EQ(all->steps(), one->steps());
  EXPECT_LT(difference(*one, points), 1e-8); // measured 2e-11
  EXPECT_NEAR(all->wall(1, 1).force, one->wall(1, 1).force, 1e-8 * one->wall(1, 1).force);
  EXPECT_NEAR(end.dissipated(), one->energies().dissipated(), 1e-8 * end.elastic);
}

// A run that was kept on all ranks goes on alone, and one that was kept alone goes on on all.
TEST(MaterialPointRanks, GoesOnOnAnotherNumberOfRanks)
{
  const auto all = shell<2>(LawKind::Isotropic, Scene::Straight, true, 24, everyone());
  const auto one = shell<2>(LawKind::Isotropic, Scene::Straight, true, 24, alone());
  all->advance(30);
  one->advance(30);
  io::Checkpoint ofAll;
  io::Checkpoint ofOne;
  all->keep(ofAll);
  ofAll.hold();
  one->keep(ofOne);
  ofOne.hold();
  all->takeBack(ofOne);
  if (everyone().rank() == 0)
    one->takeBack(ofAll);
  all->advance(30);
  const PointEnergies end = all->energies();
  const MaterialPoints<2> points = all->gather();
  if (everyone().rank() != 0)
    return;
  one->advance(30);
  EXPECT_LT(difference(*one, points), 1e-8);
  EXPECT_NEAR(end.dissipated(), one->energies().dissipated(), 1e-8);
  EXPECT_NEAR(all->impulse(1, 1), one->impulse(1, 1), 1e-8);
}

/// A block in a box, a part of it on each rank; `spoil` may change this rank's points and the options.
template <class Spoil>
std::unique_ptr<PointDynamics<2>> block(Spoil&& spoil)
{
  MaterialPoints<2> points = shareOf(filled<2>({ 16, 20 }, 1, 2, 1), everyone());
  PointDynamicsOptions<2> options;
  options.spacing = 1;
  options.sides = { { { wallAt(0), wallAt(16) }, { wallAt(0), wallAt(20) } } };
  options.comm = everyone();
  spoil(points, options);
  return std::make_unique<PointDynamics<2>>(std::move(points), neoHookean<2>(1, 0.3), options);
}

bool isLast()
{
  return everyone().rank() == everyone().size() - 1;
}

/// Runs f, which must throw this error with these words in it.
template <class Thrown, class F>
void expectThrown(const std::string& words, F&& f)
{
  try
  {
    f();
    ADD_FAILURE() << "nothing thrown: " << words;
  }
  catch (const Thrown& e)
  {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

TEST(MaterialPointRanks, ErrorOfOneEndsAll)
{
  expectThrown<InputError>(
    "column 1 of point 3 is nan",
    []
    {
      block(
        [](MaterialPoints<2>& points, PointDynamicsOptions<2>&)
        {
          if (isLast())
            points.column(1)[3] = std::nan("");
        });
    });
  const auto body = block(
    [](MaterialPoints<2>& points, PointDynamicsOptions<2>&)
    {
      if (isLast())
        points.column(MaterialPoints<2>::velocities)[0] = 1e6;
    });
  // on one rank it is found outside the grid
  const char* const words = everyone().parallel() ? "further than half a cell in a step" : "is outside the grid";
  expectThrown<DivergenceError>(words, [&] { body->advance(10); });
}

TEST(MaterialPointRanks, RefusesWhatItCannotDo)
{
  if (!everyone().parallel())
    GTEST_SKIP() << "on several ranks";
  using Options = PointDynamicsOptions<2>;
  expectThrown<InputError>(
    "two points have the number",
    [] {
      block([](MaterialPoints<2>& points, Options&) { points = filled<2>({ 16, 20 }, 1, 2, 1); });
    });
  expectThrown<ParameterError>(
    "ranks for 6 rows of cells", [] { block([](MaterialPoints<2>&, Options& options) { options.spacing = 4; }); });
  expectThrown<ParameterError>("ranks with FLIP, XPIC or a consistent mass",
    [] { block([](MaterialPoints<2>&, Options& options) { options.transfer = Transfer::Flip; }); });
}

TEST(MaterialPointRanks, OneStopsAll)
{
  const auto body = block(
    [](MaterialPoints<2>&, PointDynamicsOptions<2>& options)
    {
      if (isLast())
        options.progress = [](std::int64_t step, double) { return step > 0; };
    });
  EXPECT_FALSE(body->advance(1000));
  EXPECT_EQ(body->steps(), 101); // asked after a hundred; ends after a step whose points can be looked at
}

} // namespace
