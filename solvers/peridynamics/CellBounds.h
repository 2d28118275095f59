#pragma once

#include "peridynamics/BondLattice.h"

#include <vector>

namespace lamella::peridynamics
{

/// Bounds of a periodic cell's stiffness on its own lattice, in Voigt order by rows [Pa]: upper − C and C − lower have
/// no negative eigenvalue, whatever the phases' places.
struct CellBounds
{
  std::vector<double> voigt; ///< every node follows the mean strain: C = 1/V Σ K |ξ|² a aᵀ, a = (n₁², n₂², n₁n₂) …
  /// Every bond pulls as in a lattice of one material: S = C₀⁻¹ (1/V Σ K₀² |ξ|²/K a aᵀ) C₀⁻¹, C₀ the stiffness of that
  /// lattice. Zero where some bond is missing (voids, notches), for then such forces do not balance.
  std::vector<double> reuss;
};

/// From one pass over the bonds, surface correction included. Collective.
/// @param bonds periodic along every axis
[[nodiscard]] CellBounds cellBounds(const BondLattice& bonds);

} // namespace lamella::peridynamics
