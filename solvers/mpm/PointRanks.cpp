#include "mpm/PointRanks.h"

#include "core/Error.h"
#include "core/Mix.h"
#include "core/Together.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

namespace lamella::mpm
{
namespace
{

constexpr double uneven = 0.95;

/// Points of the busiest rank.
double busiest(const std::vector<double>& counts, const std::vector<int>& firsts)
{
  double most = 0;
  for (std::size_t r = 0; r + 1 < firsts.size(); ++r)
    most = std::max(most, std::accumulate(counts.begin() + firsts[r], counts.begin() + firsts[r + 1], 0.0));
  return most;
}

/// Column by column, then phase and number: all of a point as doubles, which hold them exactly.
template <int Dim>
void pack(const MaterialPoints<Dim>& points, std::size_t p, double* values)
{
  for (int c = 0; c < points.columns(); ++c)
    *values++ = points.column(c)[p];
  *values++ = points.phase()[p];
  *values = points.id()[p];
}

template <int Dim>
void unpack(MaterialPoints<Dim>& points, std::size_t p, const double* values)
{
  for (int c = 0; c < points.columns(); ++c)
    points.column(c)[p] = *values++;
  points.phase()[p] = static_cast<std::uint8_t>(*values++);
  points.id()[p] = static_cast<std::uint32_t>(*values);
}

/// How many values come from each rank, and where they begin.
struct Coming
{
  std::vector<int> counts;
  std::vector<int> begins;
  std::size_t all = 0;
};

/// @param sent how many go to each rank
Coming coming(const Communicator& comm, const std::vector<int>& sent)
{
  Coming c{ std::vector<int>(sent.size()), std::vector<int>(sent.size()) };
  MPI_Alltoall(sent.data(), 1, MPI_INT, c.counts.data(), 1, MPI_INT, comm.handle());
  std::partial_sum(c.counts.begin(), c.counts.end() - 1, c.begins.begin() + 1);
  c.all = static_cast<std::size_t>(c.begins.back() + c.counts.back());
  return c;
}

template <int Dim>
int valuesOf(const MaterialPoints<Dim>& points)
{
  return points.columns() + 2;
}

} // namespace

template <int Dim>
void PointRanks<Dim>::chooseAxis(const BackgroundGrid<Dim>& grid)
{
  if (!comm_.parallel())
    return;
  axis_ = Dim - 1; // the slowest in memory: exchanged rows are in one piece
  for (int a = Dim - 2; a >= 0; --a)
    if (grid.axis(a).cells > grid.axis(axis_).cells)
      axis_ = a;
  const int rows = grid.axis(axis_).cells + 1;
  if (rows < leastRows * comm_.size())
    throw ParameterError(fmt::format("{} ranks for {} rows of cells", comm_.size(), rows),
      fmt::format("take at most {} ranks, or a finer grid", std::max(1, rows / leastRows)));
  rows_.emplace(comm_, axis_);
}

template <int Dim>
std::vector<int> PointRanks<Dim>::rowsOf(const MaterialPoints<Dim>& points, const GridAxis& g) const
{
  std::vector<int> rows(points.count());
  const auto x = points.column(axis_);
  for (std::size_t p = 0; p < rows.size(); ++p)
  {
    // what is outside goes to an end, where it is refused
    const double row = std::floor(g.coordinate(x[p]) - 0.5) + 1;
    rows[p] = row >= 0 ? static_cast<int>(std::fmin(row, g.cells)) : 0;
  }
  return rows;
}

template <int Dim>
std::vector<int> PointRanks<Dim>::balanced(const std::vector<double>& counts) const
{
  std::vector<double> before(counts.size() + 1);
  std::partial_sum(counts.begin(), counts.end(), before.begin() + 1);
  const int ranks = comm_.size();
  const int rows = static_cast<int>(counts.size());
  std::vector<int> firsts(static_cast<std::size_t>(ranks) + 1);
  firsts.back() = rows;
  for (int r = 1; r < ranks; ++r)
  {
    const double wanted = before.back() * r / ranks;
    auto row = static_cast<int>(std::lower_bound(before.begin(), before.end(), wanted) - before.begin());
    if (row > 0 && wanted - before[static_cast<std::size_t>(row) - 1] < before[static_cast<std::size_t>(row)] - wanted)
      --row;
    firsts[static_cast<std::size_t>(r)] =
      std::clamp(row, firsts[static_cast<std::size_t>(r) - 1] + leastRows, rows - leastRows * (ranks - r));
  }
  return firsts;
}

template <int Dim>
void PointRanks<Dim>::distribute(MaterialPoints<Dim>& points, const BackgroundGrid<Dim>& grid)
{
  if (!comm_.parallel())
    return;
  const GridAxis& g = grid.axis(axis_);
  if (g.cells + 1 < leastRows * comm_.size())
    throw DivergenceError(
      fmt::format("{} rows of cells are left along axis {} for {} ranks", g.cells + 1, axis_, comm_.size()),
      "take fewer ranks, or a finer grid");
  const std::vector<int> rows = rowsOf(points, g);
  std::vector<double> counts(static_cast<std::size_t>(g.cells) + 1);
  for (const int row : rows)
    ++counts[static_cast<std::size_t>(row)];
  comm_.sum(counts);
  std::vector<int> better = balanced(counts);
  if (firsts_.empty() || firsts_.back() != better.back() || busiest(counts, better) < uneven * busiest(counts, firsts_))
    firsts_ = std::move(better);
  migrate(points, rows);
}

template <int Dim>
void PointRanks<Dim>::migrate(MaterialPoints<Dim>& points, const std::vector<int>& rows) const
{
  const auto ranks = static_cast<std::size_t>(comm_.size());
  const auto self = static_cast<std::size_t>(comm_.rank());
  std::vector<std::vector<std::size_t>> to(ranks);
  for (std::size_t p = 0; p < rows.size(); ++p)
    to[static_cast<std::size_t>(std::upper_bound(firsts_.begin(), firsts_.end() - 1, rows[p]) - firsts_.begin() - 1)]
      .push_back(p);
  if (comm_.any(to[self].size() != points.count()))
    points = send(points, to);
}

template <int Dim>
MaterialPoints<Dim> PointRanks<Dim>::byNumber(
  const MaterialPoints<Dim>& points, std::span<const std::int64_t> firsts) const
{
  std::vector<std::vector<std::size_t>> to(static_cast<std::size_t>(comm_.size()));
  for (std::size_t p = 0; p < points.count(); ++p)
    to[static_cast<std::size_t>(
         std::upper_bound(firsts.begin(), firsts.end() - 1, std::int64_t{ points.id()[p] }) - firsts.begin() - 1)]
      .push_back(p);
  return send(points, to);
}

template <int Dim>
MaterialPoints<Dim> PointRanks<Dim>::send(
  const MaterialPoints<Dim>& points, const std::vector<std::vector<std::size_t>>& to) const
{
  const auto ranks = static_cast<std::size_t>(comm_.size());
  const auto self = static_cast<std::size_t>(comm_.rank());
  const auto values = static_cast<std::size_t>(valuesOf(points));
  std::vector<int> sent(ranks);
  std::vector<int> sentFrom(ranks);
  std::vector<double> leaving;
  for (std::size_t r = 0; r < ranks; ++r)
  {
    sentFrom[r] = static_cast<int>(leaving.size() / values);
    if (r == self)
      continue;
    sent[r] = static_cast<int>(to[r].size());
    for (const std::size_t p : to[r])
    {
      leaving.resize(leaving.size() + values);
      pack(points, p, leaving.data() + leaving.size() - values);
    }
  }
  const Coming got = coming(comm_, sent);
  const std::size_t come = got.all;
  std::vector<double> arrived(come * values);
  MPI_Datatype point = MPI_DATATYPE_NULL; // counts in points: many doubles overflow an int
  MPI_Type_contiguous(static_cast<int>(values), MPI_DOUBLE, &point);
  MPI_Type_commit(&point);
  MPI_Alltoallv(leaving.data(), sent.data(), sentFrom.data(), point, arrived.data(), got.counts.data(),
    got.begins.data(), point, comm_.handle());
  MPI_Type_free(&point);

  const std::vector<std::size_t>& stay = to[self];
  MaterialPoints<Dim> next(stay.size() + come, points.history());
  next.setAffines(points.commonAffine());
  if (points.storesAffines())
    next.storeAffines();
  for (int c = 0; c < points.columns(); ++c)
    for (std::size_t p = 0; p < stay.size(); ++p)
      next.column(c)[p] = points.column(c)[stay[p]];
  for (std::size_t p = 0; p < stay.size(); ++p)
  {
    next.phase()[p] = points.phase()[stay[p]];
    next.id()[p] = points.id()[stay[p]];
  }
  for (std::size_t p = 0; p < come; ++p)
    unpack(next, stay.size() + p, arrived.data() + p * values);
  return next;
}

template <int Dim>
BackgroundGrid<Dim> PointRanks<Dim>::local(const BackgroundGrid<Dim>& grid) const
{
  if (!comm_.parallel())
    return grid;
  std::array<GridAxis, Dim> axes = grid.axes();
  GridAxis& g = axes[static_cast<std::size_t>(axis_)];
  const bool ring = g.end(0) == Edge::Periodic;
  const auto rank = static_cast<std::size_t>(comm_.rank());
  const bool low = rank == 0;
  const bool high = comm_.rank() + 1 == comm_.size();
  const int first = low ? 0 : firsts_[rank] - 1;
  const int last = high ? g.cells : firsts_[rank + 1];
  g.lower += first * g.spacing;
  g.cells = last - first;
  g.cut = { ring || !low, ring || !high };
  g.edge = { low ? g.end(0) : Edge::Open, high ? g.end(1) : Edge::Open };
  return BackgroundGrid<Dim>(axes);
}

template <int Dim>
MaterialPoints<Dim> PointRanks<Dim>::gather(const MaterialPoints<Dim>& points) const
{
  const std::vector<double> numbers = comm_.gather(std::vector<double>(points.id().begin(), points.id().end()));
  const std::vector<double> phases = comm_.gather(std::vector<double>(points.phase().begin(), points.phase().end()));
  std::vector<std::size_t> order(numbers.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return numbers[a] < numbers[b]; });
  MaterialPoints<Dim> all(numbers.size(), points.history());
  all.setAffines(points.commonAffine());
  if (points.storesAffines())
    all.storeAffines();
  for (int c = 0; c < points.columns(); ++c)
  {
    const std::vector<double> values = comm_.gather(points.column(c));
    for (std::size_t p = 0; p < order.size(); ++p)
      all.column(c)[p] = values[order[p]];
  }
  for (std::size_t p = 0; p < order.size(); ++p)
  {
    all.phase()[p] = static_cast<std::uint8_t>(phases[order[p]]);
    all.id()[p] = static_cast<std::uint32_t>(numbers[order[p]]);
  }
  return all;
}

