#pragma once

#include "core/Error.h"
#include "core/Median.h"

#include <fmt/format.h>

#include <cstdio>

#include <sys/resource.h>

namespace lamella::benchmark
{

/// Of all threads, what the kernel does for them left out [s].
inline double userSeconds()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

/// Runs what a program does; errors as the command line shows them.
/// @return the program's exit status
template <class F>
int told(F&& program)
{
  try
  {
    program();
    return 0;
  }
  catch (const Error& e)
  {
    fmt::print(stderr, "error: {}\nhint: {}\n", e.what(), e.hint());
    return 1;
  }
}

} // namespace lamella::benchmark
