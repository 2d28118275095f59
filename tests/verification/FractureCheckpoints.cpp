// Fracture that is stopped by force goes on to the same bonds; files that cannot be gone on from are told for what they
// are; a full disk stops nothing.
#include "../TemporaryFolder.h"
#include "FractureSamples.h"

#include "core/Error.h"
#include "io/Checkpoint.h"
#include "peridynamics/fracture/Dynamics.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace
{

using namespace lamella;
using namespace lamella::test;
using lamella::testing::Bytes;
using lamella::testing::bytesOf;
using lamella::testing::TemporaryFolder;
namespace fs = std::filesystem;

/// Some 250 bonds break in half a second or less.
Breakable sample()
{
  return walls(48, 5);
}

FractureOptions optionsFor(FractureMethod method)
{
  FractureOptions o = by(method, 0.1);
  o.renewEvery = 15;
  return o;
}

FractureRecord runOf(const FractureOptions& options)
{
  return fracture(sample(), options);
}

void expectEqual(const FractureRecord& a, const FractureRecord& b)
{
  expectSame(a, b, 0);
  ASSERT_EQ(a.curve.size(), b.curve.size());
  for (std::size_t i = 0; i < a.curve.size(); ++i)
  {
    EXPECT_EQ(a.curve[i].strain, b.curve[i].strain);
    EXPECT_EQ(a.curve[i].stress, b.curve[i].stress);
    EXPECT_EQ(a.curve[i].broken, b.curve[i].broken);
  }
  EXPECT_EQ(a.peak.stress, b.peak.stress);
  EXPECT_EQ(a.first.stress, b.first.stress);
  EXPECT_EQ(a.modulus, b.modulus);
  EXPECT_EQ(a.statistics.events, b.statistics.events);
  EXPECT_EQ(a.statistics.equilibria, b.statistics.equilibria);
  EXPECT_EQ(a.statistics.globalIterations, b.statistics.globalIterations);
  EXPECT_EQ(a.statistics.looseNodes, b.statistics.looseNodes);
  EXPECT_EQ(a.statistics.looseBonds, b.statistics.looseBonds);
  EXPECT_EQ(a.statistics.searches, b.statistics.searches);
}

constexpr const char* fileVariable = "LAMELLA_TEST_CHECKPOINT";
constexpr const char* methodVariable = "LAMELLA_TEST_METHOD";
constexpr int pipeNumber = 9;

FractureMethod methodOf(const std::string& name)
{
  return name == "events" ? FractureMethod::Events : FractureMethod::Accurate;
}

/// What the next test starts, and kills: a byte into the pipe after every event.
void runToBeKilled(const char* file, const char* method)
{
  FractureOptions o = optionsFor(methodOf(method));
  o.checkpoint.path = file;
  o.progress = [](const FractureProgress& p) { return p.broken > 0 && ::write(pipeNumber, "e", 1) != 1; };
  (void)runOf(o);
}

/// Runs this program again, waits for so many events and a little longer, and kills it.
/// @return whether it had not ended by itself before, as it may on a busy machine
bool runAndKill(const fs::path& file, const std::string& method, int events, unsigned microseconds)
{
  int ends[2];
  EXPECT_EQ(::pipe(ends), 0);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], pipeNumber);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  ::setenv(fileVariable, file.c_str(), 1);
  ::setenv(methodVariable, method.c_str(), 1);
  const std::string self = fs::read_symlink("/proc/self/exe").string();
  std::string name = self;
  char* arguments[] = { name.data(), nullptr };
  pid_t child = 0;
  EXPECT_EQ(::posix_spawn(&child, self.c_str(), &actions, nullptr, arguments, environ), 0);
  posix_spawn_file_actions_destroy(&actions);
  ::unsetenv(fileVariable);
  ::close(ends[1]);
  char byte = 0;
  for (int k = 0; k < events && ::read(ends[0], &byte, 1) == 1; ++k)
    continue;
  ::usleep(microseconds);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  ::close(ends[0]);
  return WIFSIGNALED(status);
}

