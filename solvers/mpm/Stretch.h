#pragma once

#include "mpm/Tensor.h"

/// What laws need of a deformation gradient F = R U, R a rotation and U, the stretch, symmetric.
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

/// A matrix that is known to be symmetric: its entries on the diagonal and above are found.
template <int Dim, class Real, class Product>
inline Matrix<Dim, Real> symmetric(Product&& entry)
{
  Matrix<Dim, Real> c;
  for (int i = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j)
    {
      c(i, j) = entry(i, j);
      c(j, i) = c(i, j);
    }
  return c;
}

/// a b, of which it is known that it is symmetric.
template <int Dim, class Real>
inline Matrix<Dim, Real> symmetricProduct(const Matrix<Dim, Real>& a, const Matrix<Dim, Real>& b)
{
  return symmetric<Dim, Real>(
    [&](int i, int j)
    {
      Real sum = a(i, 0) * b(0, j);
      for (int k = 1; k < Dim; ++k)
        sum = sum + a(i, k) * b(k, j);
      return sum;
    });
}

/// aᵀ b, likewise.
template <int Dim, class Real>
inline Matrix<Dim, Real> symmetricTransposedProduct(const Matrix<Dim, Real>& a, const Matrix<Dim, Real>& b)
{
  return symmetric<Dim, Real>(
    [&](int i, int j)
    {
      Real sum = a(0, i) * b(0, j);
      for (int k = 1; k < Dim; ++k)
        sum = sum + a(k, i) * b(k, j);
      return sum;
    });
}

/// a bᵀ, likewise.
template <int Dim, class Real>
inline Matrix<Dim, Real> symmetricProductTransposed(const Matrix<Dim, Real>& a, const Matrix<Dim, Real>& b)
{
  return symmetric<Dim, Real>(
    [&](int i, int j)
    {
      Real sum = a(i, 0) * b(j, 0);
      for (int k = 1; k < Dim; ++k)
        sum = sum + a(i, k) * b(j, k);
      return sum;
    });
}

