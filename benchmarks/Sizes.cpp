// Numbers of nodes along a periodic cell: processor time a node of diffusion and of bonds, for sides that can be halved
// often, seldom or never. The cell is the same for all: two phases divided by a sum of waves.
//   sizes [study=diffusion|bonds|bonds-3d] [sizes=40,41,…] [contrast=10] [horizon=3] [output=FOLDER]
#include "Keys.h"
#include "Table.h"

#include "lbm/SteadyDiffusion.h"
#include "peridynamics/PeriodicCell.h"
#include "peridynamics/StiffnessStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

std::vector<std::uint8_t> phasesOf(const Lattice& l)
{
  std::vector<std::uint8_t> phase;
  const auto turn = [&](std::int64_t i, std::size_t a)
  { return 2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(l.size[a]); };
  for (std::int64_t k = 0; k < l.size[2]; ++k)
    for (std::int64_t j = 0; j < l.size[1]; ++j)
      for (std::int64_t i = 0; i < l.size[0]; ++i)
      {
        const double x = turn(i, 0);
        const double y = turn(j, 1);
        const double z = l.dimension == 3 ? turn(k, 2) : 0;
        const double wave = std::sin(x + 2 * y) + std::sin(y - z + 1) + std::sin(2 * x + y + z + 2);
        phase.push_back(wave < 0.3 ? 1 : 2);
      }
  return phase;
}

/// Every size once, and how far the worst is from the median.
template <class F>
void each(const std::vector<double>& sizes, F&& cost)
{
  std::vector<double> all;
  for (const double size : sizes)
    all.push_back(cost(static_cast<std::int64_t>(size)));
  const double worst = all.empty() ? 0 : *std::max_element(all.begin(), all.end());
  fmt::print("  worst over median: {:.2f}\n", worst / median(all));
}

std::vector<double> sizesOf(const Keys& keys, std::int64_t first, std::int64_t last, std::int64_t step)
{
  if (keys.contains("sizes"))
    return list(keys, "sizes", 0);
  std::vector<double> sizes;
  for (std::int64_t n = first; n <= last; n += step)
    sizes.push_back(static_cast<double>(n));
  return sizes;
}

void diffusion(const Keys& keys)
{
  Table table(
    keys, "sizes", "diffusion", "nodes_a_side,iterations,setup_seconds,solve_seconds,cpu_microseconds_a_node");
  const double contrast = number(keys, "contrast", 10);
  fmt::print("diffusion, periodic volumes, contrast {:g}\n", contrast);
  each(sizesOf(keys, 40, 200, 8),
    [&](std::int64_t n)
    {
      const Lattice l = makeLattice(n, n, n, 3, 1e-6);
      const std::vector<std::uint8_t> phase = phasesOf(l);
      lbm::SteadyOptions o;
      o.stencil = lbm::Stencil::D3Q7;
      o.sides = lbm::Sides::Periodic;
      o.threads = 1;
      const std::vector<double> d{ 1, 1, contrast };
      const double start = cpu();
      lbm::SteadyDiffusion solver(l, { { 0, 0, 0 }, l.size }, phase, d, o, MPI_COMM_SELF);
      const lbm::SteadyResult r = solver.solve(0);
      const double perNode = 1e6 * (cpu() - start) / static_cast<double>(l.count());
      fmt::print("  {:>4}³  {:>3} iterations  set-up {:.3f} s  solve {:.3f} s  {:.3f} µs a node\n", n, r.iterations,
        r.setupSeconds, r.solveSeconds, perNode);
      table.line(n, r.iterations, r.setupSeconds, r.solveSeconds, perNode);
      return perNode;
    });
}

void bonds(const Keys& keys, int dimension)
{
  using namespace lamella::peridynamics;
  Table table(keys, "sizes", dimension == 3 ? "bonds-3d" : "bonds", "nodes_a_side,iterations,cpu_microseconds_a_node");
  BondModel m;
  m.continuum = dimension == 3 ? Continuum::Space : Continuum::PlaneStress;
  m.horizon = number(keys, "horizon", 3);
  const double contrast = number(keys, "contrast", 10);
  m.pairs[{ 1, 1 }].material.youngsModulus = 1;
  m.pairs[{ 2, 2 }].material.youngsModulus = contrast;
  m.pairs[{ 1, 2 }].material.youngsModulus = 2 * contrast / (1 + contrast);
  fmt::print("bonds, {}, horizon {:g}, contrast {:g}\n", dimension == 3 ? "volumes" : "pictures", m.horizon, contrast);
  each(dimension == 3 ? sizesOf(keys, 20, 60, 4) : sizesOf(keys, 496, 520, 1),
    [&](std::int64_t n)
    {
      const Lattice l = makeLattice(n, n, dimension == 3 ? n : 1, dimension, 1e-6);
      const std::vector<std::uint8_t> phase = phasesOf(l);
      StiffnessOptions o;
      o.estimateError = false;
      o.threads = 1;
      const double start = cpu();
      const StiffnessResult r = studyStiffness(m, l, phase, {}, o, Communicator(MPI_COMM_SELF));
      const double perNode = 1e6 * (cpu() - start) / static_cast<double>(l.count());
      const auto& each = r.steps.front().iterations;
      const std::int64_t iterations = std::accumulate(each.begin(), each.end(), std::int64_t{ 0 });
      fmt::print("  {:>4}  {:>4} iterations of all strains  {:.2f} µs a node\n", n, iterations, perNode);
      table.line(n, iterations, perNode);
      return perNode;
    });
}

} // namespace

int main(int argc, char** argv)
{
  return runStudies(argc, argv,
    { { "diffusion", diffusion }, { "bonds", [](const Keys& keys) { bonds(keys, 2); } },
      { "bonds-3d", [](const Keys& keys) { bonds(keys, 3); } } });
}
