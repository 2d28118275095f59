// Quasi-static fracture: run time against error, in three tables. study=methods: local corrections against one
// equilibrium an event, three samples; strength, toughness: over method, horizon and lattice, see FractureCost.h, also
// for the options of these two; none: all. With kind=aggregate, filled or wood one run in detail: nx=, seed=,
// method=events or accurate, breaking=, stop=, max=, renew=, checkpoint=, continue=, and those of EventOptions.
#include "FractureCost.h"
#include "FractureRuns.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <string>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::peridynamics;

FractureOptions optionsOf(const Keys& keys)
{
  FractureOptions o;
  o.method = text(keys, "method", "events") == "accurate" ? FractureMethod::Accurate : FractureMethod::Events;
  o.breaking = text(keys, "breaking", "strict") == "batched" ? Breaking::Batched : Breaking::Strict;
  o.stopShare = number(keys, "stop", o.stopShare);
  o.maxBroken = static_cast<std::int64_t>(number(keys, "max", 1e9));
  o.tolerance = number(keys, "tolerance", o.tolerance);
  o.renewEvery = static_cast<std::int64_t>(number(keys, "renew", static_cast<double>(o.renewEvery)));
  o.checkpoint.path = text(keys, "checkpoint", "");
  o.checkpoint.warn = [](const std::string& words) { fmt::print("warning: {}\n", words); };
  o.continueFrom = text(keys, "continue", "");
  EventOptions& e = o.events;
  e.radius = static_cast<int>(number(keys, "radius", e.radius));
  e.coarseRadius = static_cast<int>(number(keys, "coarse", e.coarseRadius));
  e.reduction = number(keys, "reduction", e.reduction);
  e.maxCycles = static_cast<int>(number(keys, "cycles", e.maxCycles));
  e.globalEvery = static_cast<int>(number(keys, "every", e.globalEvery));
  e.globalIterations = static_cast<int>(number(keys, "iterations", e.globalIterations));
  e.globalTolerance = number(keys, "global", e.globalTolerance);
  e.rivals = number(keys, "rivals", e.rivals);
  e.rivalTolerance = number(keys, "rivaltol", e.rivalTolerance);
  e.riseTolerance = number(keys, "rise", e.riseTolerance);
  e.softeningTolerance = number(keys, "softening", e.softeningTolerance);
  return o;
}

void one(const Keys& keys)
{
  const std::string kind = text(keys, "kind", "aggregate");
  const Sample s = sampleOf(kind, keys);
  const FractureOptions options = optionsOf(keys);
  const Run run = median<Run>(
    static_cast<int>(number(keys, "repeat", 1)), [&] { return quasiStatic(s, options); },
    [](const Run& x) { return x.seconds(); });
  const FractureRecord& r = run.record;
  const FractureStatistics& t = r.statistics;
  fmt::print("{} {} x {} x {}, {} bonds; ended: {}\n", kind, s.lattice.size[0], s.lattice.size[1], s.lattice.size[2],
    run.bonds, describe(r.end));
  fmt::print("  E {:.6e} first break {:.6e} peak {:.7e} at {:.6e} after {}; {} broken, {} raises\n", r.modulus,
    r.first.stress, r.peak.stress, r.peak.strain, r.peak.broken, r.broken.size(), t.raises);
  const double events = static_cast<double>(std::max<std::int64_t>(1, t.events));
  fmt::print(
    "  CPU: start {:.2f} s, run {:.2f} s, {:.3f} ms an event; wall: global {:.2f} s ({} of {:.1f} iterations), "
    "local {:.2f} s ({:.2f} cycles, {:.0f} nodes an event), search {:.2f} s\n",
    run.startSeconds, run.runSeconds, 1e3 * run.runSeconds / events, t.globalSeconds, t.equilibria,
    static_cast<double>(t.globalIterations) / static_cast<double>(t.equilibria), t.localSeconds,
    static_cast<double>(t.localCycles) / events, static_cast<double>(t.nodesVisited) / events, t.searchSeconds);
  fmt::print("  {} searches, {} loose pieces ({} nodes, {} bonds); {:.0f} bytes a node beside the bonds\n", t.searches,
    t.loosePieces, t.looseNodes, t.looseBonds, static_cast<double>(t.bytes) / static_cast<double>(s.lattice.count()));
  if (t.checkpoints > 0)
    fmt::print("  {} checkpoints, {:.1f} ms each\n", t.checkpoints,
      1e3 * t.checkpointSeconds / static_cast<double>(t.checkpoints));
  if (const auto log = keys.find("log"); log != keys.end())
  {
    std::ofstream file(log->second);
    for (const BrokenBond& b : r.broken)
      file << fmt::format("{} {} {} {} {} {:.9e} {:.9e} {:.9e}\n", b.event, b.bond.node[0], b.bond.node[1],
        b.bond.node[2], b.bond.offset, b.strain, b.criticalStrain, b.stress);
  }
}

void table(const Keys& keys)
{
  fmt::print("Local corrections against one equilibrium a break\n");
  fmt::print("{:<12} {:<18} {:>7} {:>12} {:>12} {:>8} {:>12}\n", "sample", "method", "broken", "peak [Pa]",
    "peak error", "bonds", "ms an event");
  constexpr std::pair<const char*, int> samples[] = { { "aggregate", 1 }, { "aggregate", 2 }, { "filled", 1 },
    { "wood", 1 }, { "wood", 2 } };
  for (const auto& [kind, seed] : samples)
  {
    Keys seeded = keys;
    seeded.try_emplace("seed", std::to_string(seed));
    const Sample s = sampleOf(kind, seeded);
    FractureRecord reference;
    for (const char* method : { "accurate", "events", "events, no rivals" })
    {
      FractureOptions o = optionsOf(keys);
      o.method = std::string(method) == "accurate" ? FractureMethod::Accurate : FractureMethod::Events;
      if (std::string(method) == "events, no rivals")
        o.events.rivals = 0;
      const Run r = median<Run>(
        static_cast<int>(number(keys, "repeat", 1)), [&] { return quasiStatic(s, o); },
        [](const Run& x) { return x.seconds(); });
      if (o.method == FractureMethod::Accurate)
        reference = r.record;
      fmt::print("{:<12} {:<18} {:>7} {:>12.5e} {:>+12.1e} {:>6.1f} % {:>12.2f}\n",
        fmt::format("{} {}", kind, seeded.at("seed")), method, r.record.broken.size(), r.record.peak.stress,
        r.record.peak.stress / reference.peak.stress - 1,
        100 * common(bondsOf(reference.broken), bondsOf(r.record.broken)),
        1e3 * r.runSeconds / static_cast<double>(r.record.statistics.events));
      std::fflush(stdout); // a line may take a minute
    }
  }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(
    argc, argv,
    [](const Keys& keys)
    {
      if (keys.contains("kind"))
        one(keys);
      else
        runStudies(keys,
          { { "methods", [&] { table(keys); } }, { "strength", [&] { strengthCost(keys); } },
            { "toughness", [&] { toughnessCost(keys); } } });
    });
}
