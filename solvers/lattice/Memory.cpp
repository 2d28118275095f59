#include "lattice/Memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>

namespace lamella
{
namespace
{

constexpr std::uint64_t unknown = std::numeric_limits<std::uint64_t>::max();

/// The first number of a small file, or `unknown` (also for "max", which is what an unlimited group says).
std::uint64_t firstNumber(const char* path)
{
  std::ifstream in(path);
  std::uint64_t value = 0;
  return (in >> value) ? value : unknown;
}

std::uint64_t leftInGroup(const char* limitPath, const char* usedPath)
{
  const std::uint64_t limit = firstNumber(limitPath);
  const std::uint64_t used = firstNumber(usedPath);
  if (limit == unknown || used == unknown)
  {
    return unknown;
  }
  return limit > used ? limit - used : 0;
}

} // namespace

std::uint64_t availableMemory()
{
  std::uint64_t available = unknown;
  std::ifstream meminfo("/proc/meminfo");
  std::string key;
  std::uint64_t kilobytes = 0;
  std::string rest;
  while (meminfo >> key >> kilobytes && std::getline(meminfo, rest))
  {
    if (key == "MemAvailable:")
    {
      available = kilobytes * 1024;
      break;
    }
  }
  available = std::min(available, leftInGroup("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"));
  return std::min(available,
    leftInGroup("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"));
}

std::string bytesText(double bytes)
{
  static constexpr std::array units{ "B", "kB", "MB", "GB", "TB", "PB", "EB" };
  std::size_t unit = 0;
  while (bytes >= 999.5 && unit + 1 < units.size())
  {
    bytes /= 1000;
    ++unit;
  }
  return unit == 0 ? fmt::format("{:.0f} {}", bytes, units[unit]) : fmt::format("{:.1f} {}", bytes, units[unit]);
}

} // namespace lamella
