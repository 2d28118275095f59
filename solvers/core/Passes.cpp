#include "core/Passes.h"

#include <atomic>

namespace lamella
{

namespace
{

std::array<std::atomic<std::int64_t>, passKinds> counts{};

} // namespace

void countPass(Pass pass) noexcept
{
  counts[static_cast<std::size_t>(pass)].fetch_add(1, std::memory_order_relaxed);
}

PassCounts passCounts() noexcept
{
  PassCounts now{};
  for (std::size_t i = 0; i < passKinds; ++i)
    now[i] = counts[i].load(std::memory_order_relaxed);
  return now;
}

std::array<std::pair<std::string_view, std::int64_t>, passKinds> passesSince(const PassCounts& before) noexcept
{
  const PassCounts now = passCounts();
  std::array<std::pair<std::string_view, std::int64_t>, passKinds> since;
  for (std::size_t i = 0; i < passKinds; ++i)
    since[i] = { passNames[i], now[i] - before[i] };
  return since;
}

} // namespace lamella