/// The sum of the products of all entries.
template <int Dim, class Real>
inline Real contraction(const Matrix<Dim, Real>& a, const Matrix<Dim, Real>& b)
{
  Real sum[Dim]; // of rows: short chains of additions
  for (int i = 0; i < Dim; ++i)
  {
    sum[i] = a(i, 0) * b(i, 0);
    for (int j = 1; j < Dim; ++j)
      sum[i] = sum[i] + a(i, j) * b(i, j);
  }
  for (int i = 1; i < Dim; ++i)
    sum[0] = sum[0] + sum[i];
  return sum[0];
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
template <int Dim, class Real>
inline Real greatestStretchSquared(const Matrix<Dim, Real>& F)
{
  using std::abs;
  using std::sqrt;
  constexpr double dimension = Dim;
  const Matrix<Dim, Real> b = productTransposed(F, F);
  const Real mean = (1 / dimension) * trace(b);
  const Real rest = contraction(b, b) - dimension * mean * mean; // of the deviator; round-off may leave it below 0
  return mean + sqrt((dimension - 1) / dimension * abs(rest));
}

/// Of U, in space, with what they were made of.
template <class Real>
struct StretchInvariants
{
  Matrix<3, Real> cofactor; ///< of F
  Real first;               ///< λ₁ + λ₂ + λ₃
  Real second;              ///< λ₁λ₂ + λ₂λ₃ + λ₃λ₁
  Real third;               ///< det F
  Real inverse;             ///< 1 / (first second − third), that is 1 / (λ₁ + λ₂)(λ₂ + λ₃)(λ₃ + λ₁)
};

/// From i₁² = |F|² + 2 i₂ and i₂² = |cof F|² + 2 det F i₁, sums of what is positive: no ratio of the stretches costs
/// digits. Roots in turn from above, i₁ ≤ √3 |F| and i₂ ≤ √3 |cof F|, leave at most a ninth of the relative error, 0.73
/// at worst, and about that of a small one: so an eighth of what they took is still missing, but for the error's
/// square. Newton's steps square it: two are enough for stretches that differ by a tenth, and five for any.
/// @param F with det F > 0
template <class Real>
[[gnu::always_inline]] inline StretchInvariants<Real> stretchInvariants(const Matrix<3, Real>& F)
{
  using std::abs;
  constexpr int mostSteps = 6;
  constexpr double close = 1e-4; // a step from there leaves 10⁻⁸ or so, and the next one round-off
  StretchInvariants<Real> s;
  s.cofactor = cofactor(F);
  const Matrix<3, Real>& y = s.cofactor;
  s.third = F(0, 0) * y(0, 0) + F(0, 1) * y(0, 1) + F(0, 2) * y(0, 2);
  const Real first = contraction(F, F);
  const Real second = contraction(y, y);
  const auto root = [](const Real& x) { return x * roughInverseSqrt(x); };
  const Real most = root(3.0 * second);
  Real i2 = root(second + 2.0 * s.third * root(first + 2.0 * most));
  i2 = i2 - 0.125 * (most - i2);
  Real i1 = root(first + 2.0 * i2);
  const auto newton = [&]
  {
    const Real det = i1 * i2 - s.third;
    const Real rough = roughInverse(det);
    const Real half = rough * (1.0 - 0.5 * det * rough); // of 1/det, to 10⁻⁸
    const Real rest1 = i1 * i1 - (first + 2.0 * i2);
    const Real rest2 = i2 * i2 - (second + 2.0 * s.third * i1);
    const Real change = half * (i1 * rest2 + s.third * rest1);
    i1 = i1 - half * (i2 * rest1 + rest2);
    i2 = i2 - change;
    return abs(change);
  };
  for (int step = 1; any(newton() > close * i2, i2) && step < mostSteps; ++step)
    ;
  newton();
  s.first = i1;
  s.second = i2;
  s.inverse = 1.0 / (i1 * i2 - s.third);
  return s;
}

/// R in space of what is known already.
/// @param square FᵀF
template <class Real>
inline Matrix<3, Real> rotation(
  const Matrix<3, Real>& F, const Matrix<3, Real>& square, const StretchInvariants<Real>& s)
{
  const Real ofCofactor = s.first * s.inverse;
  const Real ofF = (s.first * s.first - s.second) * s.inverse;
  Matrix<3, Real> r = product(F, square);
  for (int i = 0; i < 9; ++i)
    r.m[i] = ofCofactor * s.cofactor.m[i] + ofF * F.m[i] - s.inverse * r.m[i];
  return r;
}

/// R, closed (in space after Hoger and Carlson, Quart. Appl. Math. 42 (1984) 113): i₁ cof F + (i₁² − i₂) F − F FᵀF over
/// i₁ i₂ − i₃. Round-off over the sum of the two least stretches, of which the greatest is 1, as with any method.
/// @param F with det F > 0
template <int Dim, class Real>
inline Matrix<Dim, Real> rotation(const Matrix<Dim, Real>& F)
{
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
    return rotation(F, symmetricTransposedProduct(F, F), stretchInvariants(F));
  }
}

/// V in space of what is known already.
/// @param square F Fᵀ
template <class Real>
inline Matrix<3, Real> leftStretch(const Matrix<3, Real>& square, const StretchInvariants<Real>& s)
{
  const Real ofSquare = (s.first * s.first - s.second) * s.inverse;
  const Real ofIdentity = s.first * s.third * s.inverse;
  const Matrix<3, Real> v = symmetricProduct(square, square);
  return symmetric<3, Real>(
    [&](int i, int j)
    {
      const Real rest = ofSquare * square(i, j) - s.inverse * v(i, j);
      return i == j ? rest + ofIdentity : rest;
    });
}

/// V of F = V R: F Rᵀ, in space as its polynomial of F Fᵀ.
/// @param F with det F > 0
template <int Dim, class Real>
inline Matrix<Dim, Real> leftStretch(const Matrix<Dim, Real>& F)
{
  if constexpr (Dim == 2)
    return productTransposed(F, rotation(F));
  else
    return leftStretch(symmetricProductTransposed(F, F), stretchInvariants(F));
}

} // namespace lamella::mpm
