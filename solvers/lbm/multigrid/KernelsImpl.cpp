// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines. Plain loops over
// plain pointers, which the compiler turns into SIMD; see Kernels.h for why there is nothing else.

#include "lbm/multigrid/Kernels.h"

#define LAMELLA_SIMD _Pragma("omp simd")

namespace lamella::lbm
{
namespace
{

constexpr float unit = 1.0F / 65535.0F;

void relaxStraight(int count, std::int64_t n, float* u, const float* f, const float* const* g, const float* const* v)
{
  if (count == 4)
  {
    const float *g0 = g[0], *g1 = g[1], *g2 = g[2], *g3 = g[3];
    const float *v0 = v[0], *v1 = v[1], *v2 = v[2], *v3 = v[3];
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < n; ++i)
      u[i] =
        (f[i] + g0[i] * v0[i] + g1[i] * v1[i] + g2[i] * v2[i] + g3[i] * v3[i]) / ((g0[i] + g1[i]) + (g2[i] + g3[i]));
  }
  else
  {
    const float *g0 = g[0], *g1 = g[1], *g2 = g[2], *g3 = g[3], *g4 = g[4], *g5 = g[5];
    const float *v0 = v[0], *v1 = v[1], *v2 = v[2], *v3 = v[3], *v4 = v[4], *v5 = v[5];
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < n; ++i)
      u[i] = (f[i] + g0[i] * v0[i] + g1[i] * v1[i] + g2[i] * v2[i] + g3[i] * v3[i] + g4[i] * v4[i] + g5[i] * v5[i]) /
        ((g0[i] + g1[i]) + (g2[i] + g3[i]) + (g4[i] + g5[i]));
  }
}

void relaxStraightFromZero(int count, std::int64_t n, float* u, const float* f, const float* const* g)
{
  const float *g0 = g[0], *g1 = g[1], *g2 = g[2], *g3 = g[3];
  if (count == 4)
  {
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < n; ++i)
      u[i] = f[i] / ((g0[i] + g1[i]) + (g2[i] + g3[i]));
  }
  else
  {
    const float *g4 = g[4], *g5 = g[5];
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < n; ++i)
      u[i] = f[i] / ((g0[i] + g1[i]) + (g2[i] + g3[i]) + (g4[i] + g5[i]));
  }
}

void residualStraight(
  int count, std::int64_t n, float* r, const float* f, const float* u, const float* const* g, const float* const* v)
{
  const float *g0 = g[0], *g1 = g[1], *g2 = g[2], *g3 = g[3];
  const float *v0 = v[0], *v1 = v[1], *v2 = v[2], *v3 = v[3];
  if (count == 4)
  {
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < n; ++i)
      r[i] = f[i] + g0[i] * (v0[i] - u[i]) + g1[i] * (v1[i] - u[i]) + g2[i] * (v2[i] - u[i]) + g3[i] * (v3[i] - u[i]);
  }
  else
  {
    const float *g4 = g[4], *g5 = g[5];
    const float *v4 = v[4], *v5 = v[5];
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < n; ++i)
      r[i] = f[i] + g0[i] * (v0[i] - u[i]) + g1[i] * (v1[i] - u[i]) + g2[i] * (v2[i] - u[i]) + g3[i] * (v3[i] - u[i]) +
        g4[i] * (v4[i] - u[i]) + g5[i] * (v5[i] - u[i]);
  }
}

