#pragma once

#include "mpm/VolumeBarrier.h"

namespace lamella::mpm
{

/// Isotropic elasticity for large rotations and displacements, in the stretch U of F = R U:
///   ψ = μ |U − I|² + λ/2 tr²(U − I) + barrier(det F),
/// Hooke's law turned with the material. Its stress is the derivative of ψ exactly:
///   τ = P Fᵀ = 2μ (F Fᵀ − V) + λ tr(U − I) V + τ_barrier I,   V = F Rᵀ.
/// In a plane the third direction is in λ: see WallMaterial.h.
template <int Dim>
struct IsotropicLaw
{
  double lambda = 0; ///< Lamé's first, of the plane state [Pa]
  double mu = 0;     ///< shear modulus [Pa]
  VolumeBarrier barrier{};

  /// Kirchhoff stress τ = det F σ [Pa], symmetric.
  /// @param f deformation gradient, det F > 0
  /// @param axis not used
  template <class Real>
  LAMELLA_POINT_INLINE Matrix<Dim, Real> kirchhoff(const Matrix<Dim, Real>& f, const Vector<Dim, Real>& axis) const
  {
    (void)axis;
    const Matrix<Dim, Real> v = productTransposed(f, rotation(f));
    const Real two = Real(2 * mu);
    const Real first = Real(lambda) * (trace(v) - Dim) - two;
    const Real volume = barrier.kirchhoff(determinant(f));
    Matrix<Dim, Real> tau = productTransposed(f, f);
    for (int i = 0; i < Dim; ++i)
    {
      for (int j = 0; j < Dim; ++j)
        tau.a[i][j] = two * tau.a[i][j] + first * v.a[i][j];
      tau.a[i][i] += volume;
    }
    return tau;
  }

  /// ψ [J/m³], per initial volume.
  template <class Real>
  LAMELLA_POINT_INLINE Real energy(const Matrix<Dim, Real>& f, const Vector<Dim, Real>& axis) const
  {
    (void)axis;
    const Matrix<Dim, Real> e = lessIdentity(productTransposed(f, rotation(f))); // V has U's invariants
    const Real t = trace(e);
    return Real(mu) * contraction(e, e) + Real(0.5 * lambda) * t * t + barrier.energy(determinant(f));
  }

  /// Stress of a small strain, C : e [Pa].
  template <class Real>
  LAMELLA_POINT_INLINE Matrix<Dim, Real> hooke(const Matrix<Dim, Real>& e, const Vector<Dim, Real>& axis) const
  {
    (void)axis;
    const Real volume = Real(lambda) * trace(e);
    Matrix<Dim, Real> t;
    for (int i = 0; i < Dim; ++i)
    {
      for (int j = 0; j < Dim; ++j)
        t.a[i][j] = Real(2 * mu) * e.a[i][j];
      t.a[i][i] += volume;
    }
    return t;
  }

  /// M with ρ₀ c² ≤ M for every wave in the point as it is [Pa]: of the present, not of the initial lengths.
  template <class Real>
  LAMELLA_POINT_INLINE Real waveModulus(const Matrix<Dim, Real>& f) const
  {
    return Real(lambda + 2 * mu) * greatestStretchSquared(f) + barrier.waveModulus(determinant(f));
  }
};

} // namespace lamella::mpm
