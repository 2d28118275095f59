// Strength and crack path by damped dynamics against quasi-static fracture, with the loading rate of the second paper's
// appendix A. Without arguments one line a sample with the settings that the docs recommend. With kind=aggregate,
// filled, wood or lamella a table: nx=, seed=, grains=, saturation= of the sample; transits= (time in which the strain
// of the quasi-static peak is reached, in travel times of a wave through the sample), damping= (share of the critical
// one), tau= (in travel times; 0: no regulation), delta= (crack that gives the reference energy, over the width), jump=
// (share of the first break's strain at which it starts, in equilibrium), safety=, stretch= (factor on all s0);
// the first four may be lists a,b,c. export=FOLDER writes the sample and the last run for
// examples/dynamic-fracture/lammps.py.
#include "FractureRuns.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::peridynamics;

struct Path
{
  std::set<Bond> bonds;
  std::vector<std::array<double, 2>> middles; ///< in spacings
};

template <class Breaks>
Path pathOf(const Breaks& broken, const BondModel& model)
{
  const Stencil stencil(2, model.horizon);
  Path path{ bondsOf(broken), {} };
  for (const auto& b : broken)
  {
    const auto& step = stencil.half()[static_cast<std::size_t>(b.bond.offset)].step;
    path.middles.push_back(
      { static_cast<double>(b.bond.node[0]) + 0.5 * step[0], static_cast<double>(b.bond.node[1]) + 0.5 * step[1] });
  }
  return path;
}

/// Mean distance of a's broken bonds from the nearest of b [spacings].
double distance(const Path& a, const Path& b)
{
  double sum = 0;
  for (const auto& p : a.middles)
  {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& q : b.middles)
      least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1]));
    sum += least;
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, a.middles.size()));
}

struct Static
{
  Run run;
  Path path;
};

Static staticRun(const Sample& s, FractureMethod method, Breaking breaking)
{
  FractureOptions o;
  o.method = method;
  o.breaking = breaking;
  Run run = quasiStatic(s, o);
  Path path = pathOf(run.record.broken, s.model);
  return { std::move(run), std::move(path) };
}

/// For examples/dynamic-fracture/lammps.py: the nodes, how many of their bonds broke, and what else it takes.
void write(const std::string& folder, const Sample& s, const Path& strict, const Path& moved, const Motion& m)
{
  std::filesystem::create_directories(folder);
  const Communicator comm(MPI_COMM_SELF);
  const BondLattice bonds(s.model, s.lattice, s.phase, s.grain, comm);
  const auto endsOf = [&](const Path& path)
  {
    std::vector<int> count(s.phase.size());
    for (const Bond& b : path.bonds)
    {
      const auto& step = bonds.stencil().half()[static_cast<std::size_t>(b.offset)].step;
      ++count[static_cast<std::size_t>(s.lattice.index(b.node[0], b.node[1]))];
      ++count[static_cast<std::size_t>(s.lattice.index(b.node[0] + step[0], b.node[1] + step[1]))];
    }
    return count;
  };
  const std::vector<int> byEvents = endsOf(strict);
  const std::vector<int> byMotion = endsOf(moved);
  std::ofstream nodes(folder + "/nodes.csv");
  nodes << "x,y,phase,grain,bonds,vx,vy,broken_strict,broken_motion\n";
  for (std::int64_t y = 0; y < s.lattice.size[1]; ++y)
    for (std::int64_t x = 0; x < s.lattice.size[0]; ++x)
    {
      const auto i = static_cast<std::size_t>(s.lattice.index(x, y));
      nodes << fmt::format("{},{},{},{},{},{:.17g},{:.17g},{},{}\n", x, y, s.phase[i], s.grain.empty() ? 0 : s.grain[i],
        bonds.degree(bonds.layout().index(x, y)), m.record.startVelocity.at(0, x, y),
        m.record.startVelocity.at(1, x, y), byEvents[i], byMotion[i]);
    }
  std::ofstream settings(folder + "/settings.csv");
  settings << "name,value\n";
  double soft = std::numeric_limits<double>::infinity();
  double stiff = 0;
  for (std::size_t k = 1; k < bonds.kinds().size(); ++k)
  {
    soft = std::min(soft, bonds.kinds()[k].stiffness);
    stiff = std::max(stiff, bonds.kinds()[k].stiffness);
  }
  for (const auto& [name, value] : { std::pair{ "spacing", s.lattice.spacing }, { "horizon", s.model.horizon },
         { "density", density }, { "layers", static_cast<double>(bonds.stencil().layers()) }, { "soft", soft },
         { "stiff", stiff }, { "stretch", bonds.kinds()[1].criticalStretch }, { "step", m.record.step },
         { "steps", static_cast<double>(m.record.steps) }, { "viscosity", m.record.viscosity },
         { "peak", m.record.peak.stress } })
    settings << fmt::format("{},{:.17g}\n", name, value);
}

