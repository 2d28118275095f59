#pragma once

// Quadratic splines as polynomials of the place e in a cell, −½ … ½ from its middle node. Only for sources compiled for
// several instruction sets: everything here is local to one object file.
//
// Of nodes v₀, v₁, v₂: v(e) = A₀ + A₁ e + A₂ e², A₀ = (v₀ + 6 v₁ + v₂)/8, A₁ = (v₂ − v₀)/2, A₂ = (v₀ − 2 v₁ + v₂)/2;
// gradient A₁ + 2 e A₂ and affine velocity 4 Σ w (x_i − x) v = A₁ + (3 e − 4 e³) A₂, both over the spacing.

#include "mpm/Tensor.h"
#include "mpm/kernels/Lanes.h"

namespace lamella::mpm
{
namespace
{

template <int Dim>
constexpr int cellNodes = Dim == 2 ? 9 : 27;

/// Place along an axis and what follows from it.
template <class R>
struct CellPlace
{
  R e;
  R square;   // e²
  R gradient; // 2 e
  R affine;   // 3 e − 4 e³

  explicit CellPlace(R at)
    : e(at)
    , square(at * at)
    , gradient(at + at)
    , affine(at * (R(3.0) - R(4.0) * square))
  {
  }
};

using Node = Lanes<4>; // values of a node

template <int Dim>
inline std::int64_t nodeOffset(const std::int64_t* stride, int n)
{
  return n % 3 * stride[0] + n / 3 % 3 * stride[1] + (Dim == 3 ? n / 9 * stride[2] : 0);
}

/// Applies f to the three values along an axis, for every line of them.
template <int Dim, class R, class F>
inline void alongAxis(R* values, int axis, F&& f)
{
  const int step = axis == 0 ? 1 : axis == 1 ? 3 : 9;
  for (int outer = 0; outer < cellNodes<Dim>; outer += 3 * step)
    for (int n = outer; n < outer + step; ++n)
      f(values[n], values[n + step], values[n + 2 * step]);
}

/// @param values of the nodes of a cell, or of several side by side
template <int Dim, class R>
inline void toCoefficients(R* values)
{
  for (int axis = 0; axis < Dim; ++axis)
    alongAxis<Dim>(
      values, axis,
      [](R& a, R& b, R& c)
      {
        const R ends = 0.5 * (a + c);
        const R first = 0.5 * (c - a);
        c = ends - b;
        a = 0.75 * b + 0.25 * ends;
        b = first;
      });
}

/// The transpose: from moments to what the nodes get.
template <int Dim, class R>
inline void toNodes(R* moments)
{
  for (int axis = 0; axis < Dim; ++axis)
    alongAxis<Dim>(
      moments, axis,
      [](R& a, R& b, R& c)
      {
        const R ends = 0.125 * a + 0.5 * c;
        const R half = 0.5 * b;
        b = 0.75 * a - c;
        a = ends - half;
        c = ends + half;
      });
}

/// A component's value, gradient and affine velocity, the latter two still to be divided by the spacings.
template <int Dim, class R>
struct Evaluated
{
  R value;
  R gradient[Dim];
  R affine[Dim];
};

/// @param coefficient coefficient(n) of this component, for every lane that of its cell
template <int Dim, class R, class F>
inline Evaluated<Dim, R> evaluate(F&& coefficient, const CellPlace<R>* at)
{
  Evaluated<Dim, R> plane[Dim == 3 ? 3 : 1];
  for (int z = 0; z < (Dim == 3 ? 3 : 1); ++z)
  {
    R value[3];
    R gradient[3];
    R affine[3];
    for (int y = 0; y < 3; ++y)
    {
      const int n = z * 9 + y * 3;
      const R first = coefficient(n + 1);
      const R second = coefficient(n + 2);
      value[y] = coefficient(n) + at[0].e * (first + at[0].e * second);
      gradient[y] = first + at[0].gradient * second;
      affine[y] = first + at[0].affine * second;
    }
    const auto horner = [&](const R* c) { return c[0] + at[1].e * (c[1] + at[1].e * c[2]); };
    Evaluated<Dim, R>& p = plane[z];
    p.value = horner(value);
    p.gradient[0] = horner(gradient);
    p.affine[0] = horner(affine);
    p.gradient[1] = value[1] + at[1].gradient * value[2];
    p.affine[1] = value[1] + at[1].affine * value[2];
  }
  if constexpr (Dim == 2)
    return plane[0];
  else
  {
    Evaluated<Dim, R> r;
    const auto horner = [&](R a, R b, R c) { return a + at[2].e * (b + at[2].e * c); };
    r.value = horner(plane[0].value, plane[1].value, plane[2].value);
    for (int a = 0; a < 2; ++a)
    {
      r.gradient[a] = horner(plane[0].gradient[a], plane[1].gradient[a], plane[2].gradient[a]);
      r.affine[a] = horner(plane[0].affine[a], plane[1].affine[a], plane[2].affine[a]);
    }
    r.gradient[2] = plane[1].value + at[2].gradient * plane[2].value;
    r.affine[2] = plane[1].value + at[2].affine * plane[2].value;
    return r;
  }
}

/// Adds the transpose of evaluate() to the moments: value × value's row + gradient[k] × gradient's row + ….
template <int Dim, class R>
inline void addMoments(R* moments, const CellPlace<R>* at, R value, const R* gradient, const R* affine)
{
  const R x[3] = { value, value * at[0].e + (gradient[0] + affine[0]),
    value * at[0].square + (gradient[0] * at[0].gradient + affine[0] * at[0].affine) };
  const R y1 = gradient[1] + affine[1];
  const R y2 = gradient[1] * at[1].gradient + affine[1] * at[1].affine;
  const R xy[9] = { x[0], x[1], x[2], x[0] * at[1].e + y1, x[1] * at[1].e + at[0].e * y1,
    x[2] * at[1].e + at[0].square * y1, x[0] * at[1].square + y2, x[1] * at[1].square + at[0].e * y2,
    x[2] * at[1].square + at[0].square * y2 };
  for (int n = 0; n < 9; ++n)
    moments[n] = moments[n] + xy[n];
  if constexpr (Dim == 3)
  {
    const R z1 = gradient[2] + affine[2];
    const R z2 = gradient[2] * at[2].gradient + affine[2] * at[2].affine;
    const R px[3] = { R(1.0), at[0].e, at[0].square };
    const R py[3] = { R(1.0), at[1].e, at[1].square };
    for (int n = 0; n < 9; ++n)
    {
      const R p = px[n % 3] * py[n / 3];
      moments[9 + n] = moments[9 + n] + xy[n] * at[2].e + p * z1;
      moments[18 + n] = moments[18 + n] + xy[n] * at[2].square + p * z2;
    }
  }
}

/// Of a quantity that only has a value.
template <int Dim, class R>
inline void addMoments(R* moments, const CellPlace<R>* at, R value)
{
  const R z[3] = { value, Dim == 3 ? value * at[Dim - 1].e : value, Dim == 3 ? value * at[Dim - 1].square : value };
  for (int k = 0; k < (Dim == 3 ? 3 : 1); ++k)
  {
    const R row[3] = { z[k], z[k] * at[1].e, z[k] * at[1].square };
    for (int j = 0; j < 3; ++j)
    {
      R* m = moments + 9 * k + 3 * j;
      m[0] = m[0] + row[j];
      m[1] = m[1] + row[j] * at[0].e;
      m[2] = m[2] + row[j] * at[0].square;
    }
  }
}

/// The same two of every four lanes of a, and then of b: picks 0 and 2, or 1 and 3, crosswise.
template <int N, class T>
inline Lanes<N, T> paired(Lanes<N, T> a, Lanes<N, T> b)
{
  if constexpr (N == 4)
    return __builtin_shufflevector(a.v, b.v, 0, 4, 2, 6) + __builtin_shufflevector(a.v, b.v, 1, 5, 3, 7);
  else if constexpr (N == 8)
    return __builtin_shufflevector(a.v, b.v, 0, 8, 2, 10, 4, 12, 6, 14) +
      __builtin_shufflevector(a.v, b.v, 1, 9, 3, 11, 5, 13, 7, 15);
  else
    return __builtin_shufflevector(a.v, b.v, 0, 16, 2, 18, 4, 20, 6, 22, 8, 24, 10, 26, 12, 28, 14, 30) +
      __builtin_shufflevector(a.v, b.v, 1, 17, 3, 19, 5, 21, 7, 23, 9, 25, 11, 27, 13, 29, 15, 31);
}

/// The sums over the lanes of every cell, next to each other: four of them a cell.
template <int N, int Cells, class T>
inline Lanes<4 * Cells, T> sums(Lanes<N, T> a, Lanes<N, T> b, Lanes<N, T> c, Lanes<N, T> d)
{
  static_assert(N == 4 * Cells || (N == 2 && Cells == 1));
  if constexpr (N == 2)
  {
    Node s;
    s.v = Node::V{ a.v[0] + a.v[1], b.v[0] + b.v[1], c.v[0] + c.v[1], d.v[0] + d.v[1] };
    return s;
  }
  else
  {
    const auto ab = paired(a, b).v;
    const auto cd = paired(c, d).v;
    if constexpr (N == 4)
      return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    else if constexpr (N == 8)
      return __builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13) +
        __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15);
    else
      return __builtin_shufflevector(ab, cd, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29) +
        __builtin_shufflevector(ab, cd, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
  }
}

/// One of the four values of every cell, in all lanes of that cell.
template <int N, int Cells, class T>
inline Lanes<N, T> spread(const T* values, int which)
{
  if constexpr (Cells == 1)
    return Lanes<N, T>(values[which]);
  else
  {
    const auto v = Lanes<N, T>::load(values).v;
    if constexpr (N == 8)
      return which == 0 ? __builtin_shufflevector(v, v, 0, 0, 0, 0, 4, 4, 4, 4)
        : which == 1    ? __builtin_shufflevector(v, v, 1, 1, 1, 1, 5, 5, 5, 5)
        : which == 2    ? __builtin_shufflevector(v, v, 2, 2, 2, 2, 6, 6, 6, 6)
                        : __builtin_shufflevector(v, v, 3, 3, 3, 3, 7, 7, 7, 7);
    else
      return which == 0 ? __builtin_shufflevector(v, v, 0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12)
        : which == 1    ? __builtin_shufflevector(v, v, 1, 1, 1, 1, 5, 5, 5, 5, 9, 9, 9, 9, 13, 13, 13, 13)
        : which == 2    ? __builtin_shufflevector(v, v, 2, 2, 2, 2, 6, 6, 6, 6, 10, 10, 10, 10, 14, 14, 14, 14)
                        : __builtin_shufflevector(v, v, 3, 3, 3, 3, 7, 7, 7, 7, 11, 11, 11, 11, 15, 15, 15, 15);
  }
}

} // namespace
} // namespace lamella::mpm
