#include "mpm/PointMultigrid.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace lamella::mpm
{
namespace
{

/// Neighbours are strong whose block is this large beside the diagonal's.
constexpr double strong = 0.05;
/// Nodes of the level that is solved directly.
template <int Dim>
constexpr std::int64_t fewest = Dim == 3 ? 200 : 400;

template <int B>
std::vector<typename BlockRows<B>::Block> diagonalOf(const BlockRows<B>& m)
{
  using Block = typename BlockRows<B>::Block;
  std::vector<Block> d(static_cast<std::size_t>(m.rows()), Block::Zero());
  for (std::size_t i = 0; i < d.size(); ++i)
    for (auto e = static_cast<std::size_t>(m.begin[i]); e < static_cast<std::size_t>(m.begin[i + 1]); ++e)
      if (m.column[e] == static_cast<std::int32_t>(i))
        d[i] = m.value[e];
  return d;
}

/// Of what a block does not resist, motions that cost nothing, nothing is left.
template <int B>
typename BlockRows<B>::Block pseudoInverse(const typename BlockRows<B>::Block& block)
{
  using Square = Eigen::Matrix<double, B, B>;
  const Eigen::SelfAdjointEigenSolver<Square> solver{ Square(block) };
  const auto& values = solver.eigenvalues();
  const double least = 1e-8 * values[B - 1];
  Square sum = Square::Zero();
  for (int k = 0; k < B; ++k)
    if (values[k] > least && values[k] > 0)
      sum += solver.eigenvectors().col(k) * solver.eigenvectors().col(k).transpose() / values[k];
  return sum;
}

/// The largest eigenvalue of inverse × matrix, by powers of it, and a little more.
template <int B>
double largestEigenvalue(const BlockRows<B>& m, const std::vector<typename BlockRows<B>::Block>& inverse)
{
  constexpr int powers = 15;
  constexpr double safety = 1.1;
  const std::size_t n = static_cast<std::size_t>(m.rows()) * B;
  std::vector<double> x(n);
  std::vector<double> y(n);
  std::uint32_t seed = 12345;
  for (double& v : x)
  {
    seed = seed * 1664525U + 1013904223U;
    v = static_cast<double>(seed >> 8U) / (1U << 24U) - 0.5;
  }
  double value = 0;
  for (int k = 0; k < powers; ++k)
  {
    double size = 0;
    for (const double v : x)
      size += v * v;
    size = std::sqrt(size);
    if (!(size > 0))
      return 1;
    for (double& v : x)
      v /= size;
    m.template multiply<1>(x.data(), y.data());
    value = 0;
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < m.rows(); ++i)
    {
      using Values = Eigen::Matrix<double, B, 1>;
      const Values v = inverse[static_cast<std::size_t>(i)] * Eigen::Map<const Values>(y.data() + i * B);
      Eigen::Map<Values>{ x.data() + i* B } = v;
    }
    for (const double v : x)
      value += v * v;
    value = std::sqrt(value);
  }
  return safety * value;
}

/// By node its aggregate, −1 for nodes that nothing resists.
template <int B>
std::vector<std::int32_t> aggregates(
  const BlockRows<B>& m, const std::vector<typename BlockRows<B>::Block>& diagonal, std::int32_t& count)
{
  const auto n = static_cast<std::size_t>(m.rows());
  std::vector<double> size(n);
  for (std::size_t i = 0; i < n; ++i)
    size[i] = std::sqrt(diagonal[i].norm());
  std::vector<std::int32_t> of(n, -1);
  const auto forEachStrong = [&](std::size_t i, const auto& visit)
  {
    for (auto e = static_cast<std::size_t>(m.begin[i]); e < static_cast<std::size_t>(m.begin[i + 1]); ++e)
    {
      const auto j = static_cast<std::size_t>(m.column[e]);
      if (j == i)
        continue;
      const double strength = m.value[e].norm();
      if (strength > strong * size[i] * size[j])
        visit(j, strength / (size[i] * size[j]));
    }
  };
  count = 0;
  // where a node and all its neighbours are still free
  for (std::size_t i = 0; i < n; ++i)
  {
    bool free = of[i] < 0 && size[i] > 0;
    int neighbours = 0;
    if (free)
      forEachStrong(i,
        [&](std::size_t j, double)
        {
          free = free && of[j] < 0;
          ++neighbours;
        });
    if (!free || neighbours == 0)
      continue;
    of[i] = count;
    forEachStrong(i, [&](std::size_t j, double) { of[j] = count; });
    ++count;
  }
  // the others join the neighbour that they hang on most
  const std::vector<std::int32_t> first = of;
  for (std::size_t i = 0; i < n; ++i)
  {
    if (first[i] >= 0 || !(size[i] > 0))
      continue;
    double most = 0;
    forEachStrong(i,
      [&](std::size_t j, double strength)
      {
        if (first[j] >= 0 && strength > most)
        {
          most = strength;
          of[i] = first[j];
        }
      });
  }
  for (std::size_t i = 0; i < n; ++i)
  {
    if (of[i] >= 0 || !(size[i] > 0))
      continue;
    of[i] = count;
    forEachStrong(i,
      [&](std::size_t j, double)
      {
        if (of[j] < 0)
          of[j] = count;
      });
    ++count;
  }
  return of;
}

/// Displacements of a node from translations and rotations of a body: columns of the latter over `length`.
template <int Dim>
Eigen::Matrix<double, Dim, (Dim == 3 ? 6 : 3)> rigid(const std::array<double, Dim>& way, double length)
{
  Eigen::Matrix<double, Dim, (Dim == 3 ? 6 : 3)> r;
  r.setZero();
  for (int c = 0; c < Dim; ++c)
    r(c, c) = 1;
  if constexpr (Dim == 2)
  {
    r(0, 2) = -way[1] / length;
    r(1, 2) = way[0] / length;
  }
  else
  {
    // ω × way
    r(1, 3) = -way[2] / length;
    r(2, 3) = way[1] / length;
    r(0, 4) = way[2] / length;
    r(2, 4) = -way[0] / length;
    r(0, 5) = -way[1] / length;
    r(1, 5) = way[0] / length;
  }
  return r;
}

constexpr std::size_t often = 1000; // rows between two questions: in space some 50 ms

/// Of the aggregates, around a period by the shorter way.
template <int Dim>
NodePlaces<Dim> centresOf(const std::vector<std::int32_t>& of, std::size_t count, const NodePlaces<Dim>& places)
{
  NodePlaces<Dim> centres;
  centres.period = places.period;
  centres.at.assign(count, {});
  std::vector<std::int32_t> members(count, 0);
  std::vector<std::array<double, Dim>> first(count);
  for (std::size_t i = 0; i < of.size(); ++i)
    if (of[i] >= 0)
    {
      const auto a = static_cast<std::size_t>(of[i]);
      if (members[a]++ == 0)
        first[a] = places.at[i];
      const auto way = places.way(first[a], places.at[i]);
      for (std::size_t c = 0; c < Dim; ++c)
        centres.at[a][c] += way[c];
    }
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t c = 0; c < Dim; ++c)
      centres.at[a][c] = first[a][c] + centres.at[a][c] / members[a];
  return centres;
}

