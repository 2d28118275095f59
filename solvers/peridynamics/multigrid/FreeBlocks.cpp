#include "peridynamics/multigrid/FreeBlocks.h"

#include "peridynamics/BondForces.h"
#include "peridynamics/multigrid/LevelKernels.h"

namespace lamella::peridynamics
{

FreeBlocks::FreeBlocks(const BondLattice& bonds, const FixedComponents& fixed)
  : all(bonds.layout(), blockEntries(bonds.dimension()))
{
  diagonalBlocks(bonds, all);
  free = all;
  const NodeLayout& l = bonds.layout();
  constexpr unsigned components3[6] = { 1, 2, 4, 3, 6, 5 };
  constexpr unsigned components2[3] = { 1, 2, 3 };
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
      {
        if (fixed[i] == 0)
          continue;
        fixedNodes.push_back(i);
        partlyFixed += fixed[i] != allComponents(l.dimension) ? 1 : 0;
        for (int e = 0; e < free.components(); ++e)
          if ((fixed[i] & (l.dimension == 3 ? components3 : components2)[e]) != 0)
            free.component(e)[i] = 0;
      }
}

} // namespace lamella::peridynamics
