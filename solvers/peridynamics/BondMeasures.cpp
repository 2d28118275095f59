// What is asked for now and then: stress, energy, the most stretched bond, sections, diagonal blocks, tangents. One
// bond of the stencil and one row of nodes at a time, with the springs of the row written out first; plain loops.
#include "core/Passes.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/BondRows.h"
#include "peridynamics/RimExchange.h"
#include "peridynamics/RowJobs.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

double inOrder(const std::vector<double>& parts)
{
  double sum = 0;
  for (const double p : parts)
    sum += p;
  return sum;
}

/// The greatest of ratios with its bond; of equal ones the first.
struct Greatest
{
  double ratio = 0;
  Bond bond{};

  void offer(double other, const Bond& at)
  {
    if (other > ratio || (other == ratio && ratio > 0 && at < bond))
    {
      ratio = other;
      bond = at;
    }
  }
};

template <class Real, int Dim, bool Nonlinear>
void greatestOfRow(const BondLattice& bonds, const NodeField<Real>& u, const BondRow<Real>& row, Greatest& greatest)
{
  BondState<Real, Dim, Nonlinear> state(bonds, u, row);
  for (std::int64_t x = row.x0; x < row.x1; ++x)
  {
    if (row.inverse[x] == 0)
      continue;
    state.at(x);
    const Real ratio = state.stretch * row.inverse[x];
    if (static_cast<double>(ratio) >= greatest.ratio && ratio > 0)
      greatest.offer(static_cast<double>(ratio), bonds.bond(row.i + x, row.offset));
  }
}

StretchMaximum overRanks(const BondLattice& bonds, const Greatest& mine)
{
  Greatest all = mine;
  const Communicator& comm = bonds.communicator();
  if (comm.parallel())
  {
    all.ratio = comm.max(mine.ratio);
    std::vector<std::int64_t> holders;
    if (mine.ratio == all.ratio && all.ratio > 0)
      holders = { mine.bond.node[0], mine.bond.node[1], mine.bond.node[2], mine.bond.offset };
    const std::vector<std::int64_t> list = gather(comm, holders, 4);
    for (std::size_t k = 0; k < list.size(); k += 4)
    {
      const Bond b{ { list[k], list[k + 1], list[k + 2] }, static_cast<int>(list[k + 3]) };
      if (k == 0 || b < all.bond)
        all.bond = b;
    }
  }
  StretchMaximum result{ all.ratio, std::nullopt };
  if (all.ratio > 0)
    result.bond = all.bond;
  return result;
}

/// By the row kernels: the energy of all bonds is asked for along with the history of a motion, every few steps.
template <class Real>
double nonlinearEnergy(const BondLattice& bonds, const NodeField<Real>& u)
{
  const NodeLayout& l = bonds.layout();
  const BondNumbers<Real> numbers(bonds);
  const std::vector<Chunk> list = chunks(bonds.stencil(), maxChunk);
  const auto& table = kernelsOf<Real>(bonds).energy[l.dimension - 2];
  constexpr std::int64_t unit = 64 / static_cast<std::int64_t>(sizeof(Real));
  const std::int64_t end = (l.size[0] + unit - 1) / unit * unit;
  std::vector<double> parts(static_cast<std::size_t>(l.size[1] * l.size[2]), 0.0);
#pragma omp parallel
  {
    RowJob<Real> job{};
    begin(job, bonds, numbers);
    AlignedArray<Real> energies(l.bufferLength());
    job.f[0] = energies.data() + NodeLayout::margin;
    RowRuns runs;
#pragma omp for schedule(dynamic, 8)
    for (std::int64_t r = 0; r < l.size[1] * l.size[2]; ++r)
    {
      const std::int64_t y = r % l.size[1];
      const std::int64_t z = r / l.size[1];
      if (!runs.find(bonds, l.row(y, z), static_cast<int>(unit)))
        continue;
      std::fill_n(job.f[0], end, Real(0));
      for (const Chunk& chunk : list)
      {
        if (!inLattice(bonds, 1, y + chunk.step[1]) || !inLattice(bonds, 2, z + chunk.step[2]))
          continue;
        aim(job, bonds, numbers, chunk, u, y, z);
        for (const Run& run : runs.push)
        {
          const std::int64_t x0 = std::max<std::int64_t>(run.begin, 0);
          const std::int64_t x1 = std::min(run.end, end);
          if (x0 < x1)
            table[follow(job, numbers, chunk, run)][bonds.corrected() ? 1 : 0](job, x0, x1);
        }
      }
      double sum = 0;
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        sum += static_cast<double>(job.f[0][x]);
      parts[static_cast<std::size_t>(r)] = sum;
    }
  }
  return bonds.communicator().sum(inOrder(parts));
}

} // namespace

