// Strength and crack path by damped dynamics against quasi-static fracture, with the loading rate of the second paper's
// appendix A. Without arguments one line a sample with the settings that the docs recommend. With kind=aggregate,
// filled, wood or lamella a table: nx=, seed=, grains=, saturation= of the sample; transits= (time in which the strain
// of the quasi-static peak is reached, in travel times of a wave through the sample), damping= (share of the critical
// one), tau= (in travel times; 0: no regulation), delta= (crack that gives the reference energy, over the width), jump=
// (share of the first break's strain at which it starts, in equilibrium), safety=, stretch= (factor on all s0);
// the first four may be lists a,b,c. export=FOLDER writes the sample and the last run for
// examples/dynamic-fracture/lammps.py.
#include "BreakableSamples.h"

#include "peridynamics/fracture/DampedPull.h"
#include "peridynamics/fracture/Fracture.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <set>
#include <sstream>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::peridynamics;

constexpr double density = 1000; // sets the unit of time, no more

struct Path
{
  std::set<Bond> bonds;
  std::vector<std::array<double, 2>> middles; ///< in spacings
};

template <class Breaks>
Path pathOf(const Breaks& broken, const Stencil& stencil)
{
  Path path;
  for (const auto& b : broken)
  {
    path.bonds.insert(b.bond);
    const auto& step = stencil.half()[static_cast<std::size_t>(b.bond.offset)].step;
    path.middles.push_back(
      { static_cast<double>(b.bond.node[0]) + 0.5 * step[0], static_cast<double>(b.bond.node[1]) + 0.5 * step[1] });
  }
  return path;
}

/// Share of a's bonds that b has too.
double common(const Path& a, const Path& b)
{
  const auto same = std::count_if(a.bonds.begin(), a.bonds.end(), [&](const Bond& x) { return b.bonds.contains(x); });
  return static_cast<double>(same) / static_cast<double>(std::max<std::size_t>(1, a.bonds.size()));
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
  FractureRecord record;
  Path path;
  double seconds = 0;
};

Static quasiStatic(const Sample& s, FractureMethod method, Breaking breaking)
{
  const Communicator comm(MPI_COMM_SELF);
  const double begin = cpu();
  BondLattice bonds(s.model, s.lattice, s.phase, s.grain, comm);
  FractureOptions o;
  o.method = method;
  o.breaking = breaking;
  QuasiStaticFracture f(bonds, {}, o);
  f.run();
  return { f.record(), pathOf(f.record().broken, bonds.stencil()), cpu() - begin };
}

struct Settings
{
  double transits = 100;
  double damping = 0.1;
  double tau = 1;
  double delta = 0.01;
  double jump = 0.98;
  double safety = 0.8;
};

struct Motion
{
  DampedPullRecord record;
  Path path;
  double seconds = 0;    ///< CPU
  double overdamped = 0; ///< ν/m over twice the lowest frequency of the sample
};

Motion damped(const Sample& s, const FractureRecord& reference, const Settings& set)
{
  const Communicator comm(MPI_COMM_SELF);
  const double begin = cpu();
  BondLattice bonds(s.model, s.lattice, s.phase, s.grain, comm);
  const double travel = travelTime(s.lattice.length(1), reference.modulus, density);
  DampedPullOptions o;
  o.density = density;
  o.strainRate = reference.peak.strain / (set.transits * travel);
  o.damping = set.damping;
  o.safety = set.safety;
  o.startStrain = set.jump * reference.first.strain;
  o.maxStrain = 1.2 * reference.curve.back().strain + reference.peak.strain;
  if (set.tau > 0)
  {
    // The weakest phase's fracture energy times a short crack.
    const auto& soft = s.model.pairs.begin()->second.material;
    double s0 = std::numeric_limits<double>::infinity();
    for (const BondKind& kind : bonds.kinds())
      if (kind.criticalStretch > 0)
        s0 = std::min(s0, kind.criticalStretch);
    const double h = s.model.horizon * s.lattice.spacing;
    const double gc = 9 * soft.youngsModulus * h * s0 * s0 / (4 * std::numbers::pi);
    o.rate.emplace(set.tau * travel, gc * set.delta * s.lattice.length(0), 1);
  }
  Motion m{ pullApart(bonds, {}, o), {}, 0, 0 };
  m.path = pathOf(m.record.broken, bonds.stencil());
  const double mass = density * s.lattice.spacing * s.lattice.spacing;
  m.overdamped = m.record.viscosity / mass / (2 * std::numbers::pi / travel);
  m.seconds = cpu() - begin;
  return m;
}

/// For examples/dynamic-fracture/lammps.py: the nodes, how many of their bonds broke, and what else it takes.
void write(const std::string& folder, const Sample& s, const Path& strict, const Motion& m)
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
  const std::vector<int> byMotion = endsOf(m.path);
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

std::vector<double> list(const Keys& keys, const char* key, double other)
{
  std::vector<double> values;
  std::istringstream in(text(keys, key, fmt::format("{}", other).c_str()));
  for (std::string part; std::getline(in, part, ',');)
    values.push_back(std::atof(part.c_str()));
  return values;
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
    seed, how, 100 * (peak / strict.record.peak.stress - 1), path.bonds.size(), 100 * common(strict.path, path),
    distance(strict.path, path), distance(path, strict.path), steps, seconds, seconds / strict.seconds, kinetic);
  std::fflush(stdout);
}

std::string described(const std::string& name)
{
  return fmt::format("{:<31}", name);
}

void table(const std::string& kind, const Keys& keys)
{
  const Settings usual;
  Sample s = sampleOf(kind, keys);
  for (auto& [phases, pair] : s.model.pairs)
    for (BondMaterial* material : { &pair.material, pair.betweenGrains ? &*pair.betweenGrains : nullptr })
      if (material != nullptr && material->criticalStretch)
        *material->criticalStretch *= number(keys, "stretch", 1);
  const std::string seed = text(keys, "seed", "1");
  const Static strict = quasiStatic(s, FractureMethod::Events, Breaking::Strict);
  line(kind, seed, described("strict, events"), strict, strict.record.peak.stress, strict.path,
    strict.record.statistics.events, strict.seconds, 0);
  if (keys.contains("batched"))
  {
    const Static batched = quasiStatic(s, FractureMethod::Accurate, Breaking::Batched);
    line(kind, seed, described("batched"), strict, batched.record.peak.stress, batched.path,
      batched.record.statistics.events, batched.seconds, 0);
  }
  for (const double transits : list(keys, "transits", usual.transits))
    for (const double damping : list(keys, "damping", usual.damping))
      for (const double tau : list(keys, "tau", usual.tau))
        for (const double delta : list(keys, "delta", usual.delta))
        {
          const Motion m = damped(s, strict.record,
            { transits, damping, tau, delta, number(keys, "jump", usual.jump), number(keys, "safety", usual.safety) });
          line(kind, seed,
            fmt::format(
              "{:>8} {:>8} {:>6} {:>6}", transits, fmt::format("{}:{:.2f}", damping, m.overdamped), tau, delta),
            strict, m.record.peak.stress, m.path, m.record.steps, m.seconds, m.record.kineticShare);
          if (keys.contains("export"))
            write(keys.at("export"), s, strict.path, m);
          if (m.record.end == FractureEnd::MaxStrain)
            fmt::print(
              "  the stress has not fallen to 5 % of the peak by a strain of {:.3g}\n", m.record.curve.back().strain);
        }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(argc, argv,
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
