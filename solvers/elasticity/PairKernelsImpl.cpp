// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines; see PairKernels.h.

#include "elasticity/PairKernels.h"

#include "elasticity/ElasticPacks.h"

#include <cmath>

namespace lamella::elasticity
{
namespace
{

// The axes of one pack of elements: units, and their products by Voigt's order.
template <int D, class Real>
struct PackedAxes
{
  Pack<Real> unit[D]{};
  Pack<Real> product[voigtSize(D)]{};

  void set(const float* axis, std::int64_t i, std::int64_t count)
  {
    Real values[D][lanes<Real>]{};
    for (int l = 0; l < lanes<Real> && i + l < count; ++l)
    {
      const float* const v = axis + 3 * (i + l);
      Real length = 0;
      for (int a = 0; a < D; ++a)
        length += static_cast<Real>(v[a]) * static_cast<Real>(v[a]);
      const Real scale = length > 0 ? 1 / std::sqrt(length) : Real{ 0 };
      for (int a = 0; a < D; ++a)
        values[a][l] = scale * static_cast<Real>(v[a]);
    }
    for (int a = 0; a < D; ++a)
      unit[a] = load(values[a]);
    times<voigtSize(D)>([&](auto k) { product[k] = unit[voigtAxis(D, k, 0)] * unit[voigtAxis(D, k, 1)]; });
  }
};

// A strain as the parts take it.
template <int D, class Real>
struct PairStrain
{
  Pack<Real> e[voigtSize(D)];        // shears as angles
  Pack<Real> weighted[voigtSize(D)]; // 2 e of stretches, e of shears
  Pack<Real> trace;
  Pack<Real> along;    // n · ε · n
  Pack<Real> drawn[D]; // 2 ε · n

  template <int used, bool axial>
  void set([[maybe_unused]] const PackedAxes<D, Real>& axes)
  {
    trace = along = Pack<Real>{};
    times<D>([&](auto a) { drawn[a] = Pack<Real>{}; });
    times<voigtSize(D)>(
      [&](auto k)
      {
        if constexpr ((used >> k & 1) != 0)
        {
          constexpr int a = voigtAxis(D, k, 0);
          constexpr int b = voigtAxis(D, k, 1);
          weighted[k] = k < D ? e[k] + e[k] : e[k];
          if constexpr (k < D)
            trace += e[k];
          if constexpr (axial)
          {
            along += e[k] * axes.product[k];
            drawn[a] += weighted[k] * axes.unit[b];
            if constexpr (a != b)
              drawn[b] += weighted[k] * axes.unit[a];
          }
        }
      });
  }
};

template <int D, class Real, int fields, bool axial>
void pairs(const PairRow<D, Real>& row, double* sums)
{
  using P = Pack<Real>;
  constexpr int n = voigtSize(D);
  constexpr int count = pairsOf(fields);
  constexpr int each = pairParts(axial) * count;
  Real* const scratch = static_cast<Real*>(row.scratch);
  const std::int64_t elements = row.fields[0].count;
  bool touched[256]{};
  for (std::int64_t i = 0; i < elements; i += lanes<Real>)
  {
    std::int16_t slot[lanes<Real>];
    bool any = false;
    for (int l = 0; l < lanes<Real>; ++l)
    {
      slot[l] = i + l < elements ? row.slot[row.phase[i + l]] : std::int16_t{ -1 };
      any = any || slot[l] >= 0;
    }
    if (!any)
      continue;
    P energy[each]{};
    const Edges<D, Real, true> edges(row.fields[0], i);
    Modes<D, Real> u[fields];
    for (int f = 0; f < fields; ++f)
      u[f] = Modes<D, Real>(row.fields[f], i);
    PackedAxes<D, Real> axes;
    if constexpr (axial)
      axes.set(row.axis, i, elements);
    times<2 * (1 << (D - 1)) - 1>(
      [&](auto polynomial)
      {
        constexpr int used = usedBy<D>(polynomial);
        PairStrain<D, Real> strain[fields];
        for (int f = 0; f < fields; ++f)
        {
          strainOf(u[f], edges, polynomial, strain[f].e);
          if constexpr (polynomial == 0)
            times<n>([&](auto k) { strain[f].e[k] += all<Real>(row.fields[f].strain[k]); });
          strain[f].template set<used, axial>(axes);
        }
        const P weight = all<Real>(meanSquare(polynomial));
        for (int a = 0, at = 0; a < fields; ++a)
        {
          const PairStrain<D, Real>& s = strain[a];
          P weighted[n];
          times<n>(
            [&](auto k)
            {
              if constexpr ((used >> k & 1) != 0)
                weighted[k] = weight * s.weighted[k];
            });
          const P trace = weight * s.trace;
          [[maybe_unused]] const P along = weight * s.along;
          for (int b = a; b < fields; ++b, ++at)
          {
            const PairStrain<D, Real>& t = strain[b];
            P product{};
            times<n>(
              [&](auto k)
              {
                if constexpr ((used >> k & 1) != 0)
                  product += weighted[k] * t.e[k];
              });
            if constexpr (axial)
            {
              energy[at] += trace * t.trace;
              energy[count + at] += product;
              energy[2 * count + at] += trace * t.along + along * t.trace;
              energy[3 * count + at] += along * t.along;
              P drawn{};
              times<D>([&](auto c) { drawn += s.drawn[c] * t.drawn[c]; });
              energy[4 * count + at] += weight * drawn;
            }
            else
            {
              energy[(polynomial == 0 ? 0 : count) + at] += trace * t.trace;
              energy[2 * count + at] += product;
            }
          }
        }
      });
    for (int l = 0; l < lanes<Real>; ++l)
    {
      const std::int16_t own = slot[l];
      if (own < 0)
        continue;
      touched[own] = true;
      Real here[lanes<Real>];
      for (int m = 0; m < lanes<Real>; ++m)
      {
        here[m] = slot[m] == own ? Real{ 1 } : Real{ 0 };
        slot[m] = slot[m] == own ? std::int16_t{ -1 } : slot[m];
      }
      const P mask = load(here);
      Real* const to = scratch + static_cast<std::int64_t>(own) * each * lanes<Real>;
      for (int q = 0; q < each; ++q)
        store(to + q * lanes<Real>, load(to + q * lanes<Real>) + mask * energy[q]);
    }
  }
  for (int own = 0; own < 256; ++own)
    for (std::int64_t k = own * each; k < (own + 1) * each && touched[own]; ++k)
    {
      sums[k] += total<Real>(load(scratch + k * lanes<Real>));
      store(scratch + k * lanes<Real>, P{});
    }
}

} // namespace

extern const PairKernels LAMELLA_KERNELS;
const PairKernels LAMELLA_KERNELS = { { { pairs<2, float, 1, false>, pairs<2, float, 1, true> },
                                        { pairs<2, float, 3, false>, pairs<2, float, 3, true> } },
  { { pairs<2, double, 1, false>, pairs<2, double, 1, true> },
    { pairs<2, double, 3, false>, pairs<2, double, 3, true> } },
  { { pairs<3, float, 1, false>, pairs<3, float, 1, true> }, { pairs<3, float, 6, false>, pairs<3, float, 6, true> } },
  { { pairs<3, double, 1, false>, pairs<3, double, 1, true> },
    { pairs<3, double, 6, false>, pairs<3, double, 6, true> } } };

} // namespace lamella::elasticity
