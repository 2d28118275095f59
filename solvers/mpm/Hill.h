#pragma once

#include "mpm/PointLaw.h"

namespace lamella::mpm
{

/// A wall that is elastic and yields along and across its own axis, all directions across it alike (a law with a
/// history, as NeoHookean.h says); F of the point is all of the deformation. Elastic and plastic strains add up in the
/// logarithm E = ½ ln FᵀF of the stretch (Miehe, Apel and Lambrecht, Comput. Methods Appl. Mech. Eng. 191 (2002) 5383),
/// so that a step is one of small strains, on axes that move with the material, and what flows keeps its volume
/// exactly:
///   ψ = ½ Ee : C : Ee + barrier(det F),   Ee = E − Ep,   T = C : Ee,   τ from T : dE, the derivative of ψ exactly.
/// C is that of Orthotropic in space. It yields by Hill's criterion (Proc. R. Soc. Lond. A 193 (1948) 281) on the
/// wall's axes, 1 along it, with associated flow and linear isotropic hardening, returned to the closest point:
///   q² = ½ [(T₁₁ − T₂₂)² + (T₁₁ − T₃₃)²] + (r² − ½) (T₂₂ − T₃₃)² + (4r² − 1) T₂₃² + s² (T₁₂² + T₁₃²),
///   q ≤ σ_y + H ε̄,   dEp = dε̄ ∂q/∂T;   r and s: yield stress along over those across and in shear.
/// T : dEp = q dε̄, so that ε̄ is conjugate to the stress along the axis. A plane is one of plane strain. Doubles only,
/// with branches: not for kernels. Constants from WallMaterial.h.
struct Hill
{
  static constexpr LawKind kind = LawKind::Hill;
  /// λ, μ, α, δ, β of Orthotropic in space, greatest ρ₀c² of a wave, κ of the barrier, σ_y [Pa]; r², s²; H [Pa].
  static constexpr int constants = 11;
  static constexpr int wave = 5;
  static constexpr int barrier = 6;
  static constexpr int yield = 7;
  static constexpr int across = 8;
  static constexpr int shear = 9;
  static constexpr int hardening = 10;
  /// Equivalent plastic strain ε̄; plastic work over initial volume [J/m³]; Ep: xx, yy, yz, xz, xy, and zz = −xx − yy.
  /// All 0 at the start.
  static constexpr int history = 7;
  static constexpr int plasticStrain = 0;
  static constexpr int plasticWork = 1;
  static constexpr int plasticTensor = 2;

  /// Flows until the stress is on the yield surface again.
  /// @param F det F > 0; stays as it is
  template <int Dim>
  static void flow(const double* c, Matrix<Dim>& F, const Vector<Dim>& axis, double* history);
  template <int Dim>
  [[nodiscard]] static Matrix<Dim> kirchhoff(
    const double* c, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history);
  [[nodiscard]] static double thirdStress(
    const double* c, const Matrix<2>& F, const Vector<2>& axis, const double* history);
  /// 1: F has all of the deformation.
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
