// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines; see RowKernels.h.

#include "peridynamics/kernels/RowKernels.h"
#include "peridynamics/kernels/Simd.h"

namespace lamella::peridynamics
{
namespace
{

/// Bits of all bonds of a few nodes, and what they choose.
template <class Real, int PathId>
struct Bits
{
  using V = typename Simd<Real>::V;
  using I = typename Simd<Real>::I;
  static constexpr int planes = PathId == Uniform ? 0 : PathId <= ThreePlanes ? PathId : maxPlanes;

  I plane[planes > 0 ? planes : 1];
  I some; // a bond of any kind

  void read(const RowJob<Real>& job, std::int64_t x)
  {
    if constexpr (PathId != Uniform)
    {
      plane[0] = some = Simd<Real>::words(job.words[0] + x);
      for (int p = 1; p < planes; ++p)
        if (PathId != ManyPlanes || p < job.planes)
        {
          plane[p] = Simd<Real>::words(job.words[p] + x);
          some |= plane[p];
        }
    }
  }
  /// v where there is a bond, else 0.
  V keep(int bit, V v) const
  {
    if constexpr (PathId == Uniform)
      return v;
    else
      return pick<Real>(some, bit, V{}, v);
  }
  /// table[kind] with table[0] where there is none; not for Uniform.
  V choose(const RowJob<Real>& job, int bit, const Real* table) const
  {
    if constexpr (PathId == OnePlane)
      return pick<Real>(plane[0], bit, all(table[0]), all(table[1]));
    else if constexpr (PathId == TwoPlanes)
      return pick<Real>(plane[1], bit, pick<Real>(plane[0], bit, all(table[0]), all(table[1])),
        pick<Real>(plane[0], bit, all(table[2]), all(table[3])));
    else if constexpr (PathId == ThreePlanes)
      return pick<Real>(plane[2], bit,
        pick<Real>(plane[1], bit, pick<Real>(plane[0], bit, all(table[0]), all(table[1])),
          pick<Real>(plane[0], bit, all(table[2]), all(table[3]))),
        pick<Real>(plane[1], bit, pick<Real>(plane[0], bit, all(table[4]), all(table[5])),
          pick<Real>(plane[0], bit, all(table[6]), all(table[7]))));
    else
    {
      I code{};
      for (int p = 0; p < job.planes; ++p)
        code |= ((plane[p] >> bit) & 1) << p;
      V v{};
      for (int l = 0; l < Simd<Real>::lanes; ++l)
        v[l] = table[code[l]];
      return v;
    }
  }
  int codeOf(const RowJob<Real>& job, int bit, int lane) const
  {
    if constexpr (PathId == Uniform)
      return job.uniformKind;
    else
    {
      int code = 0;
      for (int p = 0; p < planes; ++p)
        if (PathId != ManyPlanes || p < job.planes)
          code |= static_cast<int>((plane[p][lane] >> bit) & 1) << p;
      return code;
    }
  }
};

/// The surface correction of bond b. Where there is none any finite number will do.
template <class Real, int Dim>
typename Simd<Real>::V correction(const RowJob<Real>& job, int b, std::int64_t x)
{
  typename Simd<Real>::V square = all(Real(1e-30));
  for (int c = 0; c < Dim; ++c)
    square += all(job.unit[b].halfSquare[c]) *
      (Simd<Real>::floats(job.shareI[c] + x) + Simd<Real>::floats(job.shareJ[c] + x + job.stepX + b));
  return all(Real(1)) / root<Real>(square);
}

template <class Real, int Dim, int PathId, bool Corrected, int Count>
void pushLinear(RowJob<Real>& job, std::int64_t x0, std::int64_t x1)
{
  using V = typename Simd<Real>::V;
  constexpr bool folded = PathId == Uniform || PathId == OnePlane; // k is part of the offset's numbers
  const OffsetNumbers<Real>* const numbers = folded ? job.kind : job.unit;
  V a[Count][Dim];
  V n[Count];
  for (int b = 0; b < Count; ++b)
  {
    n[b] = all(numbers[b].step[0]);
    for (int c = 0; c < Dim; ++c)
      a[b][c] = all(numbers[b].linear[c]);
  }
  const V ny = all(numbers[0].step[1]);
  const V nz = all(numbers[0].step[2]);
  const Real* const u0 = job.u[0];
  const Real* const u1 = job.u[1];
  const Real* const u2 = job.u[Dim - 1];
  const Real* const v0 = job.v[0] + job.stepX;
  const Real* const v1 = job.v[1] + job.stepX;
  const Real* const v2 = job.v[Dim - 1] + job.stepX;
  Real* const f0 = job.f[0];
  Real* const f1 = job.f[1];
  Real* const f2 = job.f[Dim - 1];
  Real* const t = job.t;
  const std::int64_t pitch = job.pitch;
  const int bit = job.bit;
  for (std::int64_t x = x0; x < x1; x += Simd<Real>::lanes)
  {
    Bits<Real, PathId> bits;
    bits.read(job, x);
    const V ux = load(u0 + x);
    const V uy = load(u1 + x);
    const V uz = Dim == 3 ? load(u2 + x) : V{};
    V sum{};
    V sumX{};
#pragma GCC unroll 8
    for (int b = 0; b < Count; ++b)
    {
      V s = a[b][0] * (load(v0 + x + b) - ux) + a[b][1] * (load(v1 + x + b) - uy);
      if constexpr (Dim == 3)
        s += a[b][2] * (load(v2 + x + b) - uz);
      if constexpr (folded)
        s = bits.keep(bit + b, s);
      else
        s *= bits.choose(job, bit + b, job.stiffness);
      if constexpr (Corrected)
        s *= correction<Real, Dim>(job, b, x);
      store(t + b * pitch + x, s);
      sum += s;
      sumX += n[b] * s;
    }
    store(f0 + x, load(f0 + x) + sumX);
    store(f1 + x, load(f1 + x) + ny * sum);
    if constexpr (Dim == 3)
      store(f2 + x, load(f2 + x) + nz * sum);
  }
}

template <class Real, int Dim, int Count>
void pullLinear(RowJob<Real>& job, std::int64_t x0, std::int64_t x1)
{
  using V = typename Simd<Real>::V;
  V n[Count];
  for (int b = 0; b < Count; ++b)
    n[b] = all(job.unit[b].step[0]);
  const V ny = all(job.unit[0].step[1]);
  const V nz = all(job.unit[0].step[2]);
  Real* const f0 = job.f[0];
  Real* const f1 = job.f[1];
  Real* const f2 = job.f[Dim - 1];
  const Real* const t = job.t - job.stepX;
  const std::int64_t pitch = job.pitch;
  for (std::int64_t x = x0; x < x1; x += Simd<Real>::lanes)
  {
    V sum{};
    V sumX{};
#pragma GCC unroll 8
    for (int b = 0; b < Count; ++b)
    {
      const V s = load(t + b * pitch + x - b);
      sum += s;
      sumX += n[b] * s;
    }
    store(f0 + x, load(f0 + x) - sumX);
    store(f1 + x, load(f1 + x) - ny * sum);
    if constexpr (Dim == 3)
      store(f2 + x, load(f2 + x) - nz * sum);
  }
}

/// (1 − (1+q)^(−1/2))/q for |q| ≤ 1/16: interpolation at Chebyshev's points, to 7e-16 or 8e-10.
template <class Real>
struct Series;
template <>
struct Series<double>
{
  static constexpr int terms = 10;
  static constexpr double c[terms] = { 0.5000000000000003, -0.3750000000000003, 0.31249999999614153,
    -0.27343749999630207, 0.2460937578992089, -0.22558594507047777, 0.20946699882785053, -0.19637519327792408,
    0.18712269731379638, -0.17778038776212374 };
};
template <>
struct Series<float>
{
  static constexpr int terms = 6;
  static constexpr float c[terms] = { 0.5F, -0.3750000003677182F, 0.3124981930641924F, -0.2734358058846643F,
    0.2473259218563051F, -0.2267411586723767F };
};

/// The series by Estrin's scheme: two more products than Horner's, and less than half as many steps that wait for each
/// other, which is what the kernels wait for.
template <class Real>
__attribute__((always_inline)) inline typename Simd<Real>::V series(typename Simd<Real>::V q)
{
  using V = typename Simd<Real>::V;
  constexpr auto& c = Series<Real>::c;
  const V square = q * q;
  const V fourth = square * square;
  const V low = (all(c[0]) + all(c[1]) * q) + (all(c[2]) + all(c[3]) * q) * square;
  V high = all(c[4]) + all(c[5]) * q;
  if constexpr (Series<Real>::terms == 10)
    high = (high + (all(c[6]) + all(c[7]) * q) * square) + (all(c[8]) + all(c[9]) * q) * fourth;
  return low + high * fourth;
}

/// What pushNonlinear() reads of a job, where no store can reach it.
template <class Real, int Dim>
struct NonlinearRows
{
  explicit NonlinearRows(const RowJob<Real>& job)
    : t(job.t)
    , pitch(job.pitch)
  {
    for (int c = 0; c < Dim; ++c)
    {
      u[c] = job.u[c];
      v[c] = job.v[c] + job.stepX;
      f[c] = job.f[c];
    }
  }
  const Real* u[Dim];
  const Real* v[Dim];
  Real* f[Dim];
  Real* t;
  std::int64_t pitch;
};

/// Elongations of `Count` bonds from `first` on: ζ = ξ + η and q = |ζ|²/|ξ|² − 1, 0 where there is no bond.
template <class Real, int Dim, int PathId, int Count>
__attribute__((always_inline)) inline void elongations(const RowJob<Real>& job, const NonlinearRows<Real, Dim>& rows,
  const OffsetNumbers<Real>* numbers, int first, std::int64_t x, const Bits<Real, PathId>& bits,
  const typename Simd<Real>::V* u, typename Simd<Real>::V (*zeta)[Dim], typename Simd<Real>::V* q)
{
  using V = typename Simd<Real>::V;
#pragma GCC unroll 8
  for (int b = 0; b < Count; ++b)
  {
    const OffsetNumbers<Real>& o = numbers[first + b];
    V sum{};
#pragma GCC unroll 3
    for (int c = 0; c < Dim; ++c)
    {
      const V xi = all(c == 0 ? o.xi[0] : numbers[0].xi[c]); // along y and z that of all bonds
      const V eta = load(rows.v[c] + x + first + b) - u[c];
      zeta[b][c] = xi + eta;
      sum += (xi + zeta[b][c]) * eta;
    }
    q[b] = bits.keep(job.bit + first + b, sum * all(o.inverseSquare));
  }
}

/// From (1 − |ξ|/|ζ|) of one bond to its force, left in the buffer and added to f.
template <class Real, int Dim, int PathId, bool Corrected>
__attribute__((always_inline)) inline void pushBond(const RowJob<Real>& job, const NonlinearRows<Real, Dim>& rows,
  const OffsetNumbers<Real>* numbers, int b, std::int64_t x, const Bits<Real, PathId>& bits,
  typename Simd<Real>::V factor, const typename Simd<Real>::V* zeta, typename Simd<Real>::V* f)
{
  using V = typename Simd<Real>::V;
  V s = factor * all(numbers[b].spring);
  if constexpr (PathId != Uniform && PathId != OnePlane)
    s *= bits.choose(job, job.bit + b, job.stiffness);
  if constexpr (Corrected)
    s *= correction<Real, Dim>(job, b, x);
#pragma GCC unroll 3
  for (int c = 0; c < Dim; ++c)
  {
    const V g = s * zeta[c];
    store(rows.t + (b * Dim + c) * rows.pitch + x, g);
    f[c] += g;
  }
}

/// A few bonds at once: stage by stage, since each alone is a long chain of dependent operations.
/// @return the largest |q| and `largest`
template <class Real, int Dim, int PathId, bool Corrected, int First, int Count>
__attribute__((always_inline)) inline typename Simd<Real>::V pushSome(const RowJob<Real>& job,
  const NonlinearRows<Real, Dim>& rows, const OffsetNumbers<Real>* numbers, std::int64_t x,
  const Bits<Real, PathId>& bits, const typename Simd<Real>::V* u, typename Simd<Real>::V* f,
  typename Simd<Real>::V largest)
{
  using V = typename Simd<Real>::V;
  V zeta[Count][Dim];
  V q[Count];
  elongations<Real, Dim, PathId, Count>(job, rows, numbers, First, x, bits, u, zeta, q);
#pragma GCC unroll 8
  for (int b = 0; b < Count; ++b)
  {
    const V size = magnitude<Real>(q[b]);
    largest = size > largest ? size : largest;
    pushBond<Real, Dim, PathId, Corrected>(
      job, rows, numbers, First + b, x, bits, q[b] * series<Real>(q[b]), zeta[b], f);
  }
  return largest;
}

/// The rare case, small rather than fast: any q, and bonds marked where critical.
template <class Real, int Dim, int PathId, bool Corrected>
__attribute__((noinline)) void pushCarefully(
  RowJob<Real>& job, const NonlinearRows<Real, Dim>& rows, std::int64_t x, typename Simd<Real>::V* f)
{
  using V = typename Simd<Real>::V;
  using I = typename Simd<Real>::I;
  const OffsetNumbers<Real>* const numbers = PathId == Uniform || PathId == OnePlane ? job.kind : job.unit;
  Bits<Real, PathId> bits;
  bits.read(job, x);
  V u[Dim];
  for (int c = 0; c < Dim; ++c)
  {
    u[c] = load(rows.u[c] + x);
    f[c] = V{};
  }
  for (int b = 0; b < job.count; ++b)
  {
    V zeta[1][Dim];
    V q[1];
    elongations<Real, Dim, PathId, 1>(job, rows, numbers, b, x, bits, u, zeta, q);
    // a bond of no length has no direction: ζ = 0 and with it the force
    V square = all(Real(1)) + q[0];
    const V least = all(Real(1e-30));
    square = square > least ? square : least;
    const V factor = q[0] / (root<Real>(square) + square);
    V limit;
    if constexpr (PathId == Uniform)
      limit = all(job.critical[job.uniformKind]);
    else
      limit = bits.choose(job, job.bit + b, job.critical);
    const I critical = q[0] > limit;
    if (any<Real>(critical))
    {
      job.marked = true;
      for (int l = 0; l < Simd<Real>::lanes; ++l)
        if (critical[l] != 0)
          job.marks[x + l] = static_cast<unsigned char>(job.marks[x + l] | (1U << b));
    }
    pushBond<Real, Dim, PathId, Corrected>(job, rows, numbers, b, x, bits, factor, zeta[0], f);
  }
}

template <class Real, int Dim, int PathId, bool Corrected, int Count>
void pushNonlinear(RowJob<Real>& job, std::int64_t x0, std::int64_t x1)
{
  using V = typename Simd<Real>::V;
  const V safe = all(job.safe);
  const NonlinearRows<Real, Dim> rows(job);
  const OffsetNumbers<Real>* const numbers = PathId == Uniform || PathId == OnePlane ? job.kind : job.unit;
  for (std::int64_t x = x0; x < x1; x += Simd<Real>::lanes)
  {
    Bits<Real, PathId> bits;
    bits.read(job, x);
    V u[Dim];
    V f[Dim];
    for (int c = 0; c < Dim; ++c)
    {
      u[c] = load(rows.u[c] + x);
      f[c] = V{};
    }
    constexpr int part = Count == 5 ? 3 : Count;
    V largest = pushSome<Real, Dim, PathId, Corrected, 0, part>(job, rows, numbers, x, bits, u, f, V{});
    if constexpr (part < Count)
      largest = pushSome<Real, Dim, PathId, Corrected, part, Count - part>(job, rows, numbers, x, bits, u, f, largest);
    if (__builtin_expect(any<Real>(largest > safe), 0))
      pushCarefully<Real, Dim, PathId, Corrected>(job, rows, x, f);
    for (int c = 0; c < Dim; ++c)
      store(rows.f[c] + x, load(rows.f[c] + x) + f[c]);
  }
}

template <class Real, int Dim, int Count>
void pullNonlinear(RowJob<Real>& job, std::int64_t x0, std::int64_t x1)
{
  using V = typename Simd<Real>::V;
  const Real* const t = job.t - job.stepX;
  const std::int64_t pitch = job.pitch;
  Real* const f0 = job.f[0];
  Real* const f1 = job.f[1];
  Real* const f2 = job.f[Dim - 1];
  for (std::int64_t x = x0; x < x1; x += Simd<Real>::lanes)
  {
    V f[3]{};
#pragma GCC unroll 8
    for (int b = 0; b < Count; ++b)
      for (int c = 0; c < Dim; ++c)
        f[c] += load(t + (b * Dim + c) * pitch + x - b);
    store(f0 + x, load(f0 + x) - f[0]);
    store(f1 + x, load(f1 + x) - f[1]);
    if constexpr (Dim == 3)
      store(f2 + x, load(f2 + x) - f[2]);
  }
}

/// Once in many steps: one bond after the other, whatever its elongation.
template <class Real, int Dim, int PathId, bool Corrected>
void energyOfBonds(RowJob<Real>& job, std::int64_t x0, std::int64_t x1)
{
  using V = typename Simd<Real>::V;
  const NonlinearRows<Real, Dim> rows(job);
  const OffsetNumbers<Real>* const numbers = PathId == Uniform || PathId == OnePlane ? job.kind : job.unit;
  V factor[maxChunk]; // of the square of the stretch
  for (int b = 0; b < job.count; ++b)
    factor[b] = all(Real(0.5) * numbers[b].spring / numbers[b].inverseSquare);
  const V one = all(Real(1));
  const V least = all(Real(1e-30));
  for (std::int64_t x = x0; x < x1; x += Simd<Real>::lanes)
  {
    Bits<Real, PathId> bits;
    bits.read(job, x);
    V u[Dim];
    for (int c = 0; c < Dim; ++c)
      u[c] = load(rows.u[c] + x);
    V sum = load(rows.f[0] + x);
    for (int b = 0; b < job.count; ++b)
    {
      V zeta[1][Dim];
      V q[1];
      elongations<Real, Dim, PathId, 1>(job, rows, numbers, b, x, bits, u, zeta, q);
      V square = one + q[0];
      square = square > least ? square : least;
      const V stretch = q[0] / (one + root<Real>(square));
      V w = factor[b] * stretch * stretch;
      if constexpr (PathId != Uniform && PathId != OnePlane)
        w *= bits.choose(job, job.bit + b, job.stiffness);
      if constexpr (Corrected)
        w *= correction<Real, Dim>(job, b, x);
      sum += w;
    }
    store(rows.f[0] + x, sum);
  }
}

// ---- the table

template <class Real, int Dim, int PathId, bool Corrected>
constexpr void fillCounts(RealRowKernels<Real>& k)
{
  auto& linear = k.linear[Dim - 2][PathId][Corrected];
  auto& nonlinear = k.nonlinear[Dim - 2][PathId][Corrected];
  linear[0] = pushLinear<Real, Dim, PathId, Corrected, 1>;
  linear[1] = pushLinear<Real, Dim, PathId, Corrected, 2>;
  linear[2] = pushLinear<Real, Dim, PathId, Corrected, 3>;
  linear[4] = pushLinear<Real, Dim, PathId, Corrected, 5>;
  nonlinear[0] = pushNonlinear<Real, Dim, PathId, Corrected, 1>;
  nonlinear[1] = pushNonlinear<Real, Dim, PathId, Corrected, 2>;
  nonlinear[2] = pushNonlinear<Real, Dim, PathId, Corrected, 3>;
  nonlinear[4] = pushNonlinear<Real, Dim, PathId, Corrected, 5>;
  k.energy[Dim - 2][PathId][Corrected] = energyOfBonds<Real, Dim, PathId, Corrected>;
}

template <class Real, int Dim>
constexpr void fillDimension(RealRowKernels<Real>& k)
{
  fillCounts<Real, Dim, Uniform, false>(k);
  fillCounts<Real, Dim, OnePlane, false>(k);
  fillCounts<Real, Dim, TwoPlanes, false>(k);
  fillCounts<Real, Dim, ThreePlanes, false>(k);
  fillCounts<Real, Dim, ManyPlanes, false>(k);
  // uniform runs lie where nothing is to be corrected
  for (int b = 0; b < maxChunk; ++b)
  {
    k.linear[Dim - 2][Uniform][1][b] = k.linear[Dim - 2][Uniform][0][b];
    k.nonlinear[Dim - 2][Uniform][1][b] = k.nonlinear[Dim - 2][Uniform][0][b];
  }
  k.energy[Dim - 2][Uniform][1] = k.energy[Dim - 2][Uniform][0];
  fillCounts<Real, Dim, OnePlane, true>(k);
  fillCounts<Real, Dim, TwoPlanes, true>(k);
  fillCounts<Real, Dim, ThreePlanes, true>(k);
  fillCounts<Real, Dim, ManyPlanes, true>(k);
  k.pullLinear[Dim - 2][0] = pullLinear<Real, Dim, 1>;
  k.pullLinear[Dim - 2][1] = pullLinear<Real, Dim, 2>;
  k.pullLinear[Dim - 2][2] = pullLinear<Real, Dim, 3>;
  k.pullLinear[Dim - 2][4] = pullLinear<Real, Dim, 5>;
  k.pullNonlinear[Dim - 2][0] = pullNonlinear<Real, Dim, 1>;
  k.pullNonlinear[Dim - 2][1] = pullNonlinear<Real, Dim, 2>;
  k.pullNonlinear[Dim - 2][2] = pullNonlinear<Real, Dim, 3>;
  k.pullNonlinear[Dim - 2][4] = pullNonlinear<Real, Dim, 5>;
}

constexpr RowKernels table()
{
  RowKernels k{};
  k.name = LAMELLA_KERNELS_NAME;
  fillDimension<double, 2>(k.d);
  fillDimension<double, 3>(k.d);
  fillDimension<float, 2>(k.f);
  fillDimension<float, 3>(k.f);
  return k;
}

} // namespace

extern const RowKernels LAMELLA_KERNELS;
const RowKernels LAMELLA_KERNELS = table();

} // namespace lamella::peridynamics
