#include "peridynamics/Preconditioner.h"

#include "peridynamics/multigrid/FreeBlocks.h"

namespace lamella::peridynamics
{

JacobiPreconditioner::JacobiPreconditioner(const BondLattice& bonds, const FixedComponents& fixed)
  : inverse_(bonds.layout(), blockEntries(bonds.dimension()))
  , r_(bonds.layout())
  , z_(bonds.layout())
{
  const FreeBlocks blocks(bonds, fixed);
  hinges_ = bonds.communicator().sum(invertBlocks(blocks.free, inverse_) - blocks.partlyFixed);
}

const NodeField<float>& JacobiPreconditioner::apply(const NodeField<double>& r, double scale)
{
  const NodeLayout& l = r_.layout();
  forOwnRows(l,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      for (int c = 0; c < l.dimension; ++c)
        levelKernels().toFloat(l.size[0], scale, r.component(c) + i, r_.component(c) + i);
    });
  return apply(r_);
}

const NodeField<float>& JacobiPreconditioner::apply(const NodeField<float>& r)
{
  const NodeLayout& l = r_.layout();
  const int entries = blockEntries(l.dimension);
  forOwnRows(l,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      const float* inverse[6];
      const float* from[3];
      float* to[3];
      for (int e = 0; e < entries; ++e)
        inverse[e] = inverse_.component(e) + i;
      for (int c = 0; c < l.dimension; ++c)
      {
        from[c] = r.component(c) + i;
        to[c] = z_.component(c) + i;
      }
      levelKernels().chebyshev(l.dimension, l.size[0], 0, 1, inverse, from, to, to, true);
    });
  return z_;
}

std::int64_t JacobiPreconditioner::bytes() const
{
  return r_.layout().count() * static_cast<std::int64_t>(sizeof(float)) *
    (inverse_.components() + r_.components() + z_.components());
}

} // namespace lamella::peridynamics