double applyStraight(int count, std::int64_t n, float* q, const float* p, const float* const* g, const float* const* v)
{
  const float *g0 = g[0], *g1 = g[1], *g2 = g[2], *g3 = g[3];
  const float *v0 = v[0], *v1 = v[1], *v2 = v[2], *v3 = v[3];
  float sum = 0;
  if (count == 4)
  {
#pragma omp simd reduction(+ : sum)
    for (std::int64_t i = 0; i < n; ++i)
    {
      const float c = p[i];
      const float s = g0[i] * (c - v0[i]) + g1[i] * (c - v1[i]) + g2[i] * (c - v2[i]) + g3[i] * (c - v3[i]);
      q[i] = s;
      sum += c * s;
    }
  }
  else
  {
    const float *g4 = g[4], *g5 = g[5];
    const float *v4 = v[4], *v5 = v[5];
#pragma omp simd reduction(+ : sum)
    for (std::int64_t i = 0; i < n; ++i)
    {
      const float c = p[i];
      const float s = g0[i] * (c - v0[i]) + g1[i] * (c - v1[i]) + g2[i] * (c - v2[i]) + g3[i] * (c - v3[i]) +
        g4[i] * (c - v4[i]) + g5[i] * (c - v5[i]);
      q[i] = s;
      sum += c * s;
    }
  }
  return sum;
}

// Blocks of `lanes` nodes keep their sums in registers while the links pass by.
constexpr int lanes = 32;

template <bool Difference>
void sumLinks(int count, std::int64_t first, const float* u, const float* const* g, const float* const* v, float* sum)
{
  for (int k = 0; k < count; ++k)
  {
    const float* gk = g[k] + first;
    const float* vk = v[k] + first;
    LAMELLA_SIMD
    for (int j = 0; j < lanes; ++j)
      sum[j] += gk[j] * (Difference ? vk[j] - u[first + j] : vk[j]);
  }
}

template <bool Difference>
void sumLinksRest(int count, std::int64_t first, std::int64_t n, const float* u, const float* const* g,
  const float* const* v, float* sum)
{
  for (int k = 0; k < count; ++k)
    for (std::int64_t j = first; j < n; ++j)
      sum[j - first] += g[k][j] * (Difference ? v[k][j] - u[j] : v[k][j]);
}

void relaxGeneral(int count, std::int64_t n, float* u, const float* f, const float* inverse, const float* const* g,
  const float* const* v)
{
  float sum[lanes];
  for (std::int64_t first = 0; first < n; first += lanes)
  {
    const std::int64_t m = n - first < lanes ? n - first : lanes;
    for (std::int64_t j = 0; j < m; ++j)
      sum[j] = f[first + j];
    if (m == lanes)
      sumLinks<false>(count, first, u, g, v, sum);
    else
      sumLinksRest<false>(count, first, n, u, g, v, sum);
    for (std::int64_t j = 0; j < m; ++j)
      u[first + j] = sum[j] * inverse[first + j];
  }
}

void residualGeneral(
  int count, std::int64_t n, float* r, const float* f, const float* u, const float* const* g, const float* const* v)
{
  float sum[lanes];
  for (std::int64_t first = 0; first < n; first += lanes)
  {
    const std::int64_t m = n - first < lanes ? n - first : lanes;
    for (std::int64_t j = 0; j < m; ++j)
      sum[j] = f[first + j];
    if (m == lanes)
      sumLinks<true>(count, first, u, g, v, sum);
    else
      sumLinksRest<true>(count, first, n, u, g, v, sum);
    for (std::int64_t j = 0; j < m; ++j)
      r[first + j] = sum[j];
  }
}

double applyGeneral(int count, std::int64_t n, float* q, const float* p, const float* const* g, const float* const* v)
{
  float sum[lanes];
  double total = 0;
  for (std::int64_t first = 0; first < n; first += lanes)
  {
    const std::int64_t m = n - first < lanes ? n - first : lanes;
    for (std::int64_t j = 0; j < m; ++j)
      sum[j] = 0;
    if (m == lanes)
      sumLinks<true>(count, first, p, g, v, sum);
    else
      sumLinksRest<true>(count, first, n, p, g, v, sum);
    float part = 0;
    for (std::int64_t j = 0; j < m; ++j)
    {
      q[first + j] = -sum[j];
      part -= sum[j] * p[first + j];
    }
    total += part;
  }
  return total;
}