/// What the aggregates' motions are at their nodes. @param scale of the finest level's values
template <int Dim, int B, int Motions>
std::vector<typename BlockRows<B, Motions>::Block> motionsAt(const std::vector<std::int32_t>& of,
  const NodePlaces<Dim>& places, const NodePlaces<Dim>& centres, const std::vector<double>* scale, double length,
  double nextLength)
{
  using Wide = typename BlockRows<B, Motions>::Block;
  std::vector<Wide> motion(of.size(), Wide::Zero());
  for (std::size_t i = 0; i < of.size(); ++i)
  {
    if (of[i] < 0)
      continue;
    const auto r = rigid<Dim>(places.way(centres.at[static_cast<std::size_t>(of[i])], places.at[i]), nextLength);
    motion[i].template topRows<Dim>() = r;
    if constexpr (B == Dim)
      for (int c = 0; c < Dim; ++c)
      {
        const double s = (*scale)[i * Dim + static_cast<std::size_t>(c)];
        motion[i].row(c) *= s > 0 ? 1 / s : 0;
      }
    else
      for (int c = Dim; c < B; ++c)
        motion[i](c, c) = length / nextLength;
  }
  return motion;
}

/// up = (1 − ω D⁻¹ A) tentative. @param inverse D⁻¹
template <int B, int Motions>
void smoothMotions(const BlockRows<B>& m, const std::vector<typename BlockRows<B>::Block>& inverse, double omega,
  const std::vector<std::int32_t>& of, std::size_t count,
  const std::vector<typename BlockRows<B, Motions>::Block>& tentative, BlockRows<B, Motions>& up,
  const std::function<void()>& told)
{
  std::vector<std::int32_t> at(count, -1);
  for (std::size_t i = 0; i < of.size(); ++i)
  {
    if (i % often == 0)
      told();
    const auto begin = static_cast<std::size_t>(up.begin.back());
    const auto add = [&](std::int32_t a, const typename BlockRows<B, Motions>::Block& block)
    {
      auto& slot = at[static_cast<std::size_t>(a)];
      if (slot < static_cast<std::int32_t>(begin)) // of an earlier row
      {
        slot = static_cast<std::int32_t>(up.column.size());
        up.column.push_back(a);
        up.value.push_back(block);
      }
      else
        up.value[static_cast<std::size_t>(slot)] += block;
    };
    if (of[i] >= 0)
    {
      add(of[i], tentative[i]);
      for (auto e = static_cast<std::size_t>(m.begin[i]); e < static_cast<std::size_t>(m.begin[i + 1]); ++e)
      {
        const auto j = static_cast<std::size_t>(m.column[e]);
        if (of[j] >= 0)
          add(of[j], -omega * (inverse[i] * (m.value[e] * tentative[j])));
      }
    }
    up.begin.push_back(static_cast<std::int64_t>(up.column.size()));
  }
}

