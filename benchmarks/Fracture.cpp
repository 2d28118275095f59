// Quasi-static fracture: time and error of the local corrections against one equilibrium an event, a table of three
// samples. With kind=aggregate, filled or wood one run in detail: nx=, seed=, method=events or accurate, breaking=,
// stop=, max=, renew=, checkpoint=, continue=, and those of EventOptions.
#include "BreakableSamples.h"

#include "peridynamics/fracture/Fracture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::peridynamics;

struct Run
{
  FractureRecord record;
  std::int64_t bonds = 0;
  double startSeconds = 0; ///< CPU
  double runSeconds = 0;
};

Run run(const Sample& s, const FractureOptions& options)
{
  const Communicator comm(MPI_COMM_SELF);
  BondLattice bonds(s.model, s.lattice, s.phase, s.grain, comm);
  Run r;
  r.bonds = bonds.bonds();
  const double begin = cpu();
  QuasiStaticFracture fracture(bonds, {}, options);
  const double ready = cpu();
  fracture.run();
  r.record = fracture.record();
  r.startSeconds = ready - begin;
  r.runSeconds = cpu() - ready;
  return r;
}

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
  return o;
}

void one(const Keys& keys)
{
  const std::string kind = text(keys, "kind", "aggregate");
  const Sample s = sampleOf(kind, keys);
  const Run run_ = run(s, optionsOf(keys));
  const FractureRecord& r = run_.record;
  const FractureStatistics& t = r.statistics;
  fmt::print(
    "{} {} x {}, {} bonds; ended: {}\n", kind, s.lattice.size[0], s.lattice.size[1], run_.bonds, describe(r.end));
  fmt::print("  E {:.6e} first break {:.6e} peak {:.7e} at {:.6e} after {}; {} broken, {} raises\n", r.modulus,
    r.first.stress, r.peak.stress, r.peak.strain, r.peak.broken, r.broken.size(), t.raises);
  const double events = static_cast<double>(std::max<std::int64_t>(1, t.events));
  fmt::print(
    "  CPU: start {:.2f} s, run {:.2f} s, {:.3f} ms an event; wall: global {:.2f} s ({} of {:.1f} iterations), "
    "local {:.2f} s ({:.2f} cycles, {:.0f} nodes an event), search {:.2f} s\n",
    run_.startSeconds, run_.runSeconds, 1e3 * run_.runSeconds / events, t.globalSeconds, t.equilibria,
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
      file << fmt::format("{} {} {} {} {:.9e} {:.9e} {:.9e}\n", b.event, b.bond.node[0], b.bond.node[1], b.bond.offset,
        b.strain, b.criticalStrain, b.stress);
  }
}

void table(const Keys& keys)
{
  fmt::print("{:<10} {:<22} {:>7} {:>12} {:>12} {:>8} {:>12}\n", "sample", "method", "broken", "peak [Pa]",
    "peak error", "bonds", "ms an event");
  for (const char* kind : { "aggregate", "filled", "wood" })
  {
    const Sample s = sampleOf(kind, keys);
    FractureRecord reference;
    for (const char* method : { "accurate", "events", "events, no rivals" })
    {
      FractureOptions o = optionsOf(keys);
      o.method = std::string(method) == "accurate" ? FractureMethod::Accurate : FractureMethod::Events;
      if (std::string(method) == "events, no rivals")
        o.events.rivals = 0;
      const Run r = run(s, o);
      if (o.method == FractureMethod::Accurate)
        reference = r.record;
      std::set<Bond> broken;
      for (const BrokenBond& b : r.record.broken)
        broken.insert(b.bond);
      const auto same = std::count_if(
        reference.broken.begin(), reference.broken.end(), [&](const BrokenBond& b) { return broken.contains(b.bond); });
      fmt::print("{:<10} {:<22} {:>7} {:>12.5e} {:>+12.1e} {:>6.1f} % {:>12.2f}\n", kind, method,
        r.record.broken.size(), r.record.peak.stress, r.record.peak.stress / reference.peak.stress - 1,
        100.0 * static_cast<double>(same) / static_cast<double>(reference.broken.size()),
        1e3 * r.runSeconds / static_cast<double>(r.record.statistics.events));
      std::fflush(stdout); // a line may take a minute
    }
  }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(argc, argv, [](const Keys& keys) { keys.contains("kind") ? one(keys) : table(keys); });
}
