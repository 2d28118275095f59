#pragma once

#include <array>
#include <span>

namespace lamella::lbm
{

/// Bounds on the effective conductivity that only the phases' shares are needed for.
struct Bounds
{
  double series = 0;               ///< harmonic mean, 1/Σ(fᵢ/kᵢ): layers across the flux (Wiener 1912)
  double parallel = 0;             ///< arithmetic mean, Σ fᵢkᵢ: layers along the flux
  double hashinShtrikmanLower = 0; ///< isotropic media in `dimension` dimensions (Hashin & Shtrikman 1962)
  double hashinShtrikmanUpper = 0;
};

/// @param fractions       share of each phase, ≥ 0, sum 1
/// @param conductivities  of each phase, ≥ 0, in any unit; the bounds come in the same
/// @param dimension       2 or 3
[[nodiscard]] Bounds bounds(std::span<const double> fractions, std::span<const double> conductivities, int dimension);

} // namespace lamella::lbm