void header()
{
  fmt::print("{:<10} {:>5} {:>8} {:>8} {:>6} {:>6} {:>10} {:>8} {:>7} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}\n", "sample",
    "seed", "transits", "damping", "tau", "delta", "peak", "broken", "common", "dist 1", "dist 2", "steps", "CPU [s]",
    "cost", "kin/el");
}

void line(const std::string& kind, const std::string& seed, const std::string& how, const Static& strict, double peak,
  const Path& path, std::int64_t steps, double seconds, double kinetic)
{
  fmt::print("{:<10} {:>5} {} {:>+9.2f}% {:>8} {:>6.1f}% {:>8.2f} {:>8.2f} {:>8} {:>8.2f} {:>8.1f} {:>9.1e}\n", kind,
    seed, how, 100 * (peak / strict.run.record.peak.stress - 1), path.bonds.size(),
    100 * common(strict.path.bonds, path.bonds), distance(strict.path, path), distance(path, strict.path), steps,
    seconds, seconds / strict.run.seconds(), kinetic);
  std::fflush(stdout);
}

std::string described(const std::string& name)
{
  return fmt::format("{:<31}", name);
}

void table(const std::string& kind, const Keys& keys)
{
  const PullSettings usual;
  Sample s = sampleOf(kind, keys);
  scaleStretch(s.model, number(keys, "stretch", 1));
  const std::string seed = text(keys, "seed", "1");
  const Static strict = staticRun(s, FractureMethod::Events, Breaking::Strict);
  line(kind, seed, described("strict, events"), strict, strict.run.record.peak.stress, strict.path,
    strict.run.record.statistics.events, strict.run.seconds(), 0);
  if (keys.contains("batched"))
  {
    const Static batched = staticRun(s, FractureMethod::Accurate, Breaking::Batched);
    line(kind, seed, described("batched"), strict, batched.run.record.peak.stress, batched.path,
      batched.run.record.statistics.events, batched.run.seconds(), 0);
  }
  for (const double transits : list(keys, "transits", usual.transits))
    for (const double damping : list(keys, "damping", usual.damping))
      for (const double tau : list(keys, "tau", usual.tau))
        for (const double delta : list(keys, "delta", usual.delta))
        {
          const Motion m = damped(s, strict.run.record,
            { transits, damping, tau, delta, number(keys, "jump", usual.jump), number(keys, "safety", usual.safety) });
          const Path path = pathOf(m.record.broken, s.model);
          line(kind, seed,
            fmt::format(
              "{:>8} {:>8} {:>6} {:>6}", transits, fmt::format("{}:{:.2f}", damping, m.overdamped), tau, delta),
            strict, m.record.peak.stress, path, m.record.steps, m.seconds, m.record.kineticShare);
          if (keys.contains("export"))
            write(keys.at("export"), s, strict.path, path, m);
          if (m.record.end == FractureEnd::MaxStrain)
            fmt::print(
              "  the stress has not fallen to 5 % of the peak by a strain of {:.3g}\n", m.record.curve.back().strain);
        }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(
    argc, argv,
    [](const Keys& keys)
    {
      header();
      if (keys.contains("kind"))
      {
        table(keys.at("kind"), keys);
        return;
      }
      Keys small = keys;
      small.emplace("nx", "64");
      small.emplace("grains", "24");
      for (const char* seed : { "1", "2", "3" })
      {
        small["seed"] = seed;
        table("aggregate", small);
      }
      small["seed"] = "1";
      small["nx"] = "128";
      table("lamella", small);
    });
}