// Ten times of ten, at moments that a seed chooses: after any event, and up to some events later, where it may be
// writing a checkpoint.
TEST(FractureCheckpoints, KilledAndContinuedBreaksTheSameBonds)
{
  std::mt19937 random(11);
  for (const std::string method : { "events", "accurate" })
  {
    const FractureRecord whole = runOf(optionsFor(methodOf(method)));
    ASSERT_GT(whole.broken.size(), 60U);
    int killed = 0;
    for (int time = 0; time < 5; ++time)
    {
      SCOPED_TRACE(method + std::to_string(time));
      const TemporaryFolder folder;
      const fs::path file = folder / "c.h5";
      const int events = 15 + static_cast<int>(random() % (whole.broken.size() - 45));
      killed += runAndKill(file, method, events, random() % 3000) ? 1 : 0;
      FractureOptions o = optionsFor(methodOf(method));
      o.continueFrom = file;
      BondLattice bonds = latticeOf(sample().model, sample().sample, alone());
      QuasiStaticFracture f(bonds, {}, o);
      EXPECT_GE(static_cast<int>(f.record().broken.size()), events / 15 * 15 - 15);
      EXPECT_LT(f.record().broken.size(), whole.broken.size());
      f.run();
      expectEqual(whole, f.record());
    }
    EXPECT_GT(killed, 0);
  }
}

TEST(FractureCheckpoints, NoneIsAsMany)
{
  const TemporaryFolder folder;
  FractureOptions o = optionsFor(FractureMethod::Events);
  const FractureRecord without = runOf(o);
  o.checkpoint.path = folder / "c.h5";
  const FractureRecord with = runOf(o);
  expectEqual(without, with);
  EXPECT_EQ(with.statistics.checkpoints, with.statistics.events / 15);
  o.checkpoint.every = 40;
  EXPECT_EQ(runOf(o).statistics.checkpoints, with.statistics.events / 45);
  o.checkpoint.seconds = 1e-9; // pass before each
  EXPECT_EQ(runOf(o).statistics.checkpoints, with.statistics.events / 45);
  o.checkpoint.seconds = 1e9;
  o.checkpoint.path = folder / "none.h5";
  EXPECT_EQ(runOf(o).statistics.checkpoints, 0);
  EXPECT_FALSE(fs::exists(o.checkpoint.path));
}

// A limit is no part of the scene: a run that came to its end there goes on from its last checkpoint.
TEST(FractureCheckpoints, GoesOnBeyondALimit)
{
  const TemporaryFolder folder;
  FractureOptions o = optionsFor(FractureMethod::Events);
  const FractureRecord whole = runOf(o);
  o.checkpoint.path = folder / "c.h5";
  o.checkpoint.provenance = R"({"program": "lamella"})";
  o.maxBroken = 50;
  (void)runOf(o);
  o.continueFrom = o.checkpoint.path;
  o.maxBroken = 1000000;
  expectEqual(whole, runOf(o));
  const io::Checkpoint last = io::readFile(o.checkpoint.path);
  EXPECT_EQ(last.provenance, o.checkpoint.provenance);
  EXPECT_EQ(last.arrays.at("displacement").unit, "m");
  EXPECT_EQ(last.arrays.at("displacement").shape, (std::vector<std::int64_t>{ 1, 48, 48, 2 }));
}

void refused(const std::function<void()>& act, const std::string& words)
{
  try
  {
    act();
    FAIL() << "not refused: " << words;
  }
  catch (const Error& e)
  {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    EXPECT_FALSE(e.hint().empty());
  }
}

struct Written
{
  TemporaryFolder folder;
  FractureOptions options = optionsFor(FractureMethod::Events);
  fs::path file = folder / "c.h5";
  Written()
  {
    options.maxBroken = 16;
    options.checkpoint.path = file;
    (void)runOf(options);
    options.checkpoint = {};
    options.continueFrom = file;
  }
};

TEST(FractureCheckpoints, RefusesWhatIsNoGoodFile)
{
  Written w;
  const Bytes good = bytesOf(w.file);
  ASSERT_GT(good.size(), 4096U);
  const auto refuse = [&](const Bytes& bytes, const std::string& words)
  {
    w.options.continueFrom = w.folder.write("bad.h5", bytes);
    refused([&] { (void)runOf(w.options); }, words);
  };
  for (const std::size_t size : { std::size_t{ 0 }, std::size_t{ 7 }, std::size_t{ 40 }, std::size_t{ 300 },
         std::size_t{ 512 }, good.size() / 2, good.size() - 1 })
    refuse({ good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size) }, size == 0 ? "is empty" : "is cut off");
  for (std::size_t at = 512; at < good.size(); at += good.size() / 7)
  {
    Bytes bad = good;
    bad[at] ^= 4;
    refuse(bad, "is damaged");
  }
  const auto with = [&](const std::string& from, const std::string& to)
  {
    std::string text(good.begin(), good.end());
    text.replace(text.find(from), from.size(), to);
    return Bytes(text.begin(), text.end());
  };
  refuse(with("format 1", "format 7"), "is newer than this program: its format is 7, written by lamella");
  refuse(with("Lamella", "Another"), "is not a checkpoint");
  refuse({ good.begin() + 512, good.end() }, "is not a checkpoint, but another HDF5 file");
  const std::string text = "strain,stress\n0,0\n";
  refuse({ text.begin(), text.end() }, "is not a checkpoint");
  w.options.continueFrom = w.folder / "none.h5";
  refused([&] { (void)runOf(w.options); }, "No such file");
  w.options.continueFrom = w.folder.path();
  refused([&] { (void)runOf(w.options); }, "is a folder");
}

