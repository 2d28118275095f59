// Packings: user CPU of 400 disks and 1000 spheres from a random start to rest, and what the samples are like.
#include "Timing.h"

#include "packing/Bridges.h"
#include "packing/Packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::packing;

void measure(const char* label, PackingOptions options, int samples)
{
  fmt::print("{}\n  seed  user CPU    steps  fraction  rattlers  contacts less degrees of freedom  a grain  aspect  "
             "anisotropy: fabric  stress  unbalanced\n",
    label);
  std::vector<double> seconds;
  for (int seed = 1; seed <= samples; ++seed)
  {
    options.seed = static_cast<std::uint64_t>(seed);
    const double start = userSeconds();
    const Packing p = pack(options);
    seconds.push_back(userSeconds() - start);
    const PackingStatistics s = statistics(p, options.friction > 0);
    const auto held = static_cast<std::int64_t>(p.count()) - s.rattlers;
    fmt::print(
      "  {:>4}  {:>6.2f} s  {:>7}    {:.4f}  {:>8}  {:>8} = {} N' + {:<21} {:.3f}   {:.4f}  {:>18.3f}  {:>6.3f}  "
      "{:.1e}\n",
      seed, seconds.back(), p.steps, s.packingFraction, s.rattlers, s.grainContacts + s.wallContacts, options.dimension,
      s.grainContacts + s.wallContacts - options.dimension * held, s.coordination, s.aspect, s.fabricAnisotropy,
      s.stressAnisotropy, p.unbalanced);
    std::fflush(stdout);
  }
  std::sort(seconds.begin(), seconds.end());
  fmt::print(
    "  user CPU: median {:.2f} s, {:.2f} to {:.2f}\n\n", seconds[seconds.size() / 2], seconds.front(), seconds.back());
}

} // namespace

int main(int argc, char** argv)
{
  return told(
    [&]
    {
      const bool quick = argc > 1 && std::string(argv[1]) == "--quick";
      measure("400 disks between walls", {}, 30);
      PackingOptions periodic;
      periodic.periodic = true;
      measure("400 disks, periodic", periodic, 3);
      PackingOptions rough;
      rough.friction = 0.3;
      measure("400 disks between walls, friction 0.3", rough, 3);
      PackingOptions spheres;
      spheres.dimension = 3;
      spheres.count = 1000;
      measure("1000 spheres between walls", spheres, quick ? 1 : 3);
    });
}
