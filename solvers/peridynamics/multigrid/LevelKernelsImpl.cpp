// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines.
#include "peridynamics/kernels/Lanes.h"
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

// Eight values whatever the registers: most levels are narrow.
constexpr int lanes = 8;
constexpr int cacheLine = 64 / sizeof(float);
using V __attribute__((vector_size(4 * lanes))) = float;
using AnyV __attribute__((vector_size(4 * lanes), aligned(4), may_alias)) = float; // at any address

V load(const float* p)
{
  return *reinterpret_cast<const AnyV*>(p);
}

/// Component c of a symmetric block, whose entry e is at block[e], times a vector.
template <int Dim, class L>
L times(int c, const L* block, const L* x)
{
  if constexpr (Dim == 2)
    return c == 0 ? block[0] * x[0] + block[2] * x[1] : block[2] * x[0] + block[1] * x[1];
  else
    return c == 0 ? block[0] * x[0] + block[3] * x[1] + block[5] * x[2]
      : c == 1    ? block[3] * x[0] + block[1] * x[1] + block[4] * x[2]
                  : block[5] * x[0] + block[4] * x[1] + block[2] * x[2];
}

/// The product on Parts vectors of Lanes nodes of a row. Returns x·out. With `Ahead` the next row's matrix is fetched.
template <int Dim, int Lanes, int Parts, bool Ahead = false>
auto blockPart(const WindowRows& w, const BlockRow& r, std::int64_t row, std::int64_t x, std::int64_t diagonalRow,
  const std::uint8_t* mirrored)
{
  using N = Vector<Lanes>;
  using L = typename N::V;
  constexpr int entries = blockEntries(Dim);
  L ahead[Parts][Dim]{};
  L behind[Parts][Dim]{};
  const float* here[Dim];
  for (int c = 0; c < Dim; ++c)
    here[c] = w.here[c] + row * w.hereRow + x;
  const float* diagonal[entries];
  for (int e = 0; e < entries; ++e)
    diagonal[e] = r.diagonal[e] + row * diagonalRow + x;
  const std::int64_t entry = r.blockStride / entries;
  const auto add = [&](L(&sum)[Dim], const auto& blockAt, std::int64_t jump)
  {
    L block[entries];
    L u[Dim];
    for (int e = 0; e < entries; ++e)
      block[e] = N::load(blockAt(e));
    for (int c = 0; c < Dim; ++c)
      u[c] = N::load(here[c] + jump);
    for (int c = 0; c < Dim; ++c)
      sum[c] += times<Dim>(c, block, u);
  };
  for (int part = 0; part < Parts; ++part)
    add(
      ahead[part], [&](int e) { return diagonal[e] + part * Lanes; }, part * Lanes);
  const float* block = r.block[0] + row * r.nextRow + x;
  for (int q = 0; q < r.half; ++q, block += r.blockStride)
  {
    for (int e = 0; Ahead && e < entries; ++e) // many and short streams: the processor does not see them coming
      for (int at = 0; at < Parts * Lanes; at += cacheLine)
        __builtin_prefetch(block + e * entry + at + r.nextRow, 0, 2);
    for (int part = 0; part < Parts; ++part)
    {
      add(
        ahead[part], [&](int e) { return block + e * entry + part * Lanes; }, w.jump[q] + part * Lanes);
      if (mirrored[q] != 0)
        add(
          behind[part], [&](int e) { return block - r.back[q] + e * entry + part * Lanes; }, part * Lanes - w.jump[q]);
    }
  }
  L sum{};
  for (int part = 0; part < Parts; ++part)
    for (int c = 0; c < Dim; ++c)
    {
      const std::int64_t at = x + part * Lanes;
      const L plus = w.plus[c] != nullptr ? N::load(w.plus[c] + row * w.plusRow + at) : L{};
      const L out = plus - (ahead[part][c] + behind[part][c]);
      N::store(w.out[c] + row * w.outRow + at, out);
      sum += out * N::load(here[c] + part * Lanes);
    }
  return sum;
}