template <class Real>
StretchMaximum largestStretch(const BondLattice& bonds, const NodeField<Real>& u, bool nonlinear)
{
  std::vector<Greatest> each(static_cast<std::size_t>(omp_get_max_threads()));
  choose(bonds, nonlinear,
    [&]<int Dim, bool Nonlinear>()
    {
      eachOwned<Real>(bonds,
        [&](const BondRow<Real>& row, std::int64_t)
        { greatestOfRow<Real, Dim, Nonlinear>(bonds, u, row, each[static_cast<std::size_t>(omp_get_thread_num())]); });
    });
  Greatest greatest;
  for (const Greatest& g : each)
    if (g.ratio > 0)
      greatest.offer(g.ratio, g.bond);
  return overRanks(bonds, greatest);
}

template <class Real>
StretchMaximum largestStretchWithin(const BondLattice& bonds, const NodeField<Real>& u,
  const std::array<std::int64_t, 3>& low, const std::array<std::int64_t, 3>& high)
{
  Greatest greatest;
  const NodeLayout& l = bonds.layout();
  const BondNumbers<Real> numbers(bonds);
  SpringRow<Real> springs(bonds, numbers);
  choose(bonds, false,
    [&]<int Dim, bool Nonlinear>()
    {
      for (std::int64_t z = std::max<std::int64_t>(0, low[2]); z < std::min(l.size[2], high[2]); ++z)
        for (std::int64_t y = std::max<std::int64_t>(0, low[1]); y < std::min(l.size[1], high[1]); ++y)
          for (int o = 0; o < static_cast<int>(bonds.stencil().half().size()); ++o)
            greatestOfRow<Real, Dim, Nonlinear>(bonds, u,
              springs.read(y, z, o, std::max<std::int64_t>(0, low[0]), std::min(l.size[0], high[0])), greatest);
    });
  StretchMaximum result{ greatest.ratio, std::nullopt };
  if (greatest.ratio > 0)
    result.bond = greatest.bond;
  return result;
}

template <class Real>
double elasticEnergy(const BondLattice& bonds, const NodeField<Real>& u, bool nonlinear)
{
  if (nonlinear)
    return nonlinearEnergy(bonds, u);
  std::vector<double> parts(static_cast<std::size_t>(bonds.layout().size[1] * bonds.layout().size[2]), 0.0);
  choose(bonds, false,
    [&]<int Dim, bool Nonlinear>()
    {
      eachOwned<Real>(bonds,
        [&](const BondRow<Real>& row, std::int64_t r)
        {
          BondState<Real, Dim, Nonlinear> state(bonds, u, row);
          double sum = 0;
          for (std::int64_t x = row.x0; x < row.x1; ++x)
          {
            state.at(x);
            const Real extension = state.stretch * state.length;
            sum += static_cast<double>(row.spring[x] * extension * extension);
          }
          parts[static_cast<std::size_t>(r)] += 0.5 * sum;
        });
    });
  return bonds.communicator().sum(inOrder(parts));
}

template <class Real>
void energyDensity(const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& density, bool nonlinear)
{
  countPass(Pass::EnergyDensity);
  const auto share = static_cast<Real>(0.25 / std::pow(bonds.spacing(), bonds.dimension()));
  choose(bonds, nonlinear,
    [&]<int Dim, bool Nonlinear>()
    {
      addToEnds<Real>(bonds, density, 1, Real(1),
        [&](const BondRow<Real>& row, const std::array<Real*, 6>& t)
        {
          BondState<Real, Dim, Nonlinear> state(bonds, u, row);
          for (std::int64_t x = row.x0; x < row.x1; ++x)
          {
            state.at(x);
            const Real extension = state.stretch * state.length;
            t[0][x] = share * row.spring[x] * extension * extension;
          }
        });
    });
}

