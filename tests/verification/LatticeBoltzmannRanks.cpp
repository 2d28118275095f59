// Any number of ranks and threads gives the same field, to the bit: every node does the same operations in the same
// order wherever it is. So does a run that was kept on disk and gone on with.
#include "../TemporaryFolder.h"
#include "LatticeBoltzmann.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <cstring>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::test;

MPI_Comm world()
{
  int initialized = 0;
  MPI_Initialized(&initialized);
  return initialized != 0 ? MPI_COMM_WORLD : MPI_COMM_SELF;
}

bool sameBits(double a, double b)
{
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Nodes of this rank's block whose value is not that of the whole box on one rank.
std::int64_t differing(
  const PhaseImage& image, const Block& block, const LatticeBoltzmann& part, const LatticeBoltzmann& one)
{
  const auto whole = valueOf(one, image.lattice.count());
  const auto mine = valueOf(part, block.count());
  std::int64_t wrong = 0;
  std::size_t i = 0;
  for (std::int64_t z = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      for (std::int64_t x = 0; x < block.size[0]; ++x, ++i)
        wrong += sameBits(mine[i],
                   whole[static_cast<std::size_t>(image.lattice.index(x, y + block.start[1], z + block.start[2]))])
          ? 0
          : 1;
  return wrong;
}

struct Scene
{
  PhaseImage image;
  std::vector<double> d;
  SteppingOptions options;
  std::string name;
};

// All combinations, or one in `every` of them: runs of several ranks on a busy machine wait for each other.
std::vector<Scene> scenes(std::size_t every = 1)
{
  std::vector<Scene> all;
  std::size_t number = 0;
  for (const auto stencil : everyLattice)
    for (const auto collision : { Collision::TRT, Collision::BGK })
      for (const int axis : { 0, 1, dimensionOf(stencil) - 1 })
        for (const bool periodic : { false, true })
          for (const double weak : { 0.1, 0.0 })
          {
            Scene s;
            s.image = dimensionOf(stencil) == 2 ? noise(37, 44, 1, 0.75, 3) : noise(13, 12, 10, 0.75, 3);
            s.d = { weak, 1.0 };
            s.options.stencil = stencil;
            s.options.collision = collision;
            s.options.axis = axis;
            s.options.sides = periodic ? sidesOf(axis, Boundary::Periodic, Boundary::Periodic)
                                       : sidesOf(axis, Boundary::Fixed, Boundary::Insulated);
            s.options.drop = periodic ? 1 : 0;
            s.options.relaxation = 1.5;
            s.name = std::string(name(stencil)) + " " + name(collision) + " axis " + std::to_string(axis) +
              (periodic ? " periodic " : " ") + std::to_string(weak);
            if (++number % every == 0)
              all.push_back(std::move(s));
          }
  return all;
}

TEST(LatticeBoltzmannRanks, GiveTheSameBits)
{
  for (auto& s : scenes(5)) // 5 and 7 share no factor with the numbers of choices
  {
    auto one = stepper(s.image, s.d, s.options);
    auto all = stepper(s.image, s.d, s.options, world());
    one.advance(10);
    all.advance(10);
    EXPECT_EQ(differing(s.image, decompose(s.image.lattice, world()), all, one), 0) << s.name;
    const auto a = one.faceFlux();
    const auto b = all.faceFlux();
    EXPECT_NEAR(a[0], b[0], 1e-12 * std::fabs(a[0])) << s.name; // sums over the face in another order, of terms
    EXPECT_NEAR(a[1], b[1], 1e-12 * std::fabs(a[0])) << s.name; // of both signs
    EXPECT_EQ(all.statistics().stored, one.statistics().stored) << s.name;
  }
}

TEST(LatticeBoltzmannRanks, ThreadsGiveTheSameBits)
{
  if (Communicator(world()).size() > 2)
    GTEST_SKIP() << "threads of more ranks than there are cores only wait for each other";
  for (auto& s : scenes(7))
  {
    auto one = stepper(s.image, s.d, s.options);
    one.advance(20);
    for (const int threads : { 2, 3 })
    {
      s.options.threads = threads;
      auto many = stepper(s.image, s.d, s.options, world());
      many.advance(12);
      many.advance(8);
      EXPECT_EQ(differing(s.image, decompose(s.image.lattice, world()), many, one), 0) << s.name << " " << threads;
    }
  }
  // long enough for several pairs of steps at once in each thread's slab
  const auto tall = noise(9, 400, 1, 0.7, 2);
  SteppingOptions o;
  o.axis = 1;
  o.sides = sidesOf(1, Boundary::Fixed, Boundary::Periodic);
  auto one = stepper(tall, { 0.0, 1.0 }, o);
  o.threads = 2;
  auto two = stepper(tall, { 0.0, 1.0 }, o, world());
  one.advance(38);
  two.advance(38);
  EXPECT_EQ(differing(tall, decompose(tall.lattice, world()), two, one), 0);
  // planes too large for the cache are swept in tiles, but where each thread has one plane only
  const auto deep = noise(64, 40, 40, 0.7, 2);
  o.stencil = lbm::Stencil::D3Q19;
  o.threads = 40;
  auto plain = stepper(deep, { 0.0, 1.0 }, o);
  plain.advance(6);
  for (const int threads : { 1, 2 })
  {
    o.threads = threads;
    auto tiled = stepper(deep, { 0.0, 1.0 }, o, world());
    tiled.advance(6);
    EXPECT_EQ(differing(deep, decompose(deep.lattice, world()), tiled, plain), 0);
  }
}

TEST(LatticeBoltzmannRanks, GoOnFromACheckpointToTheSameBits)
{
  const lamella::testing::TemporaryFolder folder; // only that of rank 0 is used
  for (auto& s : scenes(7))
  {
    auto whole = stepper(s.image, s.d, s.options);
    whole.advance(24);
    s.options.checkpoint.path = folder / "steps.h5";
    {
      auto first = stepper(s.image, s.d, s.options, world());
      first.advance(10);
      first.save();
    }
    auto second = stepper(s.image, s.d, s.options, world());
    second.restore(s.options.checkpoint.path);
    EXPECT_EQ(second.steps(), 10);
    second.advance(14);
    EXPECT_EQ(differing(s.image, decompose(s.image.lattice, world()), second, whole), 0) << s.name;
    s.options.relaxation = 1.25;
    auto other = stepper(s.image, s.d, s.options, world());
    EXPECT_THROW(other.restore(s.options.checkpoint.path), InputError);
  }
}

// A run that writes every so many steps, is cancelled, and goes on: its own records and those before.
TEST(LatticeBoltzmannRanks, InterruptedRunsGoOnWithTheirRecords)
{
  const lamella::testing::TemporaryFolder folder; // only that of rank 0 is used
  const auto image = noise(40, 30, 1, 0.7, 3);
  const std::vector<double> d{ 0.0, 1.0 };
  const std::vector<std::int64_t> stops{ 0, 100, 400, 1000 };
  SteppingOptions o;
  auto whole = stepper(image, d, o);
  whole.advance(stops.back());
  auto never = stepper(image, d, o, world()); // interrupted; means are summed by rank
  never.run(stops, [](const LatticeBoltzmann&) {});
  o.checkpoint.path = folder / "run.h5";
  o.checkpoint.every = 150;
  {
    int seen = 0;
    o.progress = [&](double, const char*) { return seen < 3; };
    auto first = stepper(image, d, o, world());
    EXPECT_THROW(first.run(stops, [&](const LatticeBoltzmann&) { ++seen; }), Cancelled);
    EXPECT_GT(first.lastCheckpoint(), 400); // where it stood
    EXPECT_EQ(first.lastCheckpoint(), first.steps());
    EXPECT_GT(first.checkpoints(), 1);
  }
  o.progress = nullptr;
  auto second = stepper(image, d, o, world());
  second.restore(o.checkpoint.path);
  second.run(std::span(stops).last(1), [](const LatticeBoltzmann&) {});
  EXPECT_EQ(second.lastCheckpoint(), 1000); // the end
  EXPECT_EQ(differing(image, decompose(image.lattice, world()), second, whole), 0);
  ASSERT_EQ(second.records().size(), stops.size());
  for (std::size_t i = 0; i < stops.size(); ++i)
  {
    const auto& a = second.records()[i];
    const auto& b = never.records()[i];
    EXPECT_EQ(std::tie(a.steps, a.time, a.faceFlux, a.mean), std::tie(b.steps, b.time, b.faceFlux, b.mean)) << i;
  }
  auto other = stepper(image, d, o, world());
  other.start(0.5);
  EXPECT_THROW(other.restore(o.checkpoint.path), InputError); // another initial value
}

TEST(LatticeBoltzmannRanks, ComeToRestAlike)
{
  for (const auto stencil : everyLattice)
  {
    const auto image = dimensionOf(stencil) == 2 ? noise(33, 40, 1, 0.8, 5) : noise(12, 14, 11, 0.8, 5);
    SteppingOptions o;
    o.stencil = stencil;
    o.steady = true;
    auto one = stepper(image, { 0.0, 1.0 }, o);
    auto all = stepper(image, { 0.0, 1.0 }, o, world());
    const auto a = one.rest();
    const auto b = all.rest();
    EXPECT_NEAR(a.effective, b.effective, 1e-12 * a.effective) << name(stencil);
    EXPECT_EQ(a.steps, b.steps) << name(stencil);
    EXPECT_EQ(one.statistics().skipped, all.statistics().skipped) << name(stencil);
  }
}

} // namespace
