// What the kernels of elements share that are compiled once for every instruction set: packs of numbers, displacements
// as modes, strains. Internal to their sources: names are each one's own.
#pragma once

#include "elasticity/ElasticKernels.h"

#include <cstring>
#include <type_traits>
#include <utility>

namespace lamella::elasticity
{
namespace
{

#if defined(__AVX512F__)
constexpr int bytes = 64;
#elif defined(__AVX__)
constexpr int bytes = 32;
#else
constexpr int bytes = 16;
#endif

template <class Real>
struct Packed;
template <>
struct Packed<float>
{
  using Type [[gnu::vector_size(bytes)]] = float;
};
template <>
struct Packed<double>
{
  using Type [[gnu::vector_size(bytes)]] = double;
};
using HalfFloats [[gnu::vector_size(bytes / 2)]] = float;

template <class Real>
using Pack = typename Packed<Real>::Type;
template <class Real>
constexpr int lanes = bytes / static_cast<int>(sizeof(Real));

template <class Real>
[[gnu::always_inline]] inline Pack<Real> load(const Real* p)
{
  Pack<Real> v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <class Real>
[[gnu::always_inline]] inline void store(Real* p, Pack<Real> v)
{
  std::memcpy(p, &v, sizeof v);
}
template <class Real>
[[gnu::always_inline]] inline Pack<Real> loadFloats(const float* p)
{
  if constexpr (std::is_same_v<Real, float>)
    return load(p);
  else
  {
    HalfFloats v;
    std::memcpy(&v, p, sizeof v);
    return __builtin_convertvector(v, Pack<double>);
  }
}
template <class Real>
[[gnu::always_inline]] inline Pack<Real> all(double x)
{
  return static_cast<Real>(x) - Pack<Real>{};
}
// The values one lane on, after the last of those before.
template <class Real, int... I>
[[gnu::always_inline]] inline Pack<Real> shifted(Pack<Real> before, Pack<Real> v, std::integer_sequence<int, I...>)
{
  return __builtin_shufflevector(before, v, (lanes<Real> - 1 + I)...);
}
template <class Real>
[[gnu::always_inline]] inline Pack<Real> shifted(Pack<Real> before, Pack<Real> v)
{
  return shifted<Real>(before, v, std::make_integer_sequence<int, lanes<Real>>{});
}
template <class Real>
double total(Pack<Real> v)
{
  double sum = 0;
  for (int i = 0; i < lanes<Real>; ++i)
    sum += static_cast<double>(v[i]);
  return sum;
}

// f(0), f(1), … with constants that the compiler knows.
template <int N, class F>
[[gnu::always_inline]] inline void times(F&& f)
{
  [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline))
  {
    (f(std::integral_constant<int, I>{}), ...);
  }
  (std::make_integer_sequence<int, N>{});
}

// mean square of the product of some of ξ, η, ζ
constexpr double meanSquare(int polynomial)
{
  double w = 1;
  for (int a = 0; a < 3; ++a)
    if ((polynomial >> a & 1) != 0)
      w /= 3;
  return w;
}

// A displacement's coefficients times the number of corners, of one pack of elements.
template <int D, class Real>
struct Modes
{
  static constexpr int corners = 1 << D;
  Pack<Real> m[D][corners]{};

  Modes() = default;
  [[gnu::always_inline]] explicit Modes(const ElasticRow<D, Real>& row, std::int64_t i)
  {
    times<D>(
      [&](auto c)
      {
        times<corners / 2>(
          [&](auto r)
          {
            const Pack<Real> low = load(row.u[c][r] + i);
            const Pack<Real> high = load(row.u[c][r] + i + 1);
            m[c][2 * r] = high + low;
            m[c][2 * r + 1] = high - low;
          });
        times<D - 1>(
          [&](auto axis)
          {
            constexpr int bit = 2 << axis;
            times<corners>(
              [&](auto p)
              {
                if constexpr ((p & bit) == 0)
                {
                  const Pack<Real> low = m[c][p];
                  const Pack<Real> high = m[c][p | bit];
                  m[c][p] = high + low;
                  m[c][p | bit] = high - low;
                }
              });
          });
      });
  }

  // u = Σ over corners of its mode's sign times the mode
  [[gnu::always_inline]] void back()
  {
    times<D>(
      [&](auto c)
      {
        times<D - 1>(
          [&](auto axis)
          {
            constexpr int bit = 2 << axis;
            times<corners>(
              [&](auto p)
              {
                if constexpr ((p & bit) == 0)
                {
                  const Pack<Real> mean = m[c][p];
                  const Pack<Real> slope = m[c][p | bit];
                  m[c][p] = mean - slope;
                  m[c][p | bit] = mean + slope;
                }
              });
          });
      });
  }
};

// The components of strain that vary as a polynomial: those with a derivative along an axis that it lacks.
template <int D>
constexpr int usedBy(int polynomial)
{
  int used = 0;
  for (int d = 0; d < D; ++d)
    for (int c = 0; c < D && (polynomial >> d & 1) == 0; ++c)
      used |= 1 << voigt(D, c, d);
  return used;
}

template <int D, class Real, bool stretched>
struct Edges
{
  Pack<Real> inverse[D];

  [[gnu::always_inline]] Edges(const ElasticRow<D, Real>& row, std::int64_t i)
  {
    if constexpr (stretched)
    {
      inverse[0] = loadFloats<Real>(row.stretchX + i);
      times<D - 1>([&](auto a) { inverse[a + 1] = all<Real>(row.stretch[a + 1]); });
    }
  }
  [[gnu::always_inline]] Pack<Real> over(Pack<Real> v, int axis) const { return stretched ? v * inverse[axis] : v; }
};

template <int D, class Real, bool stretched, class Mode>
[[gnu::always_inline]] inline void strainOf(
  const Modes<D, Real>& u, const Edges<D, Real, stretched>& edges, Mode, Pack<Real>* e)
{
  constexpr int polynomial = Mode::value;
  times<voigtSize(D)>([&](auto k) { e[k] = Pack<Real>{}; });
  times<D>(
    [&](auto d)
    {
      if constexpr ((polynomial >> d & 1) == 0)
        times<D>([&](auto c) { e[voigt(D, c, d)] += edges.over(u.m[c][polynomial | 1 << d], d); });
    });
}

constexpr int voigtAxis(int dimension, int component, int which)
{
  for (int a = 0; a < dimension; ++a)
    for (int b = a; b < dimension; ++b)
      if (voigt(dimension, a, b) == component)
        return which == 0 ? a : b;
  return 0;
}

} // namespace
} // namespace lamella::elasticity
