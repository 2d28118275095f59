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

// Eight floats that the compiler keeps in registers, whatever their alignment.
typedef float Vector __attribute__((vector_size(32), aligned(4), may_alias));
constexpr int lanes = 8;

inline Vector load(const float* p)
{
  return *reinterpret_cast<const Vector*>(p);
}
inline void store(float* p, Vector v)
{
  *reinterpret_cast<Vector*>(p) = v;
}

// Sums over the links for `Blocks` × 8 nodes from `first` on, kept in registers while the links pass by.
template <int Blocks, bool Difference>
inline void sumLinks(
  int count, std::int64_t first, const Vector* centre, const float* const* g, const float* const* v, Vector* total)
{
  Vector sum[Blocks];
  for (int b = 0; b < Blocks; ++b)
    sum[b] = total[b];
  for (int k = 0; k < count; ++k)
  {
    const float* gk = g[k] + first;
    const float* vk = v[k] + first;
    for (int b = 0; b < Blocks; ++b)
      sum[b] += load(gk + lanes * b) * (Difference ? load(vk + lanes * b) - centre[b] : load(vk + lanes * b));
  }
  for (int b = 0; b < Blocks; ++b)
    total[b] = sum[b];
}

// Calls f(std::integral_constant-like block count, first, nodes in it): whole blocks of 32 nodes, then of 8. The last
// one may reach past the row; what it reads there is never used, and it is told how many nodes to write.
template <int N>
struct Count
{
  static constexpr int value = N;
};
template <class F>
inline void forBlocks(std::int64_t n, F&& f)
{
  std::int64_t first = 0;
  for (; first + 4 * lanes <= n; first += 4 * lanes)
    f(Count<4>{}, first, 4 * lanes);
  for (; first < n; first += lanes)
    f(Count<1>{}, first, static_cast<int>(n - first < lanes ? n - first : lanes));
}

template <int Blocks>
inline void storeFirst(float* out, const Vector* v, int nodes)
{
  if (nodes == Blocks * lanes)
  {
    for (int b = 0; b < Blocks; ++b)
      store(out + lanes * b, v[b]);
    return;
  }
  for (int j = 0; j < nodes; ++j)
    out[j] = v[j / lanes][j % lanes];
}

void relaxGeneral(int count, std::int64_t n, float* u, const float* f, const float* inverse, const float* const* g,
  const float* const* v)
{
  forBlocks(
    n,
    [&](auto blocks, std::int64_t first, int nodes)
    {
      constexpr int Blocks = decltype(blocks)::value;
      Vector sum[Blocks];
      for (int b = 0; b < Blocks; ++b)
        sum[b] = load(f + first + lanes * b);
      sumLinks<Blocks, false>(count, first, sum, g, v, sum);
      for (int b = 0; b < Blocks; ++b)
        sum[b] *= load(inverse + first + lanes * b);
      storeFirst<Blocks>(u + first, sum, nodes);
    });
}

void residualGeneral(
  int count, std::int64_t n, float* r, const float* f, const float* u, const float* const* g, const float* const* v)
{
  forBlocks(
    n,
    [&](auto blocks, std::int64_t first, int nodes)
    {
      constexpr int Blocks = decltype(blocks)::value;
      Vector sum[Blocks];
      Vector centre[Blocks];
      for (int b = 0; b < Blocks; ++b)
      {
        sum[b] = load(f + first + lanes * b);
        centre[b] = load(u + first + lanes * b);
      }
      sumLinks<Blocks, true>(count, first, centre, g, v, sum);
      storeFirst<Blocks>(r + first, sum, nodes);
    });
}

