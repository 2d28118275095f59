#include "statistics/StressDistribution.h"

#include "core/Error.h"
#include "statistics/Slabs.h"
#include "statistics/TailHistogram.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::statistics
{

namespace
{

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double mostBins = 1e6;

/// What the first pass finds of a group.
struct Moments
{
  std::int64_t count = 0;
  std::int64_t tensile = 0;
  std::int64_t compressive = 0;
  Sum positive;
  Sum negative;
  double smallest = inf;
  double largest = -inf;
};

/// What the second pass finds of a group.
struct Shape
{
  Sum squares; ///< about the mean
  std::vector<std::int64_t> bins;
};

/// What the third pass finds of a group: values beyond the threshold.
struct Beyond
{
  std::int64_t count = 0;
  Sum excess;
};

void checkOptions(const DistributionOptions& o)
{
  const auto refuse = [](const std::string& what, const char* hint) { throw ParameterError(what, hint); };
  if (!(o.binWidth > 0) || !std::isfinite(o.binWidth))
    refuse(fmt::format("a bin width of {} is not positive and finite", o.binWidth),
      "give the width of a bin in mean tensile stresses, such as 0.05");
  if (!std::isfinite(o.low) || !std::isfinite(o.high))
    refuse(fmt::format("the range {} to {} is not finite", o.low, o.high), "give it in mean tensile stresses");
  if (!(o.threshold >= 0) || !std::isfinite(o.threshold))
    refuse(fmt::format("a threshold of {} is not positive and finite", o.threshold),
      "give where the tail begins in mean tensile stresses, such as 2, or 0 for a share of the tensile values");
  if (o.threshold == 0 && !(o.tailShare > 0 && o.tailShare <= 1))
    refuse(fmt::format("a tail share of {} is outside 0 to 1", o.tailShare), "0.1 takes the largest tenth");
  if (!std::isfinite(o.reference) || o.reference < 0)
    refuse(fmt::format("a reference stress of {} is not positive and finite", o.reference),
      "give the stress to compare with in Pa, or 0 for none");
}

/// First pass. The groups of all ranks; mean, deviation and tail are left.
std::vector<StressGroup> moments(const Values& values, std::size_t groups, const Communicator& comm)
{
  std::vector<std::vector<Moments>> parts(values.slabs(), std::vector<Moments>(groups));
  std::vector<std::int64_t> strange(values.slabs() * 8, 0); // a cache line each
  values.forEach(
    [&](std::size_t slab, double value, std::size_t group)
    {
      if (!std::isfinite(value))
      {
        ++strange[slab * 8];
        return;
      }
      Moments& m = parts[slab][group];
      ++m.count;
      m.smallest = std::min(m.smallest, value);
      m.largest = std::max(m.largest, value);
      if (value > 0)
      {
        ++m.tensile;
        m.positive.add(value);
      }
      else if (value < 0)
      {
        ++m.compressive;
        m.negative.add(value);
      }
    });
  std::vector<double> sums(1 + 5 * groups, 0.0); // counts are exact in double up to 2^53
  std::vector<StressGroup> result(groups);
  for (std::size_t slab = 0; slab < values.slabs(); ++slab)
    sums[0] += static_cast<double>(strange[slab * 8]);
  for (std::size_t g = 0; g < groups; ++g)
  {
    Moments whole;
    for (const auto& part : parts)
    {
      whole.count += part[g].count;
      whole.tensile += part[g].tensile;
      whole.compressive += part[g].compressive;
      whole.positive.add(part[g].positive.value());
      whole.negative.add(part[g].negative.value());
      whole.smallest = std::min(whole.smallest, part[g].smallest);
      whole.largest = std::max(whole.largest, part[g].largest);
    }
    const std::array<double, 5> of{ static_cast<double>(whole.count), static_cast<double>(whole.tensile),
      static_cast<double>(whole.compressive), whole.positive.value(), whole.negative.value() };
    std::copy(of.begin(), of.end(), sums.begin() + static_cast<std::ptrdiff_t>(1 + 5 * g));
    result[g].smallest = -comm.max(-whole.smallest);
    result[g].largest = comm.max(whole.largest);
  }
  comm.sum(sums);
  if (sums[0] > 0)
    throw InputError(fmt::format("{:.0f} stresses are not finite", sums[0]),
      "compute the field again, or leave the phase that has them out");
  for (std::size_t g = 0; g < groups; ++g)
  {
    const double* const of = sums.data() + 1 + 5 * g;
    StressGroup& group = result[g];
    group.count = std::llround(of[0]);
    group.tensile = std::llround(of[1]);
    group.compressive = std::llround(of[2]);
    if (group.count == 0)
    {
      group.smallest = 0;
      group.largest = 0;
      continue;
    }
    group.mean = (of[3] + of[4]) / of[0];
    group.meanTensile = group.tensile > 0 ? of[3] / of[1] : 0;
    group.meanCompressive = group.compressive > 0 ? of[4] / of[2] : 0;
  }
  return result;
}

/// All groups as one, in a fixed order.
StressGroup together(const std::vector<StressGroup>& groups)
{
  StressGroup all;
  all.smallest = inf;
  all.largest = -inf;
  Sum positive;
  Sum negative;
  for (const StressGroup& g : groups)
  {
    if (g.count == 0)
      continue;
    all.count += g.count;
    all.tensile += g.tensile;
    all.compressive += g.compressive;
    positive.add(g.meanTensile * static_cast<double>(g.tensile));
    negative.add(g.meanCompressive * static_cast<double>(g.compressive));
    all.smallest = std::min(all.smallest, g.smallest);
    all.largest = std::max(all.largest, g.largest);
  }
  if (all.count == 0)
    throw InputError("there is no stress to count", "choose phases that the sample has");
  if (all.tensile == 0)
    throw InputError(fmt::format("none of {} stresses is above 0: there is no mean tensile stress", all.count),
      all.compressive == 0 ? "check the component, and that the sample is loaded"
                           : "choose another component; for compression, change the sign of the stress");
  all.mean = (positive.value() + negative.value()) / static_cast<double>(all.count);
  all.meanTensile = positive.value() / static_cast<double>(all.tensile);
  all.meanCompressive = all.compressive > 0 ? negative.value() / static_cast<double>(all.compressive) : 0;
  if (!std::isfinite(positive.value()) || !std::isfinite(negative.value()) || !(all.meanTensile >= 1e-290))
    throw InputError(
      fmt::format("stresses from {} to {} are too large or too small to be summed", all.smallest, all.largest),
      "give the field in Pa");
  return all;
}

struct Bins
{
  std::int64_t first = 0;
  std::size_t count = 0;
};

Bins binsFor(const StressGroup& all, const DistributionOptions& o)
{
  const bool given = o.low < o.high;
  const auto edge = [&](double at, bool up)
  {
    const double bin = at / o.binWidth;
    const double nearest = std::round(bin);
    return std::abs(bin - nearest) < 1e-9 * std::max(1.0, std::abs(nearest)) ? nearest
      : up                                                                   ? std::ceil(bin)
                                                                             : std::floor(bin);
  };
  const double first = given ? edge(o.low, false) : std::floor(all.smallest / all.meanTensile / o.binWidth);
  const double last = given ? edge(o.high, true) : std::floor(all.largest / all.meanTensile / o.binWidth) + 1;
  if (!(last - first <= mostBins) || std::abs(first) > 1e15)
    throw ParameterError(fmt::format("bins of {} mean tensile stresses from {:.4g} to {:.4g} are {:.3g}, more than a "
                                     "million",
                           o.binWidth, first * o.binWidth, last * o.binWidth, last - first),
      "give wider bins, or a range");
  return { static_cast<std::int64_t>(first), static_cast<std::size_t>(last - first) };
}

/// Second pass: bins and deviations of the groups, and the fine histogram of the tail.
TailHistogram shapes(const Values& values, StressDistribution& result, Bins bins, double unit, const Communicator& comm)
{
  const std::size_t groups = result.groups.size();
  const TailHistogram empty(unit, result.all.largest);
  std::vector<TailHistogram> tails(values.slabs(), empty);
  std::vector<std::vector<Shape>> parts(values.slabs(), std::vector<Shape>(groups));
  for (auto& part : parts)
    for (std::size_t g = 0; g < groups; ++g)
      part[g].bins.assign(result.groups[g].count > 0 ? bins.count : 0, 0);
  const double mean = result.all.meanTensile;
  const auto firstBin = static_cast<double>(bins.first);
  const auto binCount = static_cast<double>(bins.count);
  values.forEach(
    [&](std::size_t slab, double value, std::size_t g)
    {
      Shape& shape = parts[slab][g];
      const double off = value - result.groups[g].mean;
      shape.squares.add(off * off);
      // The largest value may come out one bin too far by round-off where the range is that of the values.
      const double bin = std::floor(value / mean / result.binWidth) - firstBin;
      if (bin >= 0 && bin < binCount)
        ++shape.bins[static_cast<std::size_t>(bin)];
      if (value > 0)
        tails[slab].add(value);
    });
  Sum squares;
  std::vector<double> sums;
  for (std::size_t g = 0; g < groups; ++g)
  {
    StressGroup& group = result.groups[g];
    if (group.count == 0)
      continue;
    sums.assign(1 + bins.count, 0.0);
    Sum own;
    for (const auto& part : parts)
    {
      own.add(part[g].squares.value());
      for (std::size_t b = 0; b < bins.count; ++b)
        sums[1 + b] += static_cast<double>(part[g].bins[b]);
    }
    sums[0] = own.value();
    comm.sum(sums);
    const auto count = static_cast<double>(group.count);
    group.deviation = std::sqrt(sums[0] / count);
    const double off = group.mean - result.all.mean;
    squares.add(sums[0]);
    squares.add(count * off * off);
    for (std::size_t b = 0; b < bins.count; ++b)
    {
      group.bins.push_back(std::llround(sums[1 + b]));
      group.density.push_back(sums[1 + b] / count / result.binWidth);
      result.all.bins[b] += group.bins[b];
    }
  }
  const auto count = static_cast<double>(result.all.count);
  result.all.deviation = std::sqrt(squares.value() / count);
  for (std::size_t b = 0; b < bins.count; ++b)
    result.all.density[b] = static_cast<double>(result.all.bins[b]) / count / result.binWidth;
  TailHistogram whole = std::move(tails.front());
  for (std::size_t slab = 1; slab < tails.size(); ++slab)
    whole.add(tails[slab]);
  whole.finish(comm);
  return whole;
}

ExponentialTail fitted(double threshold, std::int64_t count, double excess, std::int64_t tensile)
{
  ExponentialTail tail;
  tail.threshold = threshold;
  tail.count = count;
  tail.share = tensile > 0 ? static_cast<double>(count) / static_cast<double>(tensile) : 0;
  if (count >= 2 && excess > 0)
  {
    tail.theta = static_cast<double>(count) / excess;
    tail.standardError = tail.theta / std::sqrt(static_cast<double>(count));
  }
  return tail;
}

/// Third pass: the tails of the groups beyond a threshold [Pa].
void tails(const Values& values, StressDistribution& result, double threshold, const Communicator& comm)
{
  const std::size_t groups = result.groups.size();
  const double mean = result.all.meanTensile;
  std::vector<std::vector<Beyond>> parts(values.slabs(), std::vector<Beyond>(groups));
  values.forEach(
    [&](std::size_t slab, double value, std::size_t g)
    {
      if (value > threshold)
      {
        ++parts[slab][g].count;
        parts[slab][g].excess.add((value - threshold) / mean);
      }
    });
  std::vector<double> sums(2 * groups, 0.0);
  for (std::size_t g = 0; g < groups; ++g)
  {
    Sum excess;
    for (const auto& part : parts)
    {
      sums[2 * g] += static_cast<double>(part[g].count);
      excess.add(part[g].excess.value());
    }
    sums[2 * g + 1] = excess.value();
  }
  comm.sum(sums);
  std::int64_t count = 0;
  Sum excess;
  for (std::size_t g = 0; g < groups; ++g)
  {
    StressGroup& group = result.groups[g];
    group.tail = fitted(threshold / mean, std::llround(sums[2 * g]), sums[2 * g + 1], group.tensile);
    count += group.tail.count;
    excess.add(sums[2 * g + 1]);
  }
  result.all.tail = fitted(threshold / mean, count, excess.value(), result.all.tensile);
}

} // namespace

StressDistribution stressDistribution(std::span<const double> values, std::span<const std::uint8_t> group, int groups,
  const DistributionOptions& options, const Communicator& comm)
{
  checkOptions(options);
  const Values all(values, group, options);
  StressDistribution result;
  result.binWidth = options.binWidth;
  result.reference = options.reference;
  result.groups = moments(all, static_cast<std::size_t>(groups), comm);
  result.all = together(result.groups);
  const Bins bins = binsFor(result.all, options);
  result.firstBin = bins.first;
  result.all.bins.assign(bins.count, 0);
  result.all.density.assign(bins.count, 0.0);

  const double mean = result.all.meanTensile;
  const bool given = options.threshold > 0;
  double threshold = given ? options.threshold * mean : 0;
  if (given && !(result.all.largest > threshold))
    throw ParameterError(
      fmt::format("no stress is beyond the threshold of {} mean tensile stresses", options.threshold),
      fmt::format("the largest is {:.4g} of them; give a lower threshold", result.all.largest / mean));
  const TailHistogram fine = shapes(all, result, bins, given ? threshold : mean, comm);
  if (!given)
    threshold = fine.edgeForShare(options.tailShare);
  tails(all, result, threshold, comm);
  result.all.tail.distance = fine.distance(threshold, result.all.tail.theta / mean);
  double last = -1;
  for (const double share : { 0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.07, 0.05, 0.03, 0.02, 0.01, 0.005 })
  {
    const double at = fine.edgeForShare(share);
    const TailHistogram::Beyond beyond = fine.beyond(at);
    if (at == last || beyond.count < 10)
      continue;
    last = at;
    ExponentialTail tail = fitted(at / mean, beyond.count, beyond.excess / mean, result.all.tensile);
    tail.distance = fine.distance(at, tail.theta / mean);
    result.tails.push_back(tail);
  }
  return result;
}

} // namespace lamella::statistics
