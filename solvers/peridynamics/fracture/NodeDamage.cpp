#include "peridynamics/fracture/NodeDamage.h"

#include "peridynamics/BondForces.h"

#include <array>

namespace lamella::peridynamics
{

void measure(BrokenState& state, const BondLattice& bonds, bool stress, bool energy, bool nonlinear)
{
  if (stress)
  {
    state.stressOfNodes.emplace(bonds.layout(), bonds.dimension() == 2 ? 3 : 6);
    nodalStress(bonds, *state.displacement, *state.stressOfNodes, nonlinear);
  }
  if (energy)
  {
    state.energyDensity.emplace(bonds.layout(), 1);
    energyDensity(bonds, *state.displacement, *state.energyDensity, nonlinear);
  }
}

NodeDamage::NodeDamage(const BondLattice& bonds)
  : bonds_(bonds)
  , degree_(bonds.layout(), 1)
  , counts_(bonds.layout(), 1)
{
  const NodeLayout& l = bonds.layout();
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        degree_.at(0, x, y, z) = static_cast<float>(bonds.degree(l.index(x, y, z)));
}

void NodeDamage::add(const Bond& bond)
{
  const NodeLayout& l = bonds_.layout();
  const auto& step = bonds_.stencil().half()[static_cast<std::size_t>(bond.offset)].step;
  for (int end = 0; end < 2; ++end)
  {
    std::array<std::int64_t, 3> n = bond.node;
    for (std::size_t a = 0; a < 3; ++a)
      n[a] = (n[a] + end * step[a] + l.global[a]) % l.global[a] - l.start[a];
    if (l.ownedNode(n))
      counts_.at(0, n[0], n[1], n[2]) += 1;
  }
}

NodeField<double> NodeDamage::damage() const
{
  NodeField<double> damage(bonds_.layout(), 1);
  for (std::int64_t i = 0; i < bonds_.layout().count(); ++i)
    if (const double all = static_cast<double>(degree_.component(0)[i]); all > 0)
      damage.component(0)[i] = counts_.component(0)[i] / all;
  return damage;
}

} // namespace lamella::peridynamics
