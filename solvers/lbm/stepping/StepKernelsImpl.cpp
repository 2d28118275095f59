// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines; see StepKernels.h
// for why there is nothing of the standard library. Eight nodes at a time, the rest of a run one by one with the same
// operations in the same order, so that how a row is cut into runs leaves no trace in the field.

#include "lbm/stepping/StepKernels.h"

namespace lamella::lbm
{
namespace
{

constexpr int lanes = 8;
constexpr int ahead = 8 * lanes; // measured: 16 and 32 are slower
typedef double Vector __attribute__((vector_size(64)));
typedef long long Index __attribute__((vector_size(64)));
typedef std::uint8_t Bytes __attribute__((vector_size(8), aligned(1), may_alias));

// A lattice as Velocities.h numbers it: the population at rest, if there is one, then pairs of opposite ones, those
// along an axis first.
template <int Count, int Rest, int Straight>
struct Set
{
  static constexpr int count = Count;
  static constexpr int rest = Rest;
  static constexpr int straight = Straight;
  static constexpr int opposite(int q) { return q < rest ? q : ((q - rest) ^ 1) + rest; }
  static constexpr int kind(int q) { return q < rest ? 0 : q < rest + straight ? 1 : 2; }
};
struct D2Q5 : Set<5, 1, 4>
{
  static constexpr double weight[3] = { 1.0 / 3, 1.0 / 6, 0.0 };
};
struct D2Q9 : Set<9, 1, 4>
{
  static constexpr double weight[3] = { 4.0 / 9, 1.0 / 9, 1.0 / 36 };
};
struct D3Q7 : Set<6, 0, 6>
{
  static constexpr double weight[3] = { 0.0, 1.0 / 6, 0.0 };
};
struct D3Q19 : Set<19, 1, 6>
{
  static constexpr double weight[3] = { 1.0 / 3, 1.0 / 18, 1.0 / 36 };
};

template <class V>
inline V load(const double* p)
{
  V v; // at any alignment: a template argument would lose the attribute that says so
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
template <class V>
inline void store(double* p, V v)
{
  __builtin_memcpy(p, &v, sizeof v);
}

template <bool Few>
inline void lookUp(const double* table, const std::uint8_t* phase, double& out)
{
  out = table[*phase];
}
template <bool Few>
inline void lookUp(const double* table, const std::uint8_t* phase, Vector& out)
{
#ifdef __AVX512F__
  if constexpr (Few) // the table fits a register
  {
    const Index index = __builtin_convertvector(*reinterpret_cast<const Bytes*>(phase), Index);
    out = __builtin_shuffle(load<Vector>(table), index);
    return;
  }
#endif
  for (int j = 0; j < lanes; ++j)
    out[j] = table[phase[j]];
}

template <class S, class V>
inline V total(const V* v)
{
  V u = v[0] + v[1];
#pragma GCC unroll 32
  for (int q = 2; q < S::count; ++q)
    u = u + v[q];
  return u;
}

// What a node leaves in the places of what arrived there. One rate: the departing population q, where its opposite
// arrived. Two rates: see StepKernels.h.
template <class S, bool Two, class V>
inline void collide(V* v, V s, V u)
{
  const V keep = 1.0 - s;
  const V su = s * u;
  const V part[3] = { su * S::weight[0], su * S::weight[1], su * S::weight[2] };
  V in[S::count];
#pragma GCC unroll 32
  for (int q = 0; q < S::count; ++q)
    in[q] = v[q];
#pragma GCC unroll 32
  for (int q = 0; q < S::count; ++q)
    v[q] = keep * in[Two ? q : S::opposite(q)] + part[S::kind(q)];
}

template <class S, bool Two, bool Few, class V>
inline V plainAt(double* const* p, const std::uint8_t* phase, const double* rate, std::int64_t i)
{
  V v[S::count];
#pragma GCC unroll 32
  for (int q = 0; q < S::count; ++q)
    v[q] = load<V>(p[q] + i);
  V s;
  lookUp<Few>(rate, phase + i, s);
  const V u = total<S>(v);
  collide<S, Two>(v, s, u);
#pragma GCC unroll 32
  for (int q = 0; q < S::count; ++q)
    store<V>(p[q] + i, v[q]);
  return u * u;
}

// Mirrors and fixed values of a node whose populations have arrived; returns u.
template <class S, class V>
inline V complete(V* v, const SlotPattern& pattern)
{
  V in[S::count];
  for (int q = 0; q < S::count; ++q)
    in[q] = v[q];
  for (int q = 0; q < S::count; ++q)
    v[q] = in[pattern.mirror[q]];
  if (pattern.share == 0.0)
    return total<S>(v);
  V known = v[0] * (pattern.fixed[0] ? 0.0 : 1.0);
  for (int q = 1; q < S::count; ++q)
    if (!pattern.fixed[q])
      known = known + v[q];
  const V fictive = (pattern.value - known) * pattern.share;
  for (int q = 0; q < S::count; ++q)
    if (pattern.fixed[q])
      v[q] = fictive * S::weight[S::kind(q)];
  return total<S>(v);
}

template <class S, bool Two, bool Odd, class V>
inline V specialAt(
  double* const* p, const std::uint8_t* phase, const double* rate, const SlotPattern& pattern, std::int64_t i)
{
  V v[S::count];
  for (int q = 0; q < S::count; ++q)
  {
    v[q] = load<V>(p[q] + i);
    if constexpr (Odd)
      v[q] = v[q] * pattern.sign[q] + pattern.shift[q];
  }
  V s;
  lookUp<false>(rate, phase + i, s);
  const V u = complete<S>(v, pattern);
  collide<S, Two>(v, s, u);
  for (int q = 0; q < S::count; ++q)
  {
    if constexpr (Odd)
      v[q] = (v[q] - pattern.shift[q]) * pattern.sign[q];
    store<V>(p[q] + i, v[q]);
  }
  return u * u;
}

inline double sumOf(const Vector& v)
{
  return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

template <class S, bool Two, bool Few>
inline double plain(double* const* pointers, const std::uint8_t* phase, const double* rate, std::int64_t n)
{
  double* p[S::count];
#pragma GCC unroll 32
  for (int q = 0; q < S::count; ++q)
    p[q] = pointers[q];
  std::int64_t i = 0;
  double sum = 0;
  if (n >= lanes)
  {
    Vector squares{};
    for (; i + lanes <= n; i += lanes)
    {
#pragma GCC unroll 32
      for (int q = 0; q < S::count; ++q)
        __builtin_prefetch(p[q] + i + ahead, 1, 3);
      squares += plainAt<S, Two, Few, Vector>(p, phase, rate, i);
    }
    sum = sumOf(squares);
  }
  for (; i < n; ++i)
    sum += plainAt<S, Two, Few, double>(p, phase, rate, i);
  return sum;
}

template <class S, bool Two, bool Odd>
double special(
  double* const* p, const std::uint8_t* phase, const double* rate, const SlotPattern& pattern, std::int64_t n)
{
  std::int64_t i = 0;
  double sum = 0;
  for (; i + lanes <= n; i += lanes)
    sum += sumOf(specialAt<S, Two, Odd, Vector>(p, phase, rate, pattern, i));
  for (; i < n; ++i)
    sum += specialAt<S, Two, Odd, double>(p, phase, rate, pattern, i);
  return sum;
}

template <class S, bool Two>
inline double plainOf(const SlotArrays& a, double* const* p, std::int64_t first, std::int64_t n)
{
  return a.fewPhases ? plain<S, Two, true>(p, a.phase + first, a.rate, n)
                     : plain<S, Two, false>(p, a.phase + first, a.rate, n);
}

template <class S, bool Two>
double even(const SlotArrays& a, std::int64_t first, std::int64_t count)
{
  double* p[S::count];
  for (int q = 0; q < S::count; ++q)
    p[q] = a.f + q * a.stride + first;
  return plainOf<S, Two>(a, p, first, count);
}

template <class S, bool Two>
double evenRuns(const SlotArrays& a, const SlotRun* runs, std::int64_t count)
{
  double sum = 0;
  for (std::int64_t k = 0; k < count; ++k)
  {
    const SlotRun& run = runs[k];
    const SlotPattern& pattern = a.pattern[run.pattern];
    double* p[S::count];
    for (int q = 0; q < S::count; ++q)
      p[q] = a.f + q * a.stride + run.first;
    sum += pattern.special ? special<S, Two, false>(p, a.phase + run.first, a.rate, pattern, run.count)
                           : plainOf<S, Two>(a, p, run.first, run.count);
  }
  return sum;
}

template <class S, bool Two>
double oddRuns(const SlotArrays& a, const SlotRun* runs, std::int64_t number, std::int64_t count)
{
  constexpr int moving = S::count - S::rest;
  double sum = 0;
  for (std::int64_t k = 0; k < count; ++k)
  {
    const SlotRun& run = runs[k];
    const SlotPattern& pattern = a.pattern[run.pattern];
    const std::int32_t* source = a.source + (number + k) * moving;
    double* p[S::count];
    for (int q = 0; q < S::rest; ++q)
      p[q] = a.f + run.first;
    for (int q = S::rest; q < S::count; ++q)
      p[q] = a.f + ((run.own >> q) & 1U ? q : pattern.slot[q]) * a.stride + source[q - S::rest];
    sum += pattern.special ? special<S, Two, true>(p, a.phase + run.first, a.rate, pattern, run.count)
                           : plainOf<S, Two>(a, p, run.first, run.count);
  }
  return sum;
}

template <class S, bool Two>
constexpr StepLoops loopsOf()
{
  return { S::count, even<S, Two>, evenRuns<S, Two>, oddRuns<S, Two> };
}

} // namespace

extern const StepKernels LAMELLA_KERNELS;
const StepKernels LAMELLA_KERNELS = {
  { { loopsOf<D2Q5, false>(), loopsOf<D2Q9, false>(), loopsOf<D3Q7, false>(), loopsOf<D3Q19, false>() },
    { loopsOf<D2Q5, true>(), loopsOf<D2Q9, true>(), loopsOf<D3Q7, true>(), loopsOf<D3Q19, true>() } },
  LAMELLA_KERNELS_NAME
};

} // namespace lamella::lbm
