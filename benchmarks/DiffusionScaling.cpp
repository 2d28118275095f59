// Steady diffusion on more and more ranks, by lean and by piece multigrid: times and memory on one and two ranks, what
// the ranks send each other on up to 64 of them (more than there are cores: counts, and the processor time of the work
// in between), and the machine's own figures. benchmarks/diffusion-scaling.py predicts from these and draws.
// Starts itself under mpirun, once for each table, unless it already runs there.
//   study=machine|time|memory|counts   one of them; all in turn unless told
//   strong=128 weak=48   of counts: nodes an edge of the whole, and of a rank's part
//   edge=200   of time and memory: nodes an edge, of the whole and of a rank's part   memory=200,400   of memory
//   pairs=5   of runs on one rank and on all   most=64   ranks   kinds=lean,pieces,walls,voids   output=FOLDER
#include "CountedMpi.h"
#include "Keys.h"
#include "Ranks.h"
#include "Scaling.h"

#include "generators/Generators.h"
#include "lbm/Backend.h"
#include "lbm/lean/LeanSystem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include <sys/resource.h>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

constexpr const char* bench = "diffusion-scaling";

struct Kind
{
  const char* name;
  bool pieces;
  std::vector<double> conductivity; ///< of lumina and walls
};

std::vector<Kind> kindsOf(const Keys& keys)
{
  const std::string wanted = fmt::format(",{},", text(keys, "kinds", "lean,pieces,walls,voids"));
  std::vector<Kind> kinds{ { "lean", false, { 0.023, 1 } }, { "pieces", true, { 0.023, 1 } },
    { "walls", true, { 1, 0.001 } }, { "voids", true, { 0, 1 } } };
  std::erase_if(kinds, [&](const Kind& k) { return wanted.find(fmt::format(",{},", k.name)) == std::string::npos; });
  return kinds;
}

// Tissue of a cube and its mirror images, of any size.
class Tissue
{
public:
  Tissue(std::int64_t base, const std::array<std::int64_t, 3>& size)
    : lattice(makeLattice(size[0], size[1], size[2], 3, 1.0 / static_cast<double>(base)))
    , base_(base)
  {
    const Communicator world(MPI_COMM_WORLD);
    std::vector<std::byte> bytes;
    if (world.rank() == 0)
    {
      generators::SoftwoodOptions o;
      o.dimension = 3;
      o.size = { base, base, base };
      o.solidFraction = 0.40;
      o.seed = 1;
      const PhaseImage image = generators::softwood(o);
      const auto* first = reinterpret_cast<const std::byte*>(image.phase.data());
      bytes.assign(first, first + image.phase.size());
    }
    world.broadcast(bytes);
    cube_ = std::move(bytes);
  }
  [[nodiscard]] std::vector<std::uint8_t> phases(const Block& block) const
  {
    const auto from = [&](std::int64_t i) { return i / base_ % 2 == 0 ? i % base_ : base_ - 1 - i % base_; };
    std::vector<std::uint8_t> phase;
    phase.reserve(static_cast<std::size_t>(block.count()));
    for (std::int64_t z = 0; z < block.size[2]; ++z)
      for (std::int64_t y = 0; y < block.size[1]; ++y)
      {
        const std::int64_t row = base_ * (from(y + block.start[1]) + base_ * from(z + block.start[2]));
        for (std::int64_t x = 0; x < block.size[0]; ++x)
          phase.push_back(static_cast<std::uint8_t>(cube_[static_cast<std::size_t>(row + from(x))]));
      }
    return phase;
  }

  Lattice lattice;

private:
  std::int64_t base_;
  std::vector<std::byte> cube_;
};

// As many cubes as ranks, side by side.
std::array<std::int64_t, 3> cubes(std::int64_t edge, int ranks)
{
  int across = 1;
  for (int i = 1; i * i <= ranks; ++i)
    across = ranks % i == 0 ? i : across;
  return { edge, edge * across, edge * (ranks / across) };
}

struct Run
{
  lbm::SteadyResult result;
  double setUp = 0; ///< wall time [s]
  double solve = 0;
  MpiCounts ofSetUp;
  MpiCounts ofSolve;
};

Run run(const Tissue& tissue, const Kind& kind, MPI_Comm handle)
{
  const Communicator comm(handle);
  const Decomposition parts(tissue.lattice, comm);
  const auto phase = tissue.phases(parts.block());
  lbm::SteadyOptions options;
  options.stencil = lbm::Stencil::D3Q7;
  options.tolerance = 1e-6;
  options.fieldTolerance = std::numeric_limits<double>::infinity();
  const lbm::Problem problem{ tissue.lattice, parts, comm, options, phase, kind.conductivity };
  Run r;
  const MpiCounts before = mpiCounts();
  const double start = MPI_Wtime();
  const auto backend = kind.pieces ? lbm::makePieceSystem(problem) : lbm::makeLeanSystem(problem);
  const MpiCounts between = mpiCounts();
  const double middle = MPI_Wtime();
  r.result = backend->solve();
  r.solve = MPI_Wtime() - middle;
  r.setUp = middle - start;
  r.ofSetUp = between - before;
  r.ofSolve = mpiCounts() - between;
  return r;
}

