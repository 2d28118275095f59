// Fracture on more and more ranks: damped motion (the way of the paper whose samples these are: Frank, Radjai,
// Nezamabadi and Delenne, Phys. Rev. E 102 (2020) 022906, figure 19) and both quasi-static methods. Times on one and
// two ranks, what the ranks send each other on up to 64 of them (more than there are cores: counts, and the
// processor time of the work in between), bonds by rows of the samples, and the machine's own figures.
// benchmarks/fracture-scaling.py predicts from these and draws.
// Starts itself under mpirun, once for each table, unless it already runs there.
//   study=machine|time|counts   one of them; all in turn unless told
//   nx=512,1024   nodes across, of samples twice as high   steps=100   of motion   events=3   of batches   strict=40 of
//   local corrections (none on more than 16 ranks)
//   pairs=5   of runs on one rank and on all   most=64   ranks   output=FOLDER
#include "BreakableSamples.h"
#include "CountedMpi.h"
#include "Keys.h"
#include "Ranks.h"
#include "Scaling.h"

#include "peridynamics/BondForces.h"
#include "peridynamics/Equilibrium.h"
#include "peridynamics/Loading.h"
#include "peridynamics/fracture/DampedPull.h"
#include "peridynamics/fracture/Dynamics.h"
#include "peridynamics/fracture/Fracture.h"

#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::peridynamics;

constexpr const char* bench = "fracture-scaling";
constexpr double density = 1000; // sets the unit of time, no more
constexpr std::int64_t platen = 4;

struct Node
{
  std::uint8_t phase;
  std::int32_t grain;
};

// 400 cemented grains, half of the gaps filled, exactly twice as high as wide: the packing's own height is nearly that;
// rows too many are left out below the high platen, rows too few are mirror images of those before.
Sample cementedTwiceAsHigh(std::int64_t nx)
{
  const Sample packed = cemented({ .nodes = nx, .saturation = 0.5, .grains = 400, .platen = platen });
  const std::int64_t height = packed.lattice.size[1];
  const std::int64_t inner = height - 2 * platen;
  Sample s{ makeLattice(nx, 2 * nx, 1, 2, packed.lattice.spacing), {}, {}, packed.model };
  for (std::int64_t y = 0; y < 2 * nx; ++y)
  {
    std::int64_t from = (y - platen) % (2 * inner);
    from = platen + (from < inner ? from : 2 * inner - 1 - from);
    if (y < platen)
      from = y;
    else if (y >= 2 * nx - platen)
      from = height - 2 * nx + y;
    const auto at = static_cast<std::ptrdiff_t>(from * nx);
    s.phase.insert(s.phase.end(), packed.phase.begin() + at, packed.phase.begin() + at + nx);
    s.grain.insert(s.grain.end(), packed.grain.begin() + at, packed.grain.begin() + at + nx);
  }
  return s;
}

// Rank 0's, on all.
Sample sampleOnAll(std::int64_t nx)
{
  const Communicator world(MPI_COMM_WORLD);
  Sample s;
  std::vector<std::byte> phase;
  std::vector<std::byte> grain;
  std::vector<std::byte> spacing(sizeof(double));
  if (world.rank() == 0)
  {
    s = cementedTwiceAsHigh(nx);
    const auto bytes = std::as_bytes(std::span(s.phase));
    phase.assign(bytes.begin(), bytes.end());
    const auto numbers = std::as_bytes(std::span(s.grain));
    grain.assign(numbers.begin(), numbers.end());
    std::memcpy(spacing.data(), &s.lattice.spacing, sizeof(double));
  }
  world.broadcast(phase);
  world.broadcast(grain);
  world.broadcast(spacing);
  if (world.rank() == 0)
    return s;
  // The model is that of any such sample.
  s.model = cemented({}).model;
  double length = 1;
  std::memcpy(&length, spacing.data(), sizeof(double));
  s.lattice = makeLattice(nx, 2 * nx, 1, 2, length);
  s.phase.resize(phase.size());
  std::memcpy(s.phase.data(), phase.data(), phase.size());
  s.grain.resize(grain.size() / sizeof(std::int32_t));
  std::memcpy(s.grain.data(), grain.data(), grain.size());
  return s;
}

