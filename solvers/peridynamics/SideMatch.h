#pragma once

#include "elasticity/SideMatch.h"
#include "peridynamics/BondLattice.h"

#include <array>
#include <cstdint>
#include <span>

namespace lamella::peridynamics
{

/// As elasticity::sideMatch(), of a picture that ranks share. Collective.
/// @param bonds periodic along every axis
/// @param phase of the rank's slab
[[nodiscard]] std::array<elasticity::SideMatch, 3> sideMatch(
  const BondLattice& bonds, std::span<const std::uint8_t> phase);

} // namespace lamella::peridynamics