template <class Real>
void nodalStress(const BondLattice& bonds, const NodeField<Real>& u, NodeField<Real>& stress, bool nonlinear)
{
  countPass(Pass::NodalStress);
  const auto share = static_cast<Real>(0.5 / std::pow(bonds.spacing(), bonds.dimension()));
  choose(bonds, nonlinear,
    [&]<int Dim, bool Nonlinear>()
    {
      addToEnds<Real>(bonds, stress, Dim == 2 ? 3 : 6, Real(1),
        [&](const BondRow<Real>& row, const std::array<Real*, 6>& t)
        {
          BondState<Real, Dim, Nonlinear> state(bonds, u, row);
          for (std::int64_t x = row.x0; x < row.x1; ++x)
          {
            state.at(x);
            const Real s = share * row.spring[x] * state.perZeta;
            for (int c = 0; c < Dim; ++c)
              t[static_cast<std::size_t>(c)][x] = s * state.zeta[c] * state.zeta[c];
            t[Dim][x] = s * state.zeta[0] * state.zeta[1];
            if constexpr (Dim == 3)
            {
              t[4][x] = s * state.zeta[1] * state.zeta[2];
              t[5][x] = s * state.zeta[0] * state.zeta[2];
            }
          }
        });
    });
}

template <class Real>
std::array<double, 3> sectionForce(
  const BondLattice& bonds, const NodeField<Real>& u, int axis, std::int64_t layer, bool nonlinear)
{
  const NodeLayout& l = bonds.layout();
  const auto a = static_cast<std::size_t>(axis);
  const std::int64_t period = bonds.periodic()[a] ? l.global[a] : 0;
  // +1 where a bond from p to p + step leads up through the plane or an image of it, −1 down, else 0
  const auto crossing = [&](std::int64_t p, std::int64_t step)
  {
    for (const std::int64_t plane : { layer, layer - period, layer + period })
    {
      if (p < plane && p + step >= plane)
        return 1;
      if (p >= plane && p + step < plane)
        return -1;
    }
    return 0;
  };
  std::array<std::vector<double>, 3> parts;
  for (auto& p : parts)
    p.assign(static_cast<std::size_t>(l.size[1] * l.size[2]), 0.0);
  choose(bonds, nonlinear,
    [&]<int Dim, bool Nonlinear>()
    {
      eachOwned<Real>(bonds,
        [&](const BondRow<Real>& row, std::int64_t r)
        {
          const std::int64_t step = bonds.stencil().half()[static_cast<std::size_t>(row.offset)].step[a];
          if (step == 0)
            return;
          BondState<Real, Dim, Nonlinear> state(bonds, u, row);
          const std::int64_t fixed = l.start[a] + (axis == 1 ? r % l.size[1] : r / l.size[1]);
          for (std::int64_t x = row.x0; x < row.x1; ++x)
          {
            const int sign = crossing(axis == 0 ? x : fixed, step);
            if (sign == 0)
              continue;
            state.at(x);
            for (int c = 0; c < Dim; ++c)
              parts[static_cast<std::size_t>(c)][static_cast<std::size_t>(r)] +=
                sign * static_cast<double>(row.spring[x] * state.perZeta * state.zeta[c]);
          }
        });
    });
  std::array<double, 3> sum{ inOrder(parts[0]), inOrder(parts[1]), inOrder(parts[2]) };
  bonds.communicator().sum(sum);
  return sum;
}

template <class Real>
std::array<double, 3> layerSum(
  const BondLattice& bonds, const NodeField<Real>& f, int axis, std::int64_t first, std::int64_t last)
{
  const NodeLayout& l = bonds.layout();
  std::array<std::int64_t, 3> low{ 0, 0, 0 };
  std::array<std::int64_t, 3> high = l.size;
  const auto a = static_cast<std::size_t>(axis);
  low[a] = std::max<std::int64_t>(0, first - l.start[a]);
  high[a] = std::min(l.size[a], last - l.start[a]);
  std::array<double, 3> sum{};
  for (int c = 0; c < f.components() && c < 3; ++c)
    for (std::int64_t z = low[2]; z < high[2]; ++z)
      for (std::int64_t y = low[1]; y < high[1]; ++y)
      {
        double row = 0;
        for (std::int64_t x = low[0]; x < high[0]; ++x)
          row += static_cast<double>(f.at(c, x, y, z));
        sum[static_cast<std::size_t>(c)] += row;
      }
  bonds.communicator().sum(sum);
  return sum;
}

