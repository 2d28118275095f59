#pragma once

#include "mpm/Tensor.h"

/// What laws need of a deformation gradient F = R U, R a rotation and U, the stretch, symmetric. No branch on values.
namespace lamella::mpm
{

/// det m · m⁻ᵀ.
template <int Dim, class Real>
inline Matrix<Dim, Real> cofactor(const Matrix<Dim, Real>& m)
{
  if constexpr (Dim == 2)
    return { { m(1, 1), -m(1, 0), -m(0, 1), m(0, 0) } };
  else
    return { { m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1), m(1, 2) * m(2, 0) - m(1, 0) * m(2, 2),
      m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0), m(2, 1) * m(0, 2) - m(2, 2) * m(0, 1),
      m(2, 2) * m(0, 0) - m(2, 0) * m(0, 2), m(2, 0) * m(0, 1) - m(2, 1) * m(0, 0),
      m(0, 1) * m(1, 2) - m(0, 2) * m(1, 1), m(0, 2) * m(1, 0) - m(0, 0) * m(1, 2),
      m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0) } };
}

/// aᵀ b
template <int Dim, class Real>
inline Matrix<Dim, Real> transposedProduct(const Matrix<Dim, Real>& a, const Matrix<Dim, Real>& b)
{
  Matrix<Dim, Real> c;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
    {
      Real sum = a(0, i) * b(0, j);
      for (int k = 1; k < Dim; ++k)
        sum = sum + a(k, i) * b(k, j);
      c(i, j) = sum;
    }
  return c;
}

template <int Dim, class Real>
inline Real trace(const Matrix<Dim, Real>& m)
{
  Real sum = m(0, 0);
  for (int i = 1; i < Dim; ++i)
    sum = sum + m(i, i);
  return sum;
}

/// The sum of the products of all entries.
template <int Dim, class Real>
inline Real contraction(const Matrix<Dim, Real>& a, const Matrix<Dim, Real>& b)
{
  Real sum = a.m[0] * b.m[0];
  for (int i = 1; i < Dim * Dim; ++i)
    sum = sum + a.m[i] * b.m[i];
  return sum;
}

/// m − I.
template <int Dim, class Real>
inline Matrix<Dim, Real> lessIdentity(Matrix<Dim, Real> m)
{
  for (int i = 0; i < Dim; ++i)
    m(i, i) = m(i, i) - 1.0;
  return m;
}

/// The square of the greatest stretch of F, or a little more in space; exact in a plane, and where two stretches of
/// three are alike and the least.
template <int Dim>
inline double greatestStretchSquared(const Matrix<Dim>& F)
{
  const Matrix<Dim> b = productTransposed(F, F);
  const double mean = trace(b) / Dim;
  const double rest = contraction(b, b) - Dim * mean * mean; // of the deviator; round-off may leave it below 0
  return mean + std::sqrt((Dim - 1.0) / Dim * std::fabs(rest));
}

/// R. In a plane closed; in space by Newton's iteration X ← (γX + X⁻ᵀ/γ)/2 (Higham, SIAM J. Sci. Stat. Comput. 7 (1986)
/// 1160) with a fixed number of passes, which reach round-off up to a ratio of 1000 between the greatest and the least
/// stretch.
/// @param F with det F > 0
template <int Dim, class Real>
inline Matrix<Dim, Real> rotation(const Matrix<Dim, Real>& F)
{
  using std::abs;
  using std::sqrt;
  if constexpr (Dim == 2)
  {
    const Real x = F(0, 0) + F(1, 1);
    const Real y = F(1, 0) - F(0, 1);
    const Real inverse = inverseSqrt(x * x + y * y);
    const Real c = x * inverse;
    const Real s = y * inverse;
    return { { c, -s, s, c } };
  }
  else
  {
    Matrix<3, Real> x = F;
    const auto pass = [&x](const Real& first, const Real& second, const Matrix<3, Real>& y)
    {
      for (int i = 0; i < 9; ++i)
        x.m[i] = first * x.m[i] + second * y.m[i];
    };
    for (int scaled = 0; scaled < 3; ++scaled)
    {
      const Matrix<3, Real> y = cofactor(x);
      const Real inverse = 1.0 / determinant(x);
      const Real scale = sqrt(sqrt(contraction(y, y) / contraction(x, x)) * abs(inverse));
      pass(0.5 * scale, 0.5 * inverse / scale, y);
    }
    for (int polish = 0; polish < 3; ++polish) // γ = 1 but for what no longer matters
    {
      const Matrix<3, Real> y = cofactor(x);
      pass(Real(0.5), 0.5 / determinant(x), y);
    }
    return x;
  }
}

} // namespace lamella::mpm
