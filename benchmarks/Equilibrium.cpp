// Linear equilibrium of bond lattices: run time, iterations and error. Arguments: speed, solvers, accuracy, stability,
// space or scaling (under mpirun); none: all but space and scaling. Keys: nodes=LIST across the cells of accuracy
// (52,112,224), output=FOLDER for its table equilibrium-accuracy.csv (default results/bench-equilibrium), which
// benchmarks/equilibrium.py draws.
#include "peridynamics/Equilibrium.h"
#include "BreakableSamples.h"
#include "Table.h"

#include "core/Clock.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/Loading.h"
#include "peridynamics/PeriodicCell.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <mpi.h>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::peridynamics;

struct Named : Sample
{
  std::string name;
};

Sample uniform(std::int64_t nx, std::int64_t ny)
{
  Sample s{ makeLattice(nx, ny, 1, 2, 1e-3), {}, {}, {} };
  s.phase.assign(static_cast<std::size_t>(nx * ny), 1);
  s.model.pairs[{ 1, 1 }].material = { .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  return s;
}

Named homogeneous(std::int64_t nx, std::int64_t ny)
{
  return { uniform(nx, ny), "homogeneous" };
}

Named grains(int dimension, std::int64_t nodes, double contrast = 4)
{
  constexpr double saturation = 0.34;
  return { cemented({ .nodes = nodes,
             .saturation = saturation,
             .grains = dimension == 3 ? 200 : 400,
             .dimension = dimension,
             .contrast = contrast }),
    fmt::format("cemented grains, S = {:.2f}", saturation) };
}

Named softwood(std::int64_t nx, std::int64_t ny)
{
  return { breakable::softwood(nx, ny, 1, 0.5e-6), "softwood" };
}

/// Holes of a hexagonal array, round or six-sided, in a cell of n × √3 n nodes (rounded to even).
Sample holes(std::int64_t n, double solid, bool round)
{
  const std::int64_t ny = 2 * std::llround(static_cast<double>(n) * std::numbers::sqrt3 / 2);
  Sample s = uniform(n, ny);
  const double w = static_cast<double>(n);
  const double h = static_cast<double>(ny);
  const double radius = round ? std::sqrt((1 - solid) * w * h / (2 * std::numbers::pi)) : std::sqrt(1 - solid) * w / 2;
  for (std::int64_t y = 0; y < ny; ++y)
    for (std::int64_t x = 0; x < n; ++x)
    {
      bool hole = false;
      for (int i = -1; i <= 2; ++i)
        for (int j = -1; j <= 2; ++j)
        {
          const double a = static_cast<double>(x) + 0.5 - (i + (j % 2 == 0 ? 0.0 : 0.5)) * w;
          const double b = static_cast<double>(y) + 0.5 - j * h / 2;
          const double c = std::abs(a) / 2 + std::abs(b) * std::numbers::sqrt3 / 2;
          hole = hole || (round ? a * a + b * b < radius * radius : std::max(std::abs(a), c) < radius);
        }
      if (hole)
        s.phase[static_cast<std::size_t>(s.lattice.index(x, y))] = 0;
    }
  return s;
}

BondLattice bondsOf(const BondModel& model, const Sample& s, const Communicator& comm)
{
  const Block block = slab(s.lattice, Stencil(s.lattice.dimension, model.horizon), comm);
  const auto axis = static_cast<std::size_t>(s.lattice.dimension - 1);
  const std::int64_t layer = s.lattice.count() / s.lattice.size[axis];
  const auto first = static_cast<std::size_t>(layer * block.start[axis]);
  const auto count = static_cast<std::size_t>(block.count());
  return BondLattice(model, s.lattice, std::span(s.phase).subspan(first, count),
    s.grain.empty() ? std::span<const std::int32_t>() : std::span<const std::int32_t>(s.grain).subspan(first, count),
    comm);
}

const char* name(EquilibriumSolver solver)
{
  return solver == EquilibriumSolver::Multigrid ? "multigrid CG"
    : solver == EquilibriumSolver::Jacobi       ? "Jacobi CG"
                                                : "dynamic relaxation";
}

/// Everything from the phases on: bonds, loading, set-up, solution. The median of the runs by wall time.
void time(const Named& s, EquilibriumSolver solver, int runs, const Communicator& comm)
{
  struct Run
  {
    double wall, cpu;
    EquilibriumResult result;
    double bytes;
    double reaction;
  };
  std::vector<Run> all;
  for (int i = 0; i < runs; ++i)
  {
    const auto startWall = Clock::now();
    const double startCpu = cpu();
    const BondLattice bonds = bondsOf(s.model, s, comm);
    LoadedSample loaded = applyLoading(bonds, {});
    EquilibriumOptions o;
    o.solver = solver;
    o.maxIterations = 200000;
    Equilibrium equilibrium(bonds, std::move(loaded.fixed), o);
    const EquilibriumResult r = equilibrium.solve(loaded.displacement);
    const double endWall = secondsSince(startWall);
    const double endCpu = cpu() - startCpu;
    all.push_back(
      { endWall, endCpu, r, static_cast<double>(r.bytes + bonds.bytes()) / static_cast<double>(bonds.layout().owned()),
        std::abs(reactions(bonds, loaded, loaded.displacement, -1, false)
                   .low[static_cast<std::size_t>(s.lattice.dimension - 1)]) });
  }
  std::sort(all.begin(), all.end(), [](const Run& a, const Run& b) { return a.wall < b.wall; });
  const Run& m = all[all.size() / 2];
  if (comm.rank() == 0)
    fmt::print("{:<26} {:>16} {:<18} {:6d} iterations {:6d} products {:7.2f} s wall {:7.2f} s CPU {:6.0f} B/node\n",
      s.name,
      fmt::format("{} x {}{}", s.lattice.size[0], s.lattice.size[1],
        s.lattice.dimension == 3 ? fmt::format(" x {}", s.lattice.size[2]) : ""),
      name(solver), m.result.iterations, m.result.products, m.wall, m.cpu, m.bytes);
  std::fflush(stdout);
}

void speed(const Communicator& comm)
{
  fmt::print("\nBonds, loading, set-up and solution to 1e-6, horizon 3, all threads; median of 3\n");
  for (const std::int64_t n : { 256, 512, 1024 })
    for (const Named& s : { homogeneous(n, 2 * n), grains(2, n), softwood(n, 2 * n) })
      time(s, EquilibriumSolver::Multigrid, 3, comm);
}

void solvers(const Communicator& comm)
{
  fmt::print("\nThe same by other solvers, one run\n");
  for (const Named& s : { homogeneous(256, 512), grains(2, 256), softwood(256, 512) })
    for (const EquilibriumSolver solver :
      { EquilibriumSolver::Multigrid, EquilibriumSolver::Jacobi, EquilibriumSolver::DynamicRelaxation })
      time(s, solver, 1, comm);
}

void accuracy(const Keys& keys, const Communicator& comm)
{
  Table table(keys, "equilibrium", "accuracy",
    "cell,solid,horizon,micromodulus,surface_correction,nodes,modulus,exact,error,cpu_seconds");
  std::vector<double> sizes = list(keys, "nodes", 0);
  if (!keys.contains("nodes"))
    sizes = { 52, 112, 224 };
  fmt::print("\nYoung's modulus of periodic cells over that of the solid, and its error against finite elements\n");
  struct Case
  {
    bool round;
    double solid;
    double exact;
  };
  for (const Case& c : { Case{ true, 0.8, 0.56963 }, Case{ true, 0.6, 0.31338 }, Case{ false, 0.36, 0.075005 },
         Case{ false, 0.64, 0.326779 } })
    for (const double horizon : { 2.0, 3.0, 4.0, 5.0 })
      for (const int form : { 0, 1, 2, 3 }) // continuum, lattice; each with surface correction
      {
        fmt::print("{:<11} solid {:.2f} horizon {:.0f} micromodulus {:<9} {:<20}",
          c.round ? "round holes" : "honeycomb", c.solid, horizon, form % 2 == 0 ? "continuum" : "lattice",
          form < 2 ? "" : "surface correction");
        for (const double across : sizes)
        {
          const auto n = static_cast<std::int64_t>(across);
          const Sample s = holes(n, c.solid, c.round);
          BondModel m = s.model;
          m.horizon = horizon;
          m.periodic = { true, true, false };
          m.micromodulus = form % 2 == 0 ? Micromodulus::Continuum : Micromodulus::Lattice;
          m.surfaceCorrection = form >= 2;
          const double start = cpu();
          const EffectiveStiffness e = effectiveStiffness(bondsOf(m, s, comm));
          const double value = (e.constants.youngsModulus[0] + e.constants.youngsModulus[1]) / 2e9;
          const double seconds = cpu() - start;
          fmt::print("  n {:3d}: {:.5f} ({:+5.1f} %, {:.2f} s)", n, value, 100 * (value / c.exact - 1), seconds);
          table.line(c.round ? "holes" : "honeycomb", c.solid, horizon, form % 2 == 0 ? "continuum" : "lattice",
            form < 2 ? "no" : "yes", n, value, c.exact, value / c.exact - 1, seconds);
        }
        fmt::print("\n");
        std::fflush(stdout);
      }
}

void stability(const Communicator& comm)
{
  fmt::print("\nContrast, porosity, thin walls: iterations to 1e-6\n");
  const auto run = [&](const Named& s)
  {
    try
    {
      time(s, EquilibriumSolver::Multigrid, 1, comm);
    }
    catch (const Error& e)
    {
      fmt::print("{:<26} {}\n", s.name, e.what());
    }
  };
  for (const double contrast : { 1.0, 10.0, 100.0, 1e3, 1e4 })
  {
    Named s = grains(2, 256, contrast);
    s.name = fmt::format("contrast {:g}", contrast);
    run(s);
  }
  for (const double voids : { 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9 })
  {
    Named s = homogeneous(256, 512);
    s.name = fmt::format("single voids, {:.0f} %", 100 * voids);
    std::mt19937 random(1);
    for (std::uint8_t& p : s.phase)
      p = static_cast<double>(random()) < voids * 4294967296.0 ? 0 : 1;
    run(s);
  }
  for (const int thick : { 1, 2, 3, 5, 8 })
  {
    Named s = homogeneous(256, 512);
    s.name = fmt::format("square cells, wall {}", thick);
    for (std::int64_t y = 0; y < 512; ++y)
      for (std::int64_t x = 0; x < 256; ++x)
        if (x % 32 >= thick && y % 32 >= thick && y > 3 && y < 508)
          s.phase[static_cast<std::size_t>(s.lattice.index(x, y))] = 0;
    run(s);
  }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(
    argc, argv,
    [](const Keys& keys)
    {
      const Communicator comm(MPI_COMM_WORLD);
      const bool any = std::any_of(
        keys.begin(), keys.end(), [](const auto& key) { return key.second == "1" && key.first != "nodes"; });
      const auto wanted = [&](const char* word, bool always) { return (!any && always) || keys.contains(word); };
      if (wanted("speed", true))
        speed(comm);
      if (wanted("solvers", true))
        solvers(comm);
      if (wanted("accuracy", true))
        accuracy(keys, comm);
      if (wanted("stability", true))
        stability(comm);
      if (wanted("space", false))
        time(grains(3, 128), EquilibriumSolver::Multigrid, 1, comm);
      if (wanted("scaling", false))
        for (const Named& s : { homogeneous(512, 1024), grains(2, 512), softwood(512, 1024) })
          time(s, EquilibriumSolver::Multigrid, 3, comm);
    });
}
