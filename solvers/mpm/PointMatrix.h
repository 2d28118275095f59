#pragma once

#include <cmath>

/// Small matrices for the laws of material points. Everything here is inlined into its caller and takes no branch, so
/// that a loop over points vectorises, and so that code compiled for one instruction set never calls that of another.
namespace lamella::mpm
{

#define LAMELLA_POINT_INLINE [[gnu::always_inline]] inline

template <int Dim, class Real>
struct Vector
{
  Real a[Dim];
};

/// By rows: a[row][column].
template <int Dim, class Real>
struct Matrix
{
  Real a[Dim][Dim];
};

template <class Real>
LAMELLA_POINT_INLINE Real determinant(const Matrix<2, Real>& m)
{
  return m.a[0][0] * m.a[1][1] - m.a[0][1] * m.a[1][0];
}

/// det m · m⁻ᵀ.
template <class Real>
LAMELLA_POINT_INLINE Matrix<2, Real> cofactor(const Matrix<2, Real>& m)
{
  return { { { m.a[1][1], -m.a[1][0] }, { -m.a[0][1], m.a[0][0] } } };
}

template <class Real>
LAMELLA_POINT_INLINE Matrix<3, Real> cofactor(const Matrix<3, Real>& m)
{
  const auto& a = m.a;
  return { { { a[1][1] * a[2][2] - a[1][2] * a[2][1], a[1][2] * a[2][0] - a[1][0] * a[2][2],
               a[1][0] * a[2][1] - a[1][1] * a[2][0] },
    { a[2][1] * a[0][2] - a[2][2] * a[0][1], a[2][2] * a[0][0] - a[2][0] * a[0][2],
      a[2][0] * a[0][1] - a[2][1] * a[0][0] },
    { a[0][1] * a[1][2] - a[0][2] * a[1][1], a[0][2] * a[1][0] - a[0][0] * a[1][2],
      a[0][0] * a[1][1] - a[0][1] * a[1][0] } } };
}

template <class Real>
LAMELLA_POINT_INLINE Real determinant(const Matrix<3, Real>& m)
{
  const auto& a = m.a;
  return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) + a[0][1] * (a[1][2] * a[2][0] - a[1][0] * a[2][2]) +
    a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/// m n.
template <int Dim, class Real>
LAMELLA_POINT_INLINE Matrix<Dim, Real> product(const Matrix<Dim, Real>& m, const Matrix<Dim, Real>& n)
{
  Matrix<Dim, Real> r;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
    {
      Real sum = m.a[i][0] * n.a[0][j];
      for (int k = 1; k < Dim; ++k)
        sum += m.a[i][k] * n.a[k][j];
      r.a[i][j] = sum;
    }
  return r;
}

/// mᵀ n.
template <int Dim, class Real>
LAMELLA_POINT_INLINE Matrix<Dim, Real> transposedProduct(const Matrix<Dim, Real>& m, const Matrix<Dim, Real>& n)
{
  Matrix<Dim, Real> r;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
    {
      Real sum = m.a[0][i] * n.a[0][j];
      for (int k = 1; k < Dim; ++k)
        sum += m.a[k][i] * n.a[k][j];
      r.a[i][j] = sum;
    }
  return r;
}

/// m nᵀ.
template <int Dim, class Real>
LAMELLA_POINT_INLINE Matrix<Dim, Real> productTransposed(const Matrix<Dim, Real>& m, const Matrix<Dim, Real>& n)
{
  Matrix<Dim, Real> r;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
    {
      Real sum = m.a[i][0] * n.a[j][0];
      for (int k = 1; k < Dim; ++k)
        sum += m.a[i][k] * n.a[j][k];
      r.a[i][j] = sum;
    }
  return r;
}

template <int Dim, class Real>
LAMELLA_POINT_INLINE Real trace(const Matrix<Dim, Real>& m)
{
  Real sum = m.a[0][0];
  for (int i = 1; i < Dim; ++i)
    sum += m.a[i][i];
  return sum;
}

/// The sum of the products of all entries.
template <int Dim, class Real>
LAMELLA_POINT_INLINE Real contraction(const Matrix<Dim, Real>& m, const Matrix<Dim, Real>& n)
{
  Real sum = 0;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      sum += m.a[i][j] * n.a[i][j];
  return sum;
}

/// m − I.
template <int Dim, class Real>
LAMELLA_POINT_INLINE Matrix<Dim, Real> lessIdentity(Matrix<Dim, Real> m)
{
  for (int i = 0; i < Dim; ++i)
    m.a[i][i] -= 1;
  return m;
}

/// The square of the greatest stretch of F, or a little more in space; exact in a plane, and where two stretches of
/// three are alike and the least.
template <int Dim, class Real>
LAMELLA_POINT_INLINE Real greatestStretchSquared(const Matrix<Dim, Real>& f)
{
  const Matrix<Dim, Real> b = productTransposed(f, f);
  const Real mean = trace(b) * Real(1.0 / Dim);
  const Real rest = contraction(b, b) - Dim * mean * mean; // of the deviator; round-off may leave it below 0
  return mean + std::sqrt(Real((Dim - 1.0) / Dim) * std::abs(rest));
}

/// R of F = R U, R a rotation and U symmetric with positive eigenvalues; closed.
/// @param f with det F > 0
template <class Real>
LAMELLA_POINT_INLINE Matrix<2, Real> rotation(const Matrix<2, Real>& f)
{
  const Real along = f.a[0][0] + f.a[1][1];
  const Real turned = f.a[1][0] - f.a[0][1];
  const Real inverse = 1 / std::sqrt(along * along + turned * turned);
  const Real c = along * inverse;
  const Real s = turned * inverse;
  return { { { c, -s }, { s, c } } };
}

/// The same by Newton's iteration X ← (γX + X⁻ᵀ/γ)/2 (Higham, SIAM J. Sci. Stat. Comput. 7 (1986) 1160), with a
/// fixed number of passes: round-off up to a ratio of 1000 between the greatest and the least stretch.
template <class Real>
LAMELLA_POINT_INLINE Matrix<3, Real> rotation(const Matrix<3, Real>& f)
{
  constexpr int passes = 8;
  Matrix<3, Real> x = f;
  for (int pass = 0; pass < passes; ++pass)
  {
    const Matrix<3, Real> y = cofactor(x);
    const Real inverse = 1 / determinant(x);
    // scaled while far off; the last passes only polish, at γ = 1, which is what the formula then gives
    const Real ratio = std::sqrt(contraction(y, y) / contraction(x, x)) * std::abs(inverse);
    const Real scale = std::sqrt(ratio);
    const Real first = Real(0.5) * scale;
    const Real second = Real(0.5) * inverse / scale;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        x.a[i][j] = first * x.a[i][j] + second * y.a[i][j];
  }
  return x;
}

} // namespace lamella::mpm
