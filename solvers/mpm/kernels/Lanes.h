#pragma once

// Vectors of N doubles or floats as a number type for laws and shapes. Only for sources compiled for several
// instruction sets (lamella_kernels): everything here, and so every template instantiated with it, is local to one
// object file.

#include <cstdint>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace lamella::mpm
{
namespace
{

template <int N, class T>
struct LaneTypes; // the attribute may not depend on a template's parameter
#define LAMELLA_LANES(N, Number, Whole)                                                                                \
  template <>                                                                                                          \
  struct LaneTypes<N, Number>                                                                                          \
  {                                                                                                                    \
    using V __attribute__((vector_size(sizeof(Number) * N))) = Number;                                                 \
    using I __attribute__((vector_size(sizeof(Number) * N))) = Whole;                                                  \
    using U __attribute__((vector_size(sizeof(Number) * N))) = u##Whole; /* which may overflow */                      \
    using Any __attribute__((vector_size(sizeof(Number) * N), aligned(sizeof(Number)), may_alias)) =                   \
      Number; /* any place */                                                                                          \
  };
LAMELLA_LANES(2, double, int64_t)
LAMELLA_LANES(4, double, int64_t)
LAMELLA_LANES(8, double, int64_t)
LAMELLA_LANES(16, double, int64_t)
LAMELLA_LANES(4, float, int32_t)
LAMELLA_LANES(8, float, int32_t)
LAMELLA_LANES(16, float, int32_t)
#undef LAMELLA_LANES

/// @param T double, or float with twice as many lanes
template <int N, class T = double>
struct Lanes
{
  using V = typename LaneTypes<N, T>::V;
  using I = typename LaneTypes<N, T>::I;
  using U = typename LaneTypes<N, T>::U;
  using Any = typename LaneTypes<N, T>::Any;
  static constexpr bool single = sizeof(T) == 4;

  V v;

  Lanes() = default;
  Lanes(V value)
    : v(value)
  {
  }
  Lanes(double value)
    : v(static_cast<T>(value) - V{})
  {
  }
  static Lanes load(const T* p) { return *reinterpret_cast<const Any*>(p); }
  void store(T* p) const { *reinterpret_cast<Any*>(p) = v; }
  /// The first n of them; what lies behind is not touched, since it may be another thread's.
  void storeFirst(T* p, int n) const
  {
#if defined(__AVX512F__) && defined(__AVX512VL__)
    const unsigned first = (1U << n) - 1;
    if constexpr (N == 8 && !single)
      return _mm512_mask_storeu_pd(p, static_cast<__mmask8>(first), v);
    if constexpr (N == 4 && !single)
      return _mm256_mask_storeu_pd(p, static_cast<__mmask8>(first), v);
    if constexpr (N == 4 && single)
      return _mm_mask_storeu_ps(p, static_cast<__mmask8>(first), v);
#elif defined(__AVX2__)
    if constexpr (N == 4 && !single)
      return _mm256_maskstore_pd(p, (__m256i)(counting() < n), v);
    if constexpr (N == 4 && single)
      return _mm_maskstore_ps(p, (__m128i)(counting() < n), v);
#endif
    for (int l = 0; l < n; ++l)
      p[l] = v[l];
  }
  /// In `Groups` equal parts, each from its own place.
  template <int Groups>
  static Lanes loadGroups(const T* const* p)
  {
    if constexpr (Groups == 1)
      return load(p[0]);
    else
    {
      using Half = Lanes<N / 2, T>;
      return joined(Half::template loadGroups<Groups / 2>(p), Half::template loadGroups<Groups / 2>(p + Groups / 2));
    }
  }
  /// `Groups` equal parts, each of one value. Not through memory: a vector that was stored value by value is slow to
  /// load.
  template <int Groups>
  static Lanes eachGroup(const T* values)
  {
    if constexpr (Groups == 1)
      return Lanes(static_cast<double>(values[0]));
    else
    {
      using Half = Lanes<N / 2, T>;
      return joined(
        Half::template eachGroup<Groups / 2>(values), Half::template eachGroup<Groups / 2>(values + Groups / 2));
    }
  }
  /// One behind the other.
  static Lanes joined(Lanes<N / 2, T> a, Lanes<N / 2, T> b)
  {
    static_assert(N == 8 || N == 16);
#if defined(__AVX512F__)
    if constexpr (N == 8 && !single) // from memory, too, without a shuffle
      return _mm512_maskz_insertf64x4(0xff, _mm512_castpd256_pd512(a.v), b.v, 1);
#endif
    if constexpr (N == 8)
      return __builtin_shufflevector(a.v, b.v, 0, 1, 2, 3, 4, 5, 6, 7);
    else
      return __builtin_shufflevector(a.v, b.v, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  }
  /// A part of them.
  template <int Groups>
  [[nodiscard]] Lanes<N / Groups, T> group(int g) const
  {
    static_assert(Groups == 1 || N / Groups == 4);
    if constexpr (Groups == 1)
      return v;
    else if constexpr (Groups == 2)
      return g == 0 ? __builtin_shufflevector(v, v, 0, 1, 2, 3) : __builtin_shufflevector(v, v, 4, 5, 6, 7);
    else
      return g == 0 ? __builtin_shufflevector(v, v, 0, 1, 2, 3)
        : g == 1    ? __builtin_shufflevector(v, v, 4, 5, 6, 7)
        : g == 2    ? __builtin_shufflevector(v, v, 8, 9, 10, 11)
                    : __builtin_shufflevector(v, v, 12, 13, 14, 15);
  }
  /// 0, 1, 2, …
  static I counting()
  {
    I i{};
    for (int l = 0; l < N; ++l)
      i[l] = l;
    return i;
  }
  /// All bits of a lane where its bit is set.
  static I where(unsigned bits)
  {
    const I each = (I{} + 1) << counting();
    return ((I{} + static_cast<int>(bits)) & each) != 0;
  }
  template <class Other>
  [[nodiscard]] Lanes<N, Other> as() const
  {
    return __builtin_convertvector(v, typename LaneTypes<N, Other>::V);
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
    return (V)((I)a.v & (single ? INT32_MAX : INT64_MAX));
  }
  friend Lanes sqrt(Lanes a)
  {
#if defined(__AVX512F__)
    if constexpr (N == 8 && !single)
      return _mm512_maskz_sqrt_pd(0xff, a.v); // the unmasked one is said to use an undefined value
    if constexpr (N == 16 && single)
      return _mm512_maskz_sqrt_ps(0xffff, a.v);
#endif
#if defined(__AVX2__)
    if constexpr (N == 4 && !single)
      return _mm256_sqrt_pd(a.v);
    if constexpr (N == 8 && single)
      return _mm256_sqrt_ps(a.v);
#endif
    for (int l = 0; l < N; ++l)
      a.v[l] = __builtin_sqrt(a.v[l]);
    return a;
  }
  /// 1/√a of positive, normal numbers, to 2 units in the last place.
  friend Lanes inverseSqrt(Lanes a)
  {
#if defined(__AVX512F__)
    if constexpr (N == 16 && single)
    {
      const V y = _mm512_maskz_rsqrt14_ps(0xffff, a.v);
      const V rest = 1.0F - a.v * y * y;
      return y + y * rest * (0.5F + 0.375F * rest);
    }
    if constexpr (N == 8 && !single) // sooner than a root and a division
    {
      V y = _mm512_maskz_rsqrt14_pd(0xff, a.v);
      y = y + 0.5 * y * (1.0 - a.v * y * y);
      const V rest = 1.0 - a.v * y * y;
      return y + y * rest * (0.5 + 0.375 * rest);
    }
#endif
    return 1.0 / sqrt(a);
  }
  /// To 2⁻¹⁴, where the processor offers it.
  friend Lanes roughInverse(Lanes a)
  {
#if defined(__AVX512F__)
    if constexpr (N == 16 && single)
      return _mm512_maskz_rcp14_ps(0xffff, a.v);
    if constexpr (N == 8 && !single)
      return _mm512_maskz_rcp14_pd(0xff, a.v);
#endif
    return 1.0 / a;
  }
  friend Lanes roughInverseSqrt(Lanes a)
  {
#if defined(__AVX512F__)
    if constexpr (N == 16 && single)
      return _mm512_maskz_rsqrt14_ps(0xffff, a.v);
    if constexpr (N == 8 && !single)
      return _mm512_maskz_rsqrt14_pd(0xff, a.v);
#endif
    return 1.0 / sqrt(a);
  }
  /// Natural logarithm to 2 units in the last place for positive, normal numbers.
  [[gnu::always_inline]] friend Lanes log(Lanes a)
  {
    if constexpr (single)
      return log(a.template as<double>()).template as<float>();
    else
      return logarithm(a);
  }
  /// e to a power within ±700, to 2 units in the last place.
  [[gnu::always_inline]] friend Lanes exp(Lanes a)
  {
    static_assert(!single);
    // a = k ln 2 + r, |r| ≤ ½ ln 2; the sum's last bits are k
    constexpr double rounds = 6755399441055744.0; // 1.5 · 2⁵²
    const V shifted = a.v * 1.4426950408889634 + rounds;
    const V k = shifted - rounds;
    const V r = (a.v - k * 0x1.62e42feep-1) - k * 0x1.a39ef35793c76p-33;
    // thirteen terms leave 4e-18, every other one by itself
    const V rr = r * r;
    V even = rr * (1.0 / 479001600) + 1.0 / 3628800;
    V odd = rr * (1.0 / 6227020800) + 1.0 / 39916800;
    even = even * rr + 1.0 / 40320;
    odd = odd * rr + 1.0 / 362880;
    even = even * rr + 1.0 / 720;
    odd = odd * rr + 1.0 / 5040;
    even = even * rr + 1.0 / 24;
    odd = odd * rr + 1.0 / 120;
    even = even * rr + 0.5;
    odd = odd * rr + 1.0 / 6;
    const V power = 1.0 + (r + rr * (even + odd * r));
    return (V)((U)power + ((U)shifted << 52));
  }

private:
  [[gnu::always_inline]] static Lanes logarithm(Lanes a)
  {
    // a = 2^k m with m in [√½, √2)
    const U offset = U{} + 0x3fe6a09e667f3bcdULL; // √½
    const I k = (I)((U)a.v - offset) >> 52;
    const V m = (V)((U)a.v - ((U)k << 52));
    // ln m = 2 artanh s, s = (m − 1)/(m + 1), |s| ≤ 0.1716: ten terms leave 2e-17
    const V s = (m - 1.0) / (m + 1.0);
    const V z = s * s;
    // every other term by itself: two short chains instead of a long one
    const V zz = z * z;
    V even = zz * (1.0 / 19) + 1.0 / 15;
    V odd = zz * (1.0 / 21) + 1.0 / 17;
    even = even * zz + 1.0 / 11;
    odd = odd * zz + 1.0 / 13;
    even = even * zz + 1.0 / 7;
    odd = odd * zz + 1.0 / 9;
    even = even * zz + 1.0 / 3;
    odd = odd * zz + 1.0 / 5;
    const V series = odd * z + even;
    const V kd = __builtin_convertvector(k, V);
    return kd * 0.6931471805599453 + (s + s + (s + s) * (z * series));
  }
};

/// A bit a lane of a comparison.
template <int N, class T>
inline unsigned bits(typename LaneTypes<N, T>::I mask)
{
  [[maybe_unused]] constexpr bool single = sizeof(T) == 4;
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
  if constexpr (N == 8 && !single)
    return _mm512_movepi64_mask((__m512i)mask);
  if constexpr (N == 16 && single)
    return _mm512_movepi32_mask((__m512i)mask);
#endif
#if defined(__AVX2__)
  if constexpr (N == 4 && !single)
    return static_cast<unsigned>(_mm256_movemask_pd((__m256d)mask));
  if constexpr (N == 8 && single)
    return static_cast<unsigned>(_mm256_movemask_ps((__m256)mask));
#endif
  unsigned set = 0;
  for (int l = 0; l < N; ++l)
    set |= mask[l] != 0 ? 1U << l : 0U;
  return set;
}

/// Whether a comparison holds for one lane at least. @param alike of the type that was compared
template <int N, class T>
inline bool any(typename LaneTypes<N, T>::I mask, const Lanes<N, T>& /*alike*/)
{
  return bits<N, T>(mask) != 0;
}

/// Two of a number type, side by side: no operation on the one waits for any on the other.
template <class R>
struct Two
{
  R first;
  R second;

  /// Of a comparison.
  struct Answers
  {
    typename R::I first;
    typename R::I second;
  };

  Two() = default;
  Two(double value)
    : first(value)
    , second(value)
  {
  }
  Two(R a, R b)
    : first(a)
    , second(b)
  {
  }

  friend Two operator+(Two a, Two b) { return { a.first + b.first, a.second + b.second }; }
  friend Two operator-(Two a, Two b) { return { a.first - b.first, a.second - b.second }; }
  friend Two operator*(Two a, Two b) { return { a.first * b.first, a.second * b.second }; }
  friend Two operator/(Two a, Two b) { return { a.first / b.first, a.second / b.second }; }
  friend Two operator-(Two a) { return { -a.first, -a.second }; }
  friend Answers operator>(Two a, Two b) { return { a.first > b.first, a.second > b.second }; }
  friend bool any(Answers condition, const Two& alike) { return any(condition.first | condition.second, alike.first); }
  friend Two abs(Two a) { return { abs(a.first), abs(a.second) }; }
  friend Two log(Two a) { return { log(a.first), log(a.second) }; }
  friend Two inverseSqrt(Two a) { return { inverseSqrt(a.first), inverseSqrt(a.second) }; }
  friend Two roughInverse(Two a) { return { roughInverse(a.first), roughInverse(a.second) }; }
  friend Two roughInverseSqrt(Two a) { return { roughInverseSqrt(a.first), roughInverseSqrt(a.second) }; }
};

} // namespace
} // namespace lamella::mpm