double applyGeneral(int count, std::int64_t n, float* q, const float* p, const float* const* g, const float* const* v)
{
  double total = 0;
  forBlocks(n,
    [&](auto blocks, std::int64_t first, int nodes)
    {
      constexpr int Blocks = decltype(blocks)::value;
      Vector sum[Blocks];
      Vector centre[Blocks];
      for (int b = 0; b < Blocks; ++b)
      {
        sum[b] = Vector{};
        centre[b] = load(p + first + lanes * b);
      }
      sumLinks<Blocks, true>(count, first, centre, g, v, sum);
      float part = 0;
      for (int b = 0; b < Blocks; ++b)
      {
        sum[b] = -sum[b];
        const Vector product = sum[b] * centre[b];
        for (int j = 0; j < lanes; ++j)
          part += lanes * b + j < nodes ? product[j] : 0.0F;
      }
      total += part;
      storeFirst<Blocks>(q + first, sum, nodes);
    });
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
  unsigned reached[27]; // corners that a node's row may have an entry for
  for (int c = 0; c < layers; ++c)
    for (int b = 0; b < 3; ++b)
      for (int a = 0; a < 3; ++a)
      {
        const int node = a + 3 * b + 9 * c;
        const int kind = (a & 1) + 2 * (b & 1) + 4 * (c & 1);
        const int base = (a / 2) + 2 * (b / 2) + 4 * (c / 2); // the lowest corner that this node reaches
        reached[node] = 0;
        for (int k = 0; k < corners; ++k)
          if ((k & ~kind) == 0)
            reached[node] |= 1U << (base + k);
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
          int list[8];
          int used = 0;
          for (int k = 0; k < corners; ++k)
            if (((reached[from] | reached[to]) >> k) & 1U)
              list[used++] = k;
          float difference[8][width];
          for (int k = 0; k < used; ++k)
            for (int j = 0; j < width; ++j)
              difference[k][j] = row[from][list[k]][j] - row[to][list[k]][j];
          for (int k = 0; k < used; ++k)
          {
            float scaled[width];
            for (int j = 0; j < width; ++j)
              scaled[j] = -conductance[j] * difference[k][j];
            for (int l = k + 1; l < used; ++l)
            {
              float* target = sum[list[k]][list[l]];
              for (int j = 0; j < width; ++j)
                target[j] += scaled[j] * difference[l][j];
            }
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

bool factorizeBand(std::int64_t n, std::int64_t width, double* band)
{
  for (std::int64_t k = 0; k < n; ++k)
  {
    double* column = band + k * (width + 1);
    if (!(column[0] > 0))
      return false;
    column[0] = 1 / column[0];
    const std::int64_t below = n - 1 - k < width ? n - 1 - k : width;
    for (std::int64_t i = 1; i <= below; ++i)
    {
      const double factor = column[i] * column[0];
      if (factor == 0)
        continue;
      const double* from = column + i;
      double* to = band + (k + i) * (width + 1);
      LAMELLA_SIMD
      for (std::int64_t j = 0; j <= below - i; ++j)
        to[j] -= factor * from[j];
    }
  }
  return true;
}

// Two columns at once: each waits for what the one before has stored.
void solveBand(std::int64_t n, std::int64_t width, const double* band, double* x)
{
  const std::int64_t stride = width + 1;
  const auto rest = [&](std::int64_t k) { return n - 1 - k < width ? n - 1 - k : width; }; // below column k
  std::int64_t k = 0;
  for (; k + 1 < n; k += 2)
  {
    const double* first = band + k * stride;
    const double* second = first + stride;
    const double v = x[k] * first[0];
    const double w = (x[k + 1] - (width > 0 ? v * first[1] : 0)) * second[0];
    x[k] = v;
    x[k + 1] = w;
    double* to = x + k + 2;
    const std::int64_t both = rest(k) - 1; // elements of the first below the second's diagonal
    LAMELLA_SIMD
    for (std::int64_t i = 0; i < both; ++i)
      to[i] -= v * first[2 + i] + w * second[1 + i];
    for (std::int64_t i = both < 0 ? 0 : both; i < rest(k + 1); ++i)
      to[i] -= w * second[1 + i];
  }
  if (k < n)
    x[k] *= band[k * stride];
  k -= 2; // the last pair
  for (; k >= 0; k -= 2)
  {
    const double* first = band + k * stride;
    const double* second = first + stride;
    const double* from = x + k + 2;
    const std::int64_t both = rest(k) - 1;
    double s = 0;
    double t = 0;
#pragma omp simd reduction(+ : s, t)
    for (std::int64_t i = 0; i < both; ++i)
    {
      s += first[2 + i] * from[i];
      t += second[1 + i] * from[i];
    }
    for (std::int64_t i = both < 0 ? 0 : both; i < rest(k + 1); ++i)
      t += second[1 + i] * from[i];
    x[k + 1] -= t * second[0];
    x[k] -= (s + (width > 0 ? first[1] * x[k + 1] : 0)) * first[0];
  }
}

} // namespace

extern const Kernels LAMELLA_KERNELS;
const Kernels LAMELLA_KERNELS = { relaxStraight, relaxStraightFromZero, residualStraight, applyStraight, relaxGeneral,
  residualGeneral, applyGeneral, inverseSum, axpy, xpby, dot, addWeighted, merge, splitRow, galerkin, factorizeBand,
  solveBand, LAMELLA_KERNELS_NAME };

} // namespace lamella::lbm
