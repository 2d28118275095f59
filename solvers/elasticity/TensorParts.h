#pragma once

#include <array>
#include <span>
#include <vector>

/// What a stiffness tensor is nearest to, and what isotropic mixtures may have.
namespace lamella::elasticity
{

struct IsotropicPart
{
  double bulk = 0;  ///< [Pa]; in the plane the mean stress over the change of area
  double shear = 0; ///< [Pa]
  double young = 0; ///< [Pa]
  double poisson = 0;
  double rest = 0; ///< norm of what the tensor has besides, over the tensor's (Kelvin's form: the same in all axes)
};

/// Stiffness by rows, Voigt's order, shears as angles [Pa].
[[nodiscard]] IsotropicPart nearestIsotropic(std::span<const double> stiffness, int dimension);

struct OrthotropicPart
{
  std::array<std::array<double, 3>, 3> axes{}; ///< unit vectors, a right-handed system
  std::vector<double> stiffness;               ///< in these axes, by rows [Pa]
  double rest = 0;                             ///< as IsotropicPart's
};

/// In the axes in which it leaves least, searched for from the eigenvectors of C_ijkk and C_ikjk (Cowin & Mehrabadi,
/// J. Mech. Appl. Math. 40 (1987) 451) and from the box's axes.
[[nodiscard]] OrthotropicPart nearestOrthotropic(std::span<const double> stiffness, int dimension);

struct IsotropicBounds
{
  std::array<double, 2> bulk{};  ///< lower, upper [Pa]
  std::array<double, 2> shear{}; ///< lower, upper [Pa]
};

/// Bounds of statistically isotropic mixtures of isotropic phases (Hashin & Shtrikman, J. Mech. Phys. Solids 11 (1963)
/// 127; in the plane Hashin, ibid. 13 (1965) 119, for the plane's moduli).
/// @param bulk, shear of each phase [Pa], 0 of voids
[[nodiscard]] IsotropicBounds hashinShtrikman(
  std::span<const double> fractions, std::span<const double> bulk, std::span<const double> shear, int dimension);

} // namespace lamella::elasticity
