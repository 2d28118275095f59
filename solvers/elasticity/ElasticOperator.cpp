#include "elasticity/ElasticOperator.h"

#include "elasticity/ElasticSweep.h"

#include <cstddef>
#include <type_traits>

namespace lamella::elasticity
{
namespace
{

constexpr std::int64_t threadedNodes = 20000;
constexpr std::int64_t leastPlanes = 8; // of a thread

} // namespace

template <int D>
ElasticOperator<D>::ElasticOperator(
  ElasticGrid<D> grid, bool isotropic, ModuliRows<float> moduli, ModuliRows<double> exact, int threads)
  : grid_(std::move(grid))
  , isotropic_(isotropic)
  , moduli_(std::move(moduli))
  , exact_(std::move(exact))
  , threads_(grid_.ownNodes() < threadedNodes
        ? 1
        : std::max(1, static_cast<int>(std::min<std::int64_t>(threads, (grid_.last() - grid_.first()) / leastPlanes))))
  , sumLength_(grid_.rowLength() + spareValues)
  , sums_(static_cast<std::size_t>(threads_),
      std::vector<float>(static_cast<std::size_t>(2 * (D + 1) * sumLength_ * grid_.rows() + spareValues), 0.0F))
  , rims_(static_cast<std::size_t>(2 * threads_ * D * grid_.planeStride()))
{
  if (!grid_.stretched())
    return;
  stretchX_.assign(static_cast<std::size_t>(grid_.elements[0] + spareValues), 0.0F);
  for (std::int64_t i = 0; i < grid_.elements[0]; ++i)
    stretchX_[static_cast<std::size_t>(i)] = 1 / grid_.widthOf(0, i);
}

template <int D>
std::array<std::int64_t, 2> ElasticOperator<D>::slab(int thread) const noexcept
{
  const std::int64_t first = grid_.first();
  const std::int64_t pairs = (grid_.last() - first + 1) / 2;
  return { first + 2 * (pairs * thread / threads_),
    std::min(grid_.last(), first + 2 * (pairs * (thread + 1) / threads_)) };
}

template <int D>
void ElasticOperator<D>::moduliRow(
  std::int64_t row, std::int64_t plane, double* const* buffer, const double** rows) const
{
  if (exact_)
  {
    exact_(row, plane, buffer, rows);
    return;
  }
  ModuliBuffer<D, float> single(grid_.elements[0]);
  moduli_(row, plane, single.buffer.data(), single.rows.data());
  for (std::size_t m = 0; m < static_cast<std::size_t>(moduliCount()); ++m)
  {
    std::copy_n(single.rows[m], grid_.elements[0], buffer[m]);
    rows[m] = buffer[m];
  }
}

template <int D>
std::size_t ElasticOperator<D>::bytes() const noexcept
{
  std::size_t total = rims_.size() + stretchX_.size() + beside_.size();
  for (const auto& sums : sums_)
    total += sums.size();
  return total * sizeof(float);
}

template <int D>
template <class Real>
const Real* ElasticOperator<D>::nodesAround(
  const Real* u, const std::vector<Real>& beside, std::int64_t row, std::int64_t plane, int which, int component) const
{
  const ElasticGrid<D>& g = grid_;
  const std::int64_t j = D == 2 ? 0 : row + (which & 1) == g.rows() ? 0 : row + (which & 1);
  const std::int64_t up = plane + (D == 3 ? which >> 1 : which);
  if (g.parts.split() && up == g.last())
    return beside.data() + (D + component) * g.planeStride() + j * g.rowLength();
  return u + component * g.componentStride() + g.at(j, up == g.planes() ? 0 : up);
}

template <int D>
template <class Real>
void ElasticOperator<D>::forStresses(const Real* u, const ElasticLoad<D>* load, const StressRow& f) const
{
  constexpr int n = voigtSize(D);
  const ElasticGrid<D>& g = grid_;
  std::vector<Real> beside;
  planesBeside(u, beside);
  const std::int64_t length = g.elements[0] + spareValues;
#pragma omp parallel num_threads(threads_) if (threads_ > 1)
  {
    ModuliBuffer<D, double> moduli(g.elements[0]);
    std::vector<double> store(static_cast<std::size_t>((2 * n + D * rowsAround) * length), 0.0);
    std::array<double*, n> stress{};
    std::array<double*, n> strain{};
    InitialBuffer<D, double> initial(g.elements[0], load != nullptr && load->initial);
    for (std::size_t k = 0; k < n; ++k)
    {
      stress[k] = store.data() + static_cast<std::int64_t>(k) * length;
      strain[k] = store.data() + static_cast<std::int64_t>(n + k) * length;
    }
    double* const values = store.data() + 2 * n * length;
    ElasticRow<D, double> row{};
    row.count = g.elements[0];
    row.isotropic = isotropic_;
    row.stretchX = g.stretched() ? stretchX_.data() : nullptr;
    if (load != nullptr)
      for (std::size_t k = 0; k < n; ++k)
        row.strain[k] = load->strain[k] * g.edge / cornerFactor<D>;
#pragma omp for schedule(static)
    for (std::int64_t k = g.first(); k < g.lastElements(); ++k)
      for (std::int64_t j = 0; j < g.elementRows(); ++j)
      {
        for (int r = 0; r < rowsAround; ++r)
          for (int c = 0; c < D; ++c)
          {
            double* const to = values + (c * rowsAround + r) * length;
            std::copy_n(nodesAround(u, beside, j, k, r, c), g.rowLength(), to);
            row.u[c][r] = to;
          }
        moduliRow(j, k, moduli.buffer.data(), moduli.rows.data());
        std::copy(moduli.rows.begin(), moduli.rows.end(), row.moduli);
        if (row.stretchX != nullptr)
        {
          if constexpr (D == 3)
            row.stretch[1] = 1 / static_cast<double>(g.widthOf(1, j));
          row.stretch[D - 1] = 1 / static_cast<double>(g.widthOf(D - 1, k));
        }
        if (initial.used())
        {
          initial.fill(*load, j, k);
          row.initial = initial.rows.data();
        }
        double energy = 0;
        if constexpr (D == 2)
          elasticKernels().planeStress(row, stress.data(), strain.data(), &energy);
        else
          elasticKernels().spaceStress(row, stress.data(), strain.data(), &energy);
        for (std::size_t c = 0; c < n; ++c)
          for (std::int64_t i = 0; i < g.elements[0]; ++i)
          {
            stress[c][i] /= cornerFactor<D>;
            strain[c][i] *= cornerFactor<D> / g.edge;
          }
        f(j, k, row, stress.data(), strain.data(), energy);
      }
  }
}

template <int D>
template <class Real>
void ElasticOperator<D>::forRows(std::span<const StrainField<Real>> fields, const RowsOfFields<Real>& f) const
{
  const ElasticGrid<D>& g = grid_;
  std::vector<std::vector<Real>> beside(fields.size());
  for (std::size_t i = 0; i < fields.size(); ++i)
    planesBeside(fields[i].u, beside[i]);
  std::vector<float> edges = stretchX_;
  if (!g.stretched())
    edges.assign(static_cast<std::size_t>(g.elements[0] + spareValues), 1.0F);
#pragma omp parallel num_threads(threads_) if (threads_ > 1)
  {
    std::vector<ElasticRow<D, Real>> rows(fields.size());
    for (std::size_t i = 0; i < fields.size(); ++i)
    {
      rows[i] = {};
      rows[i].count = g.elements[0];
      rows[i].stretchX = edges.data();
      for (std::size_t k = 0; k < voigtSize(D); ++k)
        rows[i].strain[k] = fields[i].strain[k] * g.edge / cornerFactor<D>;
    }
#pragma omp for schedule(static)
    for (std::int64_t k = g.first(); k < g.lastElements(); ++k)
      for (std::int64_t j = 0; j < g.elementRows(); ++j)
      {
        for (std::size_t i = 0; i < fields.size(); ++i)
        {
          for (int r = 0; r < rowsAround; ++r)
            for (int c = 0; c < D; ++c)
              rows[i].u[c][r] = nodesAround(fields[i].u, beside[i], j, k, r, c);
          rows[i].stretch[1] = D == 3 ? 1 / static_cast<double>(g.widthOf(1, j)) : 1;
          rows[i].stretch[D - 1] = 1 / static_cast<double>(g.widthOf(D - 1, k));
        }
        f(threads_ > 1 ? omp_get_thread_num() : 0, j, k, rows);
      }
  }
}

template <int D>
template <class Real>
void ElasticOperator<D>::forPairs(std::span<const StrainField<Real>> fields, const PairPhases& phases,
  const std::function<void(std::int64_t plane, const double* sums)>& f) const
{
  const ElasticGrid<D>& g = grid_;
  const bool axial = static_cast<bool>(phases.axis);
  const std::size_t several = fields.size() > 1 ? 1 : 0;
  const auto kernel = [&]
  {
    const PairKernels& kernels = pairKernels();
    constexpr bool single = std::is_same_v<Real, float>;
    if constexpr (D == 2 && single)
      return kernels.plane[several][axial ? 1 : 0];
    else if constexpr (D == 2)
      return kernels.planeDouble[several][axial ? 1 : 0];
    else if constexpr (single)
      return kernels.space[several][axial ? 1 : 0];
    else
      return kernels.spaceDouble[several][axial ? 1 : 0];
  }();
  const std::size_t count =
    phases.slots * static_cast<std::size_t>(pairParts(axial) * pairsOf(static_cast<int>(fields.size())));
  const double factor = cornerFactor<D> * cornerFactor<D> / (g.edge * g.edge);
  const auto threads = static_cast<std::size_t>(threads_);
  std::vector<std::vector<std::byte>> scratch(threads, std::vector<std::byte>(count * pairScratch));
  std::vector<std::vector<double>> sums(threads, std::vector<double>(count));
  forRows<Real>(fields,
    [&](int thread, std::int64_t row, std::int64_t plane, std::span<const ElasticRow<D, Real>> rows)
    {
      std::vector<double>& own = sums[static_cast<std::size_t>(thread)];
      if (row == 0)
        std::ranges::fill(own, 0.0);
      kernel({ rows.data(), phases.phase(row, plane), phases.slot.data(), axial ? phases.axis(row, plane) : nullptr,
               scratch[static_cast<std::size_t>(thread)].data() },
        own.data());
      if (row + 1 < g.elementRows())
        return;
      for (double& sum : own)
        sum *= factor;
      f(plane, own.data());
    });
}

template class ElasticOperator<2>;
template class ElasticOperator<3>;
template void ElasticOperator<2>::forStresses(const float*, const ElasticLoad<2>*, const StressRow&) const;
template void ElasticOperator<3>::forStresses(const float*, const ElasticLoad<3>*, const StressRow&) const;
template void ElasticOperator<2>::forStresses(const double*, const ElasticLoad<2>*, const StressRow&) const;
template void ElasticOperator<3>::forStresses(const double*, const ElasticLoad<3>*, const StressRow&) const;
template void ElasticOperator<2>::forPairs(std::span<const StrainField<float>>, const PairPhases&,
  const std::function<void(std::int64_t, const double*)>&) const;
template void ElasticOperator<3>::forPairs(std::span<const StrainField<float>>, const PairPhases&,
  const std::function<void(std::int64_t, const double*)>&) const;
template void ElasticOperator<2>::forPairs(std::span<const StrainField<double>>, const PairPhases&,
  const std::function<void(std::int64_t, const double*)>&) const;
template void ElasticOperator<3>::forPairs(std::span<const StrainField<double>>, const PairPhases&,
  const std::function<void(std::int64_t, const double*)>&) const;
template void ElasticOperator<2>::forRows(std::span<const StrainField<float>>, const RowsOfFields<float>&) const;
template void ElasticOperator<2>::forRows(std::span<const StrainField<double>>, const RowsOfFields<double>&) const;
template void ElasticOperator<3>::forRows(std::span<const StrainField<float>>, const RowsOfFields<float>&) const;
template void ElasticOperator<3>::forRows(std::span<const StrainField<double>>, const RowsOfFields<double>&) const;

} // namespace lamella::elasticity
