#pragma once

#include "elasticity/Materials.h"
#include "peridynamics/Stencil.h"

#include <optional>
#include <string>

/// Bond-based peridynamics: constants of the bonds from what is known of a material, and what a lattice makes of them.
/// After Frank, Radjai, Nezamabadi and Delenne, Phys. Rev. E 102 (2020) 022906, section II; Silling and Askari,
/// Comput. Struct. 83 (2005) 1526.
namespace lamella::peridynamics
{

/// A bond-based material has one free constant: its Poisson's ratio is that of its dimension.
using elasticity::Continuum;

/// That bonds of one stiffness a length have: 1/3 in plane stress, else 1/4.
[[nodiscard]] double poissonsRatio(Continuum continuum) noexcept;

/// What is known of the bonds of one pair of phases: Young's modulus, and one of the last three.
struct BondMaterial
{
  double youngsModulus = 1;                ///< E [Pa]
  std::optional<double> fractureEnergy{};  ///< Gc [J/m²]
  std::optional<double> toughness{};       ///< K [Pa √m]: Gc = K²/E in plane stress, K²(1 − ν²)/E otherwise
  std::optional<double> criticalStretch{}; ///< s₀, elongation over length
};

enum class Micromodulus
{
  Continuum, ///< c from the integral over the horizon, as the papers: the lattice is then up to 6 % off E from h = 3 on
  Lattice,   ///< c such that E along the axes is exact in the bulk of this lattice
  Isotropic  ///< c by direction (isotropicStencil()): E and Poisson's ratio are exact in every direction
};

/// Force density between two nodes c·s, s the relative elongation; the bond breaks at s₀.
struct BondConstants
{
  double micromodulus = 0;    ///< c [Pa/m⁴ in space, Pa/m³ in the plane]
  double criticalStretch = 0; ///< s₀; infinite where nothing about fracture is known
};

/// @param spacing δx [m]
/// @param name of the pair of phases, for messages
/// @throws ParameterError: a value that is not positive and finite, more than one of Gc, K and s₀
[[nodiscard]] BondConstants bondConstants(const BondMaterial& material, const Stencil& stencil, double spacing,
  Continuum continuum, Micromodulus micromodulus, const std::string& name);

/// Weights that make the bulk of a square or cubic lattice isotropic, with the continuum's E and Poisson's ratio and
/// its micromodulus: w = α + β (n₁⁴ + n₂⁴ + n₃⁴), n the direction of the bond, which of all weights with
/// Σ |ξ| w n₁⁴ = 3 Σ |ξ| w n₁² n₂² = what the continuum has changes the bonds least (Σ |ξ| (w − 1)²). All are positive
/// for horizons from √2 on: between 0.41 and 1.58 there, 0.92 and 1.01 in the plane and 0.70 and 1.25 in space at 3.
/// @return none where no weights can do it: below √2 there are bonds along the axes only, and nothing resists shear
[[nodiscard]] std::optional<Stencil> isotropicStencil(const Stencil& stencil);

/// Elastic constants and fracture energy of the bulk of a lattice, over those of the continuum for which c was chosen
/// with Micromodulus::Continuum.
struct LatticeModuli
{
  double youngsModulus = 0;         ///< along the axes
  double youngsModulusDiagonal = 0; ///< at 45° in the plane x, y
  double poissonsRatio = 0;         ///< along the axes; itself, not a ratio
  double fractureEnergy = 0;        ///< of a crack across an axis
  double toughness = 0;             ///< √(E Gc) of both
  /// How far the stiffest and the softest strain are from the continuum's, relative: by no more is the effective
  /// stiffness of anything that is made of such bulks off, on a lattice without end. 0 of an isotropic stencil.
  double worst = 0;
};

/// Sums over the stencil, w its weights: C₁₁ = ½ c δx^d Σ w |ξ| n₁⁴, C₁₂ = ½ c δx^d Σ w |ξ| n₁² n₂²;
/// Gc = Σ ½ c w |ξ| s₀² over the bonds that cross a plane, a unit of its area.
/// @throws ParameterError when the stencil's dimension does not fit the continuum
[[nodiscard]] LatticeModuli latticeModuli(const Stencil& stencil, Continuum continuum);

} // namespace lamella::peridynamics
