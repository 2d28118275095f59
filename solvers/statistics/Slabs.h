#pragma once

#include "statistics/StressDistribution.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace lamella::statistics
{

/// A sum that loses no digits (Neumaier, Z. Angew. Math. Mech. 54 (1974) 39): the same whatever the order, almost.
class Sum
{
public:
  void add(double value) noexcept
  {
    const double next = sum_ + value;
    rest_ += std::abs(sum_) >= std::abs(value) ? (sum_ - next) + value : (value - next) + sum_;
    sum_ = next;
  }
  [[nodiscard]] double value() const noexcept { return sum_ + rest_; }

private:
  double sum_ = 0;
  double rest_ = 0;
};

/// The values in slabs, each handed with its number to body(slab, value, group).
class Values
{
public:
  Values(std::span<const double> values, std::span<const std::uint8_t> group, const DistributionOptions& options)
    : values_(values)
    , group_(group)
    , options_(options)
    , slabs_(std::clamp(options.slabs, 1, 1 + static_cast<int>(std::min<std::size_t>(values.size() / 4096, 1023))))
  {
  }

  [[nodiscard]] std::size_t slabs() const noexcept { return static_cast<std::size_t>(slabs_); }

  template <class Body>
  void forEach(const Body& body) const
  {
    const auto work = [&](int number)
    {
      const auto slab = static_cast<std::size_t>(number);
      const std::size_t end = values_.size() * (slab + 1) / slabs();
      for (std::size_t i = values_.size() * slab / slabs(); i < end; ++i)
      {
        const std::uint8_t group = group_.empty() ? std::uint8_t{ 0 } : group_[i];
        if (group != noGroup)
          body(slab, values_[i], std::size_t{ group });
      }
    };
    if (options_.forEach)
      options_.forEach(slabs_, work);
    else
      for (int slab = 0; slab < slabs_; ++slab)
        work(slab);
  }

private:
  std::span<const double> values_;
  std::span<const std::uint8_t> group_;
  const DistributionOptions& options_;
  int slabs_;
};

} // namespace lamella::statistics
