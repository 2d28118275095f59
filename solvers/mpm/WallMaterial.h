#pragma once

#include "mpm/Hencky.h"
#include "mpm/Hill.h"
#include "mpm/Isotropic.h"
#include "mpm/Orthotropic.h"

#include <array>
#include <optional>
#include <string>

/// From engineers' constants to laws of material points.
namespace lamella::mpm
{

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

/// An isotropic wall that yields; in plane strain and in space.
struct PlasticMaterial
{
  IsotropicMaterial elastic{};
  double yieldStress = 100e6; ///< σ_y, pulled or pushed along one direction [Pa]; infinite: never yields
  double hardening = 0;       ///< H, slope of the yield stress over the equivalent plastic strain [Pa]
};

/// A wall with one axis that yields along it and across it; in plane strain and in space.
struct OrthotropicPlasticMaterial
{
  OrthotropicMaterial elastic{};
  double yieldStress = 100e6; ///< X, pulled or pushed along the axis [Pa]; infinite: never yields
  /// Y, across the axis [Pa], below 2 X; none: X.
  std::optional<double> yieldAcross{};
  /// S, in shear along the axis [Pa]; none: 1/S² = 2/X² + 1/Y², with which the yield stress goes from along to across
  /// without an extremum between, and X/√3 where both are alike.
  std::optional<double> yieldShear{};
  double hardening = 0; ///< H, slope of the yield stress along over the equivalent plastic strain [Pa]
};

/// Constants of the laws.
/// @param name of the phase, for messages
/// @throws ParameterError: a value that is not finite, a material that is not positive definite (names the value that
/// breaks it and its bounds)
template <int Dim>
[[nodiscard]] std::array<double, Isotropic::constants> isotropicConstants(
  const IsotropicMaterial& material, PlaneState state = PlaneState::Stress, const std::string& name = "wall");
template <int Dim>
[[nodiscard]] std::array<double, Orthotropic::constants> orthotropicConstants(
  const OrthotropicMaterial& material, PlaneState state = PlaneState::Stress, const std::string& name = "wall");
[[nodiscard]] std::array<double, Hencky::constants> henckyConstants(
  const PlasticMaterial& material, const std::string& name = "wall");
[[nodiscard]] std::array<double, Hill::constants> hillConstants(
  const OrthotropicPlasticMaterial& material, const std::string& name = "wall");

[[nodiscard]] double shearModulus(const OrthotropicMaterial& material);

} // namespace lamella::mpm
