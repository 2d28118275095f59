// The fused kernels against the plain path, and against themselves on other numbers of threads.
#include "MaterialPointShells.h"

#include "core/Error.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <vector>

namespace
{

using namespace lamella::mpm;
using namespace lamella::mpm::samples;

/// Everything that is done to all velocities at once.
/// @param left what calming leaves of them; 1 where a period grows, whose rate is not calmed
template <int Dim>
void change(PointDynamics<Dim>& body, double left)
{
  body.scaleVelocities(0.8);
  body.addStretching(1, 0.1, 0.4);
  body.calm(left, 1, -0.2, 0.3);
}

/// Share of the points that have flowed.
template <int Dim>
double yielded(const PointDynamics<Dim>& body)
{
  double count = 0;
  for (const double strain : body.points().column(MaterialPoints<Dim>::histories)) // first in both laws
    count += strain > 0 ? 1 : 0;
  return count / static_cast<double>(body.points().count());
}

template <int Dim>
void agree(LawKind law, int cells, int steps)
{
  for (const Scene scene : { Scene::Straight, Scene::Open, Scene::Periodic })
  {
    const auto plain = shell<Dim>(law, scene, false, cells);
    const auto fused = shell<Dim>(law, scene, true, cells);
    ASSERT_FALSE(plain->fused());
    ASSERT_TRUE(fused->fused());
    plain->advance(steps);
    fused->advance(steps);
    if (law == LawKind::Hencky || law == LawKind::Hill)
      EXPECT_GT(yielded(*fused), 0.1) << static_cast<int>(scene); // some, and not all
    // round-off, which the motion amplifies: measured 5e-14 to 3e-10
    EXPECT_LT(difference(*plain, fused->gather()), 1e-8) << static_cast<int>(scene);
    EXPECT_NEAR(plain->wall(1, 1).force, fused->wall(1, 1).force, 1e-8) << static_cast<int>(scene);
    if (scene != Scene::Periodic) // of a period that grows each image has another kinetic energy
      EXPECT_NEAR(plain->energies().dissipated(), fused->energies().dissipated(), 1e-8) << static_cast<int>(scene);
  }
}

// A step finds the energies and the stiffest point in its kernels; at other times they are found point by point.
template <int Dim>
void lookAlike(LawKind law, int cells, int steps)
{
  const auto plain = shell<Dim>(law, Scene::Straight, false, cells);
  const auto fused = shell<Dim>(law, Scene::Straight, true, cells);
  for (const auto& body : { plain.get(), fused.get() })
    body->advance(steps, true);
  const PointEnergies expected = plain->energies();
  const PointEnergies found = fused->energies();
  EXPECT_NEAR(found.elastic, expected.elastic, 1e-9 * expected.elastic); // as agree()
  EXPECT_NEAR(found.kinetic, expected.kinetic, 1e-9 * expected.kinetic);
  EXPECT_NEAR(fused->stableStep(), plain->stableStep(), 1e-9 * plain->stableStep());
  lamella::io::Checkpoint kept;
  fused->keep(kept);
  kept.hold();
  const auto again = shell<Dim>(law, Scene::Straight, true, cells);
  again->takeBack(kept);
  EXPECT_EQ(again->energies().elastic, found.elastic); // to the last bit
  EXPECT_EQ(again->energies().kinetic, found.kinetic);
  EXPECT_EQ(again->stableStep(), fused->stableStep());
  for (const char* const sum : { "elastic energy", "kinetic energy", "greatest stiffness" })
    ASSERT_EQ(kept.numbers.erase(sum), 1U) << sum;
  again->takeBack(kept);
  const double roundOff = 1e-13; // of sums in another order
  EXPECT_NEAR(again->energies().elastic, found.elastic, roundOff * found.elastic);
  EXPECT_NEAR(again->energies().kinetic, found.kinetic, 1e-10 * found.kinetic); // C once more, from its grid
  EXPECT_NEAR(again->stableStep(), fused->stableStep(), roundOff * fused->stableStep());
  for (const auto& body : { plain.get(), fused.get() })
  {
    change(*body, 0.7); // what was summed up before is no longer so
    EXPECT_NE(body->energies().kinetic, found.kinetic);
  }
  EXPECT_NEAR(fused->energies().kinetic, plain->energies().kinetic, 1e-9 * plain->energies().kinetic);
  for (const auto& body : { plain.get(), fused.get() })
    body->advance(1);
  EXPECT_NE(fused->energies().elastic, found.elastic);
  EXPECT_NEAR(fused->energies().elastic, plain->energies().elastic, 1e-9 * plain->energies().elastic);
  EXPECT_NEAR(fused->energies().kinetic, plain->energies().kinetic, 1e-9 * plain->energies().kinetic);
}

constexpr LawKind everyLaw[] = { LawKind::NeoHookean, LawKind::Isotropic, LawKind::Orthotropic, LawKind::Hencky,
  LawKind::Hill };

TEST(MaterialPointFused, LooksLikeThePlainPath)
{
  for (const LawKind law : everyLaw)
  {
    SCOPED_TRACE(static_cast<int>(law));
    lookAlike<2>(law, 16, 48); // steps that end on a grid of as many cells as they begin with, or none are found
    lookAlike<3>(law, 8, 16);
  }
}

TEST(MaterialPointFused, AgreesWithThePlainPath2D)
{
  for (const LawKind law : everyLaw)
    agree<2>(law, 16, 100);
}

TEST(MaterialPointFused, AgreesWithThePlainPath3D)
{
  for (const LawKind law : everyLaw)
    agree<3>(law, 8, 20);
}

template <int Dim>
void agreeInSinglePrecision(LawKind law, int cells, int steps)
{
  for (const Scene scene : { Scene::Straight, Scene::Open, Scene::Periodic })
  {
    const auto full = shell<Dim>(law, scene, true, cells);
    const auto single = shell<Dim>(law, scene, true, cells, lamella::Communicator(), Precision::Single);
    full->advance(steps);
    single->advance(steps);
    // the last bit, 6e-8, amplified by the motion as that of doubles is: up to 1.1e-3 was measured
    EXPECT_LT(difference(*full, single->gather()), 5e-3) << static_cast<int>(scene);
    EXPECT_GT(difference(*full, single->gather()), 1e-9) << static_cast<int>(scene);
    EXPECT_NEAR(full->wall(1, 1).force, single->wall(1, 1).force, 1e-4) << static_cast<int>(scene);
  }
}

TEST(MaterialPointFused, SinglePrecisionIsClose)
{
  for (const LawKind law : { LawKind::NeoHookean, LawKind::Isotropic, LawKind::Orthotropic })
  {
    agreeInSinglePrecision<2>(law, 16, 100);
    agreeInSinglePrecision<3>(law, 8, 20);
  }
}

TEST(MaterialPointFused, SinglePrecisionIsTheFusedStepsOnly)
{
  EXPECT_THROW(shell<2>(LawKind::Isotropic, Scene::Open, false, 8, lamella::Communicator(), Precision::Single),
    lamella::ParameterError);
}

// Fused steps store no affine velocities: those of the grid that moved the points must be what the plain path stores,
// also after all velocities were changed, on grids of other numbers of cells, and where points went round a period.
template <int Dim>
void keepNoAffines(int cells, int steps)
{
  for (const Scene scene : { Scene::Straight, Scene::Open, Scene::Periodic })
  {
    const auto plain = shell<Dim>(LawKind::Isotropic, scene, false, cells);
    const auto fused = shell<Dim>(LawKind::Isotropic, scene, true, cells);
    for (const double left : { 0.7, 0.0 })
    {
      for (const auto& body : { plain.get(), fused.get() })
      {
        body->advance(steps);
        change(*body, scene == Scene::Periodic ? 1 : left);
      }
      EXPECT_FALSE(fused->points().storesAffines());
      EXPECT_LT(difference(*plain, fused->gather()), 1e-8) << static_cast<int>(scene); // as agree()
      plain->advance(steps / 2);
      fused->advance(steps / 2);
      EXPECT_LT(difference(*plain, fused->gather()), 1e-8) << static_cast<int>(scene);
      if (scene != Scene::Periodic) // as in agree()
        EXPECT_NEAR(plain->energies().kinetic, fused->energies().kinetic, 1e-10);
    }
  }
}

TEST(MaterialPointFused, AffineVelocitiesAreThoseOfTheGrid)
{
  keepNoAffines<2>(16, 30);
  keepNoAffines<3>(8, 12);
}

// What goes on from a checkpoint does so to the last bit, also from where all velocities were changed; from one of
// before, which has the points' affine velocities but not the grid that they came from, to round-off.
void goesOn(LawKind law)
{
  const auto whole = shell<2>(law, Scene::Periodic, true, 16);
  whole->advance(30);
  change(*whole, 1);
  lamella::io::Checkpoint kept;
  whole->keep(kept);
  kept.hold();
  lamella::io::Checkpoint older = kept;
  ASSERT_EQ(older.arrays.erase("past nodes") + older.arrays.erase("past grid"), 2U);
  const auto again = shell<2>(law, Scene::Periodic, true, 16);
  const auto ofOlder = shell<2>(law, Scene::Periodic, true, 16);
  again->takeBack(kept);
  ofOlder->takeBack(older);
  for (const auto& body : { whole.get(), again.get(), ofOlder.get() })
  {
    change(*body, 1);
    body->sortAnew(); // so that affine velocities are given to the grid
    body->advance(25);
  }
  EXPECT_EQ(difference(*whole, again->gather()), 0);
  EXPECT_LT(difference(*whole, ofOlder->gather()), 1e-8); // as agree()
  kept.arrays.at("past grid").values = std::vector<double>(11, 1.0);
  EXPECT_THROW(again->takeBack(kept), lamella::InputError);
}

TEST(MaterialPointFused, GoesOnFromACheckpoint)
{
  for (const LawKind law : { LawKind::Orthotropic, LawKind::Hencky, LawKind::Hill }) // the last two remember
  {
    SCOPED_TRACE(static_cast<int>(law));
    goesOn(law);
  }
}

// Versions before had tiles as wide as the grid, which no longer fit: points are sorted into ours, and the same motion
// goes on.
TEST(MaterialPointFused, GoesOnFromOtherTiles)
{
  const auto whole = shell<3>(LawKind::Isotropic, Scene::Straight, true, 20);
  whole->advance(10);
  lamella::io::Checkpoint kept;
  whole->keep(kept);
  kept.hold();
  auto& tiles = kept.arrays.at("stripes");
  auto& firsts = std::get<std::vector<std::int64_t>>(tiles.values);
  ASSERT_GT(firsts.size(), 5U); // more than one along both axes
  firsts = { 0, firsts.back() };
  tiles.shape = { 2 };
  const auto again = shell<3>(LawKind::Isotropic, Scene::Straight, true, 20);
  again->takeBack(kept);
  for (const auto& body : { whole.get(), again.get() })
    body->advance(10);
  EXPECT_LT(difference(*whole, again->gather()), 1e-10); // round-off of sums in another order
}

// With one point a cell all points start on the ends of the polynomials' cells, and nodes along the outline are reached
// by a hair: sums over a cell, in which such a mass is lost in round-off, must not tear these nodes away.
TEST(MaterialPointFused, HardlyReachedNodesDoNoHarm)
{
  MaterialPoints<2> points = filled<2>({ 12, 12 }, 1, 1, 1.0);
  for (std::size_t p = 0; p < points.count(); ++p)
    for (const int a : { 0, 1 })
      points.column(MaterialPoints<2>::velocities + a)[p] = 1e-6 * std::sin(17.0 * static_cast<double>(p) + a);
  PointDynamicsOptions<2> options;
  options.spacing = 1;
  PointDynamics<2> block(std::move(points), lawOf<2>(LawKind::Isotropic), options);
  ASSERT_TRUE(block.fused());
  const double start = block.energies().initial;
  for (int i = 0; i < 20; ++i)
  {
    block.advance(20);
    const PointEnergies e = block.energies();
    ASSERT_LT(e.kinetic + e.elastic, start) << block.steps(); // APIC dissipates; it was 1e20 times as much
  }
}

template <int Dim>
void sameOnThreads(int cells, int steps)
{
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = shell<Dim>(LawKind::Orthotropic, Scene::Straight, true, cells);
  one->advance(steps);
  for (const int threads : { 2, 3 })
  {
    omp_set_num_threads(threads);
    const auto several = shell<Dim>(LawKind::Orthotropic, Scene::Straight, true, cells);
    several->advance(steps);
    EXPECT_EQ(difference(*one, several->gather()), 0) << threads; // to the last bit
    EXPECT_EQ(one->wall(1, 1).force, several->wall(1, 1).force);
    EXPECT_EQ(one->energies().elastic, several->energies().elastic);
    EXPECT_EQ(one->energies().kinetic, several->energies().kinetic);
  }
  omp_set_num_threads(before);
}

TEST(MaterialPointFused, IsTheSameOnAnyNumberOfThreads)
{
  sameOnThreads<2>(40, 60);
  sameOnThreads<3>(20, 25);
}

} // namespace
