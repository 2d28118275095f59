// Explicit steps of material points on several ranks: point updates a second of wall time on one rank, on all, and on
// one with as many threads, taken in turns in one run; and what the machine itself allows: every rank moving the whole
// body by itself, at once. Starts itself under mpirun on two ranks unless it already runs there.
//   cells=224   of the block, along an edge
//   pairs=9     runs of each
//   steps=20    in a run
#include "Keys.h"
#include "MaterialPointBlock.h"
#include "Ranks.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::mpm;

/// @return seconds of the slowest rank, on rank 0
template <int Dim>
double seconds(PointDynamics<Dim>& body, int steps)
{
  const double start = MPI_Wtime();
  body.advance(steps);
  return MPI_Wtime() - start;
}

template <int Dim>
void compare(const char* label, int cells, int perCell, bool porous, int pairs, int steps)
{
  const Communicator world(MPI_COMM_WORLD);
  const bool first = world.rank() == 0;
  const double young = OrthotropicMaterial{}.along;
  const auto law = wood<Dim>();
  const auto own = block<Dim>(law, young, cells, perCell, porous, true);
  const auto shared = block<Dim>(law, young, cells, perCell, porous, true, world);
  own->advance(steps);
  shared->advance(steps);
  std::vector<double> one;
  std::vector<double> all;
  std::vector<double> threads;
  std::vector<double> ratio;
  std::vector<double> machine;
  for (int i = 0; i < pairs; ++i)
  {
    omp_set_num_threads(1);
    waitForAll();
    if (first)
      one.push_back(seconds(*own, steps));
    waitForAll();
    all.push_back(seconds(*shared, steps));
    waitForAll();
    const double slowest = world.max(seconds(*own, steps));
    omp_set_num_threads(world.size());
    if (first)
    {
      threads.push_back(seconds(*own, steps));
      ratio.push_back(one.back() / all.back());
      machine.push_back(world.size() * one.back() / slowest);
    }
  }
  omp_set_num_threads(1);
  if (!first)
    return;
  const double updates = static_cast<double>(own->points().count()) * steps / 1e6;
  fmt::print("{:30} {:8} {:8.1f} {:8.1f} {:8.1f} {:8.2f}  {:.2f} to {:.2f} {:9.2f}\n", label, own->points().count(),
    updates / median(one), updates / median(threads), updates / median(all), median(ratio),
    *std::min_element(ratio.begin(), ratio.end()), *std::max_element(ratio.begin(), ratio.end()), median(machine));
}

} // namespace

int main(int argc, char** argv)
{
  if (!onRanks(argc, argv, { "--bind-to", "none" })) // threads may go to every core
    return 1;
  return runWith(argc, argv,
    [](const Keys& keys)
    {
      const int cells = static_cast<int>(number(keys, "cells", 224));
      const int pairs = static_cast<int>(number(keys, "pairs", 9));
      const int steps = static_cast<int>(number(keys, "steps", 20));
      const Communicator world(MPI_COMM_WORLD);
      if (world.rank() == 0)
        fmt::print(
          "Millions of point updates a second of wall time, orthotropic law, {0} pairs of {1} steps; {2} ranks of "
          "one thread\n{3:30} {4:>8} {5:>8} {6:>8} {7:>8} {8:>8}  {9:12} {10}\n",
          pairs, steps, world.size(), "", "points", "1 rank", "threads", "ranks", "ratio", "of pairs", "no exchange");
      compare<2>("full, 4 a cell", cells, 2, false, pairs, steps);
      compare<2>("porous, 4 a cell", cells, 2, true, pairs, steps);
      compare<2>("full, 16 a cell", cells / 2, 4, false, pairs, steps);
      compare<3>("in space, full, 8 a cell", cells / 8, 2, false, pairs, std::max(1, steps / 2));
    });
}
