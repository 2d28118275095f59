// Checkpoints of some ranks, gone on from by as many, fewer or more.
#include "FractureSamples.h"

#include "core/Error.h"
#include "peridynamics/fracture/DynamicsStudy.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <unistd.h>

namespace
{

using namespace lamella;
using namespace lamella::test;
namespace fs = std::filesystem;

/// A file that all ranks know of; goes when all are done.
class SharedFile
{
public:
  SharedFile()
  {
    const auto process = everyone().sum(everyone().rank() == 0 ? std::int64_t{ ::getpid() } : std::int64_t{ 0 });
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ =
      fs::path(::testing::TempDir()) / ("lamella_" + std::string(test->name()) + "_" + std::to_string(process) + ".h5");
  }
  ~SharedFile()
  {
    (void)everyone().any(false); // until here
    std::error_code ignored;
    if (everyone().rank() == 0)
      fs::remove(path_, ignored);
  }
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

private:
  fs::path path_;
};

/// The first half of the ranks; none on the others.
std::optional<Communicator> half()
{
  if (!everyone().parallel())
    return alone();
  MPI_Comm part = MPI_COMM_NULL;
  const bool in = everyone().rank() < everyone().size() / 2;
  MPI_Comm_split(everyone().handle(), in ? 0 : MPI_UNDEFINED, 0, &part);
  return in ? std::optional<Communicator>(part) : std::nullopt;
}

// As many ranks: to the last bit. Others: as far as other numbers of ranks agree anyway, see FractureRanks.
TEST(FractureCheckpoints, AnyNumberOfRanksGoesOn)
{
  for (const Breaking breaking : { Breaking::Strict, Breaking::Batched })
  {
    const Breakable s = walls(40, 3);
    FractureOptions o = by(FractureMethod::Accurate, 0.2);
    o.breaking = breaking;
    o.tolerance = 1e-8;
    o.renewEvery = 6;
    o.maxBroken = 24;
    const FractureRecord whole = fracture(s, o, {}, everyone());
    const SharedFile file;
    o.checkpoint.path = file.path();
    o.maxBroken = 14;
    (void)fracture(s, o, {}, everyone());
    o.checkpoint = {};
    o.continueFrom = file.path();
    o.maxBroken = 24;
    expectSame(whole, fracture(s, o, {}, everyone()), 0);
    if (const std::optional<Communicator> part = half())
      expectSame(whole, fracture(s, o, {}, *part), 1e-5);
    expectSame(whole, fracture(s, o), 1e-5);
    (void)everyone().any(false); // all have read it
    if (everyone().rank() == 0)
    {
      o.continueFrom.clear();
      o.checkpoint.path = file.path();
      o.maxBroken = 14;
      (void)fracture(s, o);
    }
    (void)everyone().any(false);
    o.checkpoint = {};
    o.continueFrom = file.path();
    o.maxBroken = 24;
    expectSame(whole, fracture(s, o, {}, everyone()), 1e-5);
  }
}

// Events come to the same on any number of ranks, and so does a run that goes on on another.
TEST(FractureCheckpoints, EventsGoOnOnAnyNumberOfRanks)
{
  const Breakable s = cementedGrains(48, 0.5);
  FractureOptions o = by(FractureMethod::Events);
  o.renewEvery = 20;
  o.maxBroken = 60;
  const FractureRecord whole = fracture(s, o);
  EXPECT_GT(whole.broken.size(), 50U);
  const SharedFile file;
  o.checkpoint.path = file.path();
  o.maxBroken = 45;
  (void)fracture(s, o, {}, everyone());
  o.checkpoint = {};
  o.continueFrom = file.path();
  o.maxBroken = 60;
  expectSame(whole, fracture(s, o, {}, everyone()), 0);
  if (const std::optional<Communicator> part = half())
    expectSame(whole, fracture(s, o, {}, *part), 0);
  expectSame(whole, fracture(s, o), 0);
}

// A grain between two voids, glued in above and below: its weak bonds are all equally stretched and break as one batch,
// and the grain, loose, takes its own with it. With four neighbours a node columns know nothing of each other.
TEST(FractureCheckpoints, LoosePiecesStayOut)
{
  Breakable s = strip(20, 40, 1);
  const auto phase = [&](std::int64_t x, std::int64_t y) -> std::uint8_t&
  { return s.sample.phase[static_cast<std::size_t>(x + 20 * y)]; };
  for (std::int64_t y = 15; y < 25; ++y)
    for (std::int64_t x = 8; x < 13; ++x)
      phase(x, y) = x == 8 || x == 12 ? 0 : 2;
  for (std::int64_t x = 0; x < 20; ++x)
    for (std::int64_t y = 30; y < 40; ++y)
      phase(x, y) = static_cast<std::uint8_t>(3 + x % 4);
  const BondMaterial solid{ .youngsModulus = young };
  for (std::uint8_t a = 1; a < 7; ++a)
    for (std::uint8_t b = a; b < 7; ++b)
      s.model.pairs[{ a, b }].material = solid;
  s.model.pairs[{ 1, 2 }].material.criticalStretch = 1e-3;
  for (std::uint8_t a = 3; a < 7; ++a)
    s.model.pairs[{ 1, a }].material.criticalStretch = 2e-3 + 1e-4 * a;
  FractureOptions o = by(FractureMethod::Accurate, 0);
  o.breaking = Breaking::Batched;
  o.renewEvery = 1;
  o.tolerance = 1e-12; // what is equally stretched is so to 1e-9
  const FractureRecord whole = fracture(s, o, {}, everyone());
  EXPECT_EQ(whole.end, FractureEnd::NothingBreaks); // above the voids two columns still hang on their neighbours
  EXPECT_EQ(whole.broken.size(), 6U + 15U);
  EXPECT_EQ(whole.statistics.looseNodes, 30);
  EXPECT_EQ(whole.statistics.looseBonds, 3 * 9 + 2 * 10);
  const SharedFile file;
  o.checkpoint.path = file.path();
  o.maxBroken = 6;
  (void)fracture(s, o, {}, everyone());
  o.checkpoint = {};
  o.continueFrom = file.path();
  o.maxBroken = 1000;
  const FractureRecord again = fracture(s, o, {}, everyone());
  expectSame(whole, again, 0);
  EXPECT_EQ(again.statistics.looseNodes, 30);
  EXPECT_EQ(again.statistics.looseBonds, whole.statistics.looseBonds);
}

TEST(FractureCheckpoints, AllRanksSayTheSame)
{
  FractureOptions o = by(FractureMethod::Accurate, 0.2);
  o.continueFrom = "no such file.h5";
  EXPECT_THROW((void)fracture(walls(64), o, {}, everyone()), InputError);
  o.continueFrom.clear();
  o.checkpoint.path = "no such folder/c.h5";
  EXPECT_THROW((void)fracture(walls(64), o, {}, everyone()), InputError);
}

/// A sample that is pulled apart at a regulated rate and damped, held at its lower end, pushed a little to the side.
struct Motion
{
  Motion(const Communicator& comm, const fs::path& write, const fs::path& from,
    const std::function<bool(const DynamicsProgress&)>& progress = {})
    : bonds(latticeOf(aggregateModel(2), aggregate(32, 48), comm))
  {
    LoadedSample loaded = applyLoading(bonds, {});
    DynamicsOptions o;
    o.density = 1500;
    o.damping = 0.05;
    o.rate.emplace(2e-5, 1e-2, 1.0);
    o.checkpoint.path = write;
    o.checkpoint.every = 25;
    o.continueFrom = from;
    o.progress = progress;
    o.progressEvery = 0;
    motion.emplace(bonds, std::move(loaded.fixed), o);
    if (!from.empty())
      return;
    NodeField<double> v(bonds.layout());
    NodeField<double> push(bonds.layout());
    const NodeLayout& l = bonds.layout();
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
      {
        v.at(1, x, y) = 6 * (static_cast<double>(y + l.start[1]) + 0.5) / 48;
        push.at(0, x, y) = 1;
      }
    motion->setLoad(std::move(push));
    motion->setState(NodeField<double>(l), v);
  }
  BondLattice bonds;
  std::optional<BondDynamics> motion;
};

void expectSame(const BondDynamics& a, const BondDynamics& b)
{
  EXPECT_EQ(a.time(), b.time());
  EXPECT_EQ(a.rate(), b.rate());
  ASSERT_EQ(a.broken().size(), b.broken().size());
  for (std::size_t i = 0; i < a.broken().size(); ++i)
  {
    EXPECT_TRUE(a.broken()[i].bond == b.broken()[i].bond) << i;
    EXPECT_EQ(a.broken()[i].step, b.broken()[i].step);
    EXPECT_EQ(a.broken()[i].energy, b.broken()[i].energy);
  }
  const NodeLayout& l = a.displacement().layout();
  for (int c = 0; c < 2; ++c)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
      {
        ASSERT_EQ(a.displacement().at(c, x, y), b.displacement().at(c, x, y));
        ASSERT_EQ(a.velocity().at(c, x, y), b.velocity().at(c, x, y));
      }
  EXPECT_EQ(a.energies().kinetic, b.energies().kinetic);
  EXPECT_EQ(a.energies().supplied, b.energies().supplied);
  EXPECT_EQ(a.energies().damped, b.energies().damped);
  EXPECT_EQ(a.energies().initial, b.energies().initial);
}

TEST(DynamicsCheckpoints, GoesOnToTheLastBit)
{
  Motion whole(everyone(), {}, {});
  whole.motion->advance(200);
  ASSERT_GT(whole.motion->broken().size(), 10U);
  const SharedFile file;
  {
    Motion first(everyone(), file.path(), {});
    first.motion->advance(137); // the last file is of step 125
    ASSERT_LT(first.motion->broken().size(), whole.motion->broken().size());
  }
  Motion again(everyone(), {}, file.path());
  EXPECT_EQ(again.motion->steps(), 125);
  again.motion->advance(75);
  const BondDynamics& a = *whole.motion;
  expectSame(a, *again.motion);

  // on one rank: the same bonds, the same energies to round-off
  Motion one(alone(), {}, file.path());
  one.motion->advance(75);
  ASSERT_EQ(a.broken().size(), one.motion->broken().size());
  for (std::size_t i = 0; i < a.broken().size(); ++i)
    EXPECT_TRUE(a.broken()[i].bond == one.motion->broken()[i].bond) << i;
  EXPECT_NEAR(a.energies().supplied, one.motion->energies().supplied, 1e-9 * a.energies().supplied);
  EXPECT_NEAR(a.energies().damped, one.motion->energies().damped, 1e-9 * a.energies().damped);
}

// Stopped after any step, it writes that one, says so, and goes on as if it had not stopped.
TEST(DynamicsCheckpoints, AStopLeavesOne)
{
  Motion whole(everyone(), {}, {});
  whole.motion->advance(200);
  const SharedFile file;
  std::int64_t written = 0;
  {
    const auto stop = [&](const DynamicsProgress& p)
    {
      written = p.checkpoint;
      return p.step == 137;
    };
    Motion first(everyone(), file.path(), {}, stop);
    EXPECT_FALSE(first.motion->advance(200));
    EXPECT_EQ(first.motion->steps(), 137);
    EXPECT_EQ(written, 137);
  }
  Motion again(everyone(), {}, file.path());
  EXPECT_EQ(again.motion->steps(), 137);
  again.motion->advance(63);
  expectSame(*whole.motion, *again.motion);
}

/// A strip that breaks in its middle under a pull; states at numbers of broken bonds and at times.
struct KeptMotion
{
  DynamicsStudyOptions options;
  std::vector<std::pair<std::int64_t, MotionState>> states; ///< by number

