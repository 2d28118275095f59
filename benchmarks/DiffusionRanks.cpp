// Steady diffusion on several ranks: wall time of set-up and solve on all ranks over that on one, taken in turns in one
// run; and what the machine itself allows: every rank doing the whole job by itself, at once, over as many in turn.
// Starts itself under mpirun on two ranks unless it already runs there; arguments: nodes an edge, pairs of runs.
#include "Ranks.h"
#include "Timing.h"

#include "generators/Generators.h"
#include "lbm/DiffusionStudy.h"
#include "lbm/SteadyDiffusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include <mpi.h>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

double seconds(const PhaseImage& image, const std::vector<double>& d, MPI_Comm comm, double& effective)
{
  const Block block = decompose(image.lattice, comm);
  const auto phase = lbm::blockOf(image, block);
  lbm::SteadyOptions options;
  options.stencil = lbm::Stencil::D3Q7;
  options.fieldTolerance = std::numeric_limits<double>::infinity();
  const double start = MPI_Wtime();
  lbm::SteadyDiffusion solver(image.lattice, block, phase, d, options, comm);
  effective = solver.solve(0).effective[0];
  return MPI_Wtime() - start;
}

void compare(const char* label, const PhaseImage& image, const std::vector<double>& d, int pairs)
{
  int rank = 0;
  int ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  std::vector<double> one;
  std::vector<double> all;
  std::vector<double> ratio;
  std::vector<double> machine;
  double valueOfOne = 0;
  double valueOfAll = 0;
  for (int i = 0; i < pairs; ++i)
  {
    waitForAll();
    if (rank == 0)
      one.push_back(seconds(image, d, MPI_COMM_SELF, valueOfOne));
    waitForAll();
    all.push_back(seconds(image, d, MPI_COMM_WORLD, valueOfAll));
    waitForAll();
    double slowest = seconds(image, d, MPI_COMM_SELF, valueOfOne);
    MPI_Allreduce(MPI_IN_PLACE, &slowest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    if (rank == 0)
    {
      ratio.push_back(all.back() / one.back());
      machine.push_back(slowest / (ranks * one.back()));
    }
  }
  if (rank == 0)
    fmt::print(
      "{:<7} 1 rank {:.3f} s, {} ranks {:.3f} s, ratio of each pair: median {:.3f}, {:.3f} to {:.3f}; without exchange "
      "{:.3f}; values differ by {:.0e}\n",
      label, median(one), ranks, median(all), median(ratio), *std::min_element(ratio.begin(), ratio.end()),
      *std::max_element(ratio.begin(), ratio.end()), median(machine), std::abs(valueOfAll / valueOfOne - 1));
}

} // namespace

int main(int argc, char** argv)
{
  if (!onRanks(argc, argv))
    return 1;
  return told(
    [&]
    {
      MPI_Init(&argc, &argv);
      const long edge = argc > 1 ? std::atol(argv[1]) : 200;
      const int pairs = argc > 2 ? std::atoi(argv[2]) : 9;
      generators::SoftwoodOptions o;
      o.dimension = 3;
      o.size = { edge, edge, edge };
      o.solidFraction = 0.40;
      o.seed = 1;
      const PhaseImage image = generators::softwood(o);
      int rank = 0;
      MPI_Comm_rank(MPI_COMM_WORLD, &rank);
      if (rank == 0)
        fmt::print("softwood {}^3, solid fraction 0.40, seed 1, along x, {} pairs; wall time\n", edge, pairs);
      compare("heat", image, { 0.023, 1 }, pairs);
      compare("vapour", image, { 1, 0.004 }, pairs);
      MPI_Finalize();
    });
}