TEST(FractureCheckpoints, RefusesAnotherScene)
{
  const Written w;
  Breakable other = sample();
  other.model.pairs[{ 1, 1 }].material.criticalStretch = 2e-3;
  refused([&] { (void)fracture(other, w.options); }, "critical stretch 0.001 there, ");
  refused([&] { (void)fracture(walls(48, 4), w.options); }, "another scene: solid nodes: ");
  refused(
    [&] { (void)fracture(walls(56, 5), w.options); }, "another scene: nodes: 48 x 48 x 1 there, 56 x 56 x 1 here");
  other = sample();
  other.model.notches.push_back({ { 0, 24e-6, 0 }, { 10e-6, 0, 0 }, {} });
  refused([&] { (void)fracture(other, w.options); }, "another scene: bonds: ");
  Loading shear;
  shear.load = LoadCase::Shear;
  refused([&] { (void)fracture(sample(), w.options, shear); }, "load: stretch there, shear here");
  FractureOptions o = w.options;
  o.events.rivals = 0;
  refused([&] { (void)runOf(o); }, "another scene: rivals within: 0.005 there, 0 here");
  o = w.options;
  o.method = FractureMethod::Accurate;
  refused([&] { (void)runOf(o); }, "method: events there, accurate here");
  o = w.options;
  o.renewEvery = 0;
  refused([&] { (void)runOf(o); }, "events between renewals: 15 there, 0 here");
  o.continueFrom.clear();
  o.checkpoint.path = w.folder / "d.h5";
  refused([&] { (void)runOf(o); }, "0 events between two renewals");
  DynamicsOptions motion;
  motion.continueFrom = w.file;
  BondLattice bonds = latticeOf(sample().model, sample().sample, alone());
  refused([&] { BondDynamics(bonds, FixedComponents(bonds.layout().count()), motion); },
    "is a checkpoint of quasi-static fracture, not of bonds in motion");
}

TEST(FractureCheckpoints, RefusesAPlaceWhereNoneCanBe)
{
  const TemporaryFolder folder;
  FractureOptions o = optionsFor(FractureMethod::Events);
  const auto refuse = [&](const fs::path& path, const std::string& words)
  {
    o.checkpoint.path = path;
    refused([&] { (void)runOf(o); }, words);
  };
  refuse(folder / "no" / "c.h5", "there is no folder");
  refuse(folder.path(), "is a folder");
  refuse(folder.write("picture.png", { 1, 2, 3 }), "is there already and is no checkpoint");
}

/// No file may grow beyond some bytes: a disk that is full, without one. Writing fails, rather than ends the program.
class FullDisk
{
public:
  FullDisk()
  {
    before_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &limit_);
  }
  ~FullDisk()
  {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  void fill() const
  {
    const rlimit small{ 1000, limit_.rlim_max };
    ::setrlimit(RLIMIT_FSIZE, &small);
  }

private:
  rlimit limit_{};
  void (*before_)(int) = nullptr;
};

TEST(FractureCheckpoints, AFullDiskStopsNothing)
{
  const TemporaryFolder folder;
  FractureOptions o = optionsFor(FractureMethod::Events);
  const FractureRecord whole = runOf(o);
  std::vector<std::string> warnings;
  FractureRecord record;
  {
    const FullDisk disk;
    o.checkpoint.path = folder / "c.h5";
    o.checkpoint.warn = [&](const std::string& text) { warnings.push_back(text); };
    o.progress = [&](const FractureProgress& p)
    {
      if (p.broken == 40)
        disk.fill();
      return false;
    };
    record = runOf(o);
  }
  expectEqual(whole, record);
  EXPECT_EQ(record.statistics.checkpoints, 2);
  ASSERT_EQ(static_cast<std::int64_t>(warnings.size()), record.statistics.events / 15 - 2);
  EXPECT_NE(warnings[0].find("File too large"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("the last good checkpoint stays"), std::string::npos) << warnings[0];
  EXPECT_EQ(
    std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1); // nothing left beside it
  o.continueFrom = o.checkpoint.path;
  o.progress = {};
  expectEqual(whole, runOf(o));
}

} // namespace

int main(int argc, char** argv)
{
  const char* file = std::getenv(fileVariable);
  if (const char* method = std::getenv(methodVariable); file != nullptr && method != nullptr)
  {
    runToBeKilled(file, method);
    return 0;
  }
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