/// The upper triangle of a matrix, row by row and in no order.
template <int Motions>
struct UpperRows
{
  using Block = typename BlockRows<Motions>::Block;
  std::vector<std::vector<std::int32_t>> column;
  std::vector<std::vector<Block>> value;
};

/// Row i of A up. `at`: −1 for every aggregate, before and after.
template <int B, int Motions>
void productRow(const BlockRows<B>& m, const BlockRows<B, Motions>& up, std::size_t i, std::vector<std::int32_t>& at,
  std::vector<std::int32_t>& mine, std::vector<typename BlockRows<B, Motions>::Block>& row)
{
  mine.clear();
  row.clear();
  for (auto e = static_cast<std::size_t>(m.begin[i]); e < static_cast<std::size_t>(m.begin[i + 1]); ++e)
  {
    const auto j = static_cast<std::size_t>(m.column[e]);
    for (auto f = static_cast<std::size_t>(up.begin[j]); f < static_cast<std::size_t>(up.begin[j + 1]); ++f)
    {
      auto& slot = at[static_cast<std::size_t>(up.column[f])];
      if (slot < 0)
      {
        slot = static_cast<std::int32_t>(mine.size());
        mine.push_back(up.column[f]);
        row.push_back(BlockRows<B, Motions>::Block::Zero());
      }
      row[static_cast<std::size_t>(slot)].noalias() += m.value[e] * up.value[f];
    }
  }
  for (const std::int32_t a : mine)
    at[static_cast<std::size_t>(a)] = -1;
}

