#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/multigrid/Galerkin.h"

namespace lamella::peridynamics
{

/// A partly fixed node's fixed components are held by springs so many times stiffer than its own.
inline constexpr float fixedSpring = 1e3F;

/// The bonds as the Galerkin product reads them. Bonds of nodes that are fixed altogether do not couple.
/// @param diagonal blocks of the nodes; all arguments must outlive what is returned
[[nodiscard]] MatrixRows rowsOfBonds(
  const BondLattice& bonds, const FixedComponents& fixed, const NodeField<float>& diagonal);

} // namespace lamella::peridynamics
