#include "peridynamics/fracture/MotionGauge.h"

#include <limits>

namespace lamella::peridynamics
{

MotionGauge::MotionGauge(const BondLattice& bonds, int axis, int along, const std::array<std::int64_t, 2>& low,
  const std::array<std::int64_t, 2>& high, const NodeField<double>* unit)
  : bonds_(bonds)
  , along_(along)
{
  const NodeLayout& l = bonds.layout();
  const auto a = static_cast<std::size_t>(axis);
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
      {
        const std::int64_t i = l.index(x, y, z);
        const std::int64_t layer = std::array{ x, y, z }[a] + l.start[a];
        if (!bonds.solid(i))
          continue;
        if (layer >= low[0] && layer < low[1])
          nodes_[0].push_back(i);
        if (layer >= high[0] && layer < high[1])
          nodes_[1].push_back(i);
      }
  atOne_ = unit != nullptr
    ? apart([values = unit->component(along)](std::int64_t i) { return values[i]; })
    : apart([&](std::int64_t i) { return bonds.spacing() * static_cast<double>(l.node(i)[a] + l.start[a]); });
}

template <class F>
double MotionGauge::apart(F&& value) const
{
  std::array<double, 4> sums{};
  for (std::size_t side = 0; side < 2; ++side)
    for (const std::int64_t i : nodes_[side])
    {
      sums[side] += value(i);
      sums[side + 2] += 1;
    }
  bonds_.communicator().sum(sums);
  return sums[2] > 0 && sums[3] > 0 ? sums[1] / sums[3] - sums[0] / sums[2] : std::numeric_limits<double>::quiet_NaN();
}

double MotionGauge::strain(const NodeField<double>& displacement) const
{
  return apart([values = displacement.component(along_)](std::int64_t i) { return values[i]; }) / atOne_;
}

NodeField<double> densitiesOf(
  const BondLattice& bonds, std::span<const std::uint8_t> phase, std::span<const double> byPhase, double other)
{
  const NodeLayout& l = bonds.layout();
  NodeField<double> densities(l, 1);
  std::size_t k = 0;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x, ++k)
        if (bonds.solid(l.index(x, y, z)))
        {
          const double own = phase[k] < byPhase.size() ? byPhase[phase[k]] : 0;
          densities.at(0, x, y, z) = own != 0 ? own : other;
        }
  return densities;
}

double meanDensity(const BondLattice& bonds, const NodeField<double>& densities)
{
  const NodeLayout& l = bonds.layout();
  double sum = 0;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        sum += densities.at(0, x, y, z);
  return bonds.communicator().sum(sum) / static_cast<double>(l.global[0] * l.global[1] * l.global[2]);
}

} // namespace lamella::peridynamics
