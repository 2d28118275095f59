#include "lbm/elements/ElementMultigrid.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace lamella::lbm
{
namespace
{

constexpr int smoothing = 3;        // degree of the polynomial before and after
constexpr double smoothedPart = 4;  // eigenvalues down to the largest over this are the smoother's
constexpr double spare = 1.1;       // on the largest eigenvalue, which is found from below
constexpr int eigenvalueSteps = 12; // of the power method
constexpr double weakAxis = 0.2;    // axes that couple less than this part of the strongest are left as they are
constexpr std::int64_t directNodes = 1500;
constexpr std::int64_t threadedNodes = 30000;
constexpr std::int64_t rowsTogether = 16; // of a colour, by one thread

template <class Real>
struct Apply;
template <>
struct Apply<float>
{
  static void run(const ElementRow<float>& row, float* const out[4], float* buffer)
  {
    elementKernels().applySingle(row, out, buffer);
  }
};
template <>
struct Apply<double>
{
  static void run(const ElementRow<double>& row, double* const out[4], double* buffer)
  {
    elementKernels().applyDouble(row, out, buffer);
  }
};

// Six rows of tensors, and pointers to them.
struct Tensors
{
  std::vector<float> values;
  float* rows[6];
  explicit Tensors(std::int64_t count)
    : values(static_cast<std::size_t>(6 * count))
  {
    for (int c = 0; c < 6; ++c)
      rows[c] = values.data() + c * count;
  }
};

template <class Real>
ElementRow<Real> rowOf(const ElementBox& box, const Real* u, std::int64_t y, std::int64_t z, const Tensors& tensors,
  const std::array<double, 3>& gradient)
{
  ElementRow<Real> row{};
  row.count = box.elements[0];
  for (int k = 0; k < 4; ++k)
    row.u[k] = u == nullptr ? nullptr : u + box.row(y + (k & 1), z + (k >> 1));
  for (int c = 0; c < 6; ++c)
    row.tensor[c] = tensors.rows[c];
  std::copy(gradient.begin(), gradient.end(), row.gradient);
  return row;
}

// What a node of a finer box takes of the coarse ones beside it along one axis.
struct Stencil1
{
  std::int64_t low = 0; ///< coarse node
  float weight = 1;     ///< of that one; the rest is of the next
};

Stencil1 along(const std::vector<float>& width, bool halved, std::int64_t node)
{
  if (!halved)
    return { node, 1.0F };
  const std::int64_t pairs = node / 2;
  if (node % 2 == 0)
    return { pairs, 1.0F };
  if (static_cast<std::size_t>(node) == width.size()) // the last node of an odd number of elements
    return { pairs + 1, 1.0F };
  const float before = width[static_cast<std::size_t>(node - 1)];
  const float after = width[static_cast<std::size_t>(node)];
  return { pairs, after / (before + after) };
}

} // namespace

namespace
{

// f(low copy, high copy) of the two outer planes of nodes across an axis
template <class Real, class F>
void forOuter(const ElementBox& box, int axis, std::span<Real> values, F&& f)
{
  const auto stride = [&](int of) { return of == 0 ? 1 : of == 1 ? box.nodes(0) : box.nodes(0) * box.nodes(1); };
  const int b = axis == 0 ? 1 : 0;
  const int c = axis == 2 ? 1 : 2;
  const std::int64_t last = box.elements[static_cast<std::size_t>(axis)] * stride(axis);
  for (std::int64_t k = 0; k < box.nodes(c); ++k)
    for (std::int64_t j = 0; j < box.nodes(b); ++j)
    {
      const std::int64_t low = j * stride(b) + k * stride(c);
      f(values[static_cast<std::size_t>(low)], values[static_cast<std::size_t>(low + last)]);
    }
}

} // namespace

template <class Real>
void ElementBox::addCopies(std::span<Real> values) const
{
  for (int a = 0; a < (parts.split() ? 2 : 3); ++a)
    if (periodic[static_cast<std::size_t>(a)])
      forOuter(*this, a, values, [](Real& low, Real& high) { low = high = low + high; });
  if (!parts.split())
    return;
  const auto plane = static_cast<std::size_t>(nodes(0) * nodes(1));
  Real* const low = values.data();
  Real* const high = values.data() + values.size() - plane;
  std::vector<Real> below(plane, Real{ 0 }); // stays 0 beyond the box
  std::vector<Real> above(plane, Real{ 0 });
  parts.up(high, below.data(), plane);
  parts.down(low, above.data(), plane);
  for (std::size_t i = 0; i < plane; ++i)
  {
    low[i] += below[i];
    high[i] += above[i];
  }
}

template <class Real>
void ElementBox::hold(std::span<Real> values) const
{
  if (fixed >= 0)
    forOuter(
      *this, fixed, values,
      [lowest = fixed < 2 || first() == 0, highest = fixed < 2 || isLast()](Real& low, Real& high)
      {
        low = lowest ? Real{ 0 } : low;
        high = highest ? Real{ 0 } : high;
      });
}
template void ElementBox::addCopies(std::span<float>) const;
template void ElementBox::addCopies(std::span<double>) const;
template void ElementBox::hold(std::span<float>) const;
template void ElementBox::hold(std::span<double>) const;

ElementOperator::ElementOperator(const ElementBox& box, TensorRows tensors, int threads)
  : box_(box)
  , tensors_(std::move(tensors))
  , threads_(box.nodes() < threadedNodes ? 1 : threads)
{
}

// f(y, z, tensors of the row, buffer)
template <class Real, class F>
void ElementOperator::forRows(const RowRange& rows, F&& f) const
{
  const auto& e = box_.elements;
  const std::int64_t high = rows[1][1];
  // planes of few rows go together: what they share stays in the cache
  const std::int64_t together = std::max<std::int64_t>(1, rowsTogether / e[1]);
  const std::int64_t groups = (high - rows[1][0] + together - 1) / together;
#pragma omp parallel num_threads(threads_) if (threads_ > 1)
  {
    Tensors tensors(e[0]);
    std::vector<Real> buffer(static_cast<std::size_t>(8 * (e[0] + 1)));
    for (std::int64_t colour = 0; colour < 2; ++colour)
    {
#pragma omp for schedule(static)
      for (std::int64_t half = 0; half < (groups + 1 - colour) / 2; ++half)
      {
        const std::int64_t from = rows[1][0] + together * (2 * half + colour);
        for (std::int64_t z = from; z < std::min(from + together, high); ++z)
          for (std::int64_t y = rows[0][0]; y < rows[0][1]; ++y)
          {
            tensors_(y, z, tensors.rows);
            f(y, z, tensors, buffer.data());
          }
      }
    }
  }
}

template <class Real>
void ElementOperator::apply(std::span<const Real> u, std::span<Real> out, const std::array<double, 3>& gradient) const
{
  std::ranges::fill(out, Real{ 0 });
  forRows<Real>(
    [&](std::int64_t y, std::int64_t z, const Tensors& tensors, Real* buffer)
    {
      const ElementRow<Real> row = rowOf(box_, u.data(), y, z, tensors, gradient);
      Real* rows[4];
      for (int k = 0; k < 4; ++k)
        rows[k] = out.data() + box_.row(y + (k & 1), z + (k >> 1));
      Apply<Real>::run(row, rows, buffer);
    });
  box_.close(out);
}
template void ElementOperator::apply(std::span<const float>, std::span<float>, const std::array<double, 3>&) const;
template void ElementOperator::apply(std::span<const double>, std::span<double>, const std::array<double, 3>&) const;

void ElementOperator::diagonal(std::span<float> out) const
{
  std::ranges::fill(out, 0.0F);
  forRows<float>(
    [&](std::int64_t y, std::int64_t z, const Tensors& tensors, float*)
    {
      const ElementRow<float> row = rowOf<float>(box_, nullptr, y, z, tensors, { 0, 0, 0 });
      float* rows[4];
      for (int k = 0; k < 4; ++k)
        rows[k] = out.data() + box_.row(y + (k & 1), z + (k >> 1));
      elementKernels().diagonal(row, rows);
    });
  box_.addCopies(out);
}

void ElementOperator::forFluxes(
  std::span<const double> u, const std::array<double, 3>& gradient, const RowRange& rows, const FluxRow& f) const
{
  const std::int64_t n = box_.elements[0];
  forRows<double>(rows,
    [&](std::int64_t y, std::int64_t z, const Tensors& tensors, double* buffer)
    {
      double* const flux[3] = { buffer, buffer + n, buffer + 2 * n };
      double energy = 0;
      elementKernels().fluxes(rowOf(box_, u.data(), y, z, tensors, gradient), flux, &energy);
      f(y, z, flux, energy);
    });
}

ElementMultigrid::ElementMultigrid(const ElementOperator& finest)
{
  addLevel(finest, finest.box());
  for (int a = 0; a < 3; ++a)
    levels_[0]->width[static_cast<std::size_t>(a)].assign(
      static_cast<std::size_t>(finest.box().elements[static_cast<std::size_t>(a)]), 1.0F);
  while (levels_.back()->op.box().wholeNodes() > directNodes && coarsen())
  {
  }
  factorize();
}

void ElementMultigrid::addLevel(const ElementOperator& op, const ElementBox& made)
{
  auto level = std::make_unique<Level>(op, made);
  if (level->gathered())
    level->madeOffset = op.box().row(0, made.first());
  const auto nodes = static_cast<std::size_t>(op.box().nodes());
  level->inverse.resize(nodes);
  op.diagonal(level->inverse);
  for (float& value : level->inverse)
    value = value > 0 ? 1 / value : 0.0F;
  op.box().hold(std::span<float>(level->inverse));
  level->d.resize(nodes);
  level->t.resize(nodes);
  if (!levels_.empty())
  {
    level->b.resize(nodes);
    level->x.resize(nodes);
  }
  findLargest(*level);
  levels_.push_back(std::move(level));
}

namespace
{

// A start without any pattern, the same everywhere.
float scattered(std::size_t i)
{
  std::uint64_t h = (i + 1) * 0x9e3779b97f4a7c15ULL;
  h ^= h >> 29;
  h *= 0xbf58476d1ce4e5b9ULL;
  return static_cast<float>(static_cast<double>(h >> 11) * 0x1p-53 - 0.5);
}

// f(node row's first place) for the rows of a box, over threads.
template <class F>
void forNodeRows(const ElementBox& box, int threads, F&& f)
{
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t i = 0; i < box.nodes(1) * box.nodes(2); ++i)
    f(i % box.nodes(1), i / box.nodes(1));
}

} // namespace