template <int Dim>
double windowOf(const WindowRows& w, const BlockRow& r, std::int64_t diagonalRow, const std::uint8_t* const* mirrored)
{
  return sumOfParts(
    w.rows, w.n,
    [&]<int nodes, int parts>(
      std::int64_t row, std::int64_t x, std::integral_constant<int, nodes>, std::integral_constant<int, parts>)
    { return blockPart<Dim, nodes, parts>(w, r, row, x, diagonalRow, mirrored[row]); });
}

/// One row. Past its last node there is padding, where matrices are zero.
template <int Dim>
void subtract(std::int64_t n, const BlockRow& r)
{
  WindowRows w;
  w.jump = r.jump;
  for (int c = 0; c < Dim; ++c)
  {
    w.here[c] = r.here[c];
    w.plus[c] = w.out[c] = r.out[c];
  }
  std::int64_t x = 0;
  for (; x + 2 * wide - lanes < n; x += 2 * wide)
    blockPart<Dim, wide, 2, true>(w, r, 0, x, 0, r.mirrored);
  for (; x + wide - lanes < n; x += wide)
    blockPart<Dim, wide, 1, true>(w, r, 0, x, 0, r.mirrored);
  for (; x < n; x += lanes)
    blockPart<Dim, lanes, 1, true>(w, r, 0, x, 0, r.mirrored);
}

double window(int dimension, const WindowRows& rows, const BlockRow& matrix, std::int64_t diagonalRow,
  const std::uint8_t* const* mirrored)
{
  return dimension == 3 ? windowOf<3>(rows, matrix, diagonalRow, mirrored)
                        : windowOf<2>(rows, matrix, diagonalRow, mirrored);
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

void restrictRows(
  std::int64_t n, int rows, const float* weights, const float* const* fine, int fields, float* const* out)
{
  for (std::int64_t i = 0; i < n; i += lanes)
  {
    V first{}; // of the fine nodes 2i and on
    V second{};
    for (int r = 0; r < rows; ++r)
    {
      const float* v = fine[r] + 2 * i;
      first += weights[r] * (load(v) + 0.5F * (load(v - 1) + load(v + 1)));
      second += weights[r] * (load(v + lanes) + 0.5F * (load(v + lanes - 1) + load(v + lanes + 1)));
    }
    const V sum = __builtin_shufflevector(first, second, 0, 2, 4, 6, 8, 10, 12, 14);
    for (int f = 0; f < fields; ++f)
    {
      float* to = out[f] + i;
      if (i + lanes <= n)
        *reinterpret_cast<AnyV*>(to) = load(to) + sum;
      else
        for (std::int64_t k = 0; k < n - i; ++k)
          to[k] += sum[k];
    }
  }
}

void interpolateRow(std::int64_t n, float w, int rows, const float* const* coarse, const float* plus, float* v)
{
  for (std::int64_t i = 0; i < n; i += 2 * lanes)
  {
    V here{}; // of the coarse nodes i/2 and on
    V next{};
    for (int r = 0; r < rows; ++r)
    {
      here += load(coarse[r] + i / 2);
      next += load(coarse[r] + i / 2 + 1);
    }
    here *= w;
    next = 0.5F * (here + w * next);
    const V low = __builtin_shufflevector(here, next, 0, 8, 1, 9, 2, 10, 3, 11);
    const V high = __builtin_shufflevector(here, next, 4, 12, 5, 13, 6, 14, 7, 15);
    const auto put = [&](std::int64_t at, V values)
    {
      if (at + lanes <= n)
        *reinterpret_cast<AnyV*>(v + at) = plus != nullptr ? load(plus + at) + values : values;
      else
        for (std::int64_t k = 0; k < n - at; ++k)
          v[at + k] = plus != nullptr ? plus[at + k] + values[k] : values[k];
    };
    put(i, low);
    put(i + lanes, high);
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
const LevelKernels LAMELLA_KERNELS{ window, subtractProduct, chebyshev, restrictRows, interpolateRow, axpy, dot,
  dotMixed, axpyDouble, direction, toFloat };

} // namespace lamella::peridynamics
