#pragma once

#include "mpm/PointLaw.h"
#include "mpm/Stretch.h"
#include "mpm/VolumeBarrier.h"

namespace lamella::mpm
{

/// Elasticity of a wall along and across its own axis, for large rotations and displacements (a law as NeoHookean.h
/// says), in the stretch U of F = R U: ψ = ½ (U − I) : C : (U − I) + barrier(det F), C fixed to the material. The
/// stress T = C : (U − I) and U need not have the same axes, so that τ is not R T U Rᵀ: with the antisymmetric A that
/// makes (T + A) U symmetric,
///   τ = R (T + A) U Rᵀ + τ_barrier I
/// is the derivative of ψ exactly. `axis` is the unit vector along the wall before it moved; its sign does not matter.
///
/// In a plane C has four constants, those of plane stress or plane strain. In space all directions across the axis a
/// are alike:
///   T = λ tr e I + 2μ e + α ((a·e a) I + tr e a⊗a) + 2δ (a⊗(e a) + (e a)⊗a) + β (a·e a) a⊗a,   e = U − I.
/// Constants from WallMaterial.h.
struct Orthotropic
{
  static constexpr LawKind kind = LawKind::Orthotropic;
  /// [Pa] In a plane C₁₁ (along the axis), C₂₂, C₁₂ (= C₁₃), G₁₂, C₂₃; in space λ, μ, α, δ, β. Then the greatest ρ₀c²
  /// of a wave in the unstrained material, and κ of the barrier.
  static constexpr int constants = 7;
  static constexpr int wave = 5;
  static constexpr int barrier = 6;
  static constexpr int history = 0;

  template <int Dim, class Real>
  [[nodiscard]] static Matrix<Dim, Real> kirchhoff(
    const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& axis)
  {
    const Real volume = VolumeBarrier::kirchhoff(c[barrier], determinant(F));
    if constexpr (Dim == 2)
      return inPlane(c, F, axis, volume);
    else
      return inSpace(c, F, axis, volume);
  }

  /// The third stretch is 1, so R does not turn it: C₁₃ e₁₁ + C₂₃ e₂₂ on the wall's axes, and the barrier.
  [[nodiscard]] static double thirdStress(const double* c, const Matrix<2>& F, const Vector<2>& axis)
  {
    const Matrix<2> e = lessIdentity(transposedProduct(rotation(F), F));
    const double along = axis[0] * axis[0] * e(0, 0) + 2 * axis[0] * axis[1] * e(0, 1) + axis[1] * axis[1] * e(1, 1);
    return c[2] * along + c[4] * (trace(e) - along) + VolumeBarrier::kirchhoff(c[barrier], determinant(F));
  }

  template <int Dim, class Real>
  [[nodiscard]] static Real energy(const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& axis)
  {
    const Matrix<Dim, Real> e = lessIdentity(transposedProduct(rotation(F), F));
    return 0.5 * contraction(hooke(c, e, axis), e) + VolumeBarrier::energy(c[barrier], determinant(F));
  }

  template <int Dim>
  [[nodiscard]] static double stiffness(const double* c, const Matrix<Dim>& F, const Vector<Dim>& /*axis*/)
  {
    return c[wave] * greatestStretchSquared(F) + VolumeBarrier::stiffness(c[barrier], determinant(F));
  }

