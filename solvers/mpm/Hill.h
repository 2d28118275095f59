#pragma once

#include "mpm/Orthotropic.h"
#include "mpm/PointLaw.h"
#include "mpm/SymmetricEigen.h"
#include "mpm/VolumeBarrier.h"

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
/// T : dEp = q dε̄, so that ε̄ is conjugate to the stress along the axis. A plane is one of plane strain. Constants from
/// WallMaterial.h.
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
  template <int Dim, class Real>
  static Flow<Dim, Real> flow(const Real* c, Matrix<Dim, Real>& F, const Vector<Dim, Real>& axis, Real* history)
  {
    const Stretches<Dim, Real> u(F);
    Tensor<Dim, Real> e = u.elastic(history);
    Tensor<Dim, Real> T = hooke(c, e, axis);
    const Modes<Dim, Real> modes(T, axis);
    // q² = Σ part / (1 + rate x)², x = Δε̄/q, as stress over q is what flows: each part is divided by 1 + rate x
    const Real uniaxial = c[0] + 2.0 * c[1] + 2.0 * c[2] + 4.0 * c[3] + c[4]; // C₁₁ − 2 C₁₂ + ½ (C₂₂ + C₂₃)
    const Real ofAcross = 0.5 * (4.0 * c[across] - 1.0);
    const Real ofShear = 0.5 * c[shear];
    const Real parts[3] = { modes.axial * modes.axial, ofAcross * modes.across.square(),
      ofShear * modes.shear.square() };
    const Real rates[3] = { uniaxial - 2.0 * (c[0] + c[2]) + c[0] + c[1], 2.0 * c[1] * ofAcross,
      2.0 * (c[1] + c[3]) * ofShear };
    const Real limit = c[yield] + c[hardening] * history[plasticStrain];
    const auto yields = parts[0] + parts[1] + parts[2] > limit * limit;
    const bool one = any(yields, limit);
    if (one)
    {
      const Real x = flowing(yields, parts, rates, limit, c[hardening]);
      const Real none(0.0); // of lanes that do not, whose limit may be infinite
      const Real amount = select(yields, x * limit / (1.0 - c[hardening] * x), none);
      const Real along = modes.axial * x / (1.0 + rates[0] * x);
      const Real sideways = ofAcross * x / (1.0 + rates[1] * x);
      const Real sliding = ofShear * x / (1.0 + rates[2] * x);
      Tensor<Dim, Real> flowed; // along the axis 1, across it −½; and what the other parts have
      flowed.in = symmetric<Dim, Real>(
        [&](int i, int j)
        {
          const Real f =
            1.5 * along * (axis[i] * axis[j]) + sideways * modes.across.in(i, j) + sliding * modes.shear.in(i, j);
          return i == j ? f - 0.5 * along : f;
        });
      if constexpr (Dim == 2)
        flowed.third = sideways * modes.across.third - 0.5 * along;
      remember(flowed, history);
      history[plasticStrain] = history[plasticStrain] + amount;
      history[plasticWork] =
        history[plasticWork] + select(yields, (limit + 0.5 * c[hardening] * amount) * amount, none);
      e = u.elastic(history);
      T = hooke(c, e, axis);
    }
    return { u.kirchhoff(c, F, T), one };
  }

  template <int Dim, class Real>
  [[nodiscard]] static Matrix<Dim, Real> kirchhoff(
    const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& axis, const Real* history)
  {
    const Stretches<Dim, Real> u(F);
    return u.kirchhoff(c, F, hooke(c, u.elastic(history), axis));
  }
  [[nodiscard]] static double thirdStress(
    const double* c, const Matrix<2>& F, const Vector<2>& axis, const double* history)
  {
    return hooke(c, Stretches<2, double>(F).elastic(history), axis).third +
      VolumeBarrier::kirchhoff(c[barrier], determinant(F));
  }
  /// 1: F has all of the deformation.
  [[nodiscard]] static double thirdStretch(const double* /*history*/) { return 1; }
  /// The elastic part [J/m³].
  template <int Dim, class Real>
  [[nodiscard]] static Real energy(
    const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& axis, const Real* history)
  {
    const Tensor<Dim, Real> e = Stretches<Dim, Real>(F).elastic(history);
    const Tensor<Dim, Real> T = hooke(c, e, axis);
    return 0.5 * (contraction(e.in, T.in) + e.third * T.third) + VolumeBarrier::energy(c[barrier], determinant(F));
  }
  template <int Dim, class Real>
  [[nodiscard]] static Real stiffness(
    const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& axis, const Real* history)
  {
    // as Hencky's: a logarithmic strain changes by no more than the velocity gradient, and stress turns and stretches
    using std::sqrt;
    const Tensor<Dim, Real> T = hooke(c, Stretches<Dim, Real>(F).elastic(history), axis);
    return c[wave] + 2.0 * sqrt(T.square()) + VolumeBarrier::stiffness(c[barrier], determinant(F));
  }

