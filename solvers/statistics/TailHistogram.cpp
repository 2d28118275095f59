#include "statistics/TailHistogram.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::statistics
{

namespace
{

constexpr double finest = 5e-5;
constexpr double lowest = 1e-4; // of the unit
constexpr double mostTailBins = 1 << 19;

} // namespace

TailHistogram::TailHistogram(double unit, double largest)
  : unit_(unit)
  , step_(finest)
{
  const double below = -std::log(lowest);
  const double above = std::max(0.0, std::log(largest) - std::log(unit));
  step_ = std::max(finest, (below + above) / mostTailBins);
  offset_ = static_cast<std::int64_t>(std::ceil(below / step_));
  const auto bins = static_cast<std::size_t>(offset_ + static_cast<std::int64_t>(std::ceil(above / step_)) + 2);
  count_.assign(bins, 0.0);
  sum_.assign(bins, 0.0);
}

double TailHistogram::edge(std::int64_t bin) const noexcept
{
  return unit_ * std::exp(static_cast<double>(bin - offset_) * step_);
}

void TailHistogram::add(double value)
{
  auto bin = static_cast<std::int64_t>(std::ceil(std::log(value / unit_) / step_)) - 1 + offset_;
  bin = value > unit_ ? std::max(bin, offset_) : std::min(bin, offset_ - 1);
  bin = std::clamp<std::int64_t>(bin, 0, static_cast<std::int64_t>(count_.size()) - 1);
  ++count_[static_cast<std::size_t>(bin)];
  sum_[static_cast<std::size_t>(bin)] += value;
}

void TailHistogram::add(const TailHistogram& other)
{
  for (std::size_t i = 0; i < count_.size(); ++i)
  {
    count_[i] += other.count_[i];
    sum_[i] += other.sum_[i];
  }
}

void TailHistogram::finish(const Communicator& comm)
{
  comm.sum(count_);
  comm.sum(sum_);
  double count = 0;
  double sum = 0;
  for (std::size_t bin = count_.size(); bin-- > 0;)
  {
    if (count_[bin] == 0)
      continue;
    count += count_[bin];
    sum += sum_[bin];
    full_.push_back({ static_cast<std::int64_t>(bin), count_[bin], count, sum });
  }
  std::reverse(full_.begin(), full_.end());
  count_ = {};
  sum_ = {};
}

std::vector<TailHistogram::Full>::const_iterator TailHistogram::above(double threshold) const noexcept
{
  const std::int64_t bin = offset_ + std::llround(std::log(threshold / unit_) / step_);
  return std::lower_bound(
    full_.begin(), full_.end(), bin, [](const Full& full, std::int64_t number) { return full.bin < number; });
}

TailHistogram::Beyond TailHistogram::beyond(double threshold) const
{
  const auto first = above(threshold);
  if (first == full_.end())
    return {};
  return { std::llround(first->countFrom), first->sumFrom - first->countFrom * threshold };
}

double TailHistogram::edgeForShare(double share) const
{
  const double most = share * full_.front().countFrom;
  const auto first =
    std::partition_point(full_.begin(), full_.end(), [most](const Full& full) { return full.countFrom > most; });
  return edge(first == full_.end() ? full_.back().bin + 1 : first->bin);
}

double TailHistogram::distance(double threshold, double rate) const
{
  if (!(rate > 0))
    return std::numeric_limits<double>::quiet_NaN();
  const auto first = above(threshold);
  double largest = 0;
  double below = 0;
  // Between full bins only the law grows, so its extremes are at their ends.
  for (auto full = first; full != full_.end(); ++full)
  {
    const auto law = [&](std::int64_t at) { return -std::expm1(-rate * std::max(0.0, edge(at) - threshold)); };
    const double atLow = std::abs(below / first->countFrom - law(full->bin));
    below += full->count;
    const double atHigh = std::abs(below / first->countFrom - law(full->bin + 1));
    largest = std::max({ largest, atLow, atHigh });
  }
  return largest;
}

} // namespace lamella::statistics
