#pragma once

#include <algorithm>
#include <thread>

namespace lamella
{

/// Threads to use where so many are asked for. @param asked 0: one for each core that the machine has
[[nodiscard]] inline int threadCount(int asked)
{
  return asked > 0 ? asked : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

} // namespace lamella
