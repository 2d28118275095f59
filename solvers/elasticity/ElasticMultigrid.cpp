#include "elasticity/ElasticMultigrid.h"

#include "elasticity/ElasticSweep.h"

#include <cmath>
#include <numbers>

namespace lamella::elasticity
{
namespace
{

constexpr std::int64_t coarsestNodes = 30;
constexpr double longEdge = 1.5;       // axes of elements longer than the shortest by this are left as they are
constexpr double withoutForce = 1e-12; // eigenvalues of the coarsest matrix, scaled to a diagonal of 1: rigid motions

// What a node of a finer box takes of the coarse ones beside it along one axis.
struct Share
{
  std::int64_t low = 0; ///< coarse node
  float weight = 1;     ///< of that one; the rest is of the next
};

template <int D>
Share shareOf(const ElasticGrid<D>& fine, bool halved, int axis, std::int64_t node)
{
  if (!halved)
    return { node, 1.0F };
  if (node % 2 == 0)
    return { node / 2, 1.0F };
  if (node == fine.elements[static_cast<std::size_t>(axis)]) // the last one of an odd number of elements
    return { node / 2 + 1, 1.0F };
  const float before = fine.widthOf(axis, node - 1);
  const float after = fine.widthOf(axis, node);
  return { node / 2, after / (before + after) };
}

// A row of nodes to the coarse nodes along it, added with a factor; copies of a node's first one along x count once.
template <int D>
void restrictRow(const ElasticGrid<D>& fine, bool halved, const float* from, std::int64_t coarseElements, float* to)
{
  const std::int64_t n = fine.elements[0];
  if (!halved)
  {
    std::copy_n(from, n + 1, to);
    return;
  }
  const bool around = fine.periodic[0];
  to[coarseElements] = 0;
  for (std::int64_t i = 0; i < coarseElements; ++i)
    to[i] = from[2 * i];
  if (!around && n % 2 == 0)
    to[coarseElements] = from[n];
  const std::int64_t odd = n / 2; // nodes 1, 3, … between two others
  for (std::int64_t i = 0; i + 1 < odd; ++i)
  {
    to[i] += 0.5F * from[2 * i + 1];
    to[i + 1] += 0.5F * from[2 * i + 1];
  }
  if (odd > 0)
  {
    const Share s = shareOf(fine, true, 0, 2 * odd - 1);
    to[odd - 1] += s.weight * from[2 * odd - 1];
    to[odd] += (1 - s.weight) * from[2 * odd - 1];
  }
  if (n % 2 != 0 && !around)
    to[coarseElements] += from[n];
  if (around)
    to[0] = to[coarseElements] = to[0] + to[coarseElements];
}

template <int D>
void addRow(const ElasticGrid<D>& fine, bool halved, const float* from, std::int64_t coarseElements, float* to)
{
  const std::int64_t n = fine.elements[0];
  if (!halved)
  {
    for (std::int64_t i = 0; i <= n; ++i)
      to[i] += from[i];
    return;
  }
  const std::int64_t odd = n / 2;
  for (std::int64_t i = 0; i <= n / 2; ++i)
    to[2 * i] += from[i];
  for (std::int64_t i = 0; i + 1 < odd; ++i)
    to[2 * i + 1] += 0.5F * (from[i] + from[i + 1]);
  if (odd > 0)
  {
    const Share s = shareOf(fine, true, 0, 2 * odd - 1);
    to[2 * odd - 1] += s.weight * from[odd - 1] + (1 - s.weight) * from[odd];
  }
  if (n % 2 != 0)
    to[n] += from[coarseElements];
}

} // namespace

template <int D>
ElasticMultigrid<D>::ElasticMultigrid(const ElasticOperator<D>& finest,
  std::function<double(std::array<double, D>)> largestEigenvalue, const ElasticMultigridOptions& options)
  : options_(options)
  , largestEigenvalue_(std::move(largestEigenvalue))
{
  levels_.push_back(std::make_unique<Level>());
  levels_[0]->op = &finest;
  setFactors(*levels_[0], options_.smoothing);
  while (levels_.back()->op->grid().ownNodes() > coarsestNodes && coarsen())
  {
  }
  invertCoarsest();
}

template <int D>
void ElasticMultigrid<D>::setFactors(Level& level, int steps) const
{
  // elements of all widths that occur along the axes: usual and last
  const ElasticGrid<D>& g = level.op->grid();
  double largest = 0;
  for (int shape = 0; shape < 1 << D; ++shape)
  {
    std::array<double, D> widths{};
    for (int a = 0; a < D; ++a)
      widths[static_cast<std::size_t>(a)] =
        static_cast<double>(g.widthOf(a, (shape >> a & 1) != 0 ? g.elements[static_cast<std::size_t>(a)] - 1 : 0));
    largest = std::max(largest, largestEigenvalue_(widths));
  }
  const double low = largest / options_.smoothedPart;
  level.factors.clear();
  for (int i = 0; i < steps; ++i)
    level.factors.push_back(static_cast<float>(
      1 / (0.5 * (largest + low) - 0.5 * (largest - low) * std::cos(std::numbers::pi * (2 * i + 1) / (2.0 * steps)))));
}

template <int D>
bool ElasticMultigrid<D>::coarsen()
{
  Level& fine = *levels_.back();
  const ElasticGrid<D>& from = fine.op->grid();
  ElasticGrid<D> to = from;
  double shortest = 0;
  for (std::size_t a = 0; a < D; ++a)
    if (from.elements[a] > 1)
    {
      const double w = static_cast<double>(from.widthOf(static_cast<int>(a), 0));
      shortest = shortest == 0 ? w : std::min(shortest, w);
    }
  bool any = false;
  for (std::size_t a = 0; a < D; ++a)
  {
    fine.halved[a] =
      from.elements[a] > 1 && static_cast<double>(from.widthOf(static_cast<int>(a), 0)) < longEdge * shortest;
    any = any || fine.halved[a];
    if (fine.halved[a])
      to.elements[a] = (from.elements[a] + 1) / 2;
  }
  if (!any)
    return false;
  to.edge = from.edge * (fine.halved[0] ? 2 : 1);
  bool stretched = false;
  for (std::size_t a = 0; a < D; ++a)
  {
    to.width[a].resize(static_cast<std::size_t>(to.elements[a]));
    for (std::int64_t i = 0; i < to.elements[a]; ++i)
    {
      float w = 0;
      if (!fine.halved[a])
        w = from.widthOf(static_cast<int>(a), i);
      else
        for (std::int64_t k = 2 * i; k < std::min(2 * i + 2, from.elements[a]); ++k)
          w += from.widthOf(static_cast<int>(a), k);
      w *= static_cast<float>(from.edge / to.edge);
      to.width[a][static_cast<std::size_t>(i)] = w;
      stretched = stretched || w != 1.0F;
    }
  }
  if (!stretched)
    for (auto& w : to.width)
      w.clear();

  fine.below = fine.halved[D - 1] ? from.parts.halved(to.planes()) : from.parts;
  to.parts =
    to.ownNodes() > PlaneParts::fewNodes && fine.below.split() && fine.below.beginEven() ? fine.below : PlaneParts{};

  // moduli are over the edge's square and times the volume, so that sums make means
  const int kinds = fine.op->moduliCount();
  auto moduli = std::make_unique<StoredModuli<D>>(to, kinds);
  const std::int64_t firstPlane = fine.below.split() ? fine.below.first() : 0;
  const std::int64_t lastPlane =
    fine.below.split() ? std::min(fine.below.last(), to.elementPlanes()) : to.elementPlanes();
  const auto factor = static_cast<float>((from.edge / to.edge) * (from.edge / to.edge));
#pragma omp parallel num_threads(fine.op->threads()) if (fine.op->threads() > 1)
  {
    ModuliBuffer<D, float> buffer(from.elements[0]);
#pragma omp for schedule(static)
    for (std::int64_t plane = firstPlane; plane < lastPlane; ++plane)
    {
      const bool halvedPlanes = fine.halved[D - 1];
      const std::int64_t k0 = halvedPlanes ? 2 * plane : plane;
      for (std::int64_t k = k0; k < std::min(k0 + (halvedPlanes ? 2 : 1), from.elementPlanes()); ++k)
        for (std::int64_t j = 0; j < from.elementRows(); ++j)
        {
          fine.op->moduliRow(j, k, buffer.buffer.data(), buffer.rows.data());
          const std::int64_t row = D == 3 && fine.halved[1] ? j / 2 : j;
          for (int m = 0; m < kinds; ++m)
          {
            float* const out = moduli->row(m, row, plane);
            const float* const in = buffer.rows[static_cast<std::size_t>(m)];
            for (std::int64_t i = 0; i < from.elements[0]; ++i)
              out[fine.halved[0] ? i / 2 : i] += factor * in[i];
          }
        }
      if (options_.hillBulk)
        setHillBulk(fine, to, plane, static_cast<double>(factor), buffer, *moduli);
    }
  }
  if (to.parts.split())
    moduli->takeBelow(to.parts);
  else
    moduli->gather(fine.below);
  auto level = std::make_unique<Level>();
  level->own =
    std::make_unique<ElasticOperator<D>>(to, fine.op->isotropic(), moduli->rows(), nullptr, fine.op->threads());
  level->op = level->own.get();
  level->moduli = std::move(moduli);
  level->b.assign(to.values(), 0.0F);
  level->x.assign(to.values(), 0.0F);
  fine.spill.assign(static_cast<std::size_t>((fine.op->threads() * 2 + 1) * D * to.planeStride()), 0.0F);
  setFactors(*level, options_.coarseSmoothing);
  levels_.push_back(std::move(level));
  return true;
}

// λ of a plane of coarse elements whose μ is set. Σ Vᵢ / (Kᵢ + g μ) is V / (K + g μ), with the mean μ.
template <int D>
void ElasticMultigrid<D>::setHillBulk(const Level& fine, const ElasticGrid<D>& to, std::int64_t plane, double factor,
  ModuliBuffer<D, float>& buffer, StoredModuli<D>& moduli) const
{
  constexpr double shearInBulk = D == 3 ? 2.0 / 3 : 1.0; // K = λ + 2/3 μ, or λ + μ in the plane
  constexpr double g = D == 3 ? 4.0 / 3 : 1.0;
  const ElasticGrid<D>& from = fine.op->grid();
  const std::int64_t nx = to.elements[0];
  const double change = to.edge / from.edge;
  double unit = 1; // of a coarse element's volume, in the fine grid's one
  for (int a = 0; a < D; ++a)
    unit *= change;
  std::vector<double> sums(static_cast<std::size_t>(nx));
  const auto range = [](bool halved, std::int64_t i, std::int64_t count) {
    return halved ? std::array{ 2 * i, std::min(2 * i + 2, count) } : std::array{ i, i + 1 };
  };
  const auto width = [](const ElasticGrid<D>& grid, int axis, std::int64_t i)
  { return static_cast<double>(grid.widthOf(axis, i)); };
  for (std::int64_t row = 0; row < to.elementRows(); ++row)
  {
    std::ranges::fill(sums, 0.0);
    float* const lambda = moduli.row(0, row, plane);
    const float* const mu = moduli.row(1, row, plane);
    const double across = width(to, D - 1, plane) * (D == 3 ? width(to, 1, row) : 1.0);
    const auto volume = [&](std::int64_t i) { return unit * across * width(to, 0, i); };
    // as moduli are stored, times the volume; those of coarse elements times `factor`
    const auto [k0, k1] = range(fine.halved[D - 1], plane, from.elementPlanes());
    for (std::int64_t k = k0; k < k1; ++k)
    {
      const auto [j0, j1] = range(D == 3 && fine.halved[1], row, from.elementRows());
      for (std::int64_t j = j0; j < j1; ++j)
      {
        fine.op->moduliRow(j, k, buffer.buffer.data(), buffer.rows.data());
        for (std::int64_t i = 0; i < from.elements[0]; ++i)
        {
          const std::int64_t coarse = fine.halved[0] ? i / 2 : i;
          const double v = width(from, 0, i) * width(from, D - 1, k) * (D == 3 ? width(from, 1, j) : 1.0);
          const double shear = static_cast<double>(mu[coarse]) / (factor * volume(coarse));
          const double bulk =
            (static_cast<double>(buffer.rows[0][i]) + shearInBulk * static_cast<double>(buffer.rows[1][i])) / v;
          if (shear > 0)
            sums[static_cast<std::size_t>(coarse)] += v / (bulk + g * shear);
        }
      }
    }
    for (std::int64_t i = 0; i < nx; ++i)
      if (const double sum = sums[static_cast<std::size_t>(i)]; sum > 0)
      {
        const double shear = static_cast<double>(mu[i]) / (factor * volume(i));
        const double bulk = volume(i) / sum - g * shear;
        lambda[i] = static_cast<float>(std::max(0.0, factor * volume(i) * (bulk - shearInBulk * shear)));
      }
  }
}

template <int D>
void ElasticMultigrid<D>::invertCoarsest()
{
  const ElasticOperator<D>& op = *levels_.back()->op;
  const ElasticGrid<D>& g = op.grid();
  for (int c = 0; c < D; ++c)
    for (std::int64_t k = 0; k < g.planes(); ++k)
      for (std::int64_t j = 0; j < g.rows(); ++j)
        for (std::int64_t i = 0; i < g.nodes(0); ++i)
          place_.push_back(c * g.componentStride() + g.at(j, k) + i);
  const auto n = static_cast<Eigen::Index>(place_.size());
  Eigen::MatrixXd a(n, n);
  std::vector<double> u(g.values(), 0.0);
  std::vector<double> product(g.values(), 0.0);
  const auto put = [&](std::int64_t place, double value)
  {
    u[static_cast<std::size_t>(place)] = value;
    if (g.periodic[0] && (place % g.componentStride() % g.planeStride()) % g.rowLength() == 0)
      u[static_cast<std::size_t>(place + g.elements[0])] = value;
  };
  for (Eigen::Index m = 0; m < n; ++m)
  {
    put(place_[static_cast<std::size_t>(m)], 1);
    op.template sweep<double>(u.data(), nullptr, false,
      [&](int, std::int64_t k, std::int64_t j, double* const* sums)
      {
        for (int c = 0; c < D; ++c)
          std::copy_n(sums[c], g.rowLength(), product.data() + c * g.componentStride() + g.at(j, k));
      });
    put(place_[static_cast<std::size_t>(m)], 0);
    for (Eigen::Index l = 0; l < n; ++l)
      a(l, m) = product[static_cast<std::size_t>(place_[static_cast<std::size_t>(l)])];
  }
  // what is held got no force from others, but gives some: its rows are 0, and so its columns are to be
  Eigen::VectorXd scale(n);
  for (Eigen::Index m = 0; m < n; ++m)
    scale(m) = a(m, m) > 0 ? 1 / std::sqrt(a(m, m)) : 0;
  a = scale.asDiagonal() * (0.5 * (a + a.transpose())) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(a);
  Eigen::VectorXd inverse = modes.eigenvalues();
  for (double& value : inverse)
    value = value > withoutForce * static_cast<double>(n) ? 1 / value : 0;
  inverse_ = scale.asDiagonal() * modes.eigenvectors() * inverse.asDiagonal() * modes.eigenvectors().transpose() *
    scale.asDiagonal();
}

template <int D>
void ElasticMultigrid<D>::smooth(const Level& level, float factor, bool first, const float* b, float* z) const
{
  const ElasticGrid<D>& g = level.op->grid();
  const ElasticKernels& kernels = elasticKernels();
  level.op->template sweep<float>(first ? nullptr : z, nullptr, true,
    [&](int, std::int64_t k, std::int64_t j, float* const* sums)
    {
      for (int c = 0; c < D; ++c)
      {
        const std::int64_t at = c * g.componentStride() + g.at(j, k);
        if (first)
          kernels.relaxFirst(g.rowLength(), factor, b + at, sums[D], z + at);
        else
          kernels.relax(g.rowLength(), factor, b + at, sums[c], sums[D], z + at);
      }
    });
}

template <int D>
void ElasticMultigrid<D>::restrictResidual(const Level& fine, const float* b, const float* z, const Level& coarse) const
{
  const ElasticGrid<D>& f = fine.op->grid();
  const ElasticGrid<D>& g = coarse.op->grid();
  const ElasticKernels& kernels = elasticKernels();
  const std::int64_t plane = g.planeStride();
  const bool halvedPlanes = fine.halved[D - 1];
  const std::int64_t coarseElements = g.elements[0];
  std::ranges::fill(coarse.b, 0.0F);
  // Of a coarse plane the parts are summed in the order: its own fine plane, the one above, the one below. The last
  // goes by a spill, of which each thread has two, since a thread's first coarse plane gets that of the thread before.
  const auto spill = [&](int thread, std::int64_t coarsePlane, int c)
  { return fine.spill.data() + ((2 * thread + (coarsePlane & 1)) * D + c) * plane; };
  const auto addSpill = [&](int thread, std::int64_t coarsePlane)
  {
    for (int c = 0; c < D; ++c)
      kernels.add(
        plane, 1.0F, spill(thread, coarsePlane, c), coarse.b.data() + c * g.componentStride() + g.at(0, coarsePlane));
  };
  const auto firstCoarse = [&](int thread) { return fine.op->slab(thread)[0] / 2; };
  std::vector<std::vector<float>> rows(
    static_cast<std::size_t>(fine.op->threads()), std::vector<float>(static_cast<std::size_t>(g.rowLength())));

  fine.op->template sweep<float>(
    z, nullptr, false,
    [&](int thread, std::int64_t k, std::int64_t j, float* const* sums)
    {
      const Share up = shareOf(f, halvedPlanes, D - 1, k);
      const Share side = D == 3 ? shareOf(f, fine.halved[1], 1, j) : Share{};
      float* const row = rows[static_cast<std::size_t>(thread)].data();
      const bool between = up.weight < 1;
      if (between && j == 0)
        for (int c = 0; c < D; ++c)
          std::fill_n(spill(thread, up.low + 1, c), plane, 0.0F);
      for (int c = 0; c < D; ++c)
      {
        kernels.difference(f.rowLength(), b + c * f.componentStride() + f.at(j, k), sums[c], sums[c]);
        restrictRow(f, fine.halved[0], sums[c], coarseElements, row);
        for (int s = 0; s < (side.weight < 1 ? 2 : 1); ++s)
        {
          const std::int64_t to = side.low + s == g.rows() ? 0 : side.low + s;
          const float w = s == 0 ? side.weight : 1 - side.weight;
          kernels.add(g.rowLength(), w * up.weight, row,
            coarse.b.data() + c * g.componentStride() + g.at(D == 3 ? to : 0, up.low));
          if (between)
            kernels.add(g.rowLength(), w * (1 - up.weight), row,
              spill(thread, up.low + 1, c) + (D == 3 ? to : 0) * g.rowLength());
        }
      }
    },
    [&](int thread, std::int64_t k)
    {
      if (!halvedPlanes)
        return;
      // the coarse plane of this fine plane or of the one before is complete but for what came from below
      const auto [first, last] = fine.op->slab(thread);
      const bool complete = k % 2 != 0 || k + 1 == last;
      if (complete && k / 2 > first / 2)
        addSpill(thread, k / 2);
    });
  const int threads = fine.op->threads();
  if (halvedPlanes && f.parts.split()) // the last thread's, to the next rank
    f.parts.up(spill(threads - 1, f.last() / 2, 0), spill(threads, 0, 0), static_cast<std::size_t>(D * plane));
  for (int t = 0; t < threads && halvedPlanes; ++t)
  {
    if (t == 0 && f.first() == 0 && !f.periodic[D - 1])
      continue;
    const bool other = t == 0 && f.parts.split();
    const int before = other ? threads : (t + threads - 1) % threads;
    const std::int64_t end = !other ? fine.op->slab(before)[1] : f.first() == 0 ? f.planes() : f.first();
    if (end % 2 == 0) // ended between two coarse planes
      for (int c = 0; c < D; ++c)
        kernels.add(plane, 1.0F, spill(before, other ? 0 : end / 2, c),
          coarse.b.data() + c * g.componentStride() + g.at(0, firstCoarse(t)));
  }
  if (f.parts.split() && !g.parts.split())
    for (int c = 0; c < D; ++c)
      fine.below.gather(std::span(coarse.b).subspan(static_cast<std::size_t>(c * g.componentStride()),
                          static_cast<std::size_t>(g.componentStride())),
        g.planes());
  for (int c = 0; c < D; ++c)
    for (std::int64_t k = g.first(); k < g.last(); ++k)
      for (std::int64_t j = 0; j < g.rows(); ++j)
        g.forHeld(j, k, c,
          [&](std::int64_t from, std::int64_t count)
          { std::fill_n(coarse.b.data() + c * g.componentStride() + g.at(j, k) + from, count, 0.0F); });
}

template <int D>
void ElasticMultigrid<D>::addFrom(const Level& coarse, const Level& fine, float* z) const
{
  const ElasticGrid<D>& f = fine.op->grid();
  const ElasticGrid<D>& g = coarse.op->grid();
  const ElasticKernels& kernels = elasticKernels();
  const int threads = fine.op->threads();
  const std::int64_t plane = g.planeStride();
  std::vector<float> above; // the plane of all components above the rank's own ones
  if (g.parts.split() && fine.halved[D - 1])
  {
    std::vector<float> own;
    for (int c = 0; c < D; ++c)
      own.insert(
        own.end(), coarse.x.begin() + c * g.componentStride(), coarse.x.begin() + c * g.componentStride() + plane);
    above.resize(own.size());
    g.parts.down(own.data(), above.data(), own.size());
  }
#pragma omp parallel num_threads(threads) if (threads > 1)
  {
    std::vector<float> row(static_cast<std::size_t>(g.rowLength() + 1));
#pragma omp for schedule(static)
    for (std::int64_t k = f.first(); k < f.last(); ++k)
      for (std::int64_t j = 0; j < f.rows(); ++j)
      {
        const Share up = shareOf(f, fine.halved[D - 1], D - 1, k);
        const Share side = D == 3 ? shareOf(f, fine.halved[1], 1, j) : Share{};
        for (int c = 0; c < D; ++c)
        {
          std::ranges::fill(row, 0.0F);
          for (int u = 0; u < (up.weight < 1 ? 2 : 1); ++u)
            for (int s = 0; s < (side.weight < 1 ? 2 : 1); ++s)
            {
              const bool other = g.parts.split() && up.low + u == g.last();
              const std::int64_t kk = up.low + u == g.planes() ? 0 : up.low + u;
              const std::int64_t jj = D == 2 || side.low + s == g.rows() ? 0 : side.low + s;
              const float w = (u == 0 ? up.weight : 1 - up.weight) * (s == 0 ? side.weight : 1 - side.weight);
              kernels.add(g.rowLength(), w,
                other ? above.data() + c * plane + jj * g.rowLength()
                      : coarse.x.data() + c * g.componentStride() + g.at(jj, kk),
                row.data());
            }
          addRow(f, fine.halved[0], row.data(), g.elements[0], z + c * f.componentStride() + f.at(j, k));
        }
      }
  }
}

template <int D>
void ElasticMultigrid<D>::cycle(std::size_t index, const float* b, float* z) const
{
  const Level& level = *levels_[index];
  if (index + 1 == levels_.size())
  {
    const ElasticGrid<D>& g = level.op->grid();
    Eigen::VectorXd right(inverse_.rows());
    for (Eigen::Index m = 0; m < right.size(); ++m)
      right(m) = static_cast<double>(b[place_[static_cast<std::size_t>(m)]]);
    const Eigen::VectorXd solved = inverse_ * right;
    for (Eigen::Index m = 0; m < right.size(); ++m)
      z[place_[static_cast<std::size_t>(m)]] = static_cast<float>(solved(m));
    if (g.periodic[0])
      for (int c = 0; c < D; ++c)
        for (std::int64_t k = 0; k < g.planes(); ++k)
          for (std::int64_t j = 0; j < g.rows(); ++j)
          {
            float* const row = z + c * g.componentStride() + g.at(j, k);
            row[g.elements[0]] = row[0];
          }
    return;
  }
  const auto steps = level.factors.size();
  for (std::size_t i = 0; i < steps; ++i)
    smooth(level, level.factors[i], i == 0, b, z);
  const Level& coarse = *levels_[index + 1];
  restrictResidual(level, b, z, coarse);
  cycle(index + 1, coarse.b.data(), coarse.x.data());
  addFrom(coarse, level, z);
  for (std::size_t i = steps; i > 0; --i)
    smooth(level, level.factors[i - 1], false, b, z);
}

template <int D>
void ElasticMultigrid<D>::cycle(const float* b, float* z) const
{
  cycle(0, b, z);
}

template <int D>
std::size_t ElasticMultigrid<D>::bytes() const noexcept
{
  std::size_t total = sizeof(double) * static_cast<std::size_t>(inverse_.size());
  for (const auto& level : levels_)
    total += sizeof(float) *
        (level->b.size() + level->x.size() + level->spill.size() + (level->moduli ? level->moduli->size() : 0)) +
      (level->own ? level->own->bytes() : 0);
  return total;
}

template class ElasticMultigrid<2>;
template class ElasticMultigrid<3>;

} // namespace lamella::elasticity
