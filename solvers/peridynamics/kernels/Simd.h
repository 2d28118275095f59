#pragma once

// Vectors of the width that the instruction set of this compilation has. Only for RowKernelsImpl.cpp: everything here
// is local to one object file, since each is compiled for another processor.

#include <cstdint>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace lamella::peridynamics
{
namespace
{

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
constexpr int vectorBytes = 64;
#elif defined(__AVX2__)
constexpr int vectorBytes = 32;
#else
constexpr int vectorBytes = 16;
#endif

template <class Real>
struct Simd;

template <>
struct Simd<double>
{
  static constexpr int lanes = vectorBytes / 8;
  using V __attribute__((vector_size(vectorBytes))) = double;
  using Any __attribute__((vector_size(vectorBytes), aligned(8), may_alias)) = double; // at any address
  using I __attribute__((vector_size(vectorBytes))) = std::int64_t;
  using Half __attribute__((vector_size(vectorBytes / 2), aligned(4), may_alias)) = std::int32_t;
  using HalfFloat __attribute__((vector_size(vectorBytes / 2), aligned(4), may_alias)) = float;

  static I words(const std::uint32_t* p) { return __builtin_convertvector(*reinterpret_cast<const Half*>(p), I); }
  static V floats(const float* p) { return __builtin_convertvector(*reinterpret_cast<const HalfFloat*>(p), V); }
};

template <>
struct Simd<float>
{
  static constexpr int lanes = vectorBytes / 4;
  using V __attribute__((vector_size(vectorBytes))) = float;
  using Any __attribute__((vector_size(vectorBytes), aligned(4), may_alias)) = float;
  using I __attribute__((vector_size(vectorBytes))) = std::int32_t;
  using AnyWords __attribute__((vector_size(vectorBytes), aligned(4), may_alias)) = std::int32_t;

  static I words(const std::uint32_t* p) { return *reinterpret_cast<const AnyWords*>(p); }
  static V floats(const float* p) { return *reinterpret_cast<const Any*>(p); }
};

template <class Real>
inline typename Simd<Real>::V load(const Real* p)
{
  return *reinterpret_cast<const typename Simd<Real>::Any*>(p);
}
template <class Real>
inline void store(Real* p, typename Simd<Real>::V v)
{
  *reinterpret_cast<typename Simd<Real>::Any*>(p) = v;
}
template <class Real>
inline typename Simd<Real>::V all(Real value)
{
  return value - typename Simd<Real>::V{};
}

/// b where a bit of the words is set, else a.
template <class Real>
inline typename Simd<Real>::V pick(
  typename Simd<Real>::I words, int bit, typename Simd<Real>::V a, typename Simd<Real>::V b)
{
  constexpr int top = sizeof(Real) * 8 - 1;
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
  (void)top;
  if constexpr (sizeof(Real) == 8)
    return _mm512_mask_mov_pd(
      a, _mm512_test_epi64_mask((__m512i)words, _mm512_set1_epi64(std::int64_t{ 1 } << bit)), b);
  else
    return _mm512_mask_mov_ps(
      a, _mm512_test_epi32_mask((__m512i)words, _mm512_set1_epi32(static_cast<int>(1U << bit))), b);
#elif defined(__AVX2__)
  if constexpr (sizeof(Real) == 8)
    return _mm256_blendv_pd(a, b, (__m256d)(words << (top - bit)));
  else
    return _mm256_blendv_ps(a, b, (__m256)(words << (top - bit)));
#else
  const typename Simd<Real>::I mask = (words << (top - bit)) < 0;
  return mask ? b : a;
#endif
}

template <class Real>
inline typename Simd<Real>::V magnitude(typename Simd<Real>::V x)
{
  using I = typename Simd<Real>::I;
  constexpr int top = sizeof(Real) * 8 - 1;
  const I sign = (I{} + 1) << top;
  return (typename Simd<Real>::V)((I)x & ~sign);
}

template <class Real>
inline typename Simd<Real>::V root(typename Simd<Real>::V x)
{
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
  if constexpr (sizeof(Real) == 8)
    return _mm512_maskz_sqrt_pd(0xff, x); // the unmasked one is said to use an undefined value
  else
    return _mm512_maskz_sqrt_ps(0xffff, x);
#elif defined(__AVX2__)
  if constexpr (sizeof(Real) == 8)
    return _mm256_sqrt_pd(x);
  else
    return _mm256_sqrt_ps(x);
#else
  for (int l = 0; l < Simd<Real>::lanes; ++l)
    x[l] = sizeof(Real) == 8 ? __builtin_sqrt(static_cast<double>(x[l])) : __builtin_sqrtf(static_cast<float>(x[l]));
  return x;
#endif
}

/// Is any lane of a comparison true?
template <class Real>
inline bool any(typename Simd<Real>::I mask)
{
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
  return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0;
#elif defined(__AVX2__)
  return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
#else
  for (int l = 0; l < Simd<Real>::lanes; ++l)
    if (mask[l] != 0)
      return true;
  return false;
#endif
}

} // namespace
} // namespace lamella::peridynamics