  KeptMotion()
  {
    options.motion.density = 1500;
    options.motion.damping = 0.05;
    options.motion.progressEvery = 0;
    options.pull.emplace();
    options.pull->transits = 4;
    options.atBroken = { 1, 5, 6, 7, 20 };
    options.keep = [this](MotionState s) { states.emplace_back(s.number, std::move(s)); };
  }
  DynamicsResult run(const Communicator& comm)
  {
    const Sample s = aggregate(32, 48);
    const BondModel m = aggregateModel(2);
    const Block own = slab(s.lattice, Stencil(2, m.horizon), comm);
    const auto first = static_cast<std::size_t>(own.start[1] * s.lattice.size[0]);
    return studyDynamics(
      m, s.lattice, std::span(s.phase).subspan(first, static_cast<std::size_t>(own.count())), {}, options, comm);
  }
};

// A stop falls between two points of the history, after bonds have broken whose state is due at the next: that state,
// and all after it, are made as if there had been no stop, under the same numbers.
TEST(DynamicsCheckpoints, AStoppedRunMakesTheSameStates)
{
  KeptMotion whole;
  const DynamicsResult a = whole.run(everyone());
  ASSERT_GT(whole.states.size(), 3U);
  const SharedFile file;
  for (const std::int64_t broken : { 1, 6, 12 })
  {
    SCOPED_TRACE(broken);
    KeptMotion first;
    first.options.motion.checkpoint.path = file.path();
    first.options.progress = [&](const DynamicsProgress& p, double) { return p.broken >= broken; };
    EXPECT_THROW((void)first.run(everyone()), Cancelled);
    KeptMotion again;
    again.options.motion.continueFrom = file.path();
    const DynamicsResult b = again.run(everyone());
    ASSERT_EQ(first.states.size() + again.states.size(), whole.states.size());
    EXPECT_EQ(b.statesBefore, static_cast<std::int64_t>(first.states.size()));
    for (std::size_t i = 0; i < whole.states.size(); ++i)
    {
      const std::size_t before = first.states.size();
      const auto& [number, state] = i < before ? first.states[i] : again.states[i - before];
      EXPECT_EQ(number, whole.states[i].first);
      EXPECT_EQ(state.time, whole.states[i].second.time);
      EXPECT_EQ(state.strain, whole.states[i].second.strain);
      EXPECT_EQ(state.stress, whole.states[i].second.stress);
      EXPECT_EQ(state.broken, whole.states[i].second.broken);
    }
    ASSERT_EQ(a.history.size(), b.history.size());
    for (std::size_t i = 0; i < a.history.size(); ++i)
    {
      EXPECT_EQ(a.history[i].step, b.history[i].step);
      EXPECT_EQ(a.history[i].stress, b.history[i].stress);
      EXPECT_EQ(a.history[i].energies.kinetic, b.history[i].energies.kinetic);
    }
    ASSERT_EQ(a.broken.size(), b.broken.size());
    for (std::size_t i = 0; i < a.broken.size(); ++i)
      EXPECT_TRUE(a.broken[i].bond == b.broken[i].bond && a.broken[i].step == b.broken[i].step) << i;
  }
}

} // namespace
