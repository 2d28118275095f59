// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines; see ElasticKernels.h.

#include "elasticity/ElasticPacks.h"

namespace lamella::elasticity
{
namespace
{

// The stiffness of one pack of elements.
template <int D, class Real, bool isotropic>
struct Law
{
  static constexpr int size = isotropic ? 2 : stiffnessSize(D);
  Pack<Real> c[size];

  [[gnu::always_inline]] Law(const ElasticRow<D, Real>& row, std::int64_t i)
  {
    times<size>([&](auto k) { c[k] = load(row.moduli[k] + i); });
  }
  // That of strains that vary over an element.
  [[gnu::always_inline]] Law varying() const
  {
    Law v = *this;
    if constexpr (isotropic)
    {
      const Pack<Real> most = c[1] + c[1];
      v.c[0] = c[0] < most ? c[0] : most;
    }
    return v;
  }
  // of the components in `used` alone
  template <int used>
  [[gnu::always_inline]] void stress(const Pack<Real>* e, Pack<Real>* s) const
  {
    constexpr int n = voigtSize(D);
    if constexpr (isotropic)
    {
      Pack<Real> trace{};
      times<D>(
        [&](auto k)
        {
          if constexpr ((used >> k & 1) != 0)
            trace += e[k];
        });
      const Pack<Real> pressure = c[0] * trace;
      const Pack<Real> twice = c[1] + c[1];
      times<n>(
        [&](auto k)
        {
          if constexpr ((used >> k & 1) != 0)
            s[k] = k < D ? pressure + twice * e[k] : c[1] * e[k];
        });
    }
    else
      times<n>(
        [&](auto k)
        {
          if constexpr ((used >> k & 1) != 0)
          {
            Pack<Real> sum{};
            times<n>(
              [&](auto l)
              {
                if constexpr ((used >> l & 1) != 0)
                  sum += c[triangle(n, k, l)] * e[l];
              });
            s[k] = sum;
          }
        });
  }
};

// Only the diagonal without `product`.
template <int D, class Real, bool isotropic, bool stretched, bool product, bool diagonal>
void apply(const ElasticRow<D, Real>& row, Real* const (*out)[1 << (D - 1)], Real* const* sums)
{
  constexpr int rows = 1 << (D - 1);
  constexpr int n = voigtSize(D);
  using P = Pack<Real>;
  P before[D][rows]{};
  P diagonalBefore{};
  for (std::int64_t i = 0; i <= row.count; i += lanes<Real>)
  {
    const Law<D, Real, isotropic> law(row, i);
    const Law<D, Real, isotropic> varying = law.varying();
    const Edges<D, Real, stretched> edges(row, i);
    if constexpr (product)
    {
      const Modes<D, Real> u(row, i);
      Modes<D, Real> f;
      times<2 * rows - 1>(
        [&](auto polynomial)
        {
          P e[n];
          P s[n];
          strainOf(u, edges, polynomial, e);
          if constexpr (polynomial == 0)
            times<n>([&](auto k) { e[k] += all<Real>(row.strain[k]); });
          constexpr int used = usedBy<D>(polynomial);
          if constexpr (polynomial == 0)
            law.template stress<used>(e, s);
          else
            varying.template stress<used>(e, s);
          if constexpr (polynomial == 0)
            if (row.initial != nullptr)
              times<n>([&](auto k) { s[k] += load(row.initial[k] + i); });
          times<n>(
            [&](auto k)
            {
              if constexpr (polynomial != 0 && (used >> k & 1) != 0)
                s[k] *= all<Real>(meanSquare(polynomial));
            });
          times<D>(
            [&](auto d)
            {
              if constexpr ((polynomial >> d & 1) == 0)
                times<D>([&](auto c) { f.m[c][polynomial | 1 << d] += edges.over(s[voigt(D, c, d)], d); });
            });
        });
      f.back();
      times<D>(
        [&](auto c)
        {
          times<rows>(
            [&](auto r)
            {
              const P low = f.m[c][2 * r] - f.m[c][2 * r + 1];
              const P high = f.m[c][2 * r] + f.m[c][2 * r + 1];
              Real* const q = out[c][r] + i;
              store(q, load(q) + low + shifted<Real>(before[c][r], high));
              before[c][r] = high;
            });
        });
    }
    if constexpr (diagonal)
    {
      // mean over the corners and components: each mode with its own square once
      P d{};
      times<2 * rows - 1>(
        [&](auto polynomial)
        {
          times<D>(
            [&](auto a)
            {
              if constexpr ((polynomial >> a & 1) == 0)
                times<D>(
                  [&](auto c)
                  {
                    P own;
                    if constexpr (isotropic)
                      own = c == a ? (polynomial == 0 ? law : varying).c[0] + law.c[1] + law.c[1] : law.c[1];
                    else
                      own = law.c[triangle(n, voigt(D, c, a), voigt(D, c, a))];
                    d += all<Real>(meanSquare(polynomial) / D) * edges.over(edges.over(own, a), a);
                  });
            });
        });
      const P both = d + shifted<Real>(diagonalBefore, d);
      diagonalBefore = d;
      times<rows>([&](auto r) { store(sums[r] + i, load(sums[r] + i) + both); });
    }
  }
}

template <int D, class Real, bool product, bool diagonal>
void applyAny(const ElasticRow<D, Real>& row, Real* const (*out)[1 << (D - 1)], Real* const* sums)
{
  if (row.isotropic)
    row.stretchX == nullptr ? apply<D, Real, true, false, product, diagonal>(row, out, sums)
                            : apply<D, Real, true, true, product, diagonal>(row, out, sums);
  else
    row.stretchX == nullptr ? apply<D, Real, false, false, product, diagonal>(row, out, sums)
                            : apply<D, Real, false, true, product, diagonal>(row, out, sums);
}

template <int D>
void applySingle(const ElasticRow<D, float>& row, float* const (*out)[1 << (D - 1)], float* const* diagonal)
{
  if (diagonal == nullptr)
    applyAny<D, float, true, false>(row, out, nullptr);
  else if (out == nullptr)
    applyAny<D, float, false, true>(row, nullptr, diagonal);
  else
    applyAny<D, float, true, true>(row, out, diagonal);
}

template <int D>
void applyDouble(const ElasticRow<D, double>& row, double* const (*out)[1 << (D - 1)])
{
  applyAny<D, double, true, false>(row, out, nullptr);
}

template <int D, bool isotropic, bool stretched>
void stresses(const ElasticRow<D, double>& row, double* const* stress, double* const* strain, double* energy)
{
  constexpr int rows = 1 << (D - 1);
  constexpr int n = voigtSize(D);
  using P = Pack<double>;
  P sum{};
  for (std::int64_t i = 0; i < row.count; i += lanes<double>)
  {
    const Modes<D, double> u(row, i);
    const Law<D, double, isotropic> law(row, i);
    const Law<D, double, isotropic> varying = law.varying();
    const Edges<D, double, stretched> edges(row, i);
    times<2 * rows - 1>(
      [&](auto polynomial)
      {
        P e[n];
        P s[n];
        strainOf(u, edges, polynomial, e);
        if constexpr (polynomial == 0)
          times<n>([&](auto k) { e[k] += all<double>(row.strain[k]); });
        constexpr int used = usedBy<D>(polynomial);
        if constexpr (polynomial == 0)
          law.template stress<used>(e, s);
        else
          varying.template stress<used>(e, s);
        if constexpr (polynomial == 0)
        {
          if (row.initial != nullptr)
            times<n>([&](auto k) { s[k] += load(row.initial[k] + i); });
          times<n>([&](auto k) { store(stress[k] + i, s[k]); });
          times<n>([&](auto k) { store(strain[k] + i, e[k]); });
        }
        times<n>(
          [&](auto k)
          {
            if constexpr ((used >> k & 1) != 0)
              sum += all<double>(meanSquare(polynomial)) * s[k] * e[k];
          });
      });
  }
  *energy += total<double>(sum);
}

template <int D>
void stressesAny(const ElasticRow<D, double>& row, double* const* stress, double* const* strain, double* energy)
{
  if (row.isotropic)
    row.stretchX == nullptr ? stresses<D, true, false>(row, stress, strain, energy)
                            : stresses<D, true, true>(row, stress, strain, energy);
  else
    row.stretchX == nullptr ? stresses<D, false, false>(row, stress, strain, energy)
                            : stresses<D, false, true>(row, stress, strain, energy);
}

void relax(std::int64_t n, float factor, const float* b, const float* a, const float* d, float* z)
{
#pragma omp simd
  for (std::int64_t i = 0; i < n; ++i)
    z[i] += d[i] > 0 ? factor * (b[i] - a[i]) / d[i] : 0.0F;
}

void relaxFirst(std::int64_t n, float factor, const float* b, const float* d, float* z)
{
#pragma omp simd
  for (std::int64_t i = 0; i < n; ++i)
    z[i] = d[i] > 0 ? factor * b[i] / d[i] : 0.0F;
}

void difference(std::int64_t n, const float* b, const float* a, float* out)
{
#pragma omp simd
  for (std::int64_t i = 0; i < n; ++i)
    out[i] = b[i] - a[i];
}

double dot(std::int64_t n, const float* a, const float* b)
{
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (std::int64_t i = 0; i < n; ++i)
    sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return sum;
}

void dotAndSums(std::int64_t n, const float* a, const float* b, double* sums)
{
  double both = 0;
  double first = 0;
  double second = 0;
#pragma omp simd reduction(+ : both, first, second)
  for (std::int64_t i = 0; i < n; ++i)
  {
    both += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    first += static_cast<double>(a[i]);
    second += static_cast<double>(b[i]);
  }
  sums[0] += both;
  sums[1] += first;
  sums[2] += second;
}

void direct(std::int64_t n, float factor, float shift, const float* b, float* a)
{
#pragma omp simd
  for (std::int64_t i = 0; i < n; ++i)
    a[i] = b[i] - shift + factor * a[i];
}

template <class Real>
double step(std::int64_t n, double factor, const float* p, const float* q, Real* x, float* r)
{
  double sum = 0;
  const auto f = static_cast<float>(factor);
  const auto g = static_cast<Real>(factor);
#pragma omp simd reduction(+ : sum)
  for (std::int64_t i = 0; i < n; ++i)
  {
    x[i] += g * static_cast<Real>(p[i]);
    r[i] -= f * q[i];
    sum += static_cast<double>(r[i]) * static_cast<double>(r[i]);
  }
  return sum;
}

void add(std::int64_t n, float w, const float* a, float* out)
{
#pragma omp simd
  for (std::int64_t i = 0; i < n; ++i)
    out[i] += w * a[i];
}

void lookUp(std::int64_t n, const std::uint8_t* phase, const float* tableA, const float* tableB, float* a, float* b)
{
#pragma omp simd
  for (std::int64_t i = 0; i < n; ++i)
  {
    a[i] = tableA[phase[i]];
    b[i] = tableB[phase[i]];
  }
}

template <int D, class Real>
void turn(std::int64_t n, const std::uint8_t* phase, const Real* const* table, const float* axis, Real* const* out)
{
  constexpr int m = voigtSize(D);
  for (std::int64_t i = 0; i < n; ++i)
  {
    const std::uint8_t id = phase[i];
    Real v[3];
    Real length = 0;
    for (int a = 0; a < D; ++a)
    {
      v[a] = static_cast<Real>(axis[3 * i + a]);
      length += v[a] * v[a];
    }
    const Real unit = length > 0 ? 1 / length : Real{ 0 };
    Real nn[m];
    times<m>([&](auto k) { nn[k] = unit * v[voigtAxis(D, k, 0)] * v[voigtAxis(D, k, 1)]; });
    const Real lambda = table[0][id];
    const Real mu = table[1][id];
    const Real alpha = table[2][id];
    const Real beta = table[3][id];
    const Real gamma = table[4][id];
    times<m>(
      [&](auto p)
      {
        times<m>(
          [&](auto q)
          {
            if constexpr (p <= q)
            {
              constexpr int a = voigtAxis(D, p, 0);
              constexpr int b = voigtAxis(D, p, 1);
              constexpr int c = voigtAxis(D, q, 0);
              constexpr int d = voigtAxis(D, q, 1);
              Real value = beta * nn[p] * nn[q];
              if constexpr (a == b && c == d)
                value += lambda;
              if constexpr (a == b)
                value += alpha * nn[q];
              if constexpr (c == d)
                value += alpha * nn[p];
              constexpr int twice = (a == c && b == d ? 1 : 0) + (a == d && b == c ? 1 : 0);
              if constexpr (twice > 0)
                value += twice * mu;
              Real sum = 0;
              if constexpr (a == c)
                sum += nn[voigt(D, b, d)];
              if constexpr (a == d)
                sum += nn[voigt(D, b, c)];
              if constexpr (b == c)
                sum += nn[voigt(D, a, d)];
              if constexpr (b == d)
                sum += nn[voigt(D, a, c)];
              out[triangle(m, p, q)][i] = value + gamma * sum;
            }
          });
      });
  }
}

} // namespace

extern const ElasticKernels LAMELLA_KERNELS;
const ElasticKernels LAMELLA_KERNELS = { applySingle<2>, applySingle<3>, applyDouble<2>, applyDouble<3>, stressesAny<2>,
  stressesAny<3>, relax, relaxFirst, difference, dot, dotAndSums, direct, step<float>, step<double>, add, lookUp,
  turn<2, float>, turn<3, float>, turn<2, double>, turn<3, double> };

} // namespace lamella::elasticity
