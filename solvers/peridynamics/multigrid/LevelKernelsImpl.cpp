// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines.
#include "peridynamics/multigrid/LevelKernels.h"

#include <algorithm>

#define LAMELLA_SIMD _Pragma("omp simd")

namespace lamella::peridynamics
{
namespace
{

constexpr std::int64_t strip = 128; // nodes whose sums stay in the first cache while the neighbours pass

void subtract2(std::int64_t n, const BlockRow& r)
{
  for (std::int64_t begin = 0; begin < n; begin += strip)
  {
    const std::int64_t count = std::min(strip, n - begin);
    float sx[strip];
    float sy[strip];
    const float* x = r.here[0] + begin;
    const float* y = r.here[1] + begin;
    {
      const float* a = r.diagonal[0] + begin;
      const float* b = r.diagonal[1] + begin;
      const float* c = r.diagonal[2] + begin;
      LAMELLA_SIMD
      for (std::int64_t i = 0; i < count; ++i)
      {
        sx[i] = a[i] * x[i] + c[i] * y[i];
        sy[i] = c[i] * x[i] + b[i] * y[i];
      }
    }
    for (int q = 0; q < r.half; ++q)
    {
      const std::int64_t jump = r.jump[q];
      const std::int64_t shift = begin + q * r.blockStride;
      const float* a = r.block[0] + shift;
      const float* b = r.block[1] + shift;
      const float* c = r.block[2] + shift;
      const float* a0 = a - jump;
      const float* b0 = b - jump;
      const float* c0 = c - jump;
      const float* xn = x + jump;
      const float* yn = y + jump;
      const float* xp = x - jump;
      const float* yp = y - jump;
      LAMELLA_SIMD
      for (std::int64_t i = 0; i < count; ++i)
      {
        sx[i] += a[i] * xn[i] + c[i] * yn[i] + a0[i] * xp[i] + c0[i] * yp[i];
        sy[i] += c[i] * xn[i] + b[i] * yn[i] + c0[i] * xp[i] + b0[i] * yp[i];
      }
    }
    float* ox = r.out[0] + begin;
    float* oy = r.out[1] + begin;
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < count; ++i)
    {
      ox[i] -= sx[i];
      oy[i] -= sy[i];
    }
  }
}

void subtract3(std::int64_t n, const BlockRow& r)
{
  for (std::int64_t begin = 0; begin < n; begin += strip)
  {
    const std::int64_t count = std::min(strip, n - begin);
    float sx[strip];
    float sy[strip];
    float sz[strip];
    const float* x = r.here[0] + begin;
    const float* y = r.here[1] + begin;
    const float* z = r.here[2] + begin;
    const auto at = [&](int e) { return r.diagonal[e] + begin; };
    {
      const float *xx = at(0), *yy = at(1), *zz = at(2), *xy = at(3), *yz = at(4), *xz = at(5);
      LAMELLA_SIMD
      for (std::int64_t i = 0; i < count; ++i)
      {
        sx[i] = xx[i] * x[i] + xy[i] * y[i] + xz[i] * z[i];
        sy[i] = xy[i] * x[i] + yy[i] * y[i] + yz[i] * z[i];
        sz[i] = xz[i] * x[i] + yz[i] * y[i] + zz[i] * z[i];
      }
    }
    for (int q = 0; q < r.half; ++q)
      for (const bool forward : { true, false })
      {
        const std::int64_t jump = forward ? r.jump[q] : -r.jump[q];
        const std::int64_t shift = begin + q * r.blockStride + (forward ? 0 : jump);
        const float *xx = r.block[0] + shift, *yy = r.block[1] + shift, *zz = r.block[2] + shift;
        const float *xy = r.block[3] + shift, *yz = r.block[4] + shift, *xz = r.block[5] + shift;
        const float *u = x + jump, *v = y + jump, *w = z + jump;
        LAMELLA_SIMD
        for (std::int64_t i = 0; i < count; ++i)
        {
          sx[i] += xx[i] * u[i] + xy[i] * v[i] + xz[i] * w[i];
          sy[i] += xy[i] * u[i] + yy[i] * v[i] + yz[i] * w[i];
          sz[i] += xz[i] * u[i] + yz[i] * v[i] + zz[i] * w[i];
        }
      }
    float *ox = r.out[0] + begin, *oy = r.out[1] + begin, *oz = r.out[2] + begin;
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < count; ++i)
    {
      ox[i] -= sx[i];
      oy[i] -= sy[i];
      oz[i] -= sz[i];
    }
  }
}

void subtractProduct(int dimension, std::int64_t n, const BlockRow& row)
{
  (dimension == 3 ? subtract3 : subtract2)(n, row);
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
    finish(0, [=](std::int64_t i) { return b * (xx[i] * u[i] + xy[i] * v[i]); });
    finish(1, [=](std::int64_t i) { return b * (xy[i] * u[i] + yy[i] * v[i]); });
    return;
  }
  const float *xx = inverse[0], *yy = inverse[1], *zz = inverse[2], *xy = inverse[3], *yz = inverse[4],
              *xz = inverse[5], *u = r[0], *v = r[1], *w = r[2];
  finish(0, [=](std::int64_t i) { return b * (xx[i] * u[i] + xy[i] * v[i] + xz[i] * w[i]); });
  finish(1, [=](std::int64_t i) { return b * (xy[i] * u[i] + yy[i] * v[i] + yz[i] * w[i]); });
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
