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

/// Lines of nodes along x that a cell has, y fastest: planes of nodes across x have as many nodes.
template <int Dim>
constexpr int cellLines = cellNodes<Dim> / 3;

/// From the values of three nodes to the powers' coefficients.
template <class R>
inline void toPowers(R& a, R& b, R& c)
{
  const R ends = 0.5 * (a + c);
  const R first = 0.5 * (c - a);
  c = ends - b;
  a = 0.75 * b + 0.25 * ends;
  b = first;
}

/// The transpose: from the powers' moments to what the nodes get.
template <class R>
inline void fromPowers(R& a, R& b, R& c)
{
  const R ends = 0.125 * a + 0.5 * c;
  const R half = 0.5 * b;
  b = 0.75 * a - c;
  a = ends - half;
  c = ends + half;
}

/// Applies f to three values along y, and then along z, of a plane of nodes across x.
template <int Dim, class R, class F>
inline void acrossRow(R* plane, F&& f)
{
#pragma GCC unroll 3
  for (int z = 0; z < cellLines<Dim> / 3; ++z)
    f(plane[3 * z], plane[3 * z + 1], plane[3 * z + 2]);
  if constexpr (Dim == 3)
  {
#pragma GCC unroll 3
    for (int y = 0; y < 3; ++y)
      f(plane[y], plane[y + 3], plane[y + 6]);
  }
}

/// A component's value, gradient and affine velocity, the latter two still to be divided by the spacings.
template <int Dim, class R>
struct Evaluated
{
  R value;
  R gradient[Dim];
  R affine[Dim];
};

/// In a plane z of coefficients across z: of the axes x and y only.
/// @param coefficient coefficient(n) of this component, for every lane that of its cell
template <class R, int Dim, class F>
[[gnu::always_inline]] inline void evaluatePlane(F&& coefficient, const CellPlace<R>* at, int z, Evaluated<Dim, R>& r)
{
  R value[3];
  R gradient[3];
  R affine[3];
#pragma GCC unroll 3
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
  r.value = horner(value);
  r.gradient[0] = horner(gradient);
  r.affine[0] = horner(affine);
  r.gradient[1] = value[1] + at[1].gradient * value[2];
  r.affine[1] = value[1] + at[1].affine * value[2];
}

template <int Dim, class R, class F>
[[gnu::always_inline]] inline Evaluated<Dim, R> evaluate(F&& coefficient, const CellPlace<R>* at)
{
  Evaluated<Dim, R> r;
  if constexpr (Dim == 2)
    evaluatePlane<R>(coefficient, at, 0, r);
  else
  {
    // Horner's scheme along z goes with the planes, from the last one on: few numbers are held at a time
    evaluatePlane<R>(coefficient, at, 2, r);
    r.gradient[2] = at[2].gradient * r.value;
    r.affine[2] = at[2].affine * r.value;
#pragma GCC unroll 2
    for (int z = 1; z >= 0; --z)
    {
      Evaluated<Dim, R> plane;
      evaluatePlane<R>(coefficient, at, z, plane);
      if (z == 1)
      {
        r.gradient[2] = r.gradient[2] + plane.value;
        r.affine[2] = r.affine[2] + plane.value;
      }
      r.value = plane.value + at[2].e * r.value;
#pragma GCC unroll 2
      for (int a = 0; a < 2; ++a)
      {
        r.gradient[a] = plane.gradient[a] + at[2].e * r.gradient[a];
        r.affine[a] = plane.affine[a] + at[2].e * r.affine[a];
      }
    }
  }
  return r;
}

/// Adds to a moment, or begins it.
template <bool Fresh, class R>
inline void add(R& moment, const R& value)
{
  if constexpr (Fresh)
    moment = value;
  else
    moment = moment + value;
}

/// Adds the transpose of evaluate() to the moments: value × value's row + gradient[k] × gradient's row + ….
/// @tparam Fresh whether there is nothing in the moments yet
template <int Dim, bool Fresh, class R>
[[gnu::always_inline]] inline void addMoments(
  R* moments, const CellPlace<R>* at, R value, const R* gradient, const R* affine)
{
  const R x[3] = { value, value * at[0].e + (gradient[0] + affine[0]),
    value * at[0].square + (gradient[0] * at[0].gradient + affine[0] * at[0].affine) };
  const R y1 = gradient[1] + affine[1];
  const R y2 = gradient[1] * at[1].gradient + affine[1] * at[1].affine;
  const R xy[9] = { x[0], x[1], x[2], x[0] * at[1].e + y1, x[1] * at[1].e + at[0].e * y1,
    x[2] * at[1].e + at[0].square * y1, x[0] * at[1].square + y2, x[1] * at[1].square + at[0].e * y2,
    x[2] * at[1].square + at[0].square * y2 };
#pragma GCC unroll 9
  for (int n = 0; n < 9; ++n)
    add<Fresh>(moments[n], xy[n]);
  if constexpr (Dim == 3)
  {
    const R z1 = gradient[2] + affine[2];
    const R z2 = gradient[2] * at[2].gradient + affine[2] * at[2].affine;
    const R px[3] = { R(1.0), at[0].e, at[0].square };
    const R py[3] = { R(1.0), at[1].e, at[1].square };
#pragma GCC unroll 9
    for (int n = 0; n < 9; ++n)
    {
      const R p = px[n % 3] * py[n / 3];
      if constexpr (Fresh)
      {
        moments[9 + n] = xy[n] * at[2].e + p * z1;
        moments[18 + n] = xy[n] * at[2].square + p * z2;
      }
      else
      {
        moments[9 + n] = moments[9 + n] + xy[n] * at[2].e + p * z1;
        moments[18 + n] = moments[18 + n] + xy[n] * at[2].square + p * z2;
      }
    }
  }
}

/// Of a quantity that only has a value.
template <int Dim, bool Fresh, class R>
[[gnu::always_inline]] inline void addMoments(R* moments, const CellPlace<R>* at, R value)
{
  const R z[3] = { value, Dim == 3 ? value * at[Dim - 1].e : value, Dim == 3 ? value * at[Dim - 1].square : value };
#pragma GCC unroll 3
  for (int k = 0; k < (Dim == 3 ? 3 : 1); ++k)
  {
    const R row[3] = { z[k], z[k] * at[1].e, z[k] * at[1].square };
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j)
    {
      R* m = moments + 9 * k + 3 * j;
      add<Fresh>(m[0], row[j]);
      add<Fresh>(m[1], row[j] * at[0].e);
      add<Fresh>(m[2], row[j] * at[0].square);
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
  static_assert(N == 4 * Cells || (Cells == 1 && (N == 2 || N == 8)));
  if constexpr (N == 8 && Cells == 1)
  {
    const Lanes<8, T> halves = sums<8, 2>(a, b, c, d);
    Lanes<4, T> s;
    s = halves.template group<2>(0) + halves.template group<2>(1);
    return s;
  }
  else if constexpr (N == 2)
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
