#pragma once

#include <array>
#include <span>
#include <vector>

/// Engineers' constants of a stiffness along any direction, and where they are least and most.
namespace lamella::elasticity
{

/// Under stress along a direction, or sheared along it: of all directions across it the least and the most. In the
/// plane there is one across, and both are the same.
struct ConstantsAlong
{
  double young = 0;                    ///< [Pa]
  std::array<double, 2> shear{ 0, 0 }; ///< [Pa]
  std::array<double, 2> poisson{};     ///< contraction across over stretch along
};

/// A value and where it is met: unit vectors, the first component that is not 0 is above it.
struct DirectedValue
{
  double value = 0;
  std::array<double, 3> along{};
  std::array<double, 3> across{}; ///< of a modulus of Young's: zeros
};

/// Each the least and the most over all directions.
struct ConstantExtremes
{
  std::array<DirectedValue, 2> young, shear, poisson;
};

/// Of the inverse of a stiffness: E(n) = 1/(n n : S : n n), ν(n, m) = −E(n) m m : S : n n, 1/G(n, m) = 4 n m : S : n m;
/// the last two are quadratic forms of m, whose least and most across n are eigenvalues (Ting & Chen, Q. J. Mech. Appl.
/// Math. 58 (2005) 73, on how far ν may go). Moduli are 0 where nothing resists; ratios are NaN where some strain is
/// not resisted at all.
class DirectionalConstants
{
public:
  /// @param stiffness 3 × 3 or 6 × 6 by rows, Voigt's order, shears as angles [Pa]; its symmetric part counts
  /// @param dimension 2 or 3
  /// @param zero      eigenvalues at most this share of the largest count as none, as elasticConstants() has it
  DirectionalConstants(std::span<const double> stiffness, int dimension, double zero = 1e-9);

  /// @param direction of any length but 0; in the plane its third component does not count
  [[nodiscard]] double young(const std::array<double, 3>& direction) const;
  [[nodiscard]] ConstantsAlong operator()(const std::array<double, 3>& direction) const;

  /// Looked for on a grid of 4° and from its best places on, each to 10⁻⁷ in direction. Of directions that come within
  /// 10⁻⁶ of the best, one of the box's axes or diagonals is told. Some 10⁴ directions are tried, at most 10⁵ on
  /// crests.
  [[nodiscard]] ConstantExtremes extremes() const;

private:
  struct Along;
  [[nodiscard]] Along at(const std::array<double, 3>& direction) const;

  int dimension_;
  bool resists_ = true;            ///< all strains
  std::vector<double> compliance_; ///< Kelvin's form: shears times √2
  std::vector<double> lost_;       ///< projector on stresses of strains that nothing resists
};

} // namespace lamella::elasticity
