// How many nodes lie across a phase: a layer thinner than the horizon is jumped over by bonds.
#include "peridynamics/ElasticStudy.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

constexpr std::int64_t beyond = 1000; // more than any run that can be seen

/// Nodes of the same phase that lead away from each node along an axis, itself included; `beyond` where they reach the
/// sample's edge. Counted at most through the rim.
class Counts
{
public:
  Counts(const BondLattice& bonds, const NodeField<float>& phase)
    : bonds_(bonds)
    , phase_(phase)
    , reach_(bonds.layout().ghost)
  {
  }

  /// The run through a node, capped at 2 reach + 1.
  [[nodiscard]] std::int64_t run(const std::array<std::int64_t, 3>& node, std::size_t axis) const
  {
    return std::min<std::int64_t>(2 * reach_ + 1, away(node, axis, 1) + away(node, axis, -1) - 1);
  }

private:
  [[nodiscard]] std::int64_t away(const std::array<std::int64_t, 3>& node, std::size_t axis, int step) const
  {
    const NodeLayout& l = bonds_.layout();
    const float own = phase_.at(0, node[0], node[1], node[2]);
    std::array<std::int64_t, 3> at = node;
    std::int64_t count = 1;
    for (; count <= reach_; ++count)
    {
      at[axis] += step;
      const std::int64_t global = at[axis] + l.start[axis];
      if (!bonds_.periodic()[axis] && (global < 0 || global >= l.global[axis]))
        return beyond;
      if (phase_.at(0, at[0], at[1], at[2]) != own)
        break;
    }
    return count;
  }

  const BondLattice& bonds_;
  const NodeField<float>& phase_;
  std::int64_t reach_;
};

} // namespace

std::vector<PhaseThickness> phaseThickness(
  const BondLattice& bonds, const BondModel& model, std::span<const std::uint8_t> phase)
{
  const NodeLayout& l = bonds.layout();
  const NodeField<float> ids = bonds.fieldOf(phase);
  const Counts counts(bonds, ids);

  // by phase, how many nodes have each thickness
  const auto classes = 2 * static_cast<std::size_t>(l.ghost) + 2;
  std::vector<double> histogram(256 * classes, 0.0);
  const std::int64_t rows = l.size[1] * l.size[2];
#pragma omp parallel
  {
    std::vector<double> mine(histogram.size(), 0.0);
#pragma omp for schedule(static) nowait
    for (std::int64_t r = 0; r < rows; ++r)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
      {
        const std::array<std::int64_t, 3> node{ x, r % l.size[1], r / l.size[1] };
        if (!bonds.solid(l.index(node[0], node[1], node[2])))
          continue;
        std::int64_t least = 2 * l.ghost + 1;
        for (int a = 0; a < l.dimension; ++a)
          least = std::min(least, counts.run(node, static_cast<std::size_t>(a)));
        const auto id = static_cast<std::size_t>(phase[static_cast<std::size_t>(r * l.size[0] + x)]);
        ++mine[id * classes + static_cast<std::size_t>(least)];
      }
#pragma omp critical(lamellaPhaseThickness)
    for (std::size_t i = 0; i < mine.size(); ++i)
      histogram[i] += mine[i];
  }
  bonds.communicator().sum(histogram);

  std::vector<PhaseThickness> result;
  for (std::size_t id = 0; id < 256; ++id)
  {
    PhaseThickness t;
    t.phase = static_cast<std::uint8_t>(id);
    double thin = 0;
    double all = 0;
    for (std::size_t n = 0; n < classes; ++n)
    {
      all += histogram[id * classes + n];
      thin += static_cast<double>(n) < std::floor(model.horizon) ? histogram[id * classes + n] : 0;
    }
    if (all == 0)
      continue;
    t.nodes = static_cast<std::int64_t>(all);
    t.thinShare = thin / all;
    double below = 0;
    std::size_t n = 0;
    while (below + histogram[id * classes + n] < all / 2)
      below += histogram[id * classes + n++];
    t.median = static_cast<double>(n);
    result.push_back(t);
  }
  return result;
}

SampleCounts countSample(const BondLattice& bonds, const BondModel& model, std::span<const std::uint8_t> phase)
{
  const Communicator& comm = bonds.communicator();
  const std::array<std::int64_t, 3>& size = bonds.layout().global;
  SampleCounts r;
  r.nodes = size[0] * size[1] * size[2];
  r.solidNodes = bonds.solidNodes();
  r.bonds = bonds.bonds();
  const StripCounts mine = bonds.strips();
  r.strips = { comm.sum(mine.empty), comm.sum(mine.uniform), comm.sum(mine.mixed) };
  std::vector<PhaseThickness> thickness = phaseThickness(bonds, model, phase);
  if (thickness.size() > 1)
    r.thickness = std::move(thickness);
  return r;
}

} // namespace lamella::peridynamics
