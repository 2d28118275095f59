#pragma once

#include "peridynamics/Stencil.h"

#include <optional>
#include <string>

/// Bond-based peridynamics: constants of the bonds from what is known of a material, and what a lattice makes of them.
/// After Frank, Radjai, Nezamabadi and Delenne, Phys. Rev. E 102 (2020) 022906, section II; Silling and Askari,
/// Comput. Struct. 83 (2005) 1526.
namespace lamella::peridynamics
{

/// A bond-based material has one free constant: its Poisson's ratio is that of its dimension.
enum class Continuum
{
  PlaneStress, ///< ν = 1/3
  PlaneStrain, ///< ν = 1/4
  Space        ///< ν = 1/4
};

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
  Lattice    ///< c such that E along the axes is exact in the bulk of this lattice
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

/// Elastic constants and fracture energy of the bulk of a lattice, over those of the continuum for which c was chosen
/// with Micromodulus::Continuum.
struct LatticeModuli
{
  double youngsModulus = 0;         ///< along the axes
  double youngsModulusDiagonal = 0; ///< at 45° in the plane x, y
  double poissonsRatio = 0;         ///< along the axes; itself, not a ratio
  double fractureEnergy = 0;        ///< of a crack across an axis
  double toughness = 0;             ///< √(E Gc) of both
};

/// Sums over the stencil: C₁₁ = ½ c δx^d Σ |ξ| n₁⁴, C₁₂ = ½ c δx^d Σ |ξ| n₁² n₂²; Gc = Σ ½ c |ξ| s₀² over the bonds
/// that cross a plane, a unit of its area.
/// @throws ParameterError when the stencil's dimension does not fit the continuum
[[nodiscard]] LatticeModuli latticeModuli(const Stencil& stencil, Continuum continuum);

} // namespace lamella::peridynamics
