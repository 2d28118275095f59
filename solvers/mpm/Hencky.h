#pragma once

#include "mpm/PointLaw.h"
#include "mpm/SymmetricEigen.h"
#include "mpm/VolumeBarrier.h"

namespace lamella::mpm
{

/// An isotropic wall that yields (a law with a history, as NeoHookean.h says): F of the point is the elastic part of
/// F = Fe Fp. Hencky's elasticity, J2 flow with linear isotropic hardening, returned radially in logarithmic strains,
/// which keeps the plastic volume exactly (Simo, Comput. Methods Appl. Mech. Eng. 99 (1992) 61; de Souza Neto, Perić
/// and Owen, Computational Methods for Plasticity (2008), box 14.3).
///   ψ = μ Σ εᵢ² + λ/2 (Σ εᵢ)² + barrier(det Fe),   τᵢ = 2μ εᵢ + λ Σ ε + τ_barrier,   ε the logarithms of Fe's
///   stretches, q = √(3/2) |dev τ| ≤ σ_y + H ε̄
/// A plane is one of plane strain, whose elastic strain along the third direction is remembered: plane stress would
/// have to be solved for. Constants from WallMaterial.h.
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
  template <int Dim, class Real>
  static Flow<Dim, Real> flow(const Real* c, Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/, Real* history)
  {
    using std::exp;
    using std::sqrt;
    Principal<Dim, Real> p(F, history);
    const Real mean = (1.0 / 3) * p.sum;
    Vector<Dim, Real> deviator;
    Real square = Real(0.0);
    for (int i = 0; i < Dim; ++i)
    {
      deviator[i] = p.strain[i] - mean;
      square = square + deviator[i] * deviator[i];
    }
    const Real third = p.third - mean;
    if constexpr (Dim == 2)
      square = square + third * third;
    const Real q = 2.0 * c[1] * sqrt(1.5 * square);
    const Real limit = c[3] + c[4] * history[plasticStrain];
    const auto yields = q > limit;
    const bool one = any(yields, q);
    if (one)
    {
      const Real none(0.0);
      const Real amount = select(yields, (q - limit) / (3.0 * c[1] + c[4]), none);
      // what the flow takes from each logarithmic strain is taken from the stretch as a factor
      const Real less = select(yields, 3.0 * c[1] * amount / q, none);
      Vector<Dim, Real> factor;
      for (int i = 0; i < Dim; ++i)
      {
        const Real taken = less * deviator[i];
        factor[i] = exp(-taken) - 1.0;
        p.strain[i] = p.strain[i] - taken;
      }
      const Matrix<Dim, Real> change = product(spectral(factor, p.direction), F);
      for (int i = 0; i < Dim * Dim; ++i)
        F.m[i] = F.m[i] + change.m[i];
      if constexpr (Dim == 2)
        history[thirdStrain] = history[thirdStrain] - less * third;
      history[plasticStrain] = history[plasticStrain] + amount;
      history[plasticWork] = history[plasticWork] + select(yields, (limit + 0.5 * c[4] * amount) * amount, none);
    }
    return { p.kirchhoff(c), one };
  }

  /// @param F Fe, det Fe > 0
  template <int Dim, class Real>
  [[nodiscard]] static Matrix<Dim, Real> kirchhoff(
    const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/, const Real* history)
  {
    return Principal<Dim, Real>(F, history).kirchhoff(c);
  }
  /// Of plane strain: along the third direction.
  [[nodiscard]] static double thirdStress(
    const double* c, const Matrix<2>& F, const Vector<2>& /*axis*/, const double* history)
  {
    const Principal<2, double> p(F, history);
    return 2 * c[1] * p.third + p.all(c);
  }
  [[nodiscard]] static double thirdStretch(const double* history) { return std::exp(history[thirdStrain]); }
  /// The elastic part [J/m³].
  template <int Dim, class Real>
  [[nodiscard]] static Real energy(
    const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/, const Real* history)
  {
    const Principal<Dim, Real> p(F, history);
    Real squares = p.third * p.third;
    for (int i = 0; i < Dim; ++i)
      squares = squares + p.strain[i] * p.strain[i];
    return c[1] * squares + 0.5 * c[0] * p.sum * p.sum + VolumeBarrier::energy(c[2], p.volume());
  }
  template <int Dim, class Real>
  [[nodiscard]] static Real stiffness(
    const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/, const Real* history)
  {
    // a wave along a principal direction: λ + 2μ − τᵢ, since the stretch itself changes what a strain is
    using std::abs;
    using std::max;
    const Principal<Dim, Real> p(F, history);
    const Real sum = c[0] * p.sum;
    Real most = abs(2.0 * c[1] * p.third + sum); // in space of no stretch, where another one has more
    for (int i = 0; i < Dim; ++i)
      most = max(most, abs(2.0 * c[1] * p.strain[i] + sum));
    return c[0] + 2.0 * c[1] + 2.0 * most + VolumeBarrier::stiffness(c[2], p.volume());
  }

private:
  /// Logarithmic elastic strains and their directions: of Fe Feᵀ.
  template <int Dim, class Real>
  struct Principal
  {
    Vector<Dim, Real> strain;
    Matrix<Dim, Real> direction; ///< columns
    Real third{ 0.0 };           ///< strain along a plane's third direction
    Real sum;                    ///< of all three

    [[gnu::always_inline]] Principal(const Matrix<Dim, Real>& F, const Real* history)
    {
      using std::log;
      const SymmetricEigen<Dim, Real> eigen(symmetricProductTransposed(F, F));
      direction = eigen.directions;
      if constexpr (Dim == 2)
        third = history[thirdStrain];
      sum = third;
      for (int i = 0; i < Dim; ++i)
      {
        strain[i] = 0.5 * log(eigen.values[i]);
        sum = sum + strain[i];
      }
    }
    [[nodiscard]] Real volume() const
    {
      using std::exp;
      return exp(sum);
    }
    /// What all principal stresses have in common.
    [[nodiscard]] Real all(const Real* c) const { return c[0] * sum + VolumeBarrier::kirchhoff(c[2], volume()); }
    [[nodiscard]] Matrix<Dim, Real> kirchhoff(const Real* c) const
    {
      const Real common = all(c);
      Vector<Dim, Real> stress;
      for (int i = 0; i < Dim; ++i)
        stress[i] = 2.0 * c[1] * strain[i] + common;
      return spectral(stress, direction);
    }
  };
};

} // namespace lamella::mpm
