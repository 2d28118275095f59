#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace lamella::peridynamics
{

/// What was asked for that is still to come, in order.
template <class Number>
class Wanted
{
public:
  Wanted(std::vector<Number> values, Number limit)
    : values_(std::move(values))
    , limit_(limit)
  {
    std::sort(values_.begin(), values_.end());
    values_.erase(std::unique(values_.begin(), values_.end()), values_.end());
  }

  [[nodiscard]] Number next() const { return some() ? values_[at_] : limit_; }
  /// Not at the run's own limit: the end is there in any case.
  [[nodiscard]] bool some() const { return at_ < values_.size() && values_[at_] < limit_; }
  /// @return how many
  std::int64_t passed(Number value)
  {
    const std::size_t before = at_;
    while (at_ < values_.size() && values_[at_] <= value)
      ++at_;
    return static_cast<std::int64_t>(at_ - before);
  }
  /// @return how many there were
  std::int64_t skipBelow(Number value)
  {
    while (at_ < values_.size() && values_[at_] < value)
      ++at_;
    return static_cast<std::int64_t>(at_);
  }
  [[nodiscard]] std::vector<Number> left() const
  {
    return { values_.begin() + static_cast<std::ptrdiff_t>(at_), values_.end() };
  }

private:
  std::vector<Number> values_;
  std::size_t at_ = 0;
  Number limit_;
};

} // namespace lamella::peridynamics
