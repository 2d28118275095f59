// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines.
#include "peridynamics/fracture/EventKernels.h"

#include "peridynamics/kernels/Lanes.h"

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

/// Calls f(x, vector) for the vectors of a row, wide ones as long as there is room.
template <class F>
void forVectors(std::int64_t n, F&& f)
{
  std::int64_t x = 0;
  for (; x + wide <= n; x += wide)
    f(x, Vector<wide>{});
  if constexpr (wide > eventLanes)
    if (x < n)
      f(x, Vector<eventLanes>{});
}

/// The product on Parts vectors of Lanes nodes of a row. Returns u·out.
template <int Dim, int Lanes, int Parts>
auto springPart(const WindowRows& w, const SpringRows& s, std::int64_t row, std::int64_t x)
{
  using N = Vector<Lanes>;
  using L = typename N::V;
  const float* here[Dim];
  for (int c = 0; c < Dim; ++c)
    here[c] = w.here[c] + row * w.hereRow + x;
  const std::int64_t bond = row * s.springRow + x;
  L u[Parts][Dim];
  L f[Parts][Dim];
  for (int part = 0; part < Parts; ++part)
    for (int c = 0; c < Dim; ++c)
    {
      u[part][c] = N::load(here[c] + part * Lanes);
      f[part][c] = w.plus[c] != nullptr ? N::load(w.plus[c] + row * w.plusRow + x + part * Lanes) : L{};
    }
  for (int o = 0; o < s.count; ++o)
    for (int part = 0; part < Parts; ++part)
    {
      const std::int64_t at = part * Lanes;
      L ahead{};
      L behind{};
      for (int c = 0; c < Dim; ++c)
      {
        const float e = s.direction[c][o];
        ahead += e * (N::load(here[c] + at + w.jump[o]) - u[part][c]);
        behind += e * (N::load(here[c] + at - w.jump[o]) - u[part][c]);
      }
      const L t = N::load(s.spring[o] + bond + at) * ahead + N::load(s.back[o] + bond + at) * behind;
      for (int c = 0; c < Dim; ++c)
        f[part][c] += s.direction[c][o] * t;
    }
  L sum{};
  for (int part = 0; part < Parts; ++part)
    for (int c = 0; c < Dim; ++c)
    {
      N::store(w.out[c] + row * w.outRow + x + part * Lanes, f[part][c]);
      sum += f[part][c] * u[part][c];
    }
  return sum;
}

template <int Dim>
double springsOf(const WindowRows& w, const SpringRows& s)
{
  return sumOfParts(
    w.rows, w.n,
    [&]<int nodes, int parts>(std::int64_t row, std::int64_t x, std::integral_constant<int, nodes>,
      std::integral_constant<int, parts>) { return springPart<Dim, nodes, parts>(w, s, row, x); });
}

double springs(int dimension, const WindowRows& rows, const SpringRows& springs)
{
  return dimension == 3 ? springsOf<3>(rows, springs) : springsOf<2>(rows, springs);
}

// Sums over a row in single precision are good for steps of conjugate gradients; those of rows are added in double.
double total(V sums)
{
  double sum = 0;
  for (int i = 0; i < eventLanes; ++i)
    sum += static_cast<double>(sums[i]);
  return sum;
}

/// z = D⁻¹ r at a vector of nodes. Returns r·z.
template <int Dim, class N>
typename N::V invert(const float* const* inverse, std::int64_t at, const typename N::V* r, typename N::V* z)
{
  const auto m = [&](int e) { return N::load(inverse[e] + at); };
  if constexpr (Dim == 2)
  {
    z[0] = m(0) * r[0] + m(2) * r[1];
    z[1] = m(2) * r[0] + m(1) * r[1];
    return z[0] * r[0] + z[1] * r[1];
  }
  else
  {
    z[0] = m(0) * r[0] + m(3) * r[1] + m(5) * r[2];
    z[1] = m(3) * r[0] + m(1) * r[1] + m(4) * r[2];
    z[2] = m(5) * r[0] + m(4) * r[1] + m(2) * r[2];
    return z[0] * r[0] + z[1] * r[1] + z[2] * r[2];
  }
}

/// Of a step, or of none.
template <int Dim, bool Step>
double stepOf(const StepRows& s, float a)
{
  InDouble sum;
  for (std::int64_t row = 0; row < s.rows; ++row)
  {
    typename Vector<wide>::V many{};
    V few{};
    forVectors(s.n,
      [&]<class N>(std::int64_t x, N)
      {
        using L = typename N::V;
        const std::int64_t work = row * s.workRow + x;
        const std::int64_t level = row * s.levelRow + x;
        L r[Dim];
        L z[Dim];
        for (int c = 0; c < Dim; ++c)
        {
          r[c] = N::load(s.r[c] + work);
          if constexpr (Step)
          {
            const L by = a * N::load(s.p[c] + work);
            for (const auto& moved : s.moved)
              if (moved[c] != nullptr)
                N::store(moved[c] + level, N::load(moved[c] + level) + by);
            r[c] += a * N::load(s.q[c] + work);
            N::store(s.r[c] + work, r[c]);
          }
        }
        const L product = invert<Dim, N>(s.inverse, level, r, z);
        for (int c = 0; c < Dim; ++c)
          N::store((Step ? s.q[c] : s.p[c]) + work, z[c]);
        if constexpr (sizeof(L) == sizeof(V))
          few += product;
        else
          many += product;
      });
    sum.add(many);
    sum.add(few);
  }
  return sum.total();
}

double precondition(int dimension, const StepRows& rows)
{
  return dimension == 3 ? stepOf<3, false>(rows, 0) : stepOf<2, false>(rows, 0);
}

double step(int dimension, const StepRows& rows, float a)
{
  return dimension == 3 ? stepOf<3, true>(rows, a) : stepOf<2, true>(rows, a);
}

void turn(int dimension, const StepRows& s, float b)
{
  for (std::int64_t row = 0; row < s.rows; ++row)
    for (int c = 0; c < dimension; ++c)
      forVectors(
        s.n,
        [&]<class N>(std::int64_t x, N)
        {
          float* p = s.p[c] + row * s.workRow + x;
          N::store(p, N::load(s.q[c] + row * s.workRow + x) + b * N::load(p));
        });
}

void addRows(
  std::int64_t rows, std::int64_t n, float a, const float* from, std::int64_t fromRow, float* to, std::int64_t toRow)
{
  for (std::int64_t row = 0; row < rows; ++row)
    forVectors(
      n,
      [&]<class N>(std::int64_t x, N)
      {
        float* at = to + row * toRow + x;
        N::store(at, N::load(at) + a * N::load(from + row * fromRow + x));
      });
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
const EventKernels LAMELLA_KERNELS{ springs, precondition, step, turn, addRows, dot, direction, select, stretch };

} // namespace lamella::peridynamics
