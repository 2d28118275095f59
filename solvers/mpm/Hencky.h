#pragma once

#include "mpm/PointLaw.h"

namespace lamella::mpm
{

/// An isotropic wall that yields (a law with a history, as NeoHookean.h says): F of the point is the elastic part of
/// F = Fe Fp. Hencky's elasticity, J2 flow with linear isotropic hardening, returned radially in logarithmic strains,
/// which keeps the plastic volume exactly (Simo, Comput. Methods Appl. Mech. Eng. 99 (1992) 61; de Souza Neto, Perić
/// and Owen, Computational Methods for Plasticity (2008), box 14.3).
///   ψ = μ Σ εᵢ² + λ/2 (Σ εᵢ)² + barrier(det Fe),   τᵢ = 2μ εᵢ + λ Σ ε + τ_barrier,   ε the logarithms of Fe's
///   stretches q = √(3/2) |dev τ| ≤ σ_y + H ε̄
/// A plane is one of plane strain, whose elastic strain along the third direction is remembered: plane stress would
/// have to be solved for. Doubles only, with branches: not for kernels. Constants from WallMaterial.h.
struct Hencky
{
  static constexpr LawKind kind = LawKind::Hencky;
  static constexpr int constants = 5; ///< λ, μ, κ of the barrier, σ_y, H [Pa]
  /// Equivalent plastic strain ε̄; logarithmic elastic strain along a plane's third direction; plastic work over
  /// initial volume [J/m³]. All 0 at the start.
  static constexpr int history = 3;
  static constexpr int plasticStrain = 0;
  static constexpr int thirdStrain = 1;
  static constexpr int plasticWork = 2;

  /// Takes a step that was treated as elastic back to the yield surface.
  /// @param F Fe, changed where the point yields, as is the history
  template <int Dim>
  static void flow(const double* c, Matrix<Dim>& F, const Vector<Dim>& axis, double* history);

  /// @param F Fe, det Fe > 0
  template <int Dim>
  [[nodiscard]] static Matrix<Dim> kirchhoff(
    const double* c, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history);
  /// Of plane strain: along the third direction.
  [[nodiscard]] static double thirdStress(
    const double* c, const Matrix<2>& F, const Vector<2>& axis, const double* history);
  [[nodiscard]] static double thirdStretch(const double* history);
  /// The elastic part [J/m³].
  template <int Dim>
  [[nodiscard]] static double energy(
    const double* c, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history);
  template <int Dim>
  [[nodiscard]] static double stiffness(
    const double* c, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history);
};

} // namespace lamella::mpm