void ElementMultigrid::findLargest(Level& level) const
{
  const ElementBox& box = level.op.box();
  const std::size_t n = level.d.size();
  const std::size_t before = static_cast<std::size_t>(box.row(0, box.first())); // those of the ranks before
  for (std::size_t i = 0; i < n; ++i)
    level.d[i] = level.inverse[i] > 0 ? scattered(before + i) : 0.0F;
  double largest = 0;
  for (int step = 0; step < eigenvalueSteps; ++step)
  {
    // copies of a node differ in the first start: closed, they are one
    level.op.apply<float>(level.d, level.t);
    const double from = box.dot(level.d, level.d, level.op.threads());
    for (std::size_t i = 0; i < n; ++i)
      level.d[i] = level.inverse[i] * level.t[i];
    const double to = box.dot(level.d, level.d, level.op.threads());
    if (!(to > 0))
      break;
    if (step > 0)
      largest = std::max(largest, std::sqrt(to / from));
    const auto unit = static_cast<float>(1 / std::sqrt(to));
    for (float& value : level.d)
      value *= unit;
  }
  level.largest = static_cast<float>(spare * (largest > 0 ? largest : 1));
}

bool ElementMultigrid::coarsen()
{
  Level& fine = *levels_.back();
  const ElementBox& from = fine.op.box();
  const auto& e = from.elements;
  std::array<double, 3> strength{ 0, 0, 0 };
  {
    Tensors tensors(e[0]);
    for (std::int64_t z = 0; z < e[2]; ++z)
      for (std::int64_t y = 0; y < e[1]; ++y)
      {
        fine.op.tensorRow(y, z, tensors.rows);
        for (std::size_t a = 0; a < 3; ++a)
          for (std::int64_t x = 0; x < e[0]; ++x)
            strength[a] += tensors.rows[a][x];
      }
  }
  from.parts.sum(strength);
  double strongest = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (from.whole(static_cast<int>(a)) > 1)
      strongest = std::max(strongest, strength[a]);
  ElementBox made = from; // of this rank's part
  for (std::size_t a = 0; a < 3; ++a)
  {
    fine.halved[a] = from.whole(static_cast<int>(a)) > 1 && strength[a] >= weakAxis * strongest;
    if (fine.halved[a])
      made.elements[a] = (e[a] + 1) / 2;
  }
  if (std::ranges::none_of(fine.halved, std::identity{}))
    return false;
  if (fine.halved[2])
    made.parts = from.parts.halved((from.whole(2) + 1) / 2);
  ElementBox to = made;
  if (made.parts.split() && (made.wholeNodes() <= PlaneParts::fewNodes || !made.parts.beginEven()))
  {
    to.elements[2] = made.whole(2);
    to.parts = {};
  }

  std::array<std::vector<float>, 3> width;
  std::array<std::vector<float>, 3> part; // of a fine element in its coarse one
  for (std::size_t a = 0; a < 3; ++a)
  {
    const std::vector<float>& w = fine.width[a];
    part[a].assign(w.size(), 1.0F);
    if (!fine.halved[a])
    {
      width[a] = w;
      continue;
    }
    for (std::size_t i = 0; i < w.size(); i += 2)
    {
      width[a].push_back(w[i] + (i + 1 < w.size() ? w[i + 1] : 0.0F));
      for (std::size_t k = i; k < std::min(i + 2, w.size()); ++k)
        part[a][k] = w[k] / width[a].back();
    }
  }
  std::array<std::vector<float>, 6> tensor;
  for (auto& values : tensor)
    values.assign(static_cast<std::size_t>(to.count()), 0.0F);
  constexpr std::array<std::array<std::size_t, 2>, 6> axes{ { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 },
    { 1, 2 } } };
  Tensors rows(e[0]);
  for (std::int64_t z = 0; z < e[2]; ++z)
    for (std::int64_t y = 0; y < e[1]; ++y)
    {
      fine.op.tensorRow(y, z, rows.rows);
      const std::int64_t cy = fine.halved[1] ? y / 2 : y;
      const std::int64_t cz = fine.halved[2] ? z / 2 : z;
      const std::int64_t first = to.elements[0] * (cy + to.elements[1] * (cz + made.first() - to.first()));
      for (std::size_t c = 0; c < 6; ++c)
        for (std::int64_t x = 0; x < e[0]; ++x)
        {
          const std::array<float, 3> share{ part[0][static_cast<std::size_t>(x)], part[1][static_cast<std::size_t>(y)],
            part[2][static_cast<std::size_t>(z)] };
          tensor[c][static_cast<std::size_t>(first + (fine.halved[0] ? x / 2 : x))] +=
            share[axes[c][0]] * share[axes[c][1]] * rows.rows[c][x];
        }
    }
  if (made.parts.split() && !to.parts.split())
  {
    for (auto& values : tensor)
      made.parts.gather(values, to.elements[2]);
    std::vector<float> all(static_cast<std::size_t>(to.elements[2]));
    std::ranges::copy(width[2], all.begin() + made.first());
    made.parts.gather(all, to.elements[2]);
    width[2] = std::move(all);
  }
  // The level owns its tensors; the operator reads them there, and a level never moves.
  auto kept = std::make_shared<std::array<std::vector<float>, 6>>(std::move(tensor));
  const TensorRows read = [kept, nx = to.elements[0], ny = to.elements[1]](
                            std::int64_t y, std::int64_t z, float* const out[6])
  {
    for (std::size_t c = 0; c < 6; ++c)
      std::copy_n((*kept)[c].begin() + static_cast<std::ptrdiff_t>(nx * (y + ny * z)), nx, out[c]);
  };
  addLevel(ElementOperator(to, read, fine.op.threads()), made);
  levels_.back()->width = std::move(width);
  levels_.back()->tensorBytes = 24 * static_cast<std::size_t>(to.count());
  return true;
}

