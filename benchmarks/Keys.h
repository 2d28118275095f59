#pragma once

#include "Timing.h"

#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <mpi.h>

namespace lamella::benchmark
{

/// key=value of the command line; a key alone is 1.
using Keys = std::map<std::string, std::string>;

inline Keys keysOf(int argc, char** argv)
{
  Keys keys;
  for (int i = 1; i < argc; ++i)
  {
    const std::string a = argv[i];
    const std::size_t e = a.find('=');
    keys[a.substr(0, e)] = e == std::string::npos ? "1" : a.substr(e + 1);
  }
  return keys;
}

inline double number(const Keys& keys, const char* key, double other)
{
  const auto found = keys.find(key);
  return found == keys.end() ? other : std::atof(found->second.c_str());
}

inline std::string text(const Keys& keys, const char* key, const char* other)
{
  const auto found = keys.find(key);
  return found == keys.end() ? other : found->second;
}

/// key=a,b,c, or the one value.
inline std::vector<double> list(const Keys& keys, const char* key, double other)
{
  std::vector<double> values;
  std::istringstream in(text(keys, key, fmt::format("{}", other).c_str()));
  for (std::string part; std::getline(in, part, ',');)
    values.push_back(std::atof(part.c_str()));
  return values;
}

/// Of all threads [s].
inline double cpu()
{
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Parts of a benchmark with their names: study= runs one, without it all run in turn.
inline void runStudies(const Keys& keys, const std::vector<std::pair<std::string, std::function<void()>>>& studies)
{
  const std::string wanted = text(keys, "study", "");
  std::string names;
  bool found = wanted.empty();
  for (const auto& [name, run] : studies)
  {
    found = found || name == wanted;
    names += (names.empty() ? "" : ", ") + name;
  }
  if (!found)
    throw ParameterError("no study '" + wanted + "'", "one of " + names);
  for (const auto& [name, run] : studies)
    if (wanted.empty() || name == wanted)
      run();
}

/// Runs f(keys) between MPI's first and last call; errors as the command line shows them.
template <class F>
int runWith(int argc, char** argv, F&& f)
{
  MPI_Init(&argc, &argv);
  const int status = told([&] { f(keysOf(argc, argv)); });
  MPI_Finalize();
  return status;
}

/// The whole of a benchmark that is such studies.
inline int runStudies(
  int argc, char** argv, const std::vector<std::pair<std::string, std::function<void(const Keys&)>>>& studies)
{
  return runWith(
    argc, argv,
    [&](const Keys& keys)
    {
      std::vector<std::pair<std::string, std::function<void()>>> bound;
      for (const auto& [name, study] : studies)
        bound.emplace_back(
          name, [&keys, &study = study] { study(keys); });
      runStudies(keys, bound);
    });
}

} // namespace lamella::benchmark