BondLattice bondsOf(const Sample& s, const Communicator& comm)
{
  const Block part = slab(s.lattice, Stencil(2, s.model.horizon), comm);
  const auto first = static_cast<std::size_t>(part.start[1] * part.size[0]);
  const auto count = static_cast<std::size_t>(part.count());
  return { s.model, s.lattice, std::span(s.phase).subspan(first, count), std::span(s.grain).subspan(first, count),
    comm };
}

// What of a run is measured: its set-up, and its steps or iterations.
struct Measured
{
  std::int64_t units = 0; ///< steps, or iterations of conjugate gradients
  std::int64_t setUpUnits = 0;
  std::int64_t events = 0;
  std::int64_t broken = 0;
  double value = 0; ///< that all numbers of ranks must agree on
  double setUp = 0; ///< wall time [s]
  double seconds = 0;
  MpiCounts ofSetUp;
  MpiCounts counts;
};

template <class SetUp, class Run>
Measured measured(SetUp&& setUp, Run&& run)
{
  Measured m;
  const MpiCounts before = mpiCounts();
  const double start = MPI_Wtime();
  auto solver = setUp();
  const MpiCounts between = mpiCounts();
  const double middle = MPI_Wtime();
  run(*solver, m);
  m.seconds = MPI_Wtime() - middle;
  m.counts = mpiCounts() - between;
  m.setUp = middle - start;
  m.ofSetUp = between - before;
  return m;
}

// Of unit strain, by the method that Accurate has for each.
struct Unit
{
  LoadedSample sample;
  NodeField<double> u;
  double firstBreak = 0; ///< strain
  Measured cost;
};

Unit unitOf(const BondLattice& bonds)
{
  Loading loading;
  loading.strain = 1;
  Unit unit{ applyLoading(bonds, loading), {}, 0, {} };
  unit.u = unit.sample.displacement;
  unit.cost = measured([&] { return std::make_unique<Equilibrium>(bonds, unit.sample.fixed); },
    [&](Equilibrium& e, Measured& m) { m.units = e.solve(unit.u).iterations; });
  unit.firstBreak = 1 / largestStretch(bonds, unit.u, false).ratio;
  unit.cost.value = unit.firstBreak;
  return unit;
}

NodeField<double> times(const NodeField<double>& u, double factor)
{
  NodeField<double> scaled = u;
  for (int c = 0; c < u.components(); ++c)
    for (std::int64_t i = 0; i < u.layout().count(); ++i)
      scaled.component(c)[i] *= factor;
  return scaled;
}

// Damped motion from the equilibrium of a strain, at the speeds of a pull that takes 30 travel times of a wave to the
// first break. @param strain over that of the first break
Measured motion(BondLattice& bonds, const Sample& s, const Unit& unit, double strain, std::int64_t steps)
{
  constexpr double young = 1e9; // of the matrix
  const double rate = unit.firstBreak / (30 * travelTime(s.lattice.length(1), young, density));
  DynamicsOptions o;
  o.density = density;
  o.damping = 0.1;
  return measured(
    [&]
    {
      auto m = std::make_unique<BondDynamics>(bonds, unit.sample.fixed, o);
      m->setState(times(unit.u, strain * unit.firstBreak), times(unit.u, rate));
      return m;
    },
    [&](BondDynamics& m, Measured& result)
    {
      m.advance(steps);
      result.units = m.steps();
      result.broken = static_cast<std::int64_t>(m.broken().size());
      std::int64_t last = 0; // steps in which something broke count as events
      for (const DynamicBreak& b : m.broken())
        result.events += b.step != std::exchange(last, b.step) ? 1 : 0;
      result.value = m.energies().elastic;
    });
}

