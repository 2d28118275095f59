#pragma once

#include "elasticity/ElasticOperator.h"

#include <omp.h>

#include <type_traits>

namespace lamella::elasticity
{

/// A thread's place for the moduli of a row of elements, and pointers to where they are.
template <int D, class Real>
struct ModuliBuffer
{
  std::vector<Real> values;
  std::array<Real*, stiffnessSize(D)> buffer{};
  std::array<const Real*, stiffnessSize(D)> rows{};

  explicit ModuliBuffer(std::int64_t elements)
    : values(static_cast<std::size_t>(stiffnessSize(D) * (elements + spareValues)), Real{ 0 })
  {
    for (int k = 0; k < stiffnessSize(D); ++k)
      buffer[static_cast<std::size_t>(k)] = values.data() + k * (elements + spareValues);
  }
};

/// The same for stresses that a load adds, in the kernels' unit.
template <int D, class Real>
struct InitialBuffer
{
  static constexpr std::size_t count = voigtSize(D);
  std::int64_t length;
  std::vector<double> given;
  std::vector<Real> values;
  std::array<double*, count> from{};
  std::array<const Real*, count> rows{};

  InitialBuffer(std::int64_t elements, bool use)
    : length(elements + spareValues)
    , given(use ? count * static_cast<std::size_t>(length) : 0, 0.0)
    , values(given.size(), Real{ 0 })
  {
    for (std::size_t k = 0; k < count && use; ++k)
    {
      from[k] = given.data() + static_cast<std::int64_t>(k) * length;
      rows[k] = values.data() + static_cast<std::int64_t>(k) * length;
    }
  }
  [[nodiscard]] bool used() const noexcept { return !given.empty(); }
  void fill(const ElasticLoad<D>& load, std::int64_t row, std::int64_t plane)
  {
    load.initial(row, plane, from.data());
    for (std::size_t i = 0; i < given.size(); ++i)
      values[i] = static_cast<Real>(cornerFactor<D> * given[i]);
  }
};

template <int D>
template <class Real>
void ElasticOperator<D>::planesBeside(const Real* u, std::vector<Real>& beside) const
{
  const ElasticGrid<D>& g = grid_;
  if (!g.parts.split())
    return;
  const std::int64_t plane = g.planeStride();
  const std::int64_t all = D * plane;
  beside.resize(static_cast<std::size_t>(4 * all));
  Real* const own = beside.data() + 2 * all; // what others get
  for (int c = 0; c < D; ++c)
  {
    std::copy_n(u + c * g.componentStride(), plane, own + c * plane);
    std::copy_n(u + (c + 1) * g.componentStride() - plane, plane, own + all + c * plane);
  }
  g.parts.up(own + all, beside.data(), static_cast<std::size_t>(all));
  g.parts.down(own, beside.data() + all, static_cast<std::size_t>(all));
}

template <int D>
template <class Real, class Visit, class End>
void ElasticOperator<D>::sweep(
  const Real* u, const ElasticLoad<D>* load, bool diagonal, Visit&& visit, End&& endPlane) const
{
  constexpr bool single = std::is_same_v<Real, float>;
  const ElasticGrid<D>& g = grid_;
  const std::int64_t rows = g.rows();
  const std::int64_t plane = g.planeStride();
  const std::int64_t component = g.componentStride();
  const bool around = g.periodic[D - 1];
  const std::int64_t sumPlane = sumLength_ * rows;
  const int kinds = D + 1;
  std::vector<Real> rimStore;
  Real* rims = nullptr;
  if constexpr (single)
    rims = rims_.data();
  else
  {
    rimStore.resize(static_cast<std::size_t>(2 * threads_ * D * plane));
    rims = rimStore.data();
  }
  std::vector<Real> besideStore;
  const Real* beside = nullptr;
  if (u != nullptr && g.parts.split())
  {
    if constexpr (single)
    {
      planesBeside(u, beside_);
      beside = beside_.data();
    }
    else
    {
      planesBeside(u, besideStore);
      beside = besideStore.data();
    }
  }
  const auto rim = [&](int thread, int end, int c) { return rims + ((2 * thread + end) * D + c) * plane; };
  const ElasticKernels& kernels = elasticKernels();

#pragma omp parallel num_threads(threads_) if (threads_ > 1)
  {
    const int thread = threads_ > 1 ? omp_get_thread_num() : 0;
    const auto [first, last] = slab(thread);
    if (u != nullptr)
    {
      for (int c = 0; c < D; ++c)
      {
        std::copy_n(u + c * component + g.at(0, first), plane, rim(thread, 0, c));
        std::copy_n(u + c * component + g.at(0, last - 1), plane, rim(thread, 1, c));
      }
#pragma omp barrier
    }
    std::vector<Real> own;
    Real* sums = nullptr;
    if constexpr (single)
      sums = sums_[static_cast<std::size_t>(thread)].data();
    else
    {
      own.resize(static_cast<std::size_t>(2 * kinds * sumPlane + spareValues));
      sums = own.data();
    }
    Real* lower = sums;
    Real* upper = sums + kinds * sumPlane;
    std::fill_n(upper, kinds * sumPlane, Real{ 0 });
    ModuliBuffer<D, Real> moduli(g.elements[0]);
    InitialBuffer<D, Real> initial(g.elements[0], load != nullptr && load->initial);

    ElasticRow<D, Real> row{};
    row.count = g.elements[0];
    row.isotropic = isotropic_;
    row.stretchX = g.stretched() ? stretchX_.data() : nullptr;
    if (load != nullptr)
      for (std::size_t k = 0; k < voigtSize(D); ++k)
        row.strain[k] = load->strain[k] * g.edge / cornerFactor<D>;
    if (initial.used())
      row.initial = initial.rows.data();

    const auto planeOf = [&](std::int64_t k, int c) -> const Real*
    {
      if (k < first)
        return beside != nullptr && thread == 0 ? beside + c * plane : rim((thread + threads_ - 1) % threads_, 1, c);
      if (k >= last)
        return beside != nullptr && thread + 1 == threads_ ? beside + (D + c) * plane
                                                           : rim((thread + 1) % threads_, 0, c);
      return u + c * component + g.at(0, k);
    };
    for (std::int64_t k = first - 1; k < last; ++k)
    {
      std::swap(lower, upper);
      std::fill_n(upper, kinds * sumPlane, Real{ 0 });
      const bool exists = around || (k >= 0 && k < g.elementPlanes());
      const std::int64_t element = k < 0 ? k + g.elementPlanes() : k;
      for (std::int64_t j = 0; exists && j < g.elementRows(); ++j)
      {
        const std::int64_t next = D == 2 || j + 1 == rows ? 0 : j + 1;
        Real* out[D][rowsAround];
        Real* diagonalOut[rowsAround];
        for (int r = 0; r < rowsAround; ++r)
        {
          const std::int64_t jj = D == 3 && (r & 1) != 0 ? next : j;
          const int up = D == 3 ? r >> 1 : r;
          Real* const base = (up != 0 ? upper : lower) + jj * sumLength_;
          for (int c = 0; c < D; ++c)
          {
            if (u != nullptr)
              row.u[c][r] = planeOf(k + up, c) + jj * g.rowLength();
            out[c][r] = base + c * sumPlane;
          }
          diagonalOut[r] = base + D * sumPlane;
        }
        moduliRow(j, element, moduli.buffer.data(), moduli.rows.data());
        std::copy(moduli.rows.begin(), moduli.rows.end(), row.moduli);
        if (row.stretchX != nullptr)
        {
          if constexpr (D == 3)
            row.stretch[1] = 1 / static_cast<double>(g.widthOf(1, j));
          row.stretch[D - 1] = 1 / static_cast<double>(g.widthOf(D - 1, element));
        }
        if (initial.used())
          initial.fill(*load, j, element);
        if constexpr (single && D == 2)
          kernels.plane(row, u != nullptr ? out : nullptr, diagonal ? diagonalOut : nullptr);
        else if constexpr (single)
          kernels.space(row, u != nullptr ? out : nullptr, diagonal ? diagonalOut : nullptr);
        else if constexpr (D == 2)
          kernels.planeDouble(row, out);
        else
          kernels.spaceDouble(row, out);
      }
      if (k < first)
        continue;
      for (std::int64_t j = 0; j < rows; ++j)
      {
        Real* done[D + 1];
        for (int c = 0; c <= D; ++c)
        {
          done[c] = lower + c * sumPlane + j * sumLength_;
          if (g.periodic[0])
            done[c][0] = done[c][g.elements[0]] = done[c][0] + done[c][g.elements[0]];
        }
        for (int c = 0; c < D; ++c)
          g.forHeld(
            j, k, c, [&](std::int64_t from, std::int64_t count) { std::fill_n(done[c] + from, count, Real{ 0 }); });
        visit(thread, k, j, done);
      }
      endPlane(thread, k);
    }
  }
}

} // namespace lamella::elasticity
