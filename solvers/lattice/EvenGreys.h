#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

namespace lamella
{

/// 255 greys at equal distances from one to another one, for pictures of more greys than ids can tell apart. What lies
/// beyond either end counts as that end.
struct EvenGreys
{
  double none = 0;
  double all = 1;

  static constexpr int count = 255;

  [[nodiscard]] std::uint8_t of(double grey) const noexcept
  {
    return static_cast<std::uint8_t>(std::lround(std::clamp((grey - none) / (all - none), 0.0, 1.0) * (count - 1)));
  }
  [[nodiscard]] double grey(int level) const noexcept { return none + (all - none) * level / (count - 1); }
  /// What a phase of this level is called: its grey.
  [[nodiscard]] std::string name(int level) const { return fmt::format("{}", grey(level)); }
};

} // namespace lamella