template <int Dim>
void PointRanks<Dim>::checkNumbers(const MaterialPoints<Dim>& points) const
{
  if (!comm_.parallel())
    return;
  // a number goes to one rank, whoever has it: there the same ones meet, and no rank has many more than others
  const auto ranks = static_cast<std::size_t>(comm_.size());
  const auto receiver = [&](std::uint32_t number) { return static_cast<std::size_t>(mixed(number) % ranks); };
  std::vector<int> sent(ranks);
  std::vector<int> from(ranks);
  for (const std::uint32_t number : points.id())
    ++sent[receiver(number)];
  std::partial_sum(sent.begin(), sent.end() - 1, from.begin() + 1);
  std::vector<std::uint32_t> leaving(points.count());
  std::vector<int> next = from;
  for (const std::uint32_t number : points.id())
    leaving[static_cast<std::size_t>(next[receiver(number)]++)] = number;
  const Coming got = coming(comm_, sent);
  std::vector<std::uint32_t> numbers(got.all);
  MPI_Alltoallv(leaving.data(), sent.data(), from.data(), MPI_UINT32_T, numbers.data(), got.counts.data(),
    got.begins.data(), MPI_UINT32_T, comm_.handle());
  together(comm_,
    [&]
    {
      std::sort(numbers.begin(), numbers.end());
      const auto twice = std::adjacent_find(numbers.begin(), numbers.end());
      if (twice != numbers.end())
        throw InputError(fmt::format("two points have the number {}", *twice),
          "give all points on one rank and none on the others, or number those of each rank on from those before");
    });
}

template class PointRanks<2>;
template class PointRanks<3>;

} // namespace lamella::mpm
