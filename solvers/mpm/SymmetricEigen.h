#pragma once

#include "mpm/Stretch.h"

namespace lamella::mpm
{

/// Eigenvalues of a symmetric matrix, in no order, and their directions as columns, by Jacobi's rotations (Golub and
/// Van Loan, Matrix Computations, section 8.5): one in a plane, exactly; in space cyclic, until what is off the
/// diagonal has no digit left in any lane. Alike eigenvalues are as good as others.
template <int Dim, class Real>
struct SymmetricEigen
{
  Vector<Dim, Real> values;
  Matrix<Dim, Real> directions = Matrix<Dim, Real>::identity();

  /// @param m of which what is on the diagonal and above is read
  [[gnu::always_inline]] explicit SymmetricEigen(Matrix<Dim, Real> m)
  {
    if constexpr (Dim == 2)
      rotate<0, 1>(m);
    else
      for (int sweep = 0; sweep < mostSweeps; ++sweep)
      {
        const Real off = m(0, 1) * m(0, 1) + m(0, 2) * m(0, 2) + m(1, 2) * m(1, 2);
        const Real all = m(0, 0) * m(0, 0) + m(1, 1) * m(1, 1) + m(2, 2) * m(2, 2);
        if (!any(off > nothing * all, off)) // nor where one is no number
          break;
        rotate<0, 1>(m);
        rotate<0, 2>(m);
        rotate<1, 2>(m);
      }
    for (int i = 0; i < Dim; ++i)
      values[i] = m(i, i);
  }

private:
  static constexpr int mostSweeps = 10; // four or five are enough, as errors are at least squared in each
  static constexpr double nothing = 1e-33;
  static constexpr double tiny = 1e-150; // whose square is a normal number

  /// The lesser turn of two axes, p < q, that makes m(p, q) vanish, from its double angle's cosine |d|/r.
  template <int P, int Q>
  [[gnu::always_inline]] void rotate(Matrix<Dim, Real>& m)
  {
    using std::abs;
    const Real apart = m(Q, Q) - m(P, P);
    const Real d = abs(apart) + tiny; // so that nothing is turned where both are 0
    const Real twice = 2.0 * m(P, Q);
    const Real h = select(apart < Real(0.0), -twice, twice);
    const Real inverse = inverseSqrt(d * d + h * h);
    const Real square = 0.5 + 0.5 * (d * inverse); // of the cosine
    const Real secant = inverseSqrt(square);
    const Real c = square * secant;
    const Real s = 0.5 * h * inverse * secant;
    const Real change = s * secant * m(P, Q);
    m(P, P) = m(P, P) - change;
    m(Q, Q) = m(Q, Q) + change;
    m(P, Q) = Real(0.0);
    const auto turn = [&](Real& p, Real& q)
    {
      const Real old = p;
      p = c * old - s * q;
      q = s * old + c * q;
    };
    for (int r = 0; r < Dim; ++r)
    {
      if (r != P && r != Q)
        turn(r < P ? m(r, P) : m(P, r), r < Q ? m(r, Q) : m(Q, r));
      turn(directions(r, P), directions(r, Q));
    }
  }
};

/// Σ value direction ⊗ direction, of directions that are columns.
template <int Dim, class Real>
[[gnu::always_inline]] inline Matrix<Dim, Real> spectral(
  const Vector<Dim, Real>& values, const Matrix<Dim, Real>& directions)
{
  Matrix<Dim, Real> scaled;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      scaled(i, j) = directions(i, j) * values[j];
  return symmetricProductTransposed(scaled, directions);
}

} // namespace lamella::mpm
