#pragma once

#include "mpm/PointLaw.h"
#include "mpm/Stretch.h"
#include "mpm/VolumeBarrier.h"

namespace lamella::mpm
{

/// Isotropic elasticity for large rotations and displacements (a law as NeoHookean.h says), in the stretch U of F = R
/// U:
///   ψ = μ |U − I|² + λ/2 tr²(U − I) + barrier(det F),
/// Hooke's law turned with the material. Its stress is the derivative of ψ exactly:
///   τ = P Fᵀ = 2μ (F Fᵀ − V) + λ tr(U − I) V + τ_barrier I,   V = F Rᵀ.
/// Constants from WallMaterial.h, which puts the plane's third direction into λ.
struct Isotropic
{
  static constexpr LawKind kind = LawKind::Isotropic;
  static constexpr int constants = 3; ///< λ, μ, κ of the barrier [Pa]
  static constexpr int history = 0;

  template <int Dim, class Real>
  [[nodiscard]] static Matrix<Dim, Real> kirchhoff(
    const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/)
  {
    if constexpr (Dim == 3)
    {
      const StretchInvariants<Real> s = stretchInvariants(F);
      const Matrix<3, Real> square = symmetricProductTransposed(F, F);
      return stress(c, square, leftStretch(square, s), s.first, s.third);
    }
    else
    {
      const Matrix<Dim, Real> v = leftStretch(F);
      return stress(c, productTransposed(F, F), v, trace(v), determinant(F));
    }
  }

  /// @param square F Fᵀ @param first trace of V
  template <int Dim, class Real>
  [[nodiscard]] static Matrix<Dim, Real> stress(
    const Real* c, const Matrix<Dim, Real>& square, const Matrix<Dim, Real>& v, const Real& first, const Real& J)
  {
    const Real ofV = c[0] * (first - static_cast<double>(Dim)) - 2.0 * c[1];
    const Real volume = VolumeBarrier::kirchhoff(c[2], J);
    return symmetric<Dim, Real>(
      [&](int i, int j)
      {
        const Real t = 2.0 * c[1] * square(i, j) + ofV * v(i, j);
        return i == j ? t + volume : t;
      });
  }

  /// The third stretch is 1: what is left are λ and the barrier.
  [[nodiscard]] static double thirdStress(const double* c, const Matrix<2>& F, const Vector<2>& /*axis*/)
  {
    return c[0] * (trace(leftStretch(F)) - 2) + VolumeBarrier::kirchhoff(c[2], determinant(F));
  }

  template <int Dim, class Real>
  [[nodiscard]] static Real energy(const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/)
  {
    const Matrix<Dim, Real> e = lessIdentity(leftStretch(F)); // V has U's invariants
    const Real t = trace(e);
    return c[1] * contraction(e, e) + 0.5 * c[0] * t * t + VolumeBarrier::energy(c[2], determinant(F));
  }

  template <int Dim, class Real>
  [[nodiscard]] static Real stiffness(const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/)
  {
    return (c[0] + 2.0 * c[1]) * greatestStretchSquared(F) + VolumeBarrier::stiffness(c[2], determinant(F));
  }

  /// Stress of a small strain, C : e [Pa].
  template <int Dim, class Real>
  [[nodiscard]] static Matrix<Dim, Real> hooke(
    const Real* c, const Matrix<Dim, Real>& e, const Vector<Dim, Real>& /*axis*/)
  {
    const Real volume = c[0] * trace(e);
    Matrix<Dim, Real> t;
    for (int i = 0; i < Dim * Dim; ++i)
      t.m[i] = 2.0 * c[1] * e.m[i];
    for (int i = 0; i < Dim; ++i)
      t(i, i) = t(i, i) + volume;
    return t;
  }
};

} // namespace lamella::mpm