void inverseSum(int count, std::int64_t n, float* inverse, const float* const* g)
{
  for (std::int64_t i = 0; i < n; ++i)
  {
    float sum = 0;
    for (int k = 0; k < count; ++k)
      sum += g[k][i];
    inverse[i] = 1.0F / sum;
  }
}

void axpy(std::int64_t n, float a, const float* x, float* y)
{
  LAMELLA_SIMD
  for (std::int64_t i = 0; i < n; ++i)
    y[i] += a * x[i];
}

void xpby(std::int64_t n, const float* z, float b, float* p)
{
  LAMELLA_SIMD
  for (std::int64_t i = 0; i < n; ++i)
    p[i] = z[i] + b * p[i];
}

double dot(std::int64_t n, const float* x, const float* y)
{
  float sum = 0;
#pragma omp simd reduction(+ : sum)
  for (std::int64_t i = 0; i < n; ++i)
    sum += x[i] * y[i];
  return sum;
}

void addWeighted(std::int64_t n, float* __restrict out, const std::uint16_t* __restrict w, const float* __restrict x)
{
  LAMELLA_SIMD
  for (std::int64_t i = 0; i < n; ++i)
    out[i] += (static_cast<float>(static_cast<std::int32_t>(w[i])) * unit) * x[i];
}

void merge(std::int64_t n, std::int64_t half, const float* __restrict split, float* __restrict natural)
{
  const std::int64_t pairs = n / 2;
  for (std::int64_t i = 0; i < pairs; ++i)
  {
    natural[2 * i] = split[i];
    natural[2 * i + 1] = split[half + i];
  }
  if (n % 2 != 0)
    natural[n - 1] = split[pairs];
}

void splitRow(std::int64_t n, std::int64_t half, const float* __restrict natural, float* __restrict split)
{
  const std::int64_t pairs = n / 2;
  for (std::int64_t i = 0; i < pairs; ++i)
  {
    split[i] = natural[2 * i];
    split[half + i] = natural[2 * i + 1];
  }
  if (n % 2 != 0)
    split[pairs] = natural[n - 1];
}

// ---- Galerkin product -------------------------------------------------------------------------------------------

constexpr int width = 8; // cells at a time

// Offset of a node of parity a = 0, 1, 2 (2: the next cell's even node) from its cell's begin in a split row.
inline std::int64_t offsetOf(int a, std::int64_t half)
{
  return a == 0 ? 0 : a == 1 ? half : 1;
}

