#pragma once

#include "mpm/VolumeBarrier.h"

namespace lamella::mpm
{

/// Elasticity of a wall along and across its own axis, for large rotations and displacements, in the stretch U of
/// F = R U: ψ = ½ (U − I) : C : (U − I) + barrier(det F), C fixed to the material. The stress T = C : (U − I) and U
/// need not have the same axes, so that τ is not R T U Rᵀ: with the antisymmetric A that makes (T + A) U symmetric,
///   τ = R (T + A) U Rᵀ + τ_barrier I
/// is the derivative of ψ exactly.
template <int Dim>
struct OrthotropicLaw;

/// In a plane: four stiffnesses, those of plane stress or of plane strain (WallMaterial.h).
template <>
struct OrthotropicLaw<2>
{
  double along = 0;  ///< C₁₁ [Pa], 1 along the axis, 2 across
  double across = 0; ///< C₂₂ [Pa]
  double cross = 0;  ///< C₁₂ [Pa]
  double shear = 0;  ///< G₁₂ [Pa]
  double wave = 0;   ///< the greatest ρ₀ c² of a wave in the unstrained material [Pa]
  VolumeBarrier barrier{};

  /// Kirchhoff stress τ = det F σ [Pa], symmetric.
  /// @param f deformation gradient, det F > 0
  /// @param axis unit vector along the wall before it moved; its sign does not matter
  template <class Real>
  LAMELLA_POINT_INLINE Matrix<2, Real> kirchhoff(const Matrix<2, Real>& f, const Vector<2, Real>& axis) const
  {
    const Stretch<Real> u = stretch(f, axis);
    const Real e1 = u.u11 - 1;
    const Real e2 = u.u22 - 1;
    const Real t1 = Real(along) * e1 + Real(cross) * e2;
    const Real t2 = Real(cross) * e1 + Real(across) * e2;
    const Real t12 = Real(2 * shear) * u.u12;
    // (T + A) U, A = a ((0, 1), (−1, 0)) with a tr U = (U T − T U)₁₂
    const Real a = (u.u11 * t12 + u.u12 * t2 - t1 * u.u12 - t12 * u.u22) * u.inverseTrace;
    const Real y11 = t1 * u.u11 + (t12 + a) * u.u12;
    const Real y12 = t1 * u.u12 + (t12 + a) * u.u22;
    const Real y22 = (t12 - a) * u.u12 + t2 * u.u22;
    const Real cc = u.c * u.c;
    const Real ss = u.s * u.s;
    const Real cs = u.c * u.s;
    const Real volume = barrier.kirchhoff(determinant(f));
    const Real t = cs * (y11 - y22) + (cc - ss) * y12;
    const Real twice = 2 * cs * y12;
    return { { { cc * y11 - twice + ss * y22 + volume, t }, { t, ss * y11 + twice + cc * y22 + volume } } };
  }

  /// ψ [J/m³], per initial volume.
  template <class Real>
  LAMELLA_POINT_INLINE Real energy(const Matrix<2, Real>& f, const Vector<2, Real>& axis) const
  {
    const Stretch<Real> u = stretch(f, axis);
    const Real e1 = u.u11 - 1;
    const Real e2 = u.u22 - 1;
    return Real(0.5) * (Real(along) * e1 * e1 + Real(across) * e2 * e2) + Real(cross) * e1 * e2 +
      Real(2 * shear) * u.u12 * u.u12 + barrier.energy(determinant(f));
  }

  /// Stress of a small strain, C : e [Pa].
  template <class Real>
  LAMELLA_POINT_INLINE Matrix<2, Real> hooke(const Matrix<2, Real>& e, const Vector<2, Real>& axis) const
  {
    const Real cc = axis.a[0] * axis.a[0];
    const Real ss = axis.a[1] * axis.a[1];
    const Real cs = axis.a[0] * axis.a[1];
    const Real twice = 2 * cs * e.a[0][1];
    const Real e1 = cc * e.a[0][0] + twice + ss * e.a[1][1];
    const Real e2 = ss * e.a[0][0] - twice + cc * e.a[1][1];
    const Real t1 = Real(along) * e1 + Real(cross) * e2;
    const Real t2 = Real(cross) * e1 + Real(across) * e2;
    const Real t12 = Real(2 * shear) * (cs * (e.a[1][1] - e.a[0][0]) + (cc - ss) * e.a[0][1]);
    const Real t = cs * (t1 - t2) + (cc - ss) * t12;
    const Real turned = 2 * cs * t12;
    return { { { cc * t1 - turned + ss * t2, t }, { t, ss * t1 + turned + cc * t2 } } };
  }

  /// M with ρ₀ c² ≤ M for every wave in the point as it is [Pa]: of the present, not of the initial lengths.
  template <class Real>
  LAMELLA_POINT_INLINE Real waveModulus(const Matrix<2, Real>& f) const
  {
    return Real(wave) * greatestStretchSquared(f) + barrier.waveModulus(determinant(f));
  }

private:
  // U in the material's axes, and the cosine and sine of the angle by which those have turned from x and y
  template <class Real>
  struct Stretch
  {
    Real u11, u12, u22, c, s, inverseTrace;
  };

