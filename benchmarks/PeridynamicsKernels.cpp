// Bonds a second: our sums over implicit bonds, a straightforward loop over a neighbour list, and LAMMPS PERI where the
// program `lmp` is on the machine, all on the same lattices in the same run. Directed bonds, twice the number of bonds;
// user CPU, median of seven. Under mpirun in wall-clock time: one rank while the others sleep, all ranks on one
// lattice, and, for what the machine allows, each rank on a whole lattice of its own at the same time.
#include "Ranks.h"
#include "Timing.h"

#include "core/Clock.h"
#include "core/Communicator.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/kernels/RowKernels.h"

#include <fmt/format.h>
#include <mpi.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <unistd.h>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::peridynamics;

/// Seconds of one call.
template <class F>
double measure(F&& f, bool wall, int repeats)
{
  std::vector<double> times;
  f();
  for (int k = 0; k < 7; ++k)
  {
    const auto from = Clock::now();
    const double start = userSeconds();
    for (int r = 0; r < repeats; ++r)
      f();
    times.push_back((wall ? secondsSince(from) : userSeconds() - start) / repeats);
  }
  return median(times);
}

struct Scene
{
  const char* name;
  Lattice lattice;
  int phases;
  double voids;
  bool correction = false;
};

struct Sample
{
  BondModel model;
  std::vector<std::uint8_t> phase;
};

Sample sampleOf(const Scene& scene)
{
  Sample s;
  s.model.continuum = scene.lattice.dimension == 3 ? Continuum::Space : Continuum::PlaneStress;
  s.model.horizon = 3.015;
  s.model.surfaceCorrection = scene.correction;
  for (int a = 1; a <= scene.phases; ++a)
    for (int b = a; b <= scene.phases; ++b)
      s.model.pairs[{ static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b) }] = { BondMaterial{
        .youngsModulus = 1e9 * (a + b), .criticalStretch = 0.01 } };
  // blocks of 16 nodes of one phase each, so that voids and interfaces are as in a coarse picture
  std::mt19937 random(1);
  const auto& n = scene.lattice.size;
  const auto blocks = [](std::int64_t k) { return (k + 15) / 16; };
  std::vector<std::uint8_t> of(static_cast<std::size_t>(blocks(n[0]) * blocks(n[1]) * blocks(n[2])));
  for (auto& p : of)
    p = random() < scene.voids * 4294967296.0
      ? std::uint8_t{ 0 }
      : static_cast<std::uint8_t>(1 + random() % static_cast<unsigned>(scene.phases));
  for (std::int64_t z = 0; z < n[2]; ++z)
    for (std::int64_t y = 0; y < n[1]; ++y)
      for (std::int64_t x = 0; x < n[0]; ++x)
        s.phase.push_back(of[static_cast<std::size_t>((z / 16 * blocks(n[1]) + y / 16) * blocks(n[0]) + x / 16)]);
  return s;
}

template <class Real>
NodeField<Real> displaced(const BondLattice& bonds)
{
  NodeField<Real> u(bonds.layout());
  const NodeLayout& l = bonds.layout();
  std::mt19937 random(2);
  for (int c = 0; c < l.dimension; ++c)
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
          u.at(c, x, y, z) = static_cast<Real>(1e-3 * bonds.spacing() * (random() / 4294967296.0 - 0.5));
  bonds.exchange(u);
  return u;
}

template <class Real>
std::array<double, 2> ours(const BondLattice& bonds, bool wall, int repeats)
{
  NodeField<Real> u = displaced<Real>(bonds);
  NodeField<Real> f(bonds.layout());
  const double directed = 2 * static_cast<double>(bonds.bonds());
  const auto sum = [&](bool nonlinear)
  {
    // with several ranks the exchange belongs to it
    nonlinear ? (void)exchangeAndNonlinearForce(bonds, u, f) : exchangeAndLinearForce(bonds, u, f);
  };
  return { directed / measure([&] { sum(false); }, wall, repeats) / 1e6,
    directed / measure([&] { sum(true); }, wall, repeats) / 1e6 };
}

BondLattice share(const Scene& scene, const Sample& sample, const Communicator& comm)
{
  const Block block = slab(scene.lattice, Stencil(scene.lattice.dimension, 3.015), comm);
  const std::size_t axis = scene.lattice.dimension == 3 ? 2 : 1;
  const std::int64_t layer = scene.lattice.count() / scene.lattice.size[axis];
  const auto part =
    std::span(sample.phase)
      .subspan(static_cast<std::size_t>(layer * block.start[axis]), static_cast<std::size_t>(block.count()));
  return BondLattice(sample.model, scene.lattice, part, {}, comm);
}

