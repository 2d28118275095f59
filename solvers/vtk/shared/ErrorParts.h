#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

/// What is known of a value's error, part by part. Not installed.
namespace lamella
{

/// Parts that are independent of each other, by name, all in one unit.
class ErrorParts
{
public:
  /// Ignored where it is not known.
  void add(const std::string& name, double error)
  {
    if (std::isfinite(error))
      parts_.emplace_back(name, error);
  }
  [[nodiscard]] auto begin() const noexcept { return parts_.begin(); }
  [[nodiscard]] auto end() const noexcept { return parts_.end(); }
  /// The root of the sum of their squares; NaN where there are no two.
  [[nodiscard]] double total() const
  {
    double sum = 0;
    for (const auto& part : parts_)
      sum += part.second * part.second;
    return parts_.size() > 1 ? std::sqrt(sum) : std::numeric_limits<double>::quiet_NaN();
  }

private:
  std::vector<std::pair<std::string, double>> parts_;
};

} // namespace lamella