void ElementMultigrid::factorize()
{
  const Level& level = *levels_.back();
  const ElementBox& box = level.op.box();
  unknown_.assign(static_cast<std::size_t>(box.nodes()), -1);
  std::int64_t count = 0;
  for (std::int64_t z = 0; z < box.owned(2); ++z)
    for (std::int64_t y = 0; y < box.owned(1); ++y)
      for (std::int64_t x = 0; x < box.owned(0); ++x)
        if (level.inverse[static_cast<std::size_t>(box.row(y, z) + x)] > 0)
          unknown_[static_cast<std::size_t>(box.row(y, z) + x)] = count++;
  const auto wrap = [&](std::int64_t i, int axis) { return i == box.owned(axis) ? 0 : i; };
  for (std::int64_t z = 0; z < box.nodes(2); ++z)
    for (std::int64_t y = 0; y < box.nodes(1); ++y)
      for (std::int64_t x = 0; x < box.nodes(0); ++x)
        unknown_[static_cast<std::size_t>(box.row(y, z) + x)] =
          unknown_[static_cast<std::size_t>(box.row(wrap(y, 1), wrap(z, 2)) + wrap(x, 0))];

  constexpr double tiny = 1e-4; // added to the diagonal, relative: a constant may be free
  std::vector<Eigen::Triplet<double>> entries;
  Tensors tensors(box.elements[0]);
  for (std::int64_t z = 0; z < box.elements[2]; ++z)
    for (std::int64_t y = 0; y < box.elements[1]; ++y)
    {
      level.op.tensorRow(y, z, tensors.rows);
      for (std::int64_t x = 0; x < box.elements[0]; ++x)
      {
        // one element: its products with the eight hat functions
        std::array<float, 6> own{};
        for (std::size_t c = 0; c < 6; ++c)
          own[c] = tensors.rows[c][x];
        for (int p = 0; p < 8; ++p)
        {
          std::array<double, 8> u{};
          std::array<double, 8> q{};
          std::array<double, 16> buffer{};
          u[static_cast<std::size_t>(p)] = 1;
          ElementRow<double> row{};
          row.count = 1;
          double* out[4];
          for (std::size_t k = 0; k < 4; ++k)
          {
            row.u[k] = u.data() + 2 * k;
            out[k] = q.data() + 2 * k;
          }
          for (std::size_t c = 0; c < 6; ++c)
            row.tensor[c] = &own[c];
          elementKernels().applyDouble(row, out, buffer.data());
          const auto node = [&](int corner) {
            return unknown_[static_cast<std::size_t>(
              box.row(y + (corner >> 1 & 1), z + (corner >> 2)) + x + (corner & 1))];
          };
          for (int k = 0; k < 8; ++k)
            if (node(p) >= 0 && node(k) >= 0)
              entries.emplace_back(static_cast<int>(node(p)), static_cast<int>(node(k)),
                q[static_cast<std::size_t>(k)] * (p == k ? 1 + tiny : 1));
        }
      }
    }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  direct_.compute(matrix);
}

