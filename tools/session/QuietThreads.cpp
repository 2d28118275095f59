#include "session/QuietThreads.h"

#include <array>
#include <cstdlib>
#include <string_view>

#include <unistd.h>

namespace lamella::cli
{

namespace
{

// Less than a tenth of a millisecond: longer than most loops leave a thread without work, and no loss to who waits for
// a processor. The Python package takes the same.
constexpr const char* spins = "2000";

/// A number of threads, or a scene, which may hold one.
bool mayAskForThreads(char** arguments)
{
  for (char** a = arguments + 1; *a != nullptr; ++a)
  {
    const std::string_view word = *a;
    if (word == "run" || word == "--threads" || word.starts_with("--threads="))
      return true;
  }
  return false;
}

} // namespace

void beginWithQuietThreads(char** arguments)
{
  if (*arguments == nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr || std::getenv("OMP_WAIT_POLICY") != nullptr ||
    !mayAskForThreads(arguments))
    return;
  std::array<char, 4096> self{};
  const auto length = readlink("/proc/self/exe", self.data(), self.size() - 1);
  if (length > 0 && setenv("GOMP_SPINCOUNT", spins, 0) == 0)
    execv(self.data(), arguments); // comes back only when it fails: then threads spin
}

} // namespace lamella::cli