void compareRanks(const Scene& scene, int repeats)
{
  const Sample sample = sampleOf(scene);
  const Communicator world(MPI_COMM_WORLD);
  const Communicator self(MPI_COMM_SELF);
  const BondLattice whole = share(scene, sample, self);
  const BondLattice part = share(scene, sample, world);
  std::array<std::vector<double>, 2> shared;
  std::array<std::vector<double>, 2> apart;
  std::array<double, 2> rate{};
  for (int turn = 0; turn < 9; ++turn)
  {
    waitForAll();
    std::array<double, 2> one{};
    if (world.rank() == 0)
      one = ours<double>(whole, true, repeats);
    waitForAll();
    const auto all = ours<double>(part, true, repeats);
    waitForAll();
    auto each = ours<double>(whole, true, repeats);
    world.sum(each);
    for (std::size_t k = 0; k < 2; ++k)
    {
      shared[k].push_back(all[k] / one[k]);
      apart[k].push_back(each[k] / one[k]);
      rate[k] = std::max(rate[k], all[k]);
    }
  }
  if (world.rank() != 0)
    return;
  for (auto* list : { &shared, &apart })
    for (auto& ratios : *list)
      std::sort(ratios.begin(), ratios.end());
  fmt::print("{:<40} linear {:5.0f}, {:.2f} times one rank (whole lattices at once {:.2f}); nonlinear {:5.0f}, {:.2f} "
             "({:.2f})\n",
    scene.name, rate[0], shared[0][4], apart[0][4], rate[1], shared[1][4], apart[1][4]);
}

/// What one writes first: for each node, over the list of its neighbours, in double precision.
std::array<double, 2> neighbourList(const BondLattice& bonds, int repeats)
{
  const NodeLayout& l = bonds.layout();
  const int d = l.dimension;
  struct Neighbour
  {
    int to;
    float length; // in spacings
    double k;
    double critical;
  };
  std::vector<std::int64_t> begin{ 0 };
  std::vector<std::array<double, 3>> x(static_cast<std::size_t>(l.owned()));
  std::vector<std::array<double, 3>> u(x.size());
  std::vector<std::array<double, 3>> f(x.size());
  std::vector<Neighbour> list;
  const auto number = [&](std::int64_t index)
  {
    const auto n = l.node(index);
    return static_cast<std::size_t>((n[2] * l.size[1] + n[1]) * l.size[0] + n[0]);
  };
  std::mt19937 random(2);
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t at = 0; at < l.size[0]; ++at)
      {
        const std::int64_t i = l.index(at, y, z);
        const auto n = number(i);
        x[n] = { static_cast<double>(at), static_cast<double>(y), static_cast<double>(z) };
        for (int c = 0; c < d; ++c)
          u[n][static_cast<std::size_t>(c)] = 1e-3 * (random() / 4294967296.0 - 0.5);
        for (int o = 0; o < static_cast<int>(bonds.stencil().half().size()); ++o)
          for (const std::int64_t jump : { bonds.jump(o), -bonds.jump(o) })
            if (const int kind = bonds.kind(jump > 0 ? i : i + jump, o); kind != 0)
              list.push_back({ static_cast<int>(number(i + jump)),
                static_cast<float>(bonds.stencil().half()[static_cast<std::size_t>(o)].length),
                bonds.kinds()[static_cast<std::size_t>(kind)].stiffness,
                bonds.kinds()[static_cast<std::size_t>(kind)].criticalStretch });
        begin.push_back(static_cast<std::int64_t>(list.size()));
      }
  std::int64_t critical = 0;
  const auto sum = [&](bool nonlinear)
  {
    for (std::size_t i = 0; i < x.size(); ++i)
    {
      std::array<double, 3> total{};
      for (auto b = static_cast<std::size_t>(begin[i]); b < static_cast<std::size_t>(begin[i + 1]); ++b)
      {
        const Neighbour& n = list[b];
        const auto j = static_cast<std::size_t>(n.to);
        std::array<double, 3> zeta{};
        double square = 0;
        double along = 0;
        for (std::size_t c = 0; c < static_cast<std::size_t>(d); ++c)
        {
          const double xi = x[j][c] - x[i][c];
          const double eta = u[j][c] - u[i][c];
          zeta[c] = nonlinear ? xi + eta : xi;
          square += zeta[c] * zeta[c];
          along += xi * eta;
        }
        const double length = n.length;
        const double norm = nonlinear ? std::sqrt(square) : length;
        const double s = nonlinear ? (norm - length) / length : along / square;
        if (nonlinear && s > n.critical)
          ++critical;
        for (std::size_t c = 0; c < static_cast<std::size_t>(d); ++c)
          total[c] += n.k * s / norm * zeta[c];
      }
      f[i] = total;
    }
  };
  const double directed = static_cast<double>(list.size());
  const std::array<double, 2> result{ directed / measure([&] { sum(false); }, false, repeats) / 1e6,
    directed / measure([&] { sum(true); }, false, repeats) / 1e6 };
  if (critical != 0)
    fmt::print(stderr, "the neighbour list has {} critical bonds\n", critical);
  return result;
}