// One rank and all in turns, and every rank by itself at once: what the machine allows.
void time(const Keys& keys)
{
  const Communicator world(MPI_COMM_WORLD);
  const bool first = world.rank() == 0;
  const auto edge = static_cast<std::int64_t>(number(keys, "edge", 200));
  const int pairs = static_cast<int>(number(keys, "pairs", 5));
  auto table = tableOf(keys, bench, "time",
    "kind,nodes,all_nodes,ranks,pair,load,one_set_up,one_solve,one_work,one_cycles,all_set_up,all_solve,all_work,"
    "all_cycles,apart_set_up,apart_solve,weak_set_up,weak_solve,weak_work,weak_cycles,difference");
  const Tissue one(edge, { edge, edge, edge });
  const Tissue wide(edge, cubes(edge, world.size()));
  for (const Kind& kind : kindsOf(keys))
    for (int i = 0; i < pairs; ++i)
    {
      const double load = loadNow();
      Run alone;
      waitForAll();
      if (first)
        alone = run(one, kind, MPI_COMM_SELF);
      waitForAll();
      const Run all = run(one, kind, MPI_COMM_WORLD);
      waitForAll();
      const Run apart = run(one, kind, MPI_COMM_SELF);
      waitForAll();
      const Run weak = run(wide, kind, MPI_COMM_WORLD);
      if (table)
        table->line(kind.name, one.lattice.count(), wide.lattice.count(), world.size(), i, load, alone.setUp,
          alone.solve, alone.ofSolve.work, alone.result.iterations, all.setUp, all.solve, all.ofSolve.work,
          all.result.iterations, apart.setUp, apart.solve, weak.setUp, weak.solve, weak.ofSolve.work,
          weak.result.iterations, std::abs(all.result.effective[0] / alone.result.effective[0] - 1));
    }
}

const std::string columns = "kind,scaling,nx,ny,nz,ranks,py,pz,cycles,value,solver_bytes,peak_bytes,set_up,solve," +
  countColumns("s_") + "," + countColumns("");

// A line: set-up (s_…) and solve, means over the ranks and, where it says so, the most of one.
void tell(std::optional<Table>& table, const char* scaling, const Tissue& tissue, const Kind& kind, const Run& r)
{
  const Communicator world(MPI_COMM_WORLD);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double peak = world.sum(1024.0 * static_cast<double>(usage.ru_maxrss)) / world.size();
  const std::string ofSetUp = countValues(r.ofSetUp);
  const std::string ofSolve = countValues(r.ofSolve);
  const Decomposition parts(tissue.lattice, world);
  const auto& size = tissue.lattice.size;
  if (table)
    table->line(kind.name, scaling, size[0], size[1], size[2], world.size(), parts.parts()[1], parts.parts()[2],
      r.result.iterations, fmt::format("{:.12f}", r.result.effective[0]), r.result.bytes, peak, r.setUp, r.solve,
      ofSetUp, ofSolve);
}

void counts(const Keys& keys)
{
  const Communicator world(MPI_COMM_WORLD);
  auto table = tableOf(keys, bench, fmt::format("counts-{}", world.size()), columns);
  const auto strong = static_cast<std::int64_t>(number(keys, "strong", 128));
  const auto weak = static_cast<std::int64_t>(number(keys, "weak", 48));
  const Tissue whole(strong, { strong, strong, strong });
  const Tissue parts(weak, cubes(weak, world.size()));
  for (const Kind& kind : kindsOf(keys))
  {
    tell(table, "strong", whole, kind, run(whole, kind, MPI_COMM_WORLD));
    tell(table, "weak", parts, kind, run(parts, kind, MPI_COMM_WORLD));
  }
}

// One solve of one kind, for its peak.
void memory(const Keys& keys)
{
  const Communicator world(MPI_COMM_WORLD);
  const auto edge = static_cast<std::int64_t>(number(keys, "edge", 200));
  const auto kinds = kindsOf(keys);
  if (kinds.size() != 1)
    throw ParameterError(fmt::format("memory of {} kinds in one process", kinds.size()), "give kinds= one");
  auto table = tableOf(keys, bench, fmt::format("memory-{}-{}-{}", kinds.front().name, edge, world.size()), columns);
  const Tissue tissue(std::min<std::int64_t>(edge, 200), { edge, edge, edge });
  tell(table, "memory", tissue, kinds.front(), run(tissue, kinds.front(), MPI_COMM_WORLD));
}

int startAll(const Keys& keys, const char* program)
{
  const StudyStarter start(keys, program);
  bool good = start(2, "machine") && start(2, "time");
  for (const double edge : list(keys, "memory", 200))
    for (const Kind& kind : kindsOf(keys))
      for (const int ranks : { 1, 2 })
        good = good && start(ranks, "memory", { { "edge", fmt::format("{}", edge) }, { "kinds", kind.name } });
  for (const int ranks : { 1, 2, 3, 4, 8, 16, 32, 64 })
    good = good && (ranks > number(keys, "most", 64) || start(ranks, "counts"));
  return good ? 0 : 1;
}

} // namespace

int main(int argc, char** argv)
{
  if (!onRanks())
    return startAll(keysOf(argc, argv), argv[0]);
  return runWith(argc, argv,
    [](const Keys& keys)
    {
      runStudies(keys,
        { { "machine", [&] { measureMachine(keys, bench); } }, { "time", [&] { time(keys); } },
          { "memory", [&] { memory(keys); } }, { "counts", [&] { counts(keys); } } });
    });
}