/// upᵀ A up
template <int B, int Motions>
UpperRows<Motions> galerkin(
  const BlockRows<B>& m, const BlockRows<B, Motions>& up, std::size_t count, const std::function<void()>& told)
{
  UpperRows<Motions> upper;
  upper.column.resize(count);
  upper.value.resize(count);
  std::vector<std::int32_t> mine;
  std::vector<typename BlockRows<B, Motions>::Block> row;
  std::vector<std::int32_t> at(count, -1);
  std::vector<std::int32_t> slotOf(count, -1);
  const auto n = static_cast<std::size_t>(m.rows());
  for (std::size_t i = 0; i < n; ++i)
  {
    if (i % often == 0)
      told();
    productRow(m, up, i, at, mine, row);
    for (auto f = static_cast<std::size_t>(up.begin[i]); f < static_cast<std::size_t>(up.begin[i + 1]); ++f)
    {
      const std::int32_t a = up.column[f];
      auto& columns = upper.column[static_cast<std::size_t>(a)];
      auto& values = upper.value[static_cast<std::size_t>(a)];
      for (std::size_t k = 0; k < columns.size(); ++k)
        slotOf[static_cast<std::size_t>(columns[k])] = static_cast<std::int32_t>(k);
      for (std::size_t k = 0; k < mine.size(); ++k)
      {
        if (mine[k] < a)
          continue;
        auto& slot = slotOf[static_cast<std::size_t>(mine[k])];
        if (slot < 0)
        {
          slot = static_cast<std::int32_t>(columns.size());
          columns.push_back(mine[k]);
          values.push_back(UpperRows<Motions>::Block::Zero());
        }
        values[static_cast<std::size_t>(slot)].noalias() += up.value[f].transpose() * row[k];
      }
      for (const std::int32_t c : columns)
        slotOf[static_cast<std::size_t>(c)] = -1;
    }
  }
  return upper;
}

/// The whole of a symmetric matrix.
template <int Motions>
void mirror(const UpperRows<Motions>& upper, BlockRows<Motions>& whole, const std::function<void()>& told)
{
  const auto& [column, value] = upper;
  std::vector<std::int64_t> begin(column.size() + 1, 0);
  for (std::size_t a = 0; a < column.size(); ++a)
    for (const std::int32_t c : column[a])
    {
      ++begin[a + 1];
      if (static_cast<std::size_t>(c) != a)
        ++begin[static_cast<std::size_t>(c) + 1];
    }
  for (std::size_t a = 1; a < begin.size(); ++a)
    begin[a] += begin[a - 1];
  whole.begin = begin;
  whole.column.resize(static_cast<std::size_t>(begin.back()));
  whole.value.resize(whole.column.size());
  told();
  const auto put = [&](std::size_t r, std::size_t s, const auto& block)
  {
    const auto to = static_cast<std::size_t>(begin[r]++);
    whole.column[to] = static_cast<std::int32_t>(s);
    whole.value[to] = block;
  };
  for (std::size_t a = 0; a < column.size(); ++a)
    for (std::size_t k = 0; k < column[a].size(); ++k)
    {
      const auto c = static_cast<std::size_t>(column[a][k]);
      if (c == a)
        put(a, a, 0.5 * (value[a][k] + value[a][k].transpose()));
      else
      {
        put(a, c, value[a][k]);
        put(c, a, value[a][k].transpose());
      }
    }
}

} // namespace

template <int Dim>
std::array<double, Dim> NodePlaces<Dim>::way(
  const std::array<double, Dim>& from, const std::array<double, Dim>& to) const
{
  std::array<double, Dim> w;
  for (std::size_t a = 0; a < Dim; ++a)
  {
    w[a] = to[a] - from[a];
    if (period[a] > 0)
      w[a] -= period[a] * std::round(w[a] / period[a]);
  }
  return w;
}

template struct NodePlaces<2>;
template struct NodePlaces<3>;