template <class Real>
void diagonalBlocks(const BondLattice& bonds, NodeField<Real>& blocks)
{
  const int d = bonds.dimension();
  addToEnds<Real>(bonds, blocks, d == 2 ? 3 : 6, Real(1),
    [&](const BondRow<Real>& row, const std::array<Real*, 6>& t)
    {
      const Offset& o = bonds.stencil().half()[static_cast<std::size_t>(row.offset)];
      const auto e = [&](std::size_t c) { return static_cast<Real>(o.step[c] / o.length); };
      const std::array<Real, 6> ee = d == 2
        ? std::array<Real, 6>{ e(0) * e(0), e(1) * e(1), e(0) * e(1), 0, 0, 0 }
        : std::array<Real, 6>{ e(0) * e(0), e(1) * e(1), e(2) * e(2), e(0) * e(1), e(1) * e(2), e(0) * e(2) };
      for (std::size_t c = 0; c < (d == 2 ? 3U : 6U); ++c)
        for (std::int64_t x = row.x0; x < row.x1; ++x)
          t[c][x] = row.spring[x] * ee[c];
    });
}

template <class Real>
void tangentProduct(const BondLattice& bonds, const NodeField<Real>& u, const NodeField<Real>& p, NodeField<Real>& q)
{
  choose(
    bonds, true,
    [&]<int Dim, bool Nonlinear>()
    {
      addToEnds<Real>(
        bonds, q, Dim, Real(-1),
        [&](const BondRow<Real>& row, const std::array<Real*, 6>& t)
        {
          BondState<Real, Dim, Nonlinear> state(bonds, u, row);
          for (std::int64_t x = row.x0; x < row.x1; ++x)
          {
            state.at(x);
            Real along = 0;
            Real eta[Dim];
            for (int c = 0; c < Dim; ++c)
            {
              eta[c] = p.component(c)[row.j + x] - p.component(c)[row.i + x];
              along += state.zeta[c] * eta[c];
            }
            // n n·η + (1 − |ξ|/|ζ|) (η − n n·η)
            along *= (1 - state.shortening) / (state.norm * state.norm);
            for (int c = 0; c < Dim; ++c)
              t[static_cast<std::size_t>(c)][x] = row.spring[x] * (state.shortening * eta[c] + along * state.zeta[c]);
          }
        });
    });
}

#define LAMELLA_MEASURES(Real)                                                                                         \
  template StretchMaximum largestStretch(const BondLattice&, const NodeField<Real>&, bool);                            \
  template StretchMaximum largestStretchWithin(const BondLattice&, const NodeField<Real>&,                             \
    const std::array<std::int64_t, 3>&, const std::array<std::int64_t, 3>&);                                           \
  template double elasticEnergy(const BondLattice&, const NodeField<Real>&, bool);                                     \
  template void energyDensity(const BondLattice&, const NodeField<Real>&, NodeField<Real>&, bool);                     \
  template void nodalStress(const BondLattice&, const NodeField<Real>&, NodeField<Real>&, bool);                       \
  template std::array<double, 3> sectionForce(const BondLattice&, const NodeField<Real>&, int, std::int64_t, bool);    \
  template std::array<double, 3> layerSum(                                                                             \
    const BondLattice&, const NodeField<Real>&, int, std::int64_t, std::int64_t);                                      \
  template void diagonalBlocks(const BondLattice&, NodeField<Real>&);                                                  \
  template void tangentProduct(const BondLattice&, const NodeField<Real>&, const NodeField<Real>&, NodeField<Real>&);
LAMELLA_MEASURES(double)
LAMELLA_MEASURES(float)

} // namespace lamella::peridynamics