// @param residual whether b is to end as what is left
void ElementMultigrid::smooth(Level& level, std::span<float> b, std::span<float> x, bool residual) const
{
  const float high = level.largest;
  const float low = high / static_cast<float>(smoothedPart);
  const float middle = 0.5F * (high + low);
  const float spread = 0.5F * (high - low);
  const float sigma = middle / spread;
  float rho = 1 / sigma;
  const auto n = static_cast<std::int64_t>(b.size());
  const int threads = level.op.threads();
  for (int step = 0; step < smoothing; ++step)
  {
    const float next = step == 0 ? rho : 1 / (2 * sigma - rho);
    const float old = step == 0 ? 0.0F : next * rho;
    const float fresh = step == 0 ? 1 / middle : 2 * next / spread;
    rho = next;
#pragma omp parallel for simd num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t i = 0; i < n; ++i)
    {
      const auto k = static_cast<std::size_t>(i);
      level.d[k] = old * level.d[k] + fresh * level.inverse[k] * b[k];
      x[k] += level.d[k];
    }
    if (step == smoothing - 1 && !residual)
      return;
    level.op.apply<float>(level.d, level.t);
#pragma omp parallel for simd num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t i = 0; i < n; ++i)
      b[static_cast<std::size_t>(i)] -= level.t[static_cast<std::size_t>(i)];
  }
}

