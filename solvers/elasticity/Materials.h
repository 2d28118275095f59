#pragma once

#include <array>
#include <cstddef>
#include <vector>

/// Stiffness of phases from engineers' constants.
namespace lamella::elasticity
{

enum class Continuum
{
  PlaneStress,
  PlaneStrain,
  Space
};

/// The upper triangle of a stiffness in Voigt's order by rows, shears as angles [Pa]: 21 numbers in space, 6 in the
/// plane; all 0 for a void.
using PhaseStiffness = std::vector<double>;

[[nodiscard]] constexpr int dimensionOf(Continuum continuum) noexcept
{
  return continuum == Continuum::Space ? 3 : 2;
}

[[nodiscard]] PhaseStiffness voidStiffness(Continuum continuum);

/// How a material changes with a number that it is told by: λ, μ, α, β, γ of ElasticKernels.h, each by that number [Pa
/// over its unit].
struct ModulusChange
{
  std::size_t number = 0; ///< place in a list of numbers of all materials
  std::array<double, 5> moduli{};
};

/// @param young   [Pa], above 0
/// @param poisson above −1 and below 1/2 (plane stress: 1)
/// @throws ParameterError
[[nodiscard]] PhaseStiffness isotropicStiffness(Continuum continuum, double young, double poisson);

/// How λ, μ, α, β, γ change with Young's modulus and with Poisson's ratio, in that order.
[[nodiscard]] std::array<std::array<double, 5>, 2> isotropicChanges(Continuum continuum, double young, double poisson);

/// Of a material that is the same in all directions across an axis. Poisson's ratios: contraction across over stretch
/// along under stress along the axis; and within the plane across it under stress in that plane.
struct TransverseMaterial
{
  double youngAlong = 0;  ///< [Pa]
  double youngAcross = 0; ///< [Pa]
  double poissonAlong = 0;
  double poissonAcross = 0;
  double shearAlong = 0; ///< in planes that hold the axis [Pa]
};

/// @param axis of any length but 0; in the plane its third component is 0 or it is (0, 0, 1)
/// @throws ParameterError: constants of no stable material (its tensor is not positive definite), with the eigenvalue
[[nodiscard]] PhaseStiffness transverseStiffness(
  Continuum continuum, const TransverseMaterial& material, const std::array<double, 3>& axis);

/// λ, μ, α, β, γ of ElasticKernels.h [Pa]: what a voxel has whose own axis the material follows. In the plane the axis
/// lies in it, and γ is 0, since four constants tell all.
/// @throws ParameterError as transverseStiffness()
[[nodiscard]] std::array<double, 5> axialModuli(Continuum continuum, const TransverseMaterial& material);

/// How these change with each constant, in the order of TransverseMaterial.
[[nodiscard]] std::array<std::array<double, 5>, 5> transverseChanges(
  Continuum continuum, const TransverseMaterial& material);

/// λ, μ, α, β, γ of a tensor with its axis along x, upper triangle in Voigt's order.
[[nodiscard]] std::array<double, 5> axialParts(int dimension, const PhaseStiffness& alongX);

/// Expansion in the plane, along the axis and across it, of a material whose expansion this is: in plane strain more of
/// it, since the third direction is not let. Of an isotropic material all moduli and ratios are the same.
[[nodiscard]] std::array<double, 2> planeExpansion(
  Continuum continuum, const TransverseMaterial& material, const std::array<double, 2>& expansion);

/// What happens across a plane, by the stresses within it and by a change of 1 of temperature or moisture: in plane
/// stress the strain zz, in plane strain the stress zz.
struct AcrossPlane
{
  std::array<double, 3> byStress{}; ///< of xx, yy, xy; of a material with an axis along it, across it, 0 [1/Pa; 1]
  double byChange = 0;              ///< [1; Pa]
};

/// @param expansion of it along its axis and across it
[[nodiscard]] AcrossPlane acrossPlane(
  Continuum continuum, const TransverseMaterial& material, const std::array<double, 2>& expansion);

/// Of a tensor in space, which expands by the same in all directions.
/// @param space 21 numbers
[[nodiscard]] AcrossPlane acrossPlane(Continuum continuum, const PhaseStiffness& space, double expansion);

/// Expansion in the plane, Voigt's order, of a tensor in space that expands by the same in all directions: in plane
/// strain more of it, since the third direction is not let.
[[nodiscard]] std::array<double, 3> planeExpansion(Continuum continuum, const PhaseStiffness& space, double expansion);

/// @param space 21 numbers: what a plane of that material has in plane stress or plane strain
[[nodiscard]] PhaseStiffness inPlane(Continuum continuum, const PhaseStiffness& space);

/// @throws ParameterError: not finite, of another size, or not positive definite (which eigenvalue); all 0 passes
void requireStable(Continuum continuum, const PhaseStiffness& stiffness, const char* whose);

} // namespace lamella::elasticity