/// LAMMPS on a full lattice: directed bonds over the seconds that it reports for its pair forces; 0 without it.
double lammps(const Lattice& lattice, std::int64_t bonds, int steps)
{
  if (std::system("command -v lmp > /dev/null 2>&1") != 0)
    return 0;
  const std::filesystem::path folder =
    std::filesystem::temp_directory_path() / fmt::format("lamella-bench-{}", ::getpid());
  std::filesystem::create_directories(folder);
  {
    std::ofstream in(folder / "in");
    in << fmt::format(R"(units si
boundary f f f
atom_style peri
atom_modify map array
neighbor 0.0003 bin
lattice sc 0.001
region box block -5 {} -5 {} -5 {} units lattice
create_box 1 box
region full block -0.25 {} -0.25 {} -0.25 {} units lattice
create_atoms 1 region full
pair_style peri/pmb
pair_coeff * * 1.6863e22 0.003015 0.1 0.25
set group all density 2200
set group all volume 1e-9
velocity all create 1e-20 1 dist uniform
fix 1 all nve
timestep 1e-7
thermo {}
run {}
)",
      lattice.size[0] + 5, lattice.size[1] + 5, lattice.size[2] + 5, static_cast<double>(lattice.size[0]) - 0.75,
      static_cast<double>(lattice.size[1]) - 0.75, static_cast<double>(lattice.size[2]) - 0.75, steps, steps);
  }
  const std::string command =
    fmt::format("cd {} && OMP_NUM_THREADS=1 lmp -in in -log log -screen none > out 2>&1", folder.string());
  double rate = 0;
  if (std::system(command.c_str()) == 0)
  {
    std::ifstream log(folder / "log");
    for (std::string line; std::getline(log, line);)
      if (line.rfind("Pair", 0) == 0 && line.find('|') != std::string::npos)
      {
        double seconds = 0;
        std::istringstream(line.substr(line.find('|') + 1)) >> seconds;
        if (seconds > 0)
          rate = 2 * static_cast<double>(bonds) * steps / seconds / 1e6;
      }
  }
  std::filesystem::remove_all(folder);
  return rate;
}

std::string rateText(double rate)
{
  return rate > 0 ? fmt::format("{:8.1f}", rate) : std::string("       -");
}

} // namespace

int main(int argc, char** argv)
{
  const bool quick = argc > 1 && std::string(argv[1]) == "--quick";
  MPI_Init(&argc, &argv);
  {
    const Communicator comm(MPI_COMM_WORLD);
    const bool first = comm.rank() == 0;
    const bool several = comm.size() > 1;
    const auto side = [&](std::int64_t n) { return quick ? n / 2 : n; };
    const std::vector<Scene> scenes{
      { "256 x 512, one kind", makeLattice(side(256), side(512), 1, 2, 1e-3), 1, 0 },
      { "256 x 512, three kinds, a third void", makeLattice(side(256), side(512), 1, 2, 1e-3), 2, 0.33 },
      { "256 x 512, surface corrected", makeLattice(side(256), side(512), 1, 2, 1e-3), 1, 0, true },
      { "50 x 50 x 50, one kind", makeLattice(side(50), side(50), side(50), 3, 1e-3), 1, 0 },
      { "50 x 50 x 50, three kinds, a third void", makeLattice(side(50), side(50), side(50), 3, 1e-3), 2, 0.33 },
    };
    if (first)
      fmt::print("Horizon 3.015 spacings, nonlinear with the check of s0; {} rank(s), {} thread(s) each; kernels {}\n"
                 "millions of directed bonds a second                       linear  nonlinear\n",
        comm.size(), several ? 1 : omp_get_max_threads(), rowKernels().name);
    if (several)
      omp_set_num_threads(1);
    for (const Scene& scene : scenes)
    {
      const int repeats = scene.lattice.dimension == 3 ? 3 : 20;
      if (several)
      {
        compareRanks(scene, repeats);
        continue;
      }
      const Sample sample = sampleOf(scene);
      const BondLattice bonds = share(scene, sample, comm);
      // user CPU of all threads is no measure of several
      const bool wall = omp_get_max_threads() > 1;
      const auto inDouble = ours<double>(bonds, wall, repeats);
      const auto inSingle = ours<float>(bonds, wall, repeats);
      const StripCounts strips = bonds.strips();
      fmt::print("{}: {} bonds, {:.0f} bytes a node; strips {} empty, {} uniform, {} mixed\n", scene.name,
        bonds.bonds(), static_cast<double>(bonds.bytes()) / static_cast<double>(bonds.layout().owned()), strips.empty,
        strips.uniform, strips.mixed);
      fmt::print(
        "  double                                                {:8.1f}   {:8.1f}\n", inDouble[0], inDouble[1]);
      fmt::print(
        "  float                                                 {:8.1f}   {:8.1f}\n", inSingle[0], inSingle[1]);
      if (scene.correction)
        continue;
      const auto list = neighbourList(bonds, quick ? 1 : 2);
      fmt::print("  neighbour list, one thread                            {:8.1f}   {:8.1f}\n", list[0], list[1]);
      if (scene.phases == 1)
        fmt::print("  LAMMPS PERI, one core                                        -   {}\n",
          rateText(lammps(scene.lattice, bonds.bonds(), scene.lattice.dimension == 3 ? 20 : 60)));
    }
  }
  MPI_Finalize();
  return 0;
}
