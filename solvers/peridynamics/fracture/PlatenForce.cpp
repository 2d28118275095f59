#include "peridynamics/fracture/PlatenForce.h"

#include "peridynamics/BondForces.h"

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