// The next level: aggregates, how their motions are spread, and the matrix between them.
template <int Dim>
template <int B>
NodePlaces<Dim> PointMultigrid<Dim>::coarsen(const BlockRows<B>& m, const std::vector<double>* scale,
  const NodePlaces<Dim>& places, double length, double nextLength, Level<B>& level, BlockRows<motions>& next,
  const std::function<void()>& told) const
{
  std::int32_t found = 0;
  const std::vector<std::int32_t> of = aggregates(m, diagonalOf(m), found);
  const auto count = static_cast<std::size_t>(found);
  told();
  const NodePlaces<Dim> centres = centresOf(of, count, places);
  const auto tentative = motionsAt<Dim, B, motions>(of, places, centres, scale, length, nextLength);
  smoothMotions<B, motions>(m, level.inverse, 4 / (3 * level.largest), of, count, tentative, level.up, told);
  level.down = level.up.transposed(found);
  mirror(galerkin(m, level.up, count, told), next, told);
  return centres;
}

template <int Dim>
PointMultigrid<Dim>::PointMultigrid(const BlockRows<Dim>& matrix, const std::vector<double>& scale,
  NodePlaces<Dim> places, const std::function<void()>& told)
  : finest_(matrix)
{
  const auto prepare = [](const auto& m, auto& level)
  {
    level.inverse = diagonalOf(m);
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < level.inverse.size(); ++i)
      level.inverse[i] = pseudoInverse<std::decay_t<decltype(level.inverse[0])>::RowsAtCompileTime>(level.inverse[i]);
    level.largest = largestEigenvalue(m, level.inverse);
  };
  constexpr double ratio = 3; // of lengths, about
  prepare(matrix, fine_);
  told();
  double length = ratio;
  CoarseLevel level;
  places = coarsen(matrix, &scale, places, 1, length, fine_, level.matrix, told);
  for (;;)
  {
    told();
    prepare(level.matrix, level);
    const std::int64_t n = level.matrix.rows();
    if (n <= fewest<Dim> || coarse_.size() > 20)
    {
      coarse_.push_back(std::move(level));
      break;
    }
    CoarseLevel next;
    places = coarsen<motions>(level.matrix, nullptr, places, length, ratio * length, level, next.matrix, told);
    length *= ratio;
    const bool less = next.matrix.rows() < n / 2;
    coarse_.push_back(std::move(level));
    level = std::move(next);
    if (!less)
    {
      prepare(level.matrix, level);
      coarse_.push_back(std::move(level));
      break;
    }
  }
  const BlockRows<motions>& last = coarse_.back().matrix;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(last.rows() * motions, last.rows() * motions);
  for (std::int64_t i = 0; i < last.rows(); ++i)
    for (auto e = static_cast<std::size_t>(last.begin[static_cast<std::size_t>(i)]);
         e < static_cast<std::size_t>(last.begin[static_cast<std::size_t>(i) + 1]); ++e)
      dense.template block<motions, motions>(i * motions, std::int64_t{ last.column[e] } * motions) = last.value[e];
  // what costs nothing is not loaded; the shift is far below the softest motion and far above round-off
  const double most = dense.rows() > 0 ? dense.diagonal().maxCoeff() : 0;
  for (Eigen::Index i = 0; i < dense.rows(); ++i)
    dense(i, i) += 1e-11 * most + 1e-11 * dense(i, i);
  factors_.compute(dense);
}