// Until some events have passed.
Measured broken(BondLattice& bonds, FractureMethod method, Breaking breaking, std::int64_t events)
{
  FractureOptions o;
  o.method = method;
  o.breaking = breaking;
  std::int64_t seen = 0;
  bool first = true;
  o.progress = [&](const FractureProgress&) { return !first && ++seen >= events; };
  return measured(
    [&]
    {
      auto f = std::make_unique<QuasiStaticFracture>(bonds, Loading{}, o);
      first = false;
      return f;
    },
    [&](QuasiStaticFracture& f, Measured& m)
    {
      m.setUpUnits = f.record().statistics.globalIterations;
      f.run();
      const FractureRecord& r = f.record();
      m.units = r.statistics.globalIterations - m.setUpUnits;
      m.events = r.statistics.events;
      m.broken = static_cast<std::int64_t>(r.broken.size());
      m.value = r.broken.empty() ? 0 : r.broken.back().stress;
    });
}

// Bonds that a rank goes through: those with an end of its own.
std::int64_t bondsVisited(const BondLattice& bonds)
{
  const NodeLayout& l = bonds.layout();
  std::int64_t count = 0;
  for (std::int64_t y = -l.ghost; y < l.size[1]; ++y)
    bonds.forEachBond(y, 0, [&](std::int64_t, std::int64_t, int, int) { ++count; });
  return count;
}

// Solid nodes and bonds of every row, the bonds by the rows that they lead up: what a slab of any height has.
void tellRows(const Keys& keys, const BondLattice& bonds)
{
  const NodeLayout& l = bonds.layout();
  const int reach = bonds.stencil().layers();
  std::vector<std::string> names;
  for (int dy = 0; dy <= reach; ++dy)
    names.push_back(fmt::format("bonds_{}", dy));
  auto table =
    tableOf(keys, bench, fmt::format("rows-{}", l.size[0]), fmt::format("row,solid,{}", fmt::join(names, ",")));
  for (std::int64_t y = 0; y < l.size[1]; ++y)
  {
    std::int64_t solid = 0;
    for (std::int64_t i = l.index(0, y); i < l.index(l.size[0], y); ++i)
      solid += bonds.solid(i) ? 1 : 0;
    std::vector<std::int64_t> count(static_cast<std::size_t>(reach) + 1);
    bonds.forEachBond(y, 0,
      [&](std::int64_t, std::int64_t, int o, int)
      { ++count[static_cast<std::size_t>(bonds.stencil().half()[static_cast<std::size_t>(o)].step[1])]; });
    table->line(y, solid, fmt::format("{}", fmt::join(count, ",")));
  }
}

void counts(const Keys& keys)
{
  const Communicator world(MPI_COMM_WORLD);
  auto table = tableOf(keys, bench, fmt::format("counts-{}", world.size()),
    "what,nx,ny,ranks,solid,bonds,rows_most,visited,visited_most,units,set_up_units,events,broken,value,set_up,"
    "seconds," +
      countColumns("s_") + "," + countColumns(""));
  const auto steps = static_cast<std::int64_t>(number(keys, "steps", 100));
  const auto events = static_cast<std::int64_t>(number(keys, "events", 3));
  const auto strict = static_cast<std::int64_t>(number(keys, "strict", world.size() <= 16 ? 40 : 0));
  const Keys sizes{ { "nx", text(keys, "nx", "512,1024") } };
  for (const double nx : list(sizes, "nx", 512))
  {
    const Sample s = sampleOnAll(static_cast<std::int64_t>(nx));
    BondLattice bonds = bondsOf(s, world);
    if (!world.parallel())
      tellRows(keys, bonds);
    const auto visited = static_cast<double>(bondsVisited(bonds));
    const double mean = world.sum(visited) / world.size();
    const double most = world.max(visited);
    const double rows = world.max(static_cast<double>(bonds.layout().size[1]));
    const std::int64_t solid = bonds.solidNodes();
    const std::int64_t all = bonds.bonds();
    const auto tell = [&](const char* what, const Measured& m)
    {
      const std::string ofSetUp = countValues(m.ofSetUp);
      const std::string ofRun = countValues(m.counts);
      if (table)
        table->line(what, s.lattice.size[0], s.lattice.size[1], world.size(), solid, all, rows, mean, most, m.units,
          m.setUpUnits, m.events, m.broken, fmt::format("{:.12g}", m.value), m.setUp, m.seconds, ofSetUp, ofRun);
    };
    const Unit unit = unitOf(bonds);
    tell("equilibrium", unit.cost);
    tell("motion", motion(bonds, s, unit, 0.9, steps));
    tell("breaking", motion(bonds, s, unit, 1.0005, steps));
    BondLattice batched = bondsOf(s, world);
    tell("batched", broken(batched, FractureMethod::Accurate, Breaking::Batched, events));
    if (strict == 0)
      continue;
    BondLattice local = bondsOf(s, world);
    tell("events", broken(local, FractureMethod::Events, Breaking::Strict, strict));
  }
}