void ElementMultigrid::restrictTo(const Level& fine, std::span<float> b, Level& coarse) const
{
  const ElementBox& f = fine.op.box();
  const ElementBox& c = coarse.made;
  // by coarse node: the finer ones that take something of it
  std::array<std::vector<std::vector<std::pair<std::int64_t, float>>>, 3> from;
  for (int a = 0; a < 3; ++a)
  {
    const auto axis = static_cast<std::size_t>(a);
    from[axis].resize(static_cast<std::size_t>(c.nodes(a)));
    for (std::int64_t i = 0; i < f.owned(a); ++i) // of two copies the first alone
    {
      const Stencil1 s = along(fine.width[axis], fine.halved[axis], i);
      from[axis][static_cast<std::size_t>(s.low)].emplace_back(i, s.weight);
      if (s.weight < 1)
        from[axis][static_cast<std::size_t>(s.low + 1)].emplace_back(i, 1 - s.weight);
    }
  }
  forNodeRows(c, fine.op.threads(),
    [&](std::int64_t cy, std::int64_t cz)
    {
      std::vector<float> sum(static_cast<std::size_t>(f.nodes(0)), 0.0F);
      for (const auto& [z, wz] : from[2][static_cast<std::size_t>(cz)])
        for (const auto& [y, wy] : from[1][static_cast<std::size_t>(cy)])
        {
          const float* row = b.data() + f.row(y, z);
          const float w = wy * wz;
#pragma omp simd
          for (std::int64_t x = 0; x < f.nodes(0); ++x)
            sum[static_cast<std::size_t>(x)] += w * row[x];
        }
      float* out = coarse.b.data() + coarse.madeOffset + c.row(cy, cz);
      for (std::int64_t x = 0; x < c.nodes(0); ++x)
      {
        out[x] = 0;
        for (const auto& [i, w] : from[0][static_cast<std::size_t>(x)])
          out[x] += w * sum[static_cast<std::size_t>(i)];
      }
    });
  c.close(std::span<float>(coarse.b).subspan(
    static_cast<std::size_t>(coarse.madeOffset), static_cast<std::size_t>(c.nodes())));
  if (coarse.gathered())
    c.parts.gather(coarse.b, coarse.op.box().nodes(2));
}