// Chebyshev's polynomial over the upper part of the spectrum.
template <int Dim>
template <int B, int Many>
void PointMultigrid<Dim>::smooth(
  const BlockRows<B>& m, const Level<B>& level, const double* b, double* x, bool fromZero, std::vector<double>& d)
{
  using Values = typename BlockRows<B>::template Values<Many>;
  constexpr int degree = 3;
  constexpr double part = 15; // of the spectrum: what hardly any point holds lies low
  const double high = level.largest;
  const double low = high / part;
  const double theta = (high + low) / 2;
  const double delta = (high - low) / 2;
  const std::int64_t n = m.rows();
  double rho = 0;
  for (int k = 0; k < degree; ++k)
  {
    const bool start = fromZero && k == 0;
    const double next = k == 0 ? delta / theta : 1 / (2 * theta / delta - rho);
    const double ofStep = k == 0 ? 0 : next * rho;
    const double ofResidual = k == 0 ? 1 / theta : 2 * next / delta;
    rho = next;
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i)
    {
      const std::int64_t at = i * B * Many;
      Values residual = Eigen::Map<const Values>(b + at);
      if (!start)
        residual -= m.template rowTimes<Many>(i, x);
      Eigen::Map<Values> step(d.data() + at);
      const Values full = level.inverse[static_cast<std::size_t>(i)] * residual;
      step = ofStep == 0 ? Values(ofResidual * full) : Values(ofStep * step + ofResidual * full);
    }
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n * B * Many; ++i)
      x[i] = start ? d[static_cast<std::size_t>(i)] : x[i] + d[static_cast<std::size_t>(i)];
  }
}

template <int Dim>
template <int B, int Many>
void PointMultigrid<Dim>::cycle(
  const BlockRows<B>& m, const Level<B>& level, std::size_t depth, const double* b, double* x) const
{
  using Values = typename BlockRows<B>::template Values<Many>;
  const auto size = static_cast<std::size_t>(m.rows()) * B * Many;
  if (B == motions && depth == coarse_.size())
  {
    using Many_ = Eigen::Matrix<double, Eigen::Dynamic, Many, (Many == 1 ? Eigen::ColMajor : Eigen::RowMajor)>;
    const Eigen::Map<const Many_> right(b, m.rows() * B, Many);
    Eigen::Map<Many_>(x, m.rows() * B, Many) = factors_.solve(right);
    return;
  }
  std::vector<double> r(size);
  std::vector<double> d(size);
  smooth<B, Many>(m, level, b, x, true, d);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < m.rows(); ++i)
    Eigen::Map<Values>(r.data() + i * B * Many) =
      Eigen::Map<const Values>(b + i * B * Many) - m.template rowTimes<Many>(i, x);
  const CoarseLevel& below = coarse_[depth];
  std::vector<double> cb(static_cast<std::size_t>(below.matrix.rows()) * motions * Many);
  std::vector<double> cx(cb.size());
  level.down.template multiply<Many>(r.data(), cb.data());
  cycle<motions, Many>(below.matrix, below, depth + 1, cb.data(), cx.data());
  level.up.template multiply<Many>(cx.data(), x, true);
  smooth<B, Many>(m, level, b, x, false, d);
}

template <int Dim>
template <int Many>
void PointMultigrid<Dim>::apply(const double* b, double* x) const
{
  cycle<Dim, Many>(finest_, fine_, 0, b, x);
}

template <int Dim>
std::size_t PointMultigrid<Dim>::bytes() const noexcept
{
  const auto of = [](const auto& level)
  { return level.inverse.size() * sizeof(level.inverse[0]) + level.up.bytes() + level.down.bytes(); };
  std::size_t sum = of(fine_) + static_cast<std::size_t>(factors_.rows() * factors_.cols()) * sizeof(double);
  for (const CoarseLevel& level : coarse_)
    sum += of(level) + level.matrix.bytes();
  return sum;
}

template class PointMultigrid<2>;
template class PointMultigrid<3>;
#define LAMELLA_APPLY(Dim)                                                                                             \
  template void PointMultigrid<Dim>::apply<1>(const double*, double*) const;                                           \
  template void PointMultigrid<Dim>::apply<2>(const double*, double*) const;                                           \
  template void PointMultigrid<Dim>::apply<3>(const double*, double*) const;                                           \
  template void PointMultigrid<Dim>::apply<6>(const double*, double*) const;
LAMELLA_APPLY(2)
LAMELLA_APPLY(3)

} // namespace lamella::mpm