// One rank and all in turns, and every rank by itself at once: what the machine allows.
void time(const Keys& keys)
{
  const Communicator world(MPI_COMM_WORLD);
  const Communicator self(MPI_COMM_SELF);
  const bool first = world.rank() == 0;
  const int pairs = static_cast<int>(number(keys, "pairs", 5));
  const auto steps = static_cast<std::int64_t>(number(keys, "steps", 100));
  auto table = tableOf(keys, bench, "time",
    "what,nx,ranks,pair,load,units,one_set_up,one,one_work,all_set_up,all,all_work,all_work_most,apart_set_up,apart,"
    "apart_work");
  const Keys sizes{ { "nx", text(keys, "nx", "512,1024") } };
  for (const double nx : list(sizes, "nx", 512))
  {
    const Sample s = sampleOnAll(static_cast<std::int64_t>(nx));
    BondLattice alone = bondsOf(s, self);
    BondLattice shared = bondsOf(s, world);
    for (int i = 0; i < pairs; ++i)
    {
      const double load = loadNow();
      std::array<Measured, 2> one;
      const auto both = [&](BondLattice& bonds)
      {
        const Unit unit = unitOf(bonds);
        return std::array<Measured, 2>{ unit.cost, motion(bonds, s, unit, 0.9, steps) };
      };
      waitForAll();
      if (first)
        one = both(alone);
      waitForAll();
      const auto all = both(shared);
      waitForAll();
      const auto apart = both(alone);
      waitForAll();
      for (const std::size_t k : { 0, 1 })
      {
        const double mean = world.sum(all[k].counts.work) / world.size();
        const double most = world.max(all[k].counts.work);
        if (table)
          table->line(k == 0 ? "equilibrium" : "motion", s.lattice.size[0], world.size(), i, load, one[k].units,
            one[k].setUp, one[k].seconds, one[k].counts.work, all[k].setUp, all[k].seconds, mean, most, apart[k].setUp,
            apart[k].seconds, apart[k].counts.work);
      }
    }
  }
}

int startAll(const Keys& keys, const char* program)
{
  const StudyStarter start(keys, program);
  bool good = start(2, "machine") && start(2, "time");
  for (const int ranks : { 1, 2, 4, 8, 16, 32, 64 })
    good = good && (ranks > number(keys, "most", 64) || start(ranks, "counts"));
  return good ? 0 : 1;
}

} // namespace

int main(int argc, char** argv)
{
  setenv("OMP_NUM_THREADS", "1", 0); // ranks take the cores
  if (!onRanks())
    return startAll(keysOf(argc, argv), argv[0]);
  return runWith(argc, argv,
    [](const Keys& keys)
    {
      runStudies(keys,
        { { "machine", [&] { measureMachine(keys, bench); } }, { "time", [&] { time(keys); } },
          { "counts", [&] { counts(keys); } } });
    });
}
