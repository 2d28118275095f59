#pragma once

#include <cmath>

/// Small vectors and matrices of numbers or of vectors of lanes. Templates throughout, so that the kernels, compiled
/// for several instruction sets with a number type of their own, share no code with the rest.
namespace lamella::mpm
{

/// 1/√x
[[nodiscard]] inline double inverseSqrt(double x)
{
  return 1.0 / std::sqrt(x);
}

/// 1/x and 1/√x of positive, normal numbers, perhaps only to 10⁻⁴: for where what follows makes good for it.
[[nodiscard]] inline double roughInverse(double x)
{
  return 1.0 / x;
}
[[nodiscard]] inline double roughInverseSqrt(double x)
{
  return 1.0 / std::sqrt(x);
}

/// A comparison of lanes has as many answers: laws go by them so, and not by branches.
[[nodiscard]] inline double select(bool condition, double a, double b)
{
  return condition ? a : b;
}
/// Whether one of the answers is yes. @param alike of the type that was compared
[[nodiscard]] inline bool any(bool condition, double /*alike*/)
{
  return condition;
}

template <int Dim, class Real = double>
struct Vector
{
  Real v[Dim];

  Real& operator[](int i) { return v[i]; }
  const Real& operator[](int i) const { return v[i]; }
};

/// Row by row: m[i * Dim + j] is row i, column j, as the columns of MaterialPoints.
template <int Dim, class Real = double>
struct Matrix
{
  Real m[Dim * Dim];

  Real& operator()(int i, int j) { return m[i * Dim + j]; }
  const Real& operator()(int i, int j) const { return m[i * Dim + j]; }

  [[nodiscard]] static Matrix identity()
  {
    Matrix a;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j)
        a(i, j) = Real(i == j ? 1.0 : 0.0);
    return a;
  }
};

template <int Dim, class Real>
inline Matrix<Dim, Real> product(const Matrix<Dim, Real>& a, const Matrix<Dim, Real>& b)
{
  Matrix<Dim, Real> c;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
    {
      Real sum = a(i, 0) * b(0, j);
      for (int k = 1; k < Dim; ++k)
        sum = sum + a(i, k) * b(k, j);
      c(i, j) = sum;
    }
  return c;
}

/// a bᵀ
template <int Dim, class Real>
inline Matrix<Dim, Real> productTransposed(const Matrix<Dim, Real>& a, const Matrix<Dim, Real>& b)
{
  Matrix<Dim, Real> c;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
    {
      Real sum = a(i, 0) * b(j, 0);
      for (int k = 1; k < Dim; ++k)
        sum = sum + a(i, k) * b(j, k);
      c(i, j) = sum;
    }
  return c;
}

template <int Dim, class Real>
inline Real determinant(const Matrix<Dim, Real>& a)
{
  if constexpr (Dim == 2)
    return a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
  else
    return a(0, 0) * (a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)) - a(0, 1) * (a(1, 0) * a(2, 2) - a(1, 2) * a(2, 0)) +
      a(0, 2) * (a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0));
}

} // namespace lamella::mpm