private:
  /// A symmetric one in space: all of it, or its part in a plane and what it has across.
  template <int Dim, class Real>
  struct Tensor
  {
    Matrix<Dim, Real> in;
    Real third{ 0.0 };

    [[nodiscard]] Real square() const { return contraction(in, in) + third * third; }
    [[nodiscard]] Real trace() const { return mpm::trace(in) + third; }
  };

  template <int Dim, class Real>
  [[nodiscard]] static Tensor<Dim, Real> hooke(const Real* c, const Tensor<Dim, Real>& e, const Vector<Dim, Real>& axis)
  {
    Tensor<Dim, Real> T;
    Real all;
    T.in = Orthotropic::hookeInSpace<Dim>(c, e.in, e.trace(), axis, all);
    if constexpr (Dim == 2)
      T.third = 2.0 * c[1] * e.third + all;
    return T;
  }

  /// Where Ep is among what a point remembers.
  template <int Dim>
  [[nodiscard]] static constexpr int placeOf(int i, int j)
  {
    return plasticTensor + (i == j ? i : 5 - i - j); // xx, yy, yz, xz, xy
  }
  template <int Dim, class Real>
  static void remember(const Tensor<Dim, Real>& flowed, Real* history)
  {
    for (int i = 0; i < Dim; ++i)
      for (int j = i; j < Dim; ++j)
        if (i < 2 || j < 2) // that along z follows from the others
          history[placeOf<Dim>(i, j)] = history[placeOf<Dim>(i, j)] + flowed.in(i, j);
  }

  /// Squares of the stretches and their directions before they moved.
  template <int Dim, class Real>
  struct Stretches
  {
    SymmetricEigen<Dim, Real> square;
    Vector<Dim, Real> strain; ///< logarithms of the stretches

    [[gnu::always_inline]] explicit Stretches(const Matrix<Dim, Real>& F)
      : square(symmetricTransposedProduct(F, F))
    {
      using std::log;
      for (int i = 0; i < Dim; ++i)
        strain[i] = 0.5 * log(square.values[i]);
    }
    /// E − Ep.
    [[nodiscard]] Tensor<Dim, Real> elastic(const Real* history) const
    {
      const Matrix<Dim, Real> whole = spectral(strain, square.directions);
      const Real last = history[placeOf<Dim>(0, 0)] + history[placeOf<Dim>(1, 1)]; // −Ep along z
      Tensor<Dim, Real> e;
      e.in = symmetric<Dim, Real>([&](int i, int j)
        { return i == 2 && j == 2 ? whole(i, j) + last : whole(i, j) - history[placeOf<Dim>(i, j)]; });
      if constexpr (Dim == 2)
        e.third = last;
      return e;
    }
    /// On the stretches' directions each component of T : dE is one of T times a divided difference of the logarithm.
    [[nodiscard]] Matrix<Dim, Real> kirchhoff(
      const Real* c, const Matrix<Dim, Real>& F, const Tensor<Dim, Real>& T) const
    {
      const Matrix<Dim, Real>& d = square.directions;
      const Matrix<Dim, Real> own = symmetricTransposedProduct(d, product(T.in, d));
      const Matrix<Dim, Real> on = symmetric<Dim, Real>(
        [&](int i, int j) { return own(i, j) * (i == j ? 1.0 / square.values[i] : divided(i, j)); });
      const Matrix<Dim, Real> moved = product(F, d);
      Matrix<Dim, Real> tau = symmetricProductTransposed(product(moved, on), moved);
      const Real volume = VolumeBarrier::kirchhoff(c[barrier], determinant(F));
      for (int i = 0; i < Dim; ++i)
        tau(i, i) = tau(i, i) + volume;
      return tau;
    }
    /// ln(a/b) / (a − b) of two squares: 2 artanh(z)/z over a + b, z = (a − b)/(a + b), by its series where they are
    /// close, to 4·10⁻²⁰.
    [[nodiscard]] Real divided(int i, int j) const
    {
      const Real apart = square.values[i] - square.values[j];
      const Real inverse = 1.0 / (square.values[i] + square.values[j]);
      const Real z = apart * inverse;
      const Real zz = z * z;
      const auto close = zz < Real(0.0025);
      Real series = Real(1.0 / 13);
      for (int n = 11; n > 0; n -= 2)
        series = series * zz + 1.0 / n;
      return select(close, 2.0 * inverse * series, 2.0 * (strain[i] - strain[j]) / select(close, Real(1.0), apart));
    }
  };

  /// What of T makes it yield falls into three parts that flow on their own: T₁₁ less the mean across; what differs
  /// across the axis; shear along it.
  template <int Dim, class Real>
  struct Modes
  {
    Real axial;               ///< T₁₁ − ½ (T₂₂ + T₃₃)
    Tensor<Dim, Real> across; ///< without mean
    Tensor<Dim, Real> shear;

    [[gnu::always_inline]] Modes(const Tensor<Dim, Real>& T, const Vector<Dim, Real>& a)
    {
      Vector<Dim, Real> onAxis; // T a
      for (int i = 0; i < Dim; ++i)
      {
        onAxis[i] = T.in(i, 0) * a[0];
        for (int j = 1; j < Dim; ++j)
          onAxis[i] = onAxis[i] + T.in(i, j) * a[j];
      }
      Real own = a[0] * onAxis[0];
      for (int i = 1; i < Dim; ++i)
        own = own + a[i] * onAxis[i];
      const Real mean = 0.5 * (T.trace() - own);
      axial = own - mean;
      const auto mixed = [&](int i, int j) { return a[i] * onAxis[j] + onAxis[i] * a[j]; };
      shear.in = symmetric<Dim, Real>([&](int i, int j) { return mixed(i, j) - 2.0 * own * (a[i] * a[j]); });
      across.in = symmetric<Dim, Real>(
        [&](int i, int j)
        {
          const Real t = T.in(i, j) - mixed(i, j) + (own + mean) * (a[i] * a[j]);
          return i == j ? t - mean : t;
        });
      if constexpr (Dim == 2)
        across.third = T.third - mean;
    }
  };

  /// How far it flows: x of (1 − H x) q(x) = limit, q² = Σ part / (1 + rate x)²; 0 of lanes that do not. 1/q is concave
  /// and rises, (1 − H x)/limit falls: Newton's steps from 0 on come closer from below.
  template <class Real, class Answer>
  [[nodiscard]] static Real flowing(
    const Answer& yields, const Real* parts, const Real* rates, const Real& limit, const Real& hardens)
  {
    using std::abs;
    constexpr int mostSteps = 60; // four to six as a rule
    const Real none(0.0);
    const Real bound = 1.0 / limit;
    const Real slope = hardens * bound;
    Real x = none;
    for (int i = 0; i < mostSteps; ++i)
    {
      Real sum = none;
      Real falls = none; // −½ of its derivative
      for (int m = 0; m < 3; ++m)
      {
        const Real share = 1.0 / (1.0 + rates[m] * x);
        const Real part = parts[m] * share * share;
        sum = sum + part;
        falls = falls + part * share * rates[m];
      }
      const Real inverse = inverseSqrt(select(yields, sum, Real(1.0)));
      const Real rest = bound - slope * x - inverse;
      const Real steep = inverse * inverse * inverse * falls + slope;
      x = x + select(yields, rest / steep, none);
      // the next step would change less than round-off does
      if (!any((abs(rest) > 1e-8 * x * steep + 4e-16 * bound) & yields, x))
        break;
    }
    return x;
  }
};

} // namespace lamella::mpm
