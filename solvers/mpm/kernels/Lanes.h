#pragma once

// Vectors of N doubles as a number type for laws and shapes. Only for sources compiled for several instruction sets
// (lamella_kernels): everything here, and so every template instantiated with it, is local to one object file.

#include <cstdint>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace lamella::mpm
{
namespace
{

template <int N>
struct LaneTypes; // the attribute may not depend on a template's parameter
#define LAMELLA_LANES(N)                                                                                               \
  template <>                                                                                                          \
  struct LaneTypes<N>                                                                                                  \
  {                                                                                                                    \
    using V __attribute__((vector_size(8 * N))) = double;                                                              \
    using I __attribute__((vector_size(8 * N))) = std::int64_t;                                                        \
    using Any __attribute__((vector_size(8 * N), aligned(8), may_alias)) = double; /* at any address */                \
  };
LAMELLA_LANES(2)
LAMELLA_LANES(4)
LAMELLA_LANES(8)
#undef LAMELLA_LANES

template <int N>
struct Lanes
{
  using V = typename LaneTypes<N>::V;
  using I = typename LaneTypes<N>::I;
  using Any = typename LaneTypes<N>::Any;

  V v;

  Lanes() = default;
  Lanes(V value)
    : v(value)
  {
  }
  Lanes(double value)
    : v(value - V{})
  {
  }
  static Lanes load(const double* p) { return *reinterpret_cast<const Any*>(p); }
  void store(double* p) const { *reinterpret_cast<Any*>(p) = v; }
  /// The first n of them; what lies behind is not touched, since it may be another thread's.
  void storeFirst(double* p, int n) const
  {
#if defined(__AVX512F__) && defined(__AVX512VL__)
    if constexpr (N == 8)
      return _mm512_mask_storeu_pd(p, static_cast<__mmask8>((1U << n) - 1), v);
    if constexpr (N == 4)
      return _mm256_mask_storeu_pd(p, static_cast<__mmask8>((1U << n) - 1), v);
#elif defined(__AVX2__)
    if constexpr (N == 4)
      return _mm256_maskstore_pd(p, (__m256i)(counting() < n), v);
#endif
    for (int l = 0; l < n; ++l)
      p[l] = v[l];
  }
  /// In `Groups` equal parts, each from its own place.
  template <int Groups>
  static Lanes loadGroups(const double* const* p)
  {
    if constexpr (Groups == 1)
      return load(p[0]);
    else
    {
      using Half = typename LaneTypes<N / 2>::Any;
      const auto a = *reinterpret_cast<const Half*>(p[0]);
      const auto b = *reinterpret_cast<const Half*>(p[1]);
      static_assert(Groups == 2 && N == 8);
      return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
    }
  }
  /// A part of them.
  template <int Groups>
  [[nodiscard]] Lanes<N / Groups> group(int g) const
  {
    if constexpr (Groups == 1)
      return v;
    else
    {
      static_assert(Groups == 2 && N == 8);
      return g == 0 ? __builtin_shufflevector(v, v, 0, 1, 2, 3) : __builtin_shufflevector(v, v, 4, 5, 6, 7);
    }
  }
  /// 0, 1, 2, …
  static I counting()
  {
    I i{};
    for (int l = 0; l < N; ++l)
      i[l] = l;
    return i;
  }

  friend Lanes operator+(Lanes a, Lanes b)
  {
    return a.v + b.v;
  }
  friend Lanes operator-(Lanes a, Lanes b)
  {
    return a.v - b.v;
  }
  friend Lanes operator*(Lanes a, Lanes b)
  {
    return a.v * b.v;
  }
  friend Lanes operator/(Lanes a, Lanes b)
  {
    return a.v / b.v;
  }
  friend Lanes operator-(Lanes a)
  {
    return -a.v;
  }
  friend I operator<(Lanes a, Lanes b)
  {
    return a.v < b.v;
  }
  friend I operator>(Lanes a, Lanes b)
  {
    return a.v > b.v;
  }
  friend I operator<=(Lanes a, Lanes b)
  {
    return a.v <= b.v;
  }
  friend I operator>=(Lanes a, Lanes b)
  {
    return a.v >= b.v;
  }

  /// a where the condition (a comparison of lanes) holds, else b
  friend Lanes select(I condition, Lanes a, Lanes b)
  {
    return condition ? a.v : b.v;
  }
  friend Lanes min(Lanes a, Lanes b)
  {
    return a.v < b.v ? a.v : b.v;
  }
  friend Lanes max(Lanes a, Lanes b)
  {
    return a.v > b.v ? a.v : b.v;
  }
  friend Lanes abs(Lanes a)
  {
    return (V)((I)a.v & INT64_MAX);
  }
  friend Lanes sqrt(Lanes a)
  {
#if defined(__AVX512F__)
    if constexpr (N == 8)
      return _mm512_maskz_sqrt_pd(0xff, a.v); // the unmasked one is said to use an undefined value
#endif
#if defined(__AVX2__)
    if constexpr (N == 4)
      return _mm256_sqrt_pd(a.v);
#endif
    for (int l = 0; l < N; ++l)
      a.v[l] = __builtin_sqrt(a.v[l]);
    return a;
  }
  /// 1/√a of positive, normal numbers, to 2 units in the last place.
  friend Lanes inverseSqrt(Lanes a)
  {
#if defined(__AVX512F__)
    if constexpr (N == 8) // sooner than a root and a division
    {
      V y = _mm512_maskz_rsqrt14_pd(0xff, a.v);
      y = y + 0.5 * y * (1.0 - a.v * y * y);
      const V rest = 1.0 - a.v * y * y;
      return y + y * rest * (0.5 + 0.375 * rest);
    }
#endif
    return 1.0 / sqrt(a);
  }
  /// Natural logarithm to 2 units in the last place for positive, normal numbers.
  friend Lanes log(Lanes a)
  {
    // a = 2^k m with m in [√½, √2)
    const I offset = I{} + 0x3fe6a09e667f3bcdLL; // √½
    const I shifted = (I)a.v - offset;
    const I k = shifted >> 52;
    const V m = (V)((I)a.v - (k << 52));
    // ln m = 2 artanh s, s = (m − 1)/(m + 1), |s| ≤ 0.1716: ten terms leave 2e-17
    const V s = (m - 1.0) / (m + 1.0);
    const V z = s * s;
    V series = z * (1.0 / 21) + 1.0 / 19;
    series = series * z + 1.0 / 17;
    series = series * z + 1.0 / 15;
    series = series * z + 1.0 / 13;
    series = series * z + 1.0 / 11;
    series = series * z + 1.0 / 9;
    series = series * z + 1.0 / 7;
    series = series * z + 1.0 / 5;
    series = series * z + 1.0 / 3;
    const V kd = __builtin_convertvector(k, V);
    return kd * 0.6931471805599453 + (s + s + (s + s) * (z * series));
  }
};

/// A bit a lane of a comparison.
template <int N>
inline unsigned bits(typename LaneTypes<N>::I mask)
{
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
  if constexpr (N == 8)
    return _mm512_movepi64_mask((__m512i)mask);
#endif
#if defined(__AVX2__)
  if constexpr (N == 4)
    return static_cast<unsigned>(_mm256_movemask_pd((__m256d)mask));
#endif
  unsigned set = 0;
  for (int l = 0; l < N; ++l)
    set |= mask[l] != 0 ? 1U << l : 0U;
  return set;
}

} // namespace
} // namespace lamella::mpm