  /// Stress of a small strain, C : e [Pa].
  template <int Dim, class Real>
  [[nodiscard]] static Matrix<Dim, Real> hooke(const Real* c, const Matrix<Dim, Real>& e, const Vector<Dim, Real>& axis)
  {
    if constexpr (Dim == 2)
    {
      const Real cc = axis[0] * axis[0];
      const Real ss = axis[1] * axis[1];
      const Real cs = axis[0] * axis[1];
      const Real turn = cc - ss;
      const Real twice = 2.0 * cs * e(0, 1);
      const Real e1 = cc * e(0, 0) + twice + ss * e(1, 1);
      const Real e2 = ss * e(0, 0) - twice + cc * e(1, 1);
      const Real t1 = c[0] * e1 + c[2] * e2;
      const Real t2 = c[2] * e1 + c[1] * e2;
      const Real t12 = 2.0 * c[3] * (cs * (e(1, 1) - e(0, 0)) + turn * e(0, 1));
      const Real t = cs * (t1 - t2) + turn * t12;
      const Real back = 2.0 * cs * t12;
      return { { cc * t1 - back + ss * t2, t, t, ss * t1 + back + cc * t2 } };
    }
    else
    {
      Real ea[3];
      for (int i = 0; i < 3; ++i)
        ea[i] = e(i, 0) * axis[0] + e(i, 1) * axis[1] + e(i, 2) * axis[2];
      const Real aea = axis[0] * ea[0] + axis[1] * ea[1] + axis[2] * ea[2];
      const Real dilation = trace(e);
      const Real all = c[0] * dilation + c[2] * aea;
      const Real own = c[2] * dilation + c[4] * aea;
      Matrix<3, Real> t;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          t(i, j) = 2.0 * c[1] * e(i, j) + own * axis[i] * axis[j] + 2.0 * c[3] * (axis[i] * ea[j] + ea[i] * axis[j]);
      for (int i = 0; i < 3; ++i)
        t(i, i) = t(i, i) + all;
      return t;
    }
  }

private:
  template <class Real>
  [[nodiscard]] static Matrix<2, Real> inPlane(
    const Real* k, const Matrix<2, Real>& F, const Vector<2, Real>& axis, const Real& volume)
  {
    // F on the material's axes, its columns along and across; R then turns from those to the present
    const Real f11 = F(0, 0) * axis[0] + F(0, 1) * axis[1];
    const Real f12 = F(0, 1) * axis[0] - F(0, 0) * axis[1];
    const Real f21 = F(1, 0) * axis[0] + F(1, 1) * axis[1];
    const Real f22 = F(1, 1) * axis[0] - F(1, 0) * axis[1];
    const Real x = f11 + f22;
    const Real y = f21 - f12;
    const Real inverse = inverseSqrt(x * x + y * y); // of tr U
    const Real c = x * inverse;
    const Real s = y * inverse;
    const Real u11 = c * f11 + s * f21;
    const Real u12 = c * f12 + s * f22;
    const Real u22 = c * f22 - s * f12;
    const Real e1 = u11 - 1.0;
    const Real e2 = u22 - 1.0;
    const Real t1 = k[0] * e1 + k[2] * e2;
    const Real t2 = k[2] * e1 + k[1] * e2;
    const Real t12 = 2.0 * k[3] * u12;
    // A = a ((0, 1), (−1, 0)) with a tr U = (U T − T U)₁₂
    const Real a = ((u11 - u22) * t12 + u12 * (t2 - t1)) * inverse;
    const Real y11 = t1 * u11 + (t12 + a) * u12;
    const Real y12 = t1 * u12 + (t12 + a) * u22;
    const Real y22 = (t12 - a) * u12 + t2 * u22;
    const Real cc = c * c;
    const Real ss = s * s;
    const Real cs = c * s;
    const Real t = cs * (y11 - y22) + (cc - ss) * y12;
    const Real twice = 2.0 * cs * y12;
    return { { cc * y11 - twice + ss * y22 + volume, t, t, ss * y11 + twice + cc * y22 + volume } };
  }

  template <class Real>
  [[nodiscard]] static Matrix<3, Real> inSpace(
    const Real* k, const Matrix<3, Real>& F, const Vector<3, Real>& axis, const Real& volume)
  {
    const Matrix<3, Real> r = rotation(F);
    const Matrix<3, Real> u = transposedProduct(r, F);
    const Matrix<3, Real> t = hooke(k, lessIdentity(u), axis);
    // A, the cross product with w, makes (T + A) U symmetric: (tr U I − U) w = axial vector of U T − T U
    Matrix<3, Real> y = product(t, u);
    const Real x0 = y(1, 2) - y(2, 1);
    const Real x1 = y(2, 0) - y(0, 2);
    const Real x2 = y(0, 1) - y(1, 0);
    Matrix<3, Real> g;
    for (int i = 0; i < 9; ++i)
      g.m[i] = -u.m[i];
    for (int i = 0; i < 3; ++i)
      g(i, i) = g(i, i) + trace(u);
    const Matrix<3, Real> inverse = cofactor(g); // times det g
    const Real scale = 1.0 / determinant(g);
    Real w[3];
    for (int i = 0; i < 3; ++i)
      w[i] = (inverse(i, 0) * x0 + inverse(i, 1) * x1 + inverse(i, 2) * x2) * scale;
    for (int j = 0; j < 3; ++j)
    {
      y(0, j) = y(0, j) + w[1] * u(2, j) - w[2] * u(1, j);
      y(1, j) = y(1, j) + w[2] * u(0, j) - w[0] * u(2, j);
      y(2, j) = y(2, j) + w[0] * u(1, j) - w[1] * u(0, j);
    }
    Matrix<3, Real> tau = productTransposed(product(r, y), r);
    for (int i = 0; i < 3; ++i)
      tau(i, i) = tau(i, i) + volume;
    return tau;
  }
};

} // namespace lamella::mpm
