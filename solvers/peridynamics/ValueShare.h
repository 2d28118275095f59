#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/Equilibrium.h"

#include <algorithm>

namespace lamella::peridynamics
{

/// What a residual may leave of a value before an equilibrium is made better. Of bonds that are a thousand times apart
/// or more it is a tenth of EquilibriumOptions::valueShare: there it is the soft ones that the value hangs on.
[[nodiscard]] inline double shareLeft(const BondLattice& bonds, double tolerance)
{
  constexpr double apart = 1000;
  double least = 0;
  double most = 0;
  for (const BondKind& k : bonds.kinds())
    if (k.stiffness > 0)
    {
      least = least > 0 ? std::min(least, k.stiffness) : k.stiffness;
      most = std::max(most, k.stiffness);
    }
  return EquilibriumOptions::valueShare * tolerance * (most > apart * least ? 0.1 : 1);
}

} // namespace lamella::peridynamics
