#include "core/Memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <limits>

namespace lamella
{
namespace
{

constexpr std::uint64_t notKnown = std::numeric_limits<std::uint64_t>::max();

/// The first number of a small file, or `notKnown` (also for "max", which is what an unlimited group says).
std::uint64_t firstNumber(const char* path)
{
  std::ifstream in(path);
  std::uint64_t value = 0;
  return (in >> value) ? value : notKnown;
}

std::uint64_t leftInGroup(const char* limitPath, const char* usedPath)
{
  const std::uint64_t limit = firstNumber(limitPath);
  const std::uint64_t used = firstNumber(usedPath);
  if (limit == notKnown || used == notKnown)
    return notKnown;
  return limit > used ? limit - used : 0;
}

/// Under a limit of what a process may map (ulimit -v) or hold as data (ulimit -d).
std::uint64_t leftToProcess(int resource, std::size_t column)
{
  struct rlimit limit = {};
  if (::getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return notKnown;
  std::ifstream statm("/proc/self/statm"); // pages: all, resident, shared, text, 0, data and stack
  std::uint64_t pages = 0;
  for (std::size_t i = 0; i <= column; ++i)
    statm >> pages;
  const std::uint64_t used = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return !statm ? notKnown : limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

} // namespace

std::uint64_t availableMemory()
{
  std::uint64_t available = notKnown;
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
  available = std::min({ available, leftToProcess(RLIMIT_AS, 0), leftToProcess(RLIMIT_DATA, 5) });
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
