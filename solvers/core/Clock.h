#pragma once

#include <chrono>

namespace lamella
{

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double secondsSince(Clock::time_point start)
{
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Since some moment of this process.
[[nodiscard]] inline double seconds()
{
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

} // namespace lamella