template <int Dimension>
void galerkinBlock(bool straight, std::int64_t first, int valid, std::int64_t half, const CellLinks& links,
  const CellWeights (*weights)[2], float* const (*out)[2][maxForward])
{
  constexpr int corners = Dimension == 3 ? 8 : 4;
  constexpr int layers = Dimension == 3 ? 3 : 1;
  const int forward = Dimension == 3 ? (straight ? 3 : 13) : (straight ? 2 : 4);
  const int(*directions)[3] = Dimension == 3 ? directions3 : directions2;

  // Interpolation rows of the 3 × 3 (× 3) nodes of the closed cell, onto its corners.
  float row[27][8][width];
  for (int c = 0; c < layers; ++c)
    for (int b = 0; b < 3; ++b)
      for (int a = 0; a < 3; ++a)
      {
        const int node = a + 3 * b + 9 * c;
        const int kind = (a & 1) + 2 * (b & 1) + 4 * (c & 1);
        const int base = (a / 2) + 2 * (b / 2) + 4 * (c / 2); // the lowest corner that this node reaches
        for (int k = 0; k < corners; ++k)
          for (int j = 0; j < width; ++j)
            row[node][k][j] = 0;
        if (kind == 0)
        {
          for (int j = 0; j < width; ++j)
            row[node][base][j] = 1;
          continue;
        }
        const CellWeights& w = weights[b / 2][c / 2];
        for (int k = 0; k < corners; ++k)
          if ((k & ~kind) == 0)
          {
            const std::uint16_t* source = w.w[kind][k] + first + a / 2;
            for (int j = 0; j < valid; ++j)
              row[node][base + k][j] = static_cast<float>(static_cast<std::int32_t>(source[j])) * unit;
          }
      }

  float sum[8][8][width];
  for (int k = 0; k < corners; ++k)
    for (int l = 0; l < corners; ++l)
      for (int j = 0; j < width; ++j)
        sum[k][l][j] = 0;

  // Every link belongs to the cell of the lowest corner of its box.
  for (int c = 0; c < (Dimension == 3 ? 2 : 1); ++c)
    for (int b = 0; b < 2; ++b)
      for (int a = 0; a < 2; ++a)
        for (int d = 0; d < forward; ++d)
        {
          // from: where the link is stored; to: its other end
          const int fromX = a + (directions[d][0] < 0 ? 1 : 0);
          const int fromY = b + (directions[d][1] < 0 ? 1 : 0);
          const int toX = fromX + directions[d][0];
          const int toY = fromY + directions[d][1];
          const int toZ = c + directions[d][2];
          const float* stored = links.link[fromY][c][d];
          if (stored == nullptr)
            continue;
          const float* g = stored + first + offsetOf(fromX, half);
          const int from = fromX + 3 * fromY + 9 * c;
          const int to = toX + 3 * toY + 9 * toZ;
          float conductance[width];
          for (int j = 0; j < width; ++j)
            conductance[j] = j < valid ? g[j] : 0.0F;
          float difference[8][width];
          for (int k = 0; k < corners; ++k)
            for (int j = 0; j < width; ++j)
              difference[k][j] = row[from][k][j] - row[to][k][j];
          for (int k = 0; k < corners; ++k)
          {
            float scaled[width];
            for (int j = 0; j < width; ++j)
              scaled[j] = -conductance[j] * difference[k][j];
            for (int l = k + 1; l < corners; ++l)
              for (int j = 0; j < width; ++j)
                sum[k][l][j] += scaled[j] * difference[l][j];
          }
        }

  for (int k = 0; k < corners; ++k)
    for (int l = k + 1; l < corners; ++l)
    {
      // corner l − corner k as a direction, turned forward
      const int dx = (l & 1) - (k & 1);
      const int dy = ((l >> 1) & 1) - ((k >> 1) & 1);
      const int dz = ((l >> 2) & 1) - ((k >> 2) & 1);
      const bool isForward = dz > 0 || (dz == 0 && (dy > 0 || (dy == 0 && dx > 0)));
      const int sign = isForward ? 1 : -1;
      const int from = isForward ? k : l;
      int d = 0;
      while (directions[d][0] != sign * dx || directions[d][1] != sign * dy || directions[d][2] != sign * dz)
        ++d;
      float* target = out[(from >> 1) & 1][(from >> 2) & 1][d] + first + (from & 1);
      for (int j = 0; j < valid; ++j)
        target[j] += sum[k][l][j];
    }
}

void galerkin(int dimension, bool straight, std::int64_t first, std::int64_t last, std::int64_t half,
  const CellLinks& links, const CellWeights (*weights)[2], float* const (*out)[2][maxForward])
{
  for (std::int64_t i = first; i < last; i += width)
  {
    const int valid = static_cast<int>(last - i < width ? last - i : width);
    if (dimension == 3)
      galerkinBlock<3>(straight, i, valid, half, links, weights, out);
    else
      galerkinBlock<2>(straight, i, valid, half, links, weights, out);
  }
}

} // namespace

extern const Kernels LAMELLA_KERNELS;
const Kernels LAMELLA_KERNELS = { relaxStraight, relaxStraightFromZero, residualStraight, applyStraight, relaxGeneral,
  residualGeneral, applyGeneral, inverseSum, axpy, xpby, dot, addWeighted, merge, splitRow, galerkin };

} // namespace lamella::lbm
