#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace lamella::micrograph
{

/// The mean of a grey over the distance from the outline: bin i holds distances from (i - offset) · bin on.
struct Profile
{
  static constexpr double bin = 0.5; // [pixels]

  std::vector<double> sum;
  std::vector<double> place;
  std::vector<double> count;

  explicit Profile(std::size_t bins)
    : sum(bins)
    , place(bins)
    , count(bins)
  {
  }
  void add(double distance, double value)
  {
    const auto i = static_cast<std::size_t>(distance / bin);
    if (i < sum.size())
    {
      sum[i] += value;
      place[i] += distance;
      count[i] += 1;
    }
  }
  /// Bins with enough in them to be believed, as (distance, mean), in order.
  [[nodiscard]] std::vector<std::array<double, 2>> curve() const
  {
    const double most = *std::max_element(count.begin(), count.end());
    std::vector<std::array<double, 2>> points;
    for (std::size_t i = 0; i < sum.size(); ++i)
      if (count[i] >= std::max(30.0, 0.01 * most))
        points.push_back({ place[i] / count[i], sum[i] / count[i] });
    return points;
  }
};

} // namespace lamella::micrograph