  template <class Real>
  LAMELLA_POINT_INLINE static Stretch<Real> stretch(const Matrix<2, Real>& f, const Vector<2, Real>& axis)
  {
    const Real c = axis.a[0];
    const Real s = axis.a[1];
    // F on the material's axes: its columns along and across
    const Real f11 = f.a[0][0] * c + f.a[0][1] * s;
    const Real f12 = f.a[0][1] * c - f.a[0][0] * s;
    const Real f21 = f.a[1][0] * c + f.a[1][1] * s;
    const Real f22 = f.a[1][1] * c - f.a[1][0] * s;
    const Real x = f11 + f22;
    const Real y = f21 - f12;
    Stretch<Real> u;
    u.inverseTrace = 1 / std::sqrt(x * x + y * y); // of U
    u.c = x * u.inverseTrace;
    u.s = y * u.inverseTrace;
    u.u11 = u.c * f11 + u.s * f21;
    u.u12 = u.c * f12 + u.s * f22;
    u.u22 = u.c * f22 - u.s * f12;
    return u;
  }
};

/// In space: five stiffnesses of a material whose directions across the axis are all alike,
///   T = λ tr e I + 2μ e + α ((a·e a) I + tr e a⊗a) + 2δ (a⊗(e a) + (e a)⊗a) + β (a·e a) a⊗a,   e = U − I.
template <>
struct OrthotropicLaw<3>
{
  double lambda = 0; ///< λ [Pa]
  double mu = 0;     ///< μ [Pa], the shear modulus across the axis
  double alpha = 0;  ///< α [Pa]
  double delta = 0;  ///< δ [Pa]: μ + δ is the shear modulus along the axis
  double beta = 0;   ///< β [Pa]
  double wave = 0;   ///< the greatest ρ₀ c² of a wave in the unstrained material [Pa]
  VolumeBarrier barrier{};

  /// As in a plane.
  template <class Real>
  LAMELLA_POINT_INLINE Matrix<3, Real> kirchhoff(const Matrix<3, Real>& f, const Vector<3, Real>& axis) const
  {
    const Matrix<3, Real> r = rotation(f);
    const Matrix<3, Real> u = transposedProduct(r, f);
    const Matrix<3, Real> t = hooke(lessIdentity(u), axis);
    // A, the cross product with w, makes (T + A) U symmetric: (tr U I − U) w = axial vector of U T − T U
    const Matrix<3, Real> tu = product(t, u);
    const Real k0 = tu.a[1][2] - tu.a[2][1];
    const Real k1 = tu.a[2][0] - tu.a[0][2];
    const Real k2 = tu.a[0][1] - tu.a[1][0];
    const Real sum = trace(u);
    const Matrix<3, Real> g{ { { sum - u.a[0][0], -u.a[0][1], -u.a[0][2] }, { -u.a[0][1], sum - u.a[1][1], -u.a[1][2] },
      { -u.a[0][2], -u.a[1][2], sum - u.a[2][2] } } };
    const Matrix<3, Real> c = cofactor(g);
    const Real inverse = 1 / determinant(g);
    const Real w0 = (c.a[0][0] * k0 + c.a[0][1] * k1 + c.a[0][2] * k2) * inverse;
    const Real w1 = (c.a[1][0] * k0 + c.a[1][1] * k1 + c.a[1][2] * k2) * inverse;
    const Real w2 = (c.a[2][0] * k0 + c.a[2][1] * k1 + c.a[2][2] * k2) * inverse;
    const Matrix<3, Real> a{ { { 0, -w2, w1 }, { w2, 0, -w0 }, { -w1, w0, 0 } } };
    Matrix<3, Real> y = product(a, u);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        y.a[i][j] += tu.a[i][j];
    Matrix<3, Real> tau = productTransposed(product(r, y), r);
    const Real volume = barrier.kirchhoff(determinant(f));
    for (int i = 0; i < 3; ++i)
      tau.a[i][i] += volume;
    return tau;
  }

  /// ψ [J/m³], per initial volume.
  template <class Real>
  LAMELLA_POINT_INLINE Real energy(const Matrix<3, Real>& f, const Vector<3, Real>& axis) const
  {
    const Matrix<3, Real> e = lessIdentity(transposedProduct(rotation(f), f));
    return Real(0.5) * contraction(hooke(e, axis), e) + barrier.energy(determinant(f));
  }

  /// Stress of a small strain, C : e [Pa].
  template <class Real>
  LAMELLA_POINT_INLINE Matrix<3, Real> hooke(const Matrix<3, Real>& e, const Vector<3, Real>& axis) const
  {
    const auto& a = axis.a;
    Real ea[3];
    for (int i = 0; i < 3; ++i)
      ea[i] = e.a[i][0] * a[0] + e.a[i][1] * a[1] + e.a[i][2] * a[2];
    const Real aea = a[0] * ea[0] + a[1] * ea[1] + a[2] * ea[2];
    const Real dilation = trace(e);
    const Real all = Real(lambda) * dilation + Real(alpha) * aea;
    const Real own = Real(alpha) * dilation + Real(beta) * aea;
    Matrix<3, Real> t;
    for (int i = 0; i < 3; ++i)
    {
      for (int j = 0; j < 3; ++j)
        t.a[i][j] = Real(2 * mu) * e.a[i][j] + own * a[i] * a[j] + Real(2 * delta) * (a[i] * ea[j] + ea[i] * a[j]);
      t.a[i][i] += all;
    }
    return t;
  }

  /// M with ρ₀ c² ≤ M for every wave in the point as it is [Pa]: of the present, not of the initial lengths.
  template <class Real>
  LAMELLA_POINT_INLINE Real waveModulus(const Matrix<3, Real>& f) const
  {
    return Real(wave) * greatestStretchSquared(f) + barrier.waveModulus(determinant(f));
  }
};

} // namespace lamella::mpm
