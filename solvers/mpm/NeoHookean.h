#pragma once

#include "mpm/PointLaw.h"

#include <algorithm>
#include <cmath>

namespace lamella::mpm
{

/// A law of a point's material. A law is a struct of static templates over the dimension and the number type, a double
/// or the lanes of a kernel, with no branch on values (kernels work on several points at once; a choice is
/// `select(condition, a, b)`), found by argument-dependent lookup: sqrt, inverseSqrt, log, exp, min, max, select,
/// any.
///
/// - `kind`: by which kernels find it;
/// - `constants`: numbers of a phase, which every function gets as an array c of Real;
/// - `history`: numbers that a point remembers beside F (0 for elastic laws). Where it is not 0 the law also has
///   flow(c, F, axis, history), called once after F was updated, which may change both and knows the stress then; the
///   functions below then take the history as well; and thirdStretch(history), the stretch along a plane's third
///   direction that belongs to F (double only);
/// - kirchhoff: Kirchhoff stress τ = J σ [Pa], symmetric, by rows;
/// - thirdStress: of plane strain, the Kirchhoff stress along the third direction [Pa] (double only);
/// - energy: elastic energy over initial volume [J/m³], whose derivative gives τ exactly;
/// - stiffness: an upper bound of L:(dτ + …):L / |L|² over all velocity gradients L [Pa], for the time step.

/// P = λ ln J F⁻ᵀ + μ (F − F⁻ᵀ): the law of the manufactured solutions; plane strain in 2D. Stress without bound as
/// J → 0, but only as ln J.
struct NeoHookean
{
  static constexpr LawKind kind = LawKind::NeoHookean;
  static constexpr int constants = 2; ///< λ, μ [Pa]
  static constexpr int history = 0;

  template <int Dim, class Real>
  [[nodiscard]] static Matrix<Dim, Real> kirchhoff(
    const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/)
  {
    using std::log;
    Matrix<Dim, Real> tau = productTransposed(F, F);
    const Real pressure = c[0] * log(determinant(F)) - c[1];
    for (int i = 0; i < Dim * Dim; ++i)
      tau.m[i] = c[1] * tau.m[i];
    for (int i = 0; i < Dim; ++i)
      tau(i, i) = tau(i, i) + pressure;
    return tau;
  }

  [[nodiscard]] static double thirdStress(const double* c, const Matrix<2>& F, const Vector<2>& /*axis*/)
  {
    return c[0] * std::log(determinant(F));
  }

  template <int Dim, class Real>
  [[nodiscard]] static Real energy(const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/)
  {
    using std::log;
    const Real l = log(determinant(F));
    Real trace = Real(-static_cast<double>(Dim));
    for (int i = 0; i < Dim * Dim; ++i)
      trace = trace + F.m[i] * F.m[i];
    return 0.5 * (c[0] * l * l + c[1] * (trace - 2.0 * l));
  }

  /// Spatial stiffness λ 1⊗1 + 2 (μ − λ ln J) I plus the largest principal Kirchhoff stress.
  template <int Dim, class Real>
  [[nodiscard]] static Real stiffness(const Real* c, const Matrix<Dim, Real>& F, const Vector<Dim, Real>& /*axis*/)
  {
    using std::abs;
    using std::log;
    using std::max;
    const Real l = log(determinant(F));
    Real stretch(0.0); // λmax(F Fᵀ) ≤ its largest row sum
    const Matrix<Dim, Real> b = productTransposed(F, F);
    for (int i = 0; i < Dim; ++i)
    {
      Real row(0.0);
      for (int j = 0; j < Dim; ++j)
        row = row + abs(b(i, j));
      stretch = max(stretch, row);
    }
    return c[0] * (static_cast<double>(Dim) - l) + c[1] * (1.0 + stretch);
  }
};

} // namespace lamella::mpm
