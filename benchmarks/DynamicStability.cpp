// What bonds in motion stand: steps, damping, contrast of moduli, horizons, porosity, notches. Each run pulls a small
// sample apart, at a speed at which it breaks, or lets it ring without breaks; one line a run says what became of its
// energy. Steps above the bound are refused elsewhere; here they are let through. Without arguments all of it;
// study=step, damping, contrast, horizon or porosity one; energy: the balance of the branching plate and of Kalthoff's
// against the step (minutes).
#include "../tests/DiskPlate.h"
#include "../tests/MovingScenes.h"
#include "Keys.h"

#include "core/Communicator.h"
#include "peridynamics/Loading.h"
#include "peridynamics/fracture/Dynamics.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::breakable;
using namespace lamella::peridynamics;

/// Stiff disks in a soft matrix, with holes; both of one density.
struct Trial
{
  double contrast = 4; ///< of Young's moduli
  double horizon = 3;
  double porosity = 0.2;
  bool random = false; ///< single nodes for holes instead of disks
  bool notch = true;
  double safety = 0.8;
  double damping = 0;
  bool breaking = true;
  std::int64_t steps = 3000;
};

constexpr std::int64_t nx = 64;
constexpr std::int64_t ny = 96;
constexpr double spacing = 1e-3;
constexpr double density = 1500;
constexpr double young = 2e9;

BondModel modelOf(const Trial& t)
{
  BondModel m;
  m.horizon = t.horizon;
  const BondMaterial soft{ .youngsModulus = young, .criticalStretch = 5e-3 };
  m.pairs[{ 1, 1 }].material = soft;
  m.pairs[{ 1, 2 }].material = soft;
  m.pairs[{ 2, 2 }].material = { .youngsModulus = t.contrast * young, .criticalStretch = 5e-3 };
  if (t.notch)
    m.notches.push_back({ { 0, 0.5 * ny * spacing, 0 }, { 0.2 * nx * spacing, 0, 0 }, {} });
  return m;
}

struct Outcome
{
  std::string end;
  EnergyBalance energies;
  std::size_t broken = 0;
};

Outcome run(const Trial& t)
{
  const Communicator comm(MPI_COMM_SELF);
  const std::vector<std::uint8_t> phase =
    phasesOf({ nx, ny, t.porosity, t.random, std::llround(std::ceil(t.horizon)) });
  BondLattice bonds(modelOf(t), makeLattice(nx, ny, 1, 2, spacing), phase, {}, comm);
  Loading loading;
  loading.strain = 1;
  LoadedSample sample = applyLoading(bonds, loading);
  DynamicsOptions o;
  o.density = density;
  o.damping = t.damping;
  o.breaking = t.breaking;
  o.checkStep = false;
  o.step = t.safety * stableStep(bonds, density * spacing * spacing);
  BondDynamics motion(bonds, std::move(sample.fixed), o);
  // Breaks within the first third of the run; without breaks it rings at a thousandth of that.
  const double until = static_cast<double>(t.steps) * motion.step();
  const double rate = (t.breaking ? 0.03 : 3e-5) / until;
  NodeField<double> v = sample.displacement;
  for (int c = 0; c < 2; ++c)
    for (std::int64_t i = 0; i < v.layout().count(); ++i)
      v.component(c)[i] *= rate;
  Outcome out;
  motion.setState(NodeField<double>(bonds.layout()), v);
  try
  {
    motion.advance(t.steps);
    out.end = "holds";
  }
  catch (const DivergenceError& e)
  {
    out.end = e.what();
  }
  out.energies = motion.energies();
  out.broken = motion.broken().size();
  return out;
}

void header(const char* what)
{
  fmt::print(
    "{:<22} {:>6} {:>11} {:>11} {:>11} {:>10}  {}\n", what, "broken", "supplied", "kinetic", "elastic", "defect", "");
}

void line(const std::string& name, const Trial& t)
{
  Outcome o;
  try
  {
    o = run(t);
  }
  catch (const Error& e)
  {
    o.end = e.what();
  }
  fmt::print("{:<22} {:>6} {:>11.3e} {:>11.3e} {:>11.3e} {:>10.1e}  {}\n", name, o.broken, o.energies.supplied,
    o.energies.kinetic, o.energies.elastic, o.energies.defect(), o.end);
  std::fflush(stdout);
}

void steps(const Keys&)
{
  for (const bool breaking : { false, true })
  {
    header(breaking ? "step/bound, breaking" : "step/bound, whole");
    for (const double s : { 0.2, 0.4, 0.6, 0.8, 0.9, 1.0, 1.05, 1.1, 1.15, 1.2, 1.4 })
      line(fmt::format("{}", s), { .safety = s, .breaking = breaking });
  }
}

void damping(const Keys&)
{
  header("damping, step/bound");
  for (const double d : { 0.0, 0.01, 0.1, 0.3, 1.0 })
    for (const double s : { 0.8, 1.0 })
      line(fmt::format("{}, {}", d, s), { .safety = s, .damping = d });
}

void contrast(const Keys&)
{
  header("contrast of moduli");
  for (const double c : { 1.0, 10.0, 100.0, 1e3, 1e4 })
    line(fmt::format("{}", c), { .contrast = c });
}

void horizons(const Keys&)
{
  header("horizon");
  for (const double h : { 2.0, 3.0, 4.0, 5.0, 6.0, 8.0 })
    line(fmt::format("{}", h), { .horizon = h });
}

void porosity(const Keys&)
{
  header("porosity");
  for (const bool random : { false, true })
    for (const double p : { 0.0, 0.2, 0.4, 0.6 })
      line(fmt::format("{}{}", p, random ? ", single nodes" : ", disks"), { .porosity = p, .random = random });
}

void energy(const Keys& keys)
{
  const bool quick = !keys.contains("study");
  fmt::print("{:<12} {:>10} {:>12} {:>12}\n", "scene", "step/bound", "broken", "defect");
  for (const bool branching : { true, false })
    for (const double s : { 0.8, 0.4, 0.2, 0.1, 0.05, 0.02, 0.01 })
    {
      if (quick && s < 0.1)
        continue;
      const Communicator comm(MPI_COMM_SELF);
      const MovingScene scene =
        branching ? branchingPlate({ .horizon = 2e-3, .ratio = 3 }) : kalthoffWinkler({ .horizon = 4e-3, .ratio = 3 });
      DynamicsOptions o;
      o.safety = s;
      SceneInMotion sample(scene, o, comm);
      sample.motion().advance(std::llround(scene.duration / sample.motion().step()));
      const EnergyBalance e = sample.motion().energies();
      fmt::print("{:<12} {:>10} {:>12.5g} {:>12.1e}\n", branching ? "branching" : "kalthoff", s, e.broken, e.defect());
      std::fflush(stdout);
    }
}

} // namespace

int main(int argc, char** argv)
{
  return runStudies(argc, argv,
    { { "step", steps }, { "damping", damping }, { "contrast", contrast }, { "horizon", horizons },
      { "porosity", porosity }, { "energy", energy } });
}
