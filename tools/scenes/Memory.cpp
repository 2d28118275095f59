#include "scenes/Memory.h"

#include <fstream>
#include <string>

namespace lamella::cli
{

namespace
{

/// A line of /proc/self/status, in kilobytes there.
std::uint64_t status(const std::string& key)
{
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(key + ":"))
      return std::stoull(line.substr(key.size() + 1)) * 1024;
  return 0;
}

} // namespace

void resetPeakMemory()
{
  std::ofstream("/proc/self/clear_refs") << "5\n"; // proc(5): resets VmHWM
}

std::uint64_t peakMemory()
{
  return status("VmHWM");
}

std::uint64_t memoryNow()
{
  return status("VmRSS");
}

} // namespace lamella::cli
