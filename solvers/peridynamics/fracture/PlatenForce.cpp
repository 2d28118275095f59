#include "peridynamics/fracture/PlatenForce.h"

#include "peridynamics/BondForces.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lamella::peridynamics
{

PlatenForce::PlatenForce(const BondLattice& bonds, const Loading& loading, const LoadedSample& sample)
  : axis_(loading.axis < 0 ? bonds.dimension() - 1 : loading.axis)
  , component_(loading.load == LoadCase::Shear ? (axis_ + 1) % bonds.dimension() : axis_)
  , sign_(loading.strain < 0 ? -1 : 1)
  , low_(sample.lowLayers)
  , high_(sample.highLayers)
{
  for (int a = 0; a < bonds.dimension(); ++a)
    if (a != axis_)
      area_ *= static_cast<double>(bonds.layout().global[static_cast<std::size_t>(a)]) * bonds.spacing();
}

template <class Real>
double PlatenForce::of(const BondLattice& bonds, const NodeField<Real>& force) const
{
  const auto c = static_cast<std::size_t>(component_);
  const double low = layerSum(bonds, force, axis_, low_[0], low_[1])[c];
  const double high = layerSum(bonds, force, axis_, high_[0], high_[1])[c];
  return 0.5 * sign_ * (low - high);
}
template double PlatenForce::of(const BondLattice&, const NodeField<double>&) const;
template double PlatenForce::of(const BondLattice&, const NodeField<float>&) const;

// A section bears what all nodes below it feel together.
double PlatenForce::imbalance(const BondLattice& bonds, const NodeField<double>& force) const
{
  const NodeLayout& l = bonds.layout();
  const auto a = static_cast<std::size_t>(axis_);
  std::vector<double> layers(static_cast<std::size_t>(l.global[a]));
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        layers[static_cast<std::size_t>(std::array{ x, y, z }[a] + l.start[a])] += force.at(component_, x, y, z);
  bonds.communicator().sum(layers);
  const double platens = sign_ * of(bonds, force);
  double section = 0;
  double worst = 0;
  for (std::int64_t layer = 0; layer < high_[0]; ++layer)
  {
    section += layers[static_cast<std::size_t>(layer)];
    if (layer >= low_[1] - 1)
      worst = std::max(worst, std::abs(section - platens));
  }
  return worst > 0 ? worst / std::abs(platens) : 0;
}

AlignedArray<std::uint8_t> PlatenForce::marks(const BondLattice& bonds, const LoadedSample& sample) const
{
  const NodeLayout& l = bonds.layout();
  AlignedArray<std::uint8_t> marks(l.count());
  const auto a = static_cast<std::size_t>(axis_);
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
      {
        const std::int64_t layer = std::array{ x, y, z }[a] + l.start[a];
        const std::int64_t i = l.index(x, y, z);
        marks[i] = static_cast<std::uint8_t>(
          (layer < low_[1] ? 1 : 0) | (layer >= high_[0] ? 2 : 0) | (sample.fixed[i] != 0 ? 4 : 0));
      }
  return marks;
}

} // namespace lamella::peridynamics
