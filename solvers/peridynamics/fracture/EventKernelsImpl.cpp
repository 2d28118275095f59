// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines.
#include "peridynamics/fracture/EventKernels.h"

namespace lamella::peridynamics
{
namespace
{

// Eight values whatever the registers: windows are some forty nodes wide.
using V __attribute__((vector_size(4 * eventLanes))) = float;
using AnyV __attribute__((vector_size(4 * eventLanes), aligned(4), may_alias)) = float; // at any address
using W __attribute__((vector_size(4 * eventLanes))) = std::int32_t;
using AnyW __attribute__((vector_size(4 * eventLanes), aligned(4), may_alias)) = std::int32_t;

V load(const float* p)
{
  return *reinterpret_cast<const AnyV*>(p);
}
void store(float* p, V v)
{
  *reinterpret_cast<AnyV*>(p) = v;
}

template <int Dim>
void springsOf(std::int64_t n, const SpringRows& r)
{
  for (std::int64_t x = 0; x < n; x += eventLanes)
  {
    V u[Dim];
    V f[Dim];
    for (int c = 0; c < Dim; ++c)
    {
      u[c] = load(r.here[c] + x);
      f[c] = V{};
    }
    for (int o = 0; o < r.count; ++o)
    {
      const std::int64_t jump = r.jump[o];
      V ahead{};
      V behind{};
      for (int c = 0; c < Dim; ++c)
      {
        const float e = r.direction[c][o];
        ahead += e * (load(r.here[c] + x + jump) - u[c]);
        behind += e * (load(r.here[c] + x - jump) - u[c]);
      }
      const V t = load(r.spring[o] + x) * ahead + load(r.back[o] + x) * behind;
      for (int c = 0; c < Dim; ++c)
        f[c] += r.direction[c][o] * t;
    }
    for (int c = 0; c < Dim; ++c)
      store(r.out[c] + x, f[c]);
  }
}

void springs(int dimension, std::int64_t n, const SpringRows& rows)
{
  dimension == 3 ? springsOf<3>(n, rows) : springsOf<2>(n, rows);
}

// Sums over a row in single precision are good for steps of conjugate gradients; those of rows are added in double.
double total(V sums)
{
  double sum = 0;
  for (int i = 0; i < eventLanes; ++i)
    sum += static_cast<double>(sums[i]);
  return sum;
}

double precondition(int dimension, std::int64_t n, const float* const* inverse, const float* const* r, float* const* z)
{
  V sum{};
  for (std::int64_t x = 0; x < n; x += eventLanes)
  {
    const auto m = [&](int e) { return load(inverse[e] + x); };
    const V u = load(r[0] + x);
    const V v = load(r[1] + x);
    V product;
    if (dimension == 2)
    {
      const V a = m(0) * u + m(2) * v;
      const V b = m(2) * u + m(1) * v;
      store(z[0] + x, a);
      store(z[1] + x, b);
      product = a * u + b * v;
    }
    else
    {
      const V w = load(r[2] + x);
      const V a = m(0) * u + m(3) * v + m(5) * w;
      const V b = m(3) * u + m(1) * v + m(4) * w;
      const V c = m(5) * u + m(4) * v + m(2) * w;
      store(z[0] + x, a);
      store(z[1] + x, b);
      store(z[2] + x, c);
      product = a * u + b * v + c * w;
    }
    sum += product;
  }
  return total(sum);
}

double dot(std::int64_t n, const float* a, const float* b)
{
  V sum[4]{};
  std::int64_t x = 0;
  for (; x + 4 * eventLanes <= n; x += 4 * eventLanes)
    for (int s = 0; s < 4; ++s)
      sum[s] += load(a + x + s * eventLanes) * load(b + x + s * eventLanes);
  for (; x + eventLanes <= n; x += eventLanes)
    sum[0] += load(a + x) * load(b + x);
  double all = total((sum[0] + sum[1]) + (sum[2] + sum[3]));
  for (; x < n; ++x)
    all += static_cast<double>(a[x]) * static_cast<double>(b[x]);
  return all;
}

void direction(std::int64_t n, const float* z, float b, float* p)
{
  std::int64_t x = 0;
  for (; x + eventLanes <= n; x += eventLanes)
    store(p + x, load(z + x) + b * load(p + x));
  for (; x < n; ++x)
    p[x] = z[x] + b * p[x];
}

V pick(const std::uint32_t* words, int bit, V a, V b)
{
  const W w = *reinterpret_cast<const AnyW*>(words);
  const W mask = (w << (31 - bit)) < 0;
  return reinterpret_cast<V>((reinterpret_cast<W>(a) & ~mask) | (reinterpret_cast<W>(b) & mask));
}

void select(int planes, const std::uint32_t* const* words, int bit, const float* table, std::int64_t n, float* out)
{
  const V none{};
  for (std::int64_t x = 0; x < n; x += eventLanes)
    if (planes == 1)
      store(out + x, pick(words[0] + x, bit, none, none + table[1]));
    else if (planes == 2)
      store(out + x,
        pick(words[1] + x, bit, pick(words[0] + x, bit, none, none + table[1]),
          pick(words[0] + x, bit, none + table[2], none + table[3])));
    else
      for (std::int64_t i = x; i < x + eventLanes; ++i)
      {
        std::uint32_t kind = 0;
        for (int p = 0; p < planes; ++p)
          kind |= ((words[p][i] >> bit) & 1U) << p;
        out[i] = table[kind];
      }
}

template <int Dim>
float stretchOf(const TileRows& r)
{
  constexpr int parts = 16 / static_cast<int>(eventLanes);
  V greatest{};
  for (int part = 0; part < parts; ++part)
  {
    const std::int64_t x = part * eventLanes;
    V u[Dim];
    for (int c = 0; c < Dim; ++c)
      u[c] = load(r.u[c] + x);
    for (int o = 0; o < r.count; ++o)
    {
      V along{};
      for (int c = 0; c < Dim; ++c)
        along += r.direction[c][o] * (load(r.u[c] + x + r.jump[o]) - u[c]);
      along *= load(r.inverse[o] + x);
      greatest = along > greatest ? along : greatest;
    }
  }
  float largest = 0;
  for (int i = 0; i < eventLanes; ++i)
    largest = greatest[i] > largest ? greatest[i] : largest;
  return largest;
}

float stretch(const TileRows& rows)
{
  return rows.dimension == 3 ? stretchOf<3>(rows) : stretchOf<2>(rows);
}

} // namespace

extern const EventKernels LAMELLA_KERNELS;
const EventKernels LAMELLA_KERNELS{ springs, precondition, dot, direction, select, stretch };

} // namespace lamella::peridynamics
