// Packings: processor time against what is not yet that of hard grains at rest. study=
//   softness   overlaps that go to zero: packing fraction and contacts beyond isostaticity, against the hardest
//   tolerance  net forces that go to zero: packing fraction, against the tightest
// none: both. Keys: count=NUMBER of disks (200), seeds=NUMBER (5), output=FOLDER for CSV files (default
// results/bench-packing). benchmarks/packing.py draws them.
#include "Keys.h"
#include "Table.h"

#include "packing/Packing.h"

#include <cmath>
#include <cstdio>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::packing;

struct Run
{
  Packing packing;
  PackingStatistics statistics;
  double seconds = 0;
};

Run timed(const PackingOptions& o)
{
  const double start = cpu();
  Run run;
  run.packing = pack(o);
  run.seconds = cpu() - start;
  run.statistics = statistics(run.packing, o.friction > 0);
  return run;
}

/// Contacts less degrees of freedom: of smooth grains between walls, each pair of which moves, dimension × (N′ + 1).
double excess(const Run& run)
{
  const auto held = static_cast<double>(run.packing.count()) - static_cast<double>(run.statistics.rattlers);
  return static_cast<double>(run.statistics.grainContacts + run.statistics.wallContacts) -
    run.packing.dimension * (held + 1);
}

PackingOptions sample(const Keys& keys, int dimension, int seed)
{
  PackingOptions o;
  o.dimension = dimension;
  o.count = static_cast<std::int64_t>(number(keys, "count", 200));
  o.aspect = 1;
  o.seed = static_cast<std::uint64_t>(seed);
  return o;
}

/// Means over the seeds.
struct Means
{
  double seconds = 0;
  double fraction = 0;
  double error = 0; ///< of the packing fraction, against the best sample of the same seed
  double excess = 0;
  double excessShare = 0;
  double unbalanced = 0;
};

/// @param sampleOf seed -> what is packed
/// @param best packing fractions by seed; filled where there are none
template <class SampleOf>
Means means(const Keys& keys, SampleOf&& sampleOf, std::vector<double>& best)
{
  const int seeds = static_cast<int>(number(keys, "seeds", 5));
  const bool first = best.empty();
  Means m;
  for (int seed = 1; seed <= seeds; ++seed)
  {
    const Run run = timed(sampleOf(seed));
    const PackingStatistics& s = run.statistics;
    if (first)
      best.push_back(s.packingFraction);
    m.seconds += run.seconds / seeds;
    m.fraction += s.packingFraction / seeds;
    m.error += std::fabs(s.packingFraction - best.at(static_cast<std::size_t>(seed - 1))) / seeds;
    m.excess += excess(run) / seeds;
    m.excessShare += excess(run) / static_cast<double>(s.grainContacts + s.wallContacts) / seeds;
    m.unbalanced += run.packing.unbalanced / seeds;
  }
  return m;
}

/// Against the hardest samples.
void softness(const Keys& keys)
{
  Table table(keys, "packing", "softness",
    "dimension,softness,cpu_seconds,fraction,fraction_error,excess,excess_share,unbalanced");
  for (const int dimension : { 2, 3 })
  {
    std::vector<double> hardest;
    fmt::print(
      "{}D: softness, CPU [s], packing fraction, its error, contacts beyond isostaticity, net force\n", dimension);
    for (const double softness : { 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2 })
    {
      const auto sampleOf = [&](int seed)
      {
        PackingOptions o = sample(keys, dimension, seed);
        o.softness = softness;
        return o;
      };
      const Means m = means(keys, sampleOf, hardest);
      table.line(dimension, softness, m.seconds, m.fraction, m.error, m.excess, m.excessShare, m.unbalanced);
      fmt::print("{:8.0e} {:8.3f} {:10.6f} {:10.2e} {:8.1f} {:10.1e}\n", softness, m.seconds, m.fraction, m.error,
        m.excess, m.unbalanced);
      std::fflush(stdout);
    }
  }
}

/// Against the tightest samples; only with friction is the way to rest iterated all the way (Newton's method ends far
/// below any tolerance).
void tolerance(const Keys& keys)
{
  Table table(keys, "packing", "tolerance", "friction,tolerance,cpu_seconds,fraction,fraction_error,unbalanced");
  for (const double friction : { 0.0, 0.3 })
  {
    std::vector<double> tightest;
    fmt::print("friction {}: tolerance, CPU [s], packing fraction, its error, net force\n", friction);
    for (const double tolerance : { 1e-6, 1e-5, 1e-4, 1e-3, 1e-2 })
    {
      const auto sampleOf = [&](int seed)
      {
        PackingOptions o = sample(keys, 2, seed);
        o.softness = 1e-5;
        o.friction = friction;
        o.tolerance = tolerance;
        return o;
      };
      const Means m = means(keys, sampleOf, tightest);
      table.line(friction, tolerance, m.seconds, m.fraction, m.error, m.unbalanced);
      fmt::print(
        "{:8.0e} {:8.3f} {:10.6f} {:10.2e} {:10.1e}\n", tolerance, m.seconds, m.fraction, m.error, m.unbalanced);
      std::fflush(stdout);
    }
  }
}

} // namespace

int main(int argc, char** argv)
{
  return runStudies(argc, argv, { { "softness", softness }, { "tolerance", tolerance } });
}
