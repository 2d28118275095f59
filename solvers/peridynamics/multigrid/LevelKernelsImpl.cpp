// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines.
#include "peridynamics/multigrid/LevelKernels.h"

#include <algorithm>

#ifdef __AVX2__
#include <immintrin.h>
#endif

#define LAMELLA_SIMD _Pragma("omp simd")

namespace lamella::peridynamics
{
namespace
{

constexpr std::int64_t strip = 128; // nodes whose sums stay in the first cache while the neighbours pass

// Eight values whatever the registers: most levels are narrow.
constexpr int lanes = 8;
using V __attribute__((vector_size(4 * lanes))) = float;
using AnyV __attribute__((vector_size(4 * lanes), aligned(4), may_alias)) = float; // at any address

V load(const float* p)
{
  return *reinterpret_cast<const AnyV*>(p);
}

/// Component c of a symmetric block, whose entry e is at block[e], times a vector.
template <int Dim>
V times(int c, const V* block, const V* x)
{
  if constexpr (Dim == 2)
    return c == 0 ? block[0] * x[0] + block[2] * x[1] : block[2] * x[0] + block[1] * x[1];
  else
    return c == 0 ? block[0] * x[0] + block[3] * x[1] + block[5] * x[2]
      : c == 1    ? block[3] * x[0] + block[1] * x[1] + block[4] * x[2]
                  : block[5] * x[0] + block[4] * x[1] + block[2] * x[2];
}

/// The sums of `Parts` vectors of nodes stay in registers while the neighbours pass.
template <int Dim, int Parts>
void subtractPart(std::int64_t at, const BlockRow& r)
{
  constexpr int entries = blockEntries(Dim);
  V ahead[Parts][Dim];
  V behind[Parts][Dim];
  const auto add = [&](V(&sum)[Dim], const float* const* blocks, std::int64_t shift, std::int64_t jump, std::int64_t i)
  {
    V block[entries];
    V x[Dim];
    for (int e = 0; e < entries; ++e)
      block[e] = load(blocks[e] + shift + i);
    for (int c = 0; c < Dim; ++c)
      x[c] = load(r.here[c] + jump + i);
    for (int c = 0; c < Dim; ++c)
      sum[c] += times<Dim>(c, block, x);
  };
  for (int part = 0; part < Parts; ++part)
    for (int c = 0; c < Dim; ++c)
      ahead[part][c] = behind[part][c] = V{};
  for (int part = 0; part < Parts; ++part)
    add(ahead[part], r.diagonal, 0, 0, at + part * lanes);
  for (int q = 0; q < r.half; ++q)
  {
    for (int e = 0; e < entries; ++e) // the streams are many and short: the processor does not see them coming
      __builtin_prefetch(r.block[e] + q * r.blockStride + at + r.nextRow, 0, 2);
    for (int part = 0; part < Parts; ++part)
    {
      add(ahead[part], r.block, q * r.blockStride, r.jump[q], at + part * lanes);
      if (r.mirrored[q] != 0)
        add(behind[part], r.block, q * r.blockStride - r.back[q], -r.jump[q], at + part * lanes);
    }
  }
  for (int part = 0; part < Parts; ++part)
    for (int c = 0; c < Dim; ++c)
    {
      float* out = r.out[c] + at + part * lanes;
      *reinterpret_cast<AnyV*>(out) = load(out) - (ahead[part][c] + behind[part][c]);
    }
}

// Past the last node of a row there is padding, where matrices are zero.
template <int Dim>
void subtract(std::int64_t n, const BlockRow& r)
{
  constexpr int parts = Dim == 2 ? 2 : 1;
  std::int64_t i = 0;
  for (; i + (parts - 1) * lanes < n; i += parts * lanes)
    subtractPart<Dim, parts>(i, r);
  for (; i < n; i += lanes)
    subtractPart<Dim, 1>(i, r);
}

using Short __attribute__((vector_size(2 * lanes), aligned(2), may_alias)) = std::int16_t; // at any address

V load(const std::int16_t* p)
{
#ifdef __AVX2__
  // g++ 12 takes the vector apart into halves by itself
  using Long __attribute__((vector_size(4 * lanes))) = std::int32_t;
  const __m128i eight = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
  return __builtin_convertvector(reinterpret_cast<Long>(_mm256_cvtepi16_epi32(eight)), V);
#else
  return __builtin_convertvector(*reinterpret_cast<const Short*>(p), V);
#endif
}

/// The same of a packed matrix: blocks are those of the scaled vector, and so is their sum. Several vectors of nodes at
/// a time, for these share the cache lines of a block.
template <int Dim, int Parts>
void subtractPacked(std::int64_t at, const BlockRow& r)
{
  constexpr int entries = blockEntries(Dim);
  V sum[Parts][Dim]{};
  const auto add = [&](std::int64_t shift, std::int64_t jump)
  {
    for (int e = 0; e < entries; ++e) // the streams are many and short: the processor does not see them coming
      __builtin_prefetch(r.packed[e] + shift + at + r.nextRow, 0, 2);
#pragma GCC unroll 4
    for (int part = 0; part < Parts; ++part)
    {
      const std::int64_t i = at + part * lanes;
      V block[entries];
      V x[Dim];
      for (int e = 0; e < entries; ++e)
        block[e] = load(r.packed[e] + shift + i);
      const V scale = load(r.scale + jump + i);
      for (int c = 0; c < Dim; ++c)
        x[c] = scale * load(r.here[c] + jump + i);
      for (int c = 0; c < Dim; ++c)
        sum[part][c] += times<Dim>(c, block, x);
    }
  };
  for (int q = 0; q < r.half; ++q)
  {
    add(q * r.blockStride, r.jump[q]);
    if (r.mirrored[q] != 0)
      add(q * r.blockStride - r.back[q], -r.jump[q]);
  }
  for (int part = 0; part < Parts; ++part)
  {
    const std::int64_t i = at + part * lanes;
    V diagonal[entries];
    V x[Dim];
    for (int e = 0; e < entries; ++e)
      diagonal[e] = load(r.diagonal[e] + i);
    for (int c = 0; c < Dim; ++c)
      x[c] = load(r.here[c] + i);
    for (int c = 0; c < Dim; ++c)
    {
      float* out = r.out[c] + i;
      *reinterpret_cast<AnyV*>(out) = load(out) - (times<Dim>(c, diagonal, x) + load(r.scale + i) * sum[part][c]);
    }
  }
}

template <int Dim>
void subtractAllPacked(std::int64_t n, const BlockRow& r)
{
  std::int64_t i = 0;
  for (; i + 3 * lanes < n; i += 4 * lanes)
    subtractPacked<Dim, 4>(i, r);
  if (i + 2 * lanes < n)
    subtractPacked<Dim, 3>(i, r);
  else if (i + lanes < n)
    subtractPacked<Dim, 2>(i, r);
  else if (i < n)
    subtractPacked<Dim, 1>(i, r);
}

void subtractProduct(int dimension, std::int64_t n, const BlockRow& row)
{
  if (row.scale != nullptr)
    dimension == 3 ? subtractAllPacked<3>(n, row) : subtractAllPacked<2>(n, row);
  else
    dimension == 3 ? subtract<3>(n, row) : subtract<2>(n, row);
}

void chebyshev(int dimension, std::int64_t n, float a, float b, const float* const* inverse, const float* const* r,
  float* const* d, float* const* x, bool first)
{
  const auto finish = [&](int c, const auto& value)
  {
    float* dc = d[c];
    float* xc = x[c];
    if (first)
    {
      LAMELLA_SIMD
      for (std::int64_t i = 0; i < n; ++i)
        xc[i] = dc[i] = value(i);
    }
    else if (a == 0)
    {
      LAMELLA_SIMD
      for (std::int64_t i = 0; i < n; ++i)
      {
        dc[i] = value(i);
        xc[i] += dc[i];
      }
    }
    else
    {
      LAMELLA_SIMD
      for (std::int64_t i = 0; i < n; ++i)
      {
        dc[i] = a * dc[i] + value(i);
        xc[i] += dc[i];
      }
    }
  };
  if (dimension == 2)
  {
    const float *xx = inverse[0], *yy = inverse[1], *xy = inverse[2], *u = r[0], *v = r[1];
    finish(
      0, [=](std::int64_t i) { return b * (xx[i] * u[i] + xy[i] * v[i]); });
    finish(1, [=](std::int64_t i) { return b * (xy[i] * u[i] + yy[i] * v[i]); });
    return;
  }
  const float *xx = inverse[0], *yy = inverse[1], *zz = inverse[2], *xy = inverse[3], *yz = inverse[4],
              *xz = inverse[5], *u = r[0], *v = r[1], *w = r[2];
  finish(
    0, [=](std::int64_t i) { return b * (xx[i] * u[i] + xy[i] * v[i] + xz[i] * w[i]); });
  finish(
    1, [=](std::int64_t i) { return b * (xy[i] * u[i] + yy[i] * v[i] + yz[i] * w[i]); });
  finish(2, [=](std::int64_t i) { return b * (xz[i] * u[i] + yz[i] * v[i] + zz[i] * w[i]); });
}

void restrictRow(std::int64_t n, float w, const float* v, float* out)
{
  LAMELLA_SIMD
  for (std::int64_t i = 0; i < n; ++i)
    out[i] += w * (v[2 * i] + 0.5F * (v[2 * i - 1] + v[2 * i + 1]));
}

void interpolateRow(std::int64_t n, float w, int rows, const float* const* coarse, float* v)
{
  float sum[strip + 1];
  const std::int64_t pairs = (n + 1) / 2;
  for (std::int64_t begin = 0; begin < pairs; begin += strip)
  {
    const std::int64_t count = std::min(strip, pairs - begin);
    for (int r = 0; r < rows; ++r)
    {
      const float* c = coarse[r] + begin;
      if (r == 0)
        for (std::int64_t i = 0; i <= count; ++i)
          sum[i] = w * c[i];
      else
        for (std::int64_t i = 0; i <= count; ++i)
          sum[i] += w * c[i];
    }
    float* to = v + 2 * begin;
    const std::int64_t whole = 2 * (begin + count) <= n ? count : count - 1;
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < whole; ++i)
    {
      to[2 * i] = sum[i];
      to[2 * i + 1] = 0.5F * (sum[i] + sum[i + 1]);
    }
    if (whole < count)
      to[2 * whole] = sum[whole];
  }
}

void axpy(std::int64_t n, float a, const float* k, float* w)
{
  LAMELLA_SIMD
  for (std::int64_t i = 0; i < n; ++i)
    w[i] += a * k[i];
}

template <class A, class B>
double product(std::int64_t n, const A* a, const B* b)
{
  double sum = 0;
  _Pragma("omp simd reduction(+ : sum)") for (std::int64_t i = 0; i < n; ++i) sum +=
    static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return sum;
}

double dot(std::int64_t n, const double* a, const double* b)
{
  return product(n, a, b);
}

double dotMixed(std::int64_t n, const double* a, const float* b)
{
  return product(n, a, b);
}

void axpyDouble(std::int64_t n, double a, const double* x, double* y)
{
  LAMELLA_SIMD
  for (std::int64_t i = 0; i < n; ++i)
    y[i] += a * x[i];
}

void direction(std::int64_t n, const float* z, double a, double b, double* p)
{
  LAMELLA_SIMD
  for (std::int64_t i = 0; i < n; ++i)
    p[i] = a * static_cast<double>(z[i]) + b * p[i];
}

void toFloat(std::int64_t n, double scale, const double* a, float* b)
{
  LAMELLA_SIMD
  for (std::int64_t i = 0; i < n; ++i)
    b[i] = static_cast<float>(scale * a[i]);
}

} // namespace

extern const LevelKernels LAMELLA_KERNELS;
const LevelKernels LAMELLA_KERNELS{ subtractProduct, chebyshev, restrictRow, interpolateRow, axpy, dot, dotMixed,
  axpyDouble, direction, toFloat };

} // namespace lamella::peridynamics
