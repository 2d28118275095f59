// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines; see PhaseKernels.h.
//
// simdlen: of bytes beside floats compilers make vectors of as many numbers as there are bytes in a register, 32 or 64,
// and do the rest of a row one by one: of short rows that was nearly all.
//
// Pictures stay in natural order, one byte a node, where they are; the field is split by the parity of x. So phases are
// read as pairs of neighbouring bytes, of which one half or the other counts.

#include "lbm/lean/PhaseKernels.h"

namespace lamella::lbm
{
namespace
{

// Added to the sum of a node's links: where there are none, nothing is divided by 0.
constexpr float tiny = 1e-30F;

// Two bytes from any address, the lower one in the low half.
typedef std::uint16_t Pair __attribute__((aligned(1), may_alias));

inline int lowOf(const Pair* p, std::int64_t i)
{
  return p[i] & 0xff;
}
inline int highOf(const Pair* p, std::int64_t i)
{
  return p[i] >> 8;
}

// Link values from a node on to its neighbours. Of two phases, chosen by bits: exact, and compilers make no branches
// of it.
template <class Real>
struct BitsOf;
template <>
struct BitsOf<float>
{
  using type = std::int32_t;
};
template <>
struct BitsOf<double>
{
  using type = std::int64_t;
};

template <class Real>
struct Select
{
  using Bits = typename BitsOf<Real>::type;
  Bits t00, t01, to01, to11; // to: what turns into the other value
  int second;
  explicit Select(const PhaseLinks& l)
    : t00(bits(l.both[0]))
    , t01(bits(l.both[1]))
    , to01(t00 ^ t01)
    , to11(t01 ^ bits(l.both[2]))
    , second(l.second)
  {
  }
  static Bits bits(double value) { return __builtin_bit_cast(Bits, static_cast<Real>(value)); }
  static Bits mask(int id, int second) { return -static_cast<Bits>(id == second); }
  // Plain numbers: compilers keep a structure of two in memory, and vectorise nothing then.
  Bits own(int id) const { return t00 ^ (mask(id, second) & to01); }
  Bits change(int id) const { return to01 ^ (mask(id, second) & (to01 ^ to11)); }
  template <int Axis>
  Real link(Bits own, Bits change, int id) const
  {
    return __builtin_bit_cast(Real, own ^ (mask(id, second) & change));
  }
};

inline const float* tableOf(const PhaseLinks& l, int axis, float)
{
  return l.single[axis];
}
inline const double* tableOf(const PhaseLinks& l, int axis, double)
{
  return l.table[axis];
}

template <class Real>
struct Lookup
{
  const Real* table;
  explicit Lookup(const PhaseLinks& l)
    : table(tableOf(l, 0, Real{}))
  {
  }
  int own(int id) const { return 256 * id; }
  int change(int) const { return 0; }
  template <int Axis>
  Real link(int own, int, int id) const
  {
    return table[own + id];
  }
};

template <class Real>
struct LookupByAxis
{
  const Real *x, *y, *z;
  explicit LookupByAxis(const PhaseLinks& l)
    : x(tableOf(l, 0, Real{}))
    , y(tableOf(l, 1, Real{}))
    , z(tableOf(l, 2, Real{}))
  {
  }
  int own(int id) const { return 256 * id; }
  int change(int) const { return 0; }
  template <int Axis>
  Real link(int own, int, int id) const
  {
    return (Axis == 0 ? x : Axis == 1 ? y : z)[own + id];
  }
};

template <int Axis, class Table>
inline auto between(const Table& table, int a, int b)
{
  return table.template link<Axis>(table.own(a), table.change(a), b);
}

// A Gauss-Seidel half sweep over a half-row, or its residual added to `out`.
template <class Table, bool Residual, bool Sourced>
void relaxWith(const PhaseLinks& links, const PhaseRow& row, float* out)
{
  const Table table(links);
  const std::int64_t nx = row.nx;
  const int part = row.part;
  const std::int64_t count = part == 0 ? (nx + 1) / 2 : nx / 2;
  const float* own = row.own;
  const float *vs = row.side[0].value, *vn = row.side[1].value, *vb = row.side[2].value, *vt = row.side[3].value;
  const float ws = row.side[0].weight, wn = row.side[1].weight, wb = row.side[2].weight, wt = row.side[3].weight;
  const float os = row.side[0].offset, on = row.side[1].offset, ob = row.side[2].offset, ot = row.side[3].offset;
  const float *west = row.west, *east = row.east;
  const float step = row.step;
  const float* source = row.source;

  const auto end = [&](std::int64_t i, std::int64_t x)
  {
    const auto node = [&]<int Axis>(int id) { return between<Axis>(table, row.phase[x], id); };
    const float u = own[i];
    float s = Sourced ? row.source[i] : 0.0F;
    float d = 0;
    const auto link = [&](float g, float v, float offset)
    {
      s += g * (v - u + offset);
      d += g;
    };
    if (x > 0)
      link(node.template operator()<0>(row.phase[x - 1]), west[i], -step);
    else
      link(row.low.weight * node.template operator()<0>(row.low.phase), row.low.value, row.low.offset);
    if (x < nx - 1)
      link(node.template operator()<0>(row.phase[x + 1]), east[i], step);
    else
      link(row.high.weight * node.template operator()<0>(row.high.phase), row.high.value, row.high.offset);
    for (int k = 0; k < 4; ++k)
    {
      const RowSide& side = row.side[k];
      const int id = side.phase[x];
      link(side.weight * (k < 2 ? node.template operator()<1>(id) : node.template operator()<2>(id)), side.value[i],
        side.offset);
    }
    if constexpr (Residual)
      out[i] += s;
    else
      out[i] = u + s / (d + tiny);
  };

  // inner nodes: part 0 from 1 on, and the last node of either part is left out where it ends the row
  const std::int64_t first = part == 0 ? 1 : 0;
  const std::int64_t last = 2 * (count - 1) + part == nx - 1 ? count - 1 : count;
  const auto inner = [&]<bool High>()
  {
    // node x = 2i + part; before: the pair (x − 1, x), after: (x, x + 1); beside: the pair at 2i
    const std::uint8_t* p = row.phase + (High ? 0 : -1);
    const Pair* before = reinterpret_cast<const Pair*>(p);
    const Pair* after = reinterpret_cast<const Pair*>(p + 1);
    const Pair* ps = reinterpret_cast<const Pair*>(row.side[0].phase);
    const Pair* pn = reinterpret_cast<const Pair*>(row.side[1].phase);
    const Pair* pb = reinterpret_cast<const Pair*>(row.side[2].phase);
    const Pair* pt = reinterpret_cast<const Pair*>(row.side[3].phase);
    const auto beside = [](const Pair* q, std::int64_t i) { return High ? highOf(q, i) : lowOf(q, i); };
#pragma omp simd simdlen(16)
    for (std::int64_t i = first; i < last; ++i)
    {
      const int id = highOf(before, i);
      const auto mine = table.own(id);
      const auto change = table.change(id);
      const float u = own[i];
      const float gw = table.template link<0>(mine, change, lowOf(before, i));
      const float ge = table.template link<0>(mine, change, highOf(after, i));
      const float gs = ws * table.template link<1>(mine, change, beside(ps, i));
      const float gn = wn * table.template link<1>(mine, change, beside(pn, i));
      const float gb = wb * table.template link<2>(mine, change, beside(pb, i));
      const float gt = wt * table.template link<2>(mine, change, beside(pt, i));
      // differences first: else round-off stops the flux at 1e-6
      float s = gw * (west[i] - u - step) + ge * (east[i] - u + step) + gs * (vs[i] - u + os) + gn * (vn[i] - u + on) +
        gb * (vb[i] - u + ob) + gt * (vt[i] - u + ot);
      if constexpr (Sourced)
        s += source[i];
      if constexpr (Residual)
        out[i] += s;
      else
        out[i] = u + s / (((gw + ge) + (gs + gn)) + ((gb + gt) + tiny));
    }
  };
  if (part == 0)
    inner.template operator()<false>();
  else
    inner.template operator()<true>();
  if (part == 0)
    end(0, 0);
  if (last < count && (last > 0 || part == 1))
    end(last, nx - 1);
}

template <bool Residual>
void relaxOf(const PhaseLinks& links, const PhaseRow& row, float* out)
{
  const bool sourced = row.source != nullptr;
  if (links.two)
    sourced ? relaxWith<Select<float>, Residual, true>(links, row, out)
            : relaxWith<Select<float>, Residual, false>(links, row, out);
  else if (links.byAxis)
    sourced ? relaxWith<LookupByAxis<float>, Residual, true>(links, row, out)
            : relaxWith<LookupByAxis<float>, Residual, false>(links, row, out);
  else
    sourced ? relaxWith<Lookup<float>, Residual, true>(links, row, out)
            : relaxWith<Lookup<float>, Residual, false>(links, row, out);
}

void relax(const PhaseLinks& links, const PhaseRow& row, float* own)
{
  relaxOf<false>(links, row, own);
}

void addResidual(const PhaseLinks& links, const PhaseRow& row, float* out)
{
  relaxOf<true>(links, row, out);
}

template <class Table>
void sumsWith(const PhaseLinks& links, const PhaseRow& row, PhaseSums& sums, double* planes)
{
  const Table table(links);
  const std::int64_t nx = row.nx;
  const int part = row.part;
  const std::int64_t count = part == 0 ? (nx + 1) / 2 : nx / 2;
  const float* own = row.own;
  const float* east = row.east;
  double energy = 0;
  // drops are values here less values there: the opposite of the offsets' sense
  {
    const std::int64_t last = 2 * (count - 1) + part == nx - 1 ? count - 1 : count;
    const Pair* after = reinterpret_cast<const Pair*>(row.phase + part);
    const double step = row.step;
    double flux = 0;
    if (planes != nullptr)
    {
#pragma omp simd simdlen(16) reduction(+ : energy, flux)
      for (std::int64_t i = 0; i < last; ++i)
      {
        const double g = between<0>(table, lowOf(after, i), highOf(after, i));
        const double drop = static_cast<double>(own[i]) - static_cast<double>(east[i]) - step;
        energy += g * drop * drop;
        flux += g * drop;
        planes[i] += g * drop;
      }
    }
    else
    {
#pragma omp simd simdlen(16) reduction(+ : energy, flux)
      for (std::int64_t i = 0; i < last; ++i)
      {
        const double g = between<0>(table, lowOf(after, i), highOf(after, i));
        const double drop = static_cast<double>(own[i]) - static_cast<double>(east[i]) - step;
        energy += g * drop * drop;
        flux += g * drop;
      }
    }
    const auto end = [&](std::int64_t i, std::int64_t x, const RowEnd& e, bool high)
    {
      const double g = e.weight * between<0>(table, row.phase[x], e.phase);
      const double drop = static_cast<double>(own[i]) - static_cast<double>(e.value) - static_cast<double>(e.offset);
      const bool wall = e.weight != 1.0F;
      if (!wall && !high)
        return; // a link that wraps belongs to its lower end
      energy += g * drop * drop;
      if (!wall)
      {
        flux += g * drop;
        if (planes != nullptr)
          planes[i] += g * drop;
      }
      else if (high)
        sums.high += g * drop;
      else
        sums.low -= g * drop;
    };
    if (part == 0)
      end(0, 0, row.low, false);
    if (last < count)
      end(last, nx - 1, row.high, true);
    sums.flux[0] += flux;
  }
  const auto beside = [&]<int Axis>(int k)
  {
    const RowSide& side = row.side[k];
    const bool wall = side.wall;
    if (side.weight == 0.0F || (!wall && k % 2 == 0))
      return;
    const double weight = side.weight;
    const double offset = side.offset;
    const float* value = side.value;
    const std::uint8_t* a = row.phase + part;
    const std::uint8_t* b = side.phase + part;
    double flux = 0;
#pragma omp simd simdlen(16) reduction(+ : energy, flux)
    for (std::int64_t i = 0; i < count; ++i)
    {
      const double g = weight * between<Axis>(table, a[2 * i], b[2 * i]);
      const double drop = static_cast<double>(own[i]) - static_cast<double>(value[i]) - offset;
      energy += g * drop * drop;
      flux += g * drop;
    }
    if (!wall)
      sums.flux[Axis] += flux;
    else if (k % 2 == 1)
      sums.high += flux;
    else
      sums.low -= flux;
  };
  beside.template operator()<1>(0);
  beside.template operator()<1>(1);
  beside.template operator()<2>(2);
  beside.template operator()<2>(3);
  sums.energy += energy;
}

void addSums(const PhaseLinks& links, const PhaseRow& row, PhaseSums& sums, double* planes)
{
  if (links.two)
    sumsWith<Select<double>>(links, row, sums, planes);
  else if (links.byAxis)
    sumsWith<LookupByAxis<double>>(links, row, sums, planes);
  else
    sumsWith<Lookup<double>>(links, row, sums, planes);
}

// f(axis, nodes, a, b, here, there, weight, offset) for the runs of links of a half-row that addSums sums: a[2 i] and
// b[2 i] are the phases at both ends of the i-th, here[i] and there[i] the values.
template <class F>
void forRuns(const PhaseRow& row, F&& f)
{
  const std::int64_t nx = row.nx;
  const int part = row.part;
  const std::int64_t count = part == 0 ? (nx + 1) / 2 : nx / 2;
  const std::int64_t last = 2 * (count - 1) + part == nx - 1 ? count - 1 : count;
  const std::uint8_t* const phase = row.phase + part;
  f(0, last, phase, phase + 1, row.own, row.east, 1.0, static_cast<double>(row.step));
  const auto end = [&](std::int64_t i, const RowEnd& e, bool high)
  {
    if (e.weight != 1.0F || high) // a link that wraps belongs to its lower end
      f(0, 1, phase + 2 * i, &e.phase, row.own + i, &e.value, static_cast<double>(e.weight),
        static_cast<double>(e.offset));
  };
  if (part == 0)
    end(0, row.low, false);
  if (last < count)
    end(last, row.high, true);
  for (int k = 0; k < 4; ++k)
    if (const RowSide& side = row.side[k]; side.weight != 0.0F && (side.wall || k % 2 == 1))
      f(1 + k / 2, count, phase, side.phase + part, row.own, side.value, static_cast<double>(side.weight),
        static_cast<double>(side.offset));
}

// Squares of drops: of all links, of those within the first phase, and within the second.
void addSquares(std::int64_t n, int second, const Pair* a, const Pair* b, const float* here, const float* there,
  float offset, float* sums)
{
  float all = 0;
  float firsts = 0;
  float seconds = 0;
#pragma omp simd simdlen(16) reduction(+ : all, firsts, seconds)
  for (std::int64_t i = 0; i < n; ++i)
  {
    const float drop = here[i] - there[i] - offset;
    const float square = drop * drop;
    const std::int32_t d = __builtin_bit_cast(std::int32_t, square);
    const std::int32_t from = Select<float>::mask(lowOf(a, i), second);
    const std::int32_t to = Select<float>::mask(lowOf(b, i), second);
    all += square;
    firsts += __builtin_bit_cast(float, d & ~(from | to));
    seconds += __builtin_bit_cast(float, d& from& to);
  }
  sums[0] = all;
  sums[1] = firsts;
  sums[2] = seconds;
}

void addEnergies(const PhaseLinks& links, const PhaseRow& row, std::size_t ids, double* sums)
{
  const auto square = [](float here, float there, double offset)
  {
    const double drop = static_cast<double>(here) - static_cast<double>(there) - offset;
    return drop * drop;
  };
  if (links.two)
  {
    const int second = links.second;
    forRuns(row,
      [&](int, std::int64_t n, const std::uint8_t* a, const std::uint8_t* b, const float* here, const float* there,
        double weight, double offset)
      {
        constexpr std::int64_t piece = 256; // whose sums in single precision err by some 1e-7
        double all = 0;
        double first = 0; // with first
        double other = 0; // second with second
        for (std::int64_t from = 0; from < n; from += piece)
        {
          float part[3];
          addSquares(n < from + piece ? n - from : piece, second, reinterpret_cast<const Pair*>(a) + from,
            reinterpret_cast<const Pair*>(b) + from, here + from, there + from, static_cast<float>(offset), part);
          all += static_cast<double>(part[0]);
          first += static_cast<double>(part[1]);
          other += static_cast<double>(part[2]);
        }
        sums[0] += weight * links.both[0] * first;
        sums[1] += weight * links.both[1] * (all - first - other);
        sums[2] += weight * links.both[2] * other;
      });
    return;
  }
  forRuns(row,
    [&](int axis, std::int64_t n, const std::uint8_t* a, const std::uint8_t* b, const float* here, const float* there,
      double weight, double offset)
    {
      double* const sum = sums + (links.byAxis ? static_cast<std::size_t>(axis) * ids * ids : 0);
      const double* const table = links.table[axis];
      for (std::int64_t i = 0; i < n; ++i)
        sum[ids * a[2 * i] + b[2 * i]] += weight * table[256 * a[2 * i] + b[2 * i]] * square(here[i], there[i], offset);
    });
}

template <int Axis, class Table>
void linksWith(const Table& table, std::int64_t n, const std::uint8_t* a, const std::uint8_t* b, float* __restrict out)
{
#pragma omp simd simdlen(16)
  for (std::int64_t i = 0; i < n; ++i)
    out[i] = between<Axis>(table, a[i], b[i]);
}

void linksOf(
  const PhaseLinks& links, int axis, std::int64_t n, const std::uint8_t* a, const std::uint8_t* b, float* out)
{
  if (links.two)
    linksWith<0>(Select<float>(links), n, a, b, out);
  else if (axis == 0)
    linksWith<0>(LookupByAxis<float>(links), n, a, b, out);
  else if (axis == 1)
    linksWith<1>(LookupByAxis<float>(links), n, a, b, out);
  else
    linksWith<2>(LookupByAxis<float>(links), n, a, b, out);
}

void addToBoth(std::int64_t evens, std::int64_t odds, const float* coarse, float* even, float* odd)
{
#pragma omp simd simdlen(16)
  for (std::int64_t i = 0; i < odds; ++i)
  {
    even[i] += coarse[i];
    odd[i] += coarse[i];
  }
  if (evens > odds)
    even[odds] += coarse[odds];
}

} // namespace

extern const PhaseKernels LAMELLA_KERNELS;
const PhaseKernels LAMELLA_KERNELS = { relax, addResidual, addSums, addEnergies, linksOf, addToBoth };

} // namespace lamella::lbm
