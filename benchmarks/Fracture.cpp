// Quasi-static fracture: time and error of the local corrections against one equilibrium an event. Arguments: key=value
// of kind (aggregate, filled, wood), nx, seed, method (events, accurate), breaking, stop, and those of EventOptions.
#include "peridynamics/fracture/Fracture.h"
#include "generators/Generators.h"
#include "lattice/Error.h"
#include "packing/Bridges.h"
#include "packing/Packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <string>

#include <mpi.h>

namespace
{

using namespace lamella;
using namespace lamella::peridynamics;

double cpu() // of all threads
{
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Sample
{
  Lattice lattice;
  std::vector<std::uint8_t> phase; ///< 0 void, 1, 2
  std::vector<std::int32_t> grain;
  BondModel model;
};

Sample cemented(std::int64_t nodes, double saturation, std::int64_t grains, std::uint64_t seed)
{
  packing::PackingOptions o;
  o.count = grains;
  o.aspect = 2;
  o.seed = seed;
  const packing::Packing p = packing::pack(o);
  packing::BridgeOptions b;
  if (saturation < 1)
    b.saturation = saturation;
  else
    b.filled = true;
  packing::RasterOptions r;
  r.nodesAcross = nodes;
  r.platen = 4 * p.size[0] / static_cast<double>(nodes);
  packing::CementedSample c = packing::cement(p, b, r);
  Sample s{ c.image.lattice, std::move(c.image.phase), std::move(c.grain), {} };
  const BondMaterial soft{ .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  const BondMaterial stiff{ .youngsModulus = 4e9, .criticalStretch = 1e-3 };
  s.model.pairs[{ 1, 1 }].material = soft;
  s.model.pairs[{ 1, 2 }].material = soft;
  s.model.pairs[{ 2, 2 }].material = stiff;
  s.model.pairs[{ 2, 2 }].betweenGrains = soft;
  s.model.pairByGrain = true;
  return s;
}

Sample wood(std::int64_t nodes, std::uint64_t seed)
{
  generators::SoftwoodOptions o;
  o.size = { nodes, nodes, 1 };
  o.spacing = 0.5e-6;
  o.seed = seed;
  const PhaseImage image = generators::softwood(o);
  Sample s{ image.lattice, {}, {}, {} };
  for (const std::uint8_t p : image.phase)
  {
    const std::string& name = image.phases.name(p);
    s.phase.push_back(name == "lumen" || name == "void" ? 0 : 1);
  }
  const std::int64_t ny = s.lattice.size[1];
  for (std::int64_t y = 0; y < ny; ++y)
    if (y < 4 || y >= ny - 4)
      std::fill_n(s.phase.begin() + y * s.lattice.size[0], s.lattice.size[0], std::uint8_t{ 1 });
  s.model.pairs[{ 1, 1 }].material = { .youngsModulus = 1e9, .criticalStretch = 1e-3 };
  return s;
}

} // namespace

int main(int argc, char** argv)
{
  MPI_Init(&argc, &argv);
  {
    std::map<std::string, std::string> keys;
    for (int i = 1; i < argc; ++i)
    {
      const std::string a = argv[i];
      const std::size_t e = a.find('=');
      keys[a.substr(0, e)] = e == std::string::npos ? "1" : a.substr(e + 1);
    }
    const auto text = [&](const char* k, const char* other) { return keys.contains(k) ? keys[k] : other; };
    const auto number = [&](const char* k, double other)
    { return keys.contains(k) ? std::atof(keys[k].c_str()) : other; };
    try
    {
      const auto nodes = static_cast<std::int64_t>(number("nx", 256));
      const auto seed = static_cast<std::uint64_t>(number("seed", 1));
      const auto grains = static_cast<std::int64_t>(
        number("grains", std::max(20.0, std::floor(400.0 * static_cast<double>(nodes * nodes) / (512 * 512)))));
      const std::string kind = text("kind", "aggregate");
      const Sample s = kind == "wood" ? wood(nodes, seed)
                                      : cemented(nodes, kind == "filled" ? 1 : number("saturation", 0.5), grains, seed);
      const Communicator comm(MPI_COMM_SELF);
      BondLattice bonds(s.model, s.lattice, s.phase, s.grain, comm);
      const std::int64_t count = bonds.bonds();
      FractureOptions o;
      o.method = text("method", "events") == "accurate" ? FractureMethod::Accurate : FractureMethod::Events;
      o.breaking = text("breaking", "strict") == "batched" ? Breaking::Batched : Breaking::Strict;
      o.stopShare = number("stop", o.stopShare);
      o.maxBroken = static_cast<std::int64_t>(number("max", 1e9));
      o.tolerance = number("tolerance", o.tolerance);
      EventOptions& e = o.events;
      e.radius = static_cast<int>(number("radius", e.radius));
      e.coarseRadius = static_cast<int>(number("coarse", e.coarseRadius));
      e.reduction = number("reduction", e.reduction);
      e.maxCycles = static_cast<int>(number("cycles", e.maxCycles));
      e.globalEvery = static_cast<int>(number("every", e.globalEvery));
      e.globalIterations = static_cast<int>(number("iterations", e.globalIterations));
      e.globalTolerance = number("global", e.globalTolerance);
      e.rivals = number("rivals", e.rivals);
      e.rivalTolerance = number("rivaltol", e.rivalTolerance);
      e.riseTolerance = number("rise", e.riseTolerance);
      const double begin = cpu();
      QuasiStaticFracture fracture(bonds, {}, o);
      const double ready = cpu();
      fracture.run();
      const double end = cpu();
      const FractureRecord& r = fracture.record();
      const FractureStatistics& t = r.statistics;
      fmt::print("{} {}x{} solid {} bonds {} end: {}\n", kind, s.lattice.size[0], s.lattice.size[1], bonds.solidNodes(),
        count, describe(r.end));
      fmt::print("  E {:.6e} first {:.6e} peak {:.7e} at {:.6e} after {} broken {} raises {}\n", r.modulus,
        r.first.stress, r.peak.stress, r.peak.strain, r.peak.broken, r.broken.size(), t.raises);
      const double events = static_cast<double>(std::max<std::int64_t>(1, t.events));
      fmt::print(
        "  cpu: start {:.2f} s, run {:.2f} s, {:.3f} ms an event; wall: global {:.2f} ({} of {:.1f} iterations) "
        "local {:.2f} ({:.2f} cycles, {:.0f} nodes an event) search {:.2f} s\n",
        ready - begin, end - ready, 1e3 * (end - ready) / events, t.globalSeconds, t.equilibria,
        static_cast<double>(t.globalIterations) / static_cast<double>(t.equilibria), t.localSeconds,
        static_cast<double>(t.localCycles) / events, static_cast<double>(t.nodesVisited) / events, t.searchSeconds);
      fmt::print("  searches {} loose {} ({} nodes, {} bonds); {:.0f} bytes a node\n", t.searches, t.loosePieces,
        t.looseNodes, t.looseBonds, static_cast<double>(t.bytes) / static_cast<double>(s.lattice.count()));
      if (keys.contains("log"))
      {
        std::ofstream log(keys["log"]);
        for (const BrokenBond& b : r.broken)
          log << fmt::format("{} {} {} {} {:.9e} {:.9e} {:.9e}\n", b.event, b.bond.node[0], b.bond.node[1],
            b.bond.offset, b.strain, b.criticalStrain, b.stress);
      }
    }
    catch (const Error& e)
    {
      fmt::print("error: {}\nhint: {}\n", e.what(), e.hint());
    }
  }
  MPI_Finalize();
  return 0;
}
