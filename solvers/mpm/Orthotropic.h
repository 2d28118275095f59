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
    if constexpr (Dim == 2)
      return inPlane(c, F, axis, VolumeBarrier::kirchhoff(c[barrier], determinant(F)));
    else
      return inSpace(c, F, axis);
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

  template <int Dim, class Real>
  [[nodiscard]] static Real stiffness(const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/)
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
      Real all;
      return hookeInSpace<3>(c, e, trace(e), axis, all);
    }
  }

  /// The same with the constants of space.
  /// @param e strain in the plane of the first Dim directions, to which the axis belongs, as no shear leads out of it
  /// @param dilation of all three directions
  /// @param all is set to what the stress along all three has of the dilation and the strain along the axis: along a
  /// direction across the plane it is that and 2μ times the strain along it
  template <int Dim, class Real>
  [[nodiscard]] static Matrix<Dim, Real> hookeInSpace(
    const Real* c, const Matrix<Dim, Real>& e, const Real& dilation, const Vector<Dim, Real>& axis, Real& all)
  {
    Real ea[Dim];
    for (int i = 0; i < Dim; ++i)
    {
      ea[i] = e(i, 0) * axis[0];
      for (int j = 1; j < Dim; ++j)
        ea[i] = ea[i] + e(i, j) * axis[j];
    }
    Real aea = axis[0] * ea[0];
    for (int i = 1; i < Dim; ++i)
      aea = aea + axis[i] * ea[i];
    all = c[0] * dilation + c[2] * aea;
    const Real own = c[2] * dilation + c[4] * aea;
    Real b[Dim]; // a⊗b + b⊗a has all that the axis adds
    for (int i = 0; i < Dim; ++i)
      b[i] = 0.5 * own * axis[i] + 2.0 * c[3] * ea[i];
    return symmetric<Dim, Real>(
      [&](int i, int j)
      {
        const Real t = 2.0 * c[1] * e(i, j) + axis[i] * b[j] + b[i] * axis[j];
        return i == j ? t + all : t;
      });
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
  [[nodiscard]] static Matrix<3, Real> inSpace(const Real* k, const Matrix<3, Real>& F, const Vector<3, Real>& axis)
  {
    const StretchInvariants<Real> s = stretchInvariants(F);
    const Matrix<3, Real> square = symmetricTransposedProduct(F, F);
    const Matrix<3, Real> r = rotation(F, square, s);
    const Matrix<3, Real> u = symmetricTransposedProduct(r, F);
    Matrix<3, Real> t = hooke(k, lessIdentity(u), axis);
    // A, the cross product with w, makes (T + A) U symmetric: (tr U I − U) w = axial vector x of U T − T U. The inverse
    // is (U² + i₂ I) / (i₁ i₂ − i₃)
    const auto skew = [&](int i, int j)
    {
      Real sum = t(i, 0) * u(0, j) - u(i, 0) * t(0, j);
      for (int n = 1; n < 3; ++n)
        sum = sum + t(i, n) * u(n, j) - u(i, n) * t(n, j);
      return sum;
    };
    const Real x[3] = { skew(1, 2), skew(2, 0), skew(0, 1) };
    Real w[3];
    for (int i = 0; i < 3; ++i)
      w[i] = (square(i, 0) * x[0] + square(i, 1) * x[1] + square(i, 2) * x[2] + s.second * x[i]) * s.inverse;
    t(0, 1) = t(0, 1) - w[2];
    t(0, 2) = t(0, 2) + w[1];
    t(1, 0) = t(1, 0) + w[2];
    t(1, 2) = t(1, 2) - w[0];
    t(2, 0) = t(2, 0) - w[1];
    t(2, 1) = t(2, 1) + w[0];
    Matrix<3, Real> tau = symmetricProductTransposed(product(r, t), F); // U Rᵀ = Fᵀ
    const Real volume = VolumeBarrier::kirchhoff(k[barrier], s.third);
    for (int i = 0; i < 3; ++i)
      tau(i, i) = tau(i, i) + volume;
    return tau;
  }
};

} // namespace lamella::mpm