// Adds the coarse correction, and takes its product off the residual b.
void ElementMultigrid::addFrom(const Level& coarse, Level& fine, std::span<float> b, std::span<float> x) const
{
  const ElementBox& f = fine.op.box();
  const ElementBox& c = coarse.made;
  forNodeRows(f, fine.op.threads(),
    [&](std::int64_t y, std::int64_t z)
    {
      const Stencil1 sy = along(fine.width[1], fine.halved[1], y);
      const Stencil1 sz = along(fine.width[2], fine.halved[2], z);
      std::vector<float> sum(static_cast<std::size_t>(c.nodes(0)), 0.0F);
      for (const int k : { 0, 1 })
        for (const int j : { 0, 1 })
        {
          const float w = (j == 0 ? sy.weight : 1 - sy.weight) * (k == 0 ? sz.weight : 1 - sz.weight);
          if (w == 0)
            continue;
          const float* row = coarse.x.data() + coarse.madeOffset + c.row(sy.low + j, sz.low + k);
#pragma omp simd
          for (std::int64_t i = 0; i < c.nodes(0); ++i)
            sum[static_cast<std::size_t>(i)] += w * row[i];
        }
      float* out = fine.d.data() + f.row(y, z);
      for (std::int64_t i = 0; i < f.nodes(0); ++i)
      {
        const Stencil1 s = along(fine.width[0], fine.halved[0], i);
        out[i] = s.weight * sum[static_cast<std::size_t>(s.low)];
        if (s.weight < 1)
          out[i] += (1 - s.weight) * sum[static_cast<std::size_t>(s.low + 1)];
        if (!(fine.inverse[static_cast<std::size_t>(f.row(y, z) + i)] > 0))
          out[i] = 0; // held, or in a void
      }
    });
  fine.op.apply<float>(fine.d, fine.t);
  const auto n = static_cast<std::int64_t>(x.size());
  const int threads = fine.op.threads();
#pragma omp parallel for simd num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t i = 0; i < n; ++i)
  {
    x[static_cast<std::size_t>(i)] += fine.d[static_cast<std::size_t>(i)];
    b[static_cast<std::size_t>(i)] -= fine.t[static_cast<std::size_t>(i)];
  }
}

void ElementMultigrid::cycle(std::size_t index, std::span<float> b, std::span<float> x)
{
  Level& level = *levels_[index];
  if (index + 1 == levels_.size())
  {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(direct_.rows());
    for (std::size_t i = 0; i < b.size(); ++i)
      if (unknown_[i] >= 0)
        right(unknown_[i]) = static_cast<double>(b[i]); // both copies hold the same
    const Eigen::VectorXd solved = direct_.solve(right);
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = unknown_[i] >= 0 ? static_cast<float>(solved(unknown_[i])) : 0.0F;
    return;
  }
  std::ranges::fill(x, 0.0F);
  smooth(level, b, x, true);
  Level& coarse = *levels_[index + 1];
  restrictTo(level, b, coarse);
  cycle(index + 1, coarse.b, coarse.x);
  addFrom(coarse, level, b, x);
  smooth(level, b, x, false);
}

void ElementMultigrid::cycle(std::span<float> b, std::span<float> x)
{
  cycle(0, b, x);
}

std::size_t ElementMultigrid::bytes() const noexcept
{
  std::size_t total = 0;
  for (const auto& level : levels_)
    total += level->tensorBytes +
      4 * (level->inverse.size() + level->b.size() + level->x.size() + level->d.size() + level->t.size());
  return total;
}

} // namespace lamella::lbm
