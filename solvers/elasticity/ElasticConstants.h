#pragma once

#include <span>
#include <string>
#include <vector>

namespace lamella::elasticity
{

/// What a stiffness tensor says in engineers' words, from its inverse: apparent constants under stress along one
/// direction, sides free to move. In plane strain they are those of the plane: E/(1 − ν²) and ν/(1 − ν) of an isotropic
/// material.
struct ElasticConstants
{
  std::vector<double> youngsModulus; ///< along x, y(, z) [Pa]; 0 where nothing resists
  std::vector<double> shearModulus;  ///< xy in 2D; yz, xz, xy in space [Pa]; 0 likewise
  /// −ε_b/ε_a under stress along a, for (a, b) = xy, yx in 2D; xy, xz, yx, yz, zx, zy. NaN where nothing resists
  /// along a or b.
  std::vector<double> poissonsRatio;
  /// Stiffnesses of the tensor's own strains (Kelvin's), rising [Pa]; those of an isotropic plane are E/(1 + ν) twice
  /// and E/(1 − ν).
  std::vector<double> eigenvalues;
  int resisting = 0; ///< how many of them are above zero
};

/// A unit stress with at least this share of its square along strains that nothing resists, is not resisted.
inline constexpr double unresisted = 1e-6;

/// Names of the constants, in the order of constantValues(): E_x …, nu_xy …, G_xy.
[[nodiscard]] std::vector<std::string> constantNames(int dimension);
[[nodiscard]] std::vector<double> constantValues(const ElasticConstants& constants);

/// Names of the components in Voigt order: xx, yy, xy; xx, yy, zz, yz, xz, xy.
[[nodiscard]] std::vector<std::string> voigtNames(int dimension);

/// @param stiffness 3 × 3 or 6 × 6 in Voigt order, by rows, shear strains as angles (2ε) [Pa]; its symmetric part
/// counts
/// @param dimension 2 or 3
/// @param zero eigenvalues at most this share of the largest count as none: no strain of theirs is resisted
/// @throws ParameterError for another number of values, and for one that is not finite
[[nodiscard]] ElasticConstants elasticConstants(std::span<const double> stiffness, int dimension, double zero = 1e-9);

/// How they change where the tensor does by `change`, to first order, in the order of constantValues(): of the unit
/// that `change` has over the stiffness's. 0 of moduli that nothing resists.
/// @param change as many values as `stiffness`
[[nodiscard]] std::vector<double> constantChanges(
  std::span<const double> stiffness, std::span<const double> change, int dimension, double zero = 1e-9);

} // namespace lamella::elasticity
