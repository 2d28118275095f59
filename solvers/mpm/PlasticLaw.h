#pragma once

#include "mpm/WallMaterial.h"

namespace lamella::mpm
{

/// What an elastic–plastic point remembers besides its deformation gradient, which is then the elastic part.
struct PlasticState
{
  double strain = 0;      ///< equivalent plastic strain so far
  double acrossPlane = 1; ///< elastic stretch along the third direction; stays 1 in space, where F has it
};

/// An isotropic wall that yields: Hencky's elasticity, F = Fe Fp, J2 flow with linear isotropic hardening, returned
/// radially in logarithmic strains, which keeps the plastic volume exactly (Simo, Comput. Methods Appl. Mech. Eng. 99
/// (1992) 61; de Souza Neto, Perić, Owen, Computational Methods for Plasticity (2008), box 14.3).
///   ψ = μ Σ εᵢ² + λ/2 (Σ εᵢ)² + barrier(det Fe),   τᵢ = 2μ εᵢ + λ Σ ε + τ_barrier,   ε the logarithms of Fe's
///   stretches q = √(3/2) |dev τ| ≤ σ_y + H ε̄
/// In space and in plane strain: without a free surface the third direction of plane stress would have to be solved
/// for.
template <int Dim>
class PlasticLaw
{
public:
  /// @param yieldStress σ_y, in tension or compression along one direction [Pa]; infinite: never
  /// @param hardening H, slope of the yield stress over the equivalent plastic strain [Pa]
  /// @throws ParameterError as isotropicLaw() does, and for a yield stress or hardening that makes no sense
  PlasticLaw(const IsotropicMaterial& material, double yieldStress, double hardening, const std::string& name = "wall");

  /// Takes the elastic part of a step back to the yield surface.
  /// @param f Fe after a step as if it had been elastic; changed to Fe
  /// @param state changed where the point yields
  /// @returns the energy that the step turned into plastic work [J/m³], 0 where it stayed elastic
  double yield(Matrix<Dim, double>& f, PlasticState& state) const;

  /// Kirchhoff stress [Pa]. @param f Fe, det Fe > 0
  [[nodiscard]] Matrix<Dim, double> kirchhoff(const Matrix<Dim, double>& f, const PlasticState& state) const;
  /// Elastic energy density [J/m³].
  [[nodiscard]] double energy(const Matrix<Dim, double>& f, const PlasticState& state) const;
  /// M with ρ₀ c² ≤ M for every wave in the point as it is [Pa].
  [[nodiscard]] double waveModulus(const Matrix<Dim, double>& f, const PlasticState& state) const;

  [[nodiscard]] double lambda() const { return elastic_.lambda; }
  [[nodiscard]] double mu() const { return elastic_.mu; }

private:
  IsotropicLaw<3> elastic_;
  double yieldStress_;
  double hardening_;
};

extern template class PlasticLaw<2>;
extern template class PlasticLaw<3>;

} // namespace lamella::mpm
