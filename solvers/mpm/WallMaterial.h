#pragma once

#include "mpm/IsotropicLaw.h"
#include "mpm/OrthotropicLaw.h"

#include <optional>
#include <string>
#include <variant>

/// From engineers' constants to laws of material points.
namespace lamella::mpm
{

/// What a plane takes the third direction for. Space has no choice.
enum class PlaneState
{
  Stress, ///< free: no stress along it
  Strain  ///< held: no strain along it
};

struct IsotropicMaterial
{
  double youngsModulus = 7.2e9; ///< E [Pa]
  double poissonsRatio = 0.3;   ///< ν
  /// Modulus of the VolumeBarrier, over the greatest normal stiffness of the law; 0: none.
  double barrier = 1;
};

/// A material with one axis, all directions across it alike. The moduli are those of the first paper's walls; the paper
/// leaves the others open.
struct OrthotropicMaterial
{
  double along = 8e9;         ///< E_a, Young's modulus along the axis [Pa]
  double across = 6.4e9;      ///< E_t across it [Pa]
  double poissonsRatio = 0.3; ///< ν_at, contraction across over extension along, pulled along
  double acrossRatio = 0.3;   ///< ν_tt, among the directions across; of no account in plane stress
  /// G_at, shear modulus along the axis [Pa]; none: 1/G = 1/E_a + 1/E_t + 2 ν_at/E_a (de Saint-Venant), which makes
  /// a tensor with no extremum of E between along and across, and the isotropic one where both are alike.
  std::optional<double> shearModulus{};
  double barrier = 1; ///< as IsotropicMaterial
};

/// @param name of the phase, for messages
/// @throws ParameterError: a value that is not finite, a material that is not positive definite (names the value that
/// breaks it and its bound)
template <int Dim>
[[nodiscard]] IsotropicLaw<Dim> isotropicLaw(
  const IsotropicMaterial& material, PlaneState state = PlaneState::Stress, const std::string& name = "wall");
template <int Dim>
[[nodiscard]] OrthotropicLaw<Dim> orthotropicLaw(
  const OrthotropicMaterial& material, PlaneState state = PlaneState::Stress, const std::string& name = "wall");

[[nodiscard]] double shearModulus(const OrthotropicMaterial& material);

/// The elastic law of a phase.
template <int Dim>
using PointLaw = std::variant<IsotropicLaw<Dim>, OrthotropicLaw<Dim>>;

extern template IsotropicLaw<2> isotropicLaw<2>(const IsotropicMaterial&, PlaneState, const std::string&);
extern template IsotropicLaw<3> isotropicLaw<3>(const IsotropicMaterial&, PlaneState, const std::string&);
extern template OrthotropicLaw<2> orthotropicLaw<2>(const OrthotropicMaterial&, PlaneState, const std::string&);
extern template OrthotropicLaw<3> orthotropicLaw<3>(const OrthotropicMaterial&, PlaneState, const std::string&);

} // namespace lamella::mpm
