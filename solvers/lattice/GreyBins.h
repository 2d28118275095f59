#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace lamella
{

/// At most 256 greys that stand for all there are, each for those in a bin around it: for pictures of more greys than
/// ids can tell apart.
class GreyBins
{
public:
  /// @param border between bins, rising, one less than greys
  GreyBins(std::vector<double> border, std::vector<double> grey)
    : border_(std::move(border))
    , grey_(std::move(grey))
  {
  }
  /// 255 at equal distances from one grey to another one; what lies beyond either end counts as that end.
  [[nodiscard]] static GreyBins even(double first, double last)
  {
    constexpr int count = 255;
    const auto at = [&](double i) { return first + (last - first) * i / (count - 1); };
    std::vector<double> border;
    std::vector<double> grey;
    for (int i = 0; i < count; ++i)
    {
      if (i > 0)
        border.push_back(at(i - 0.5));
      grey.push_back(at(i));
    }
    if (last < first)
    {
      std::ranges::reverse(border);
      std::ranges::reverse(grey);
    }
    return { std::move(border), std::move(grey) };
  }

  [[nodiscard]] std::size_t count() const noexcept { return grey_.size(); }
  [[nodiscard]] std::uint8_t of(double grey) const noexcept
  {
    return static_cast<std::uint8_t>(std::ranges::upper_bound(border_, grey) - border_.begin());
  }
  [[nodiscard]] double grey(std::size_t bin) const noexcept { return grey_[bin]; }
  /// What a phase of this bin is called: its grey.
  [[nodiscard]] std::string name(std::size_t bin) const { return fmt::format("{}", grey_[bin]); }

private:
  std::vector<double> border_;
  std::vector<double> grey_;
};

} // namespace lamella
