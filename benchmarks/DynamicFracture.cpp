// Cracks that run: the branching plate and the plate of Kalthoff and Winkler. Without arguments a table of both. With
// scene=branching or kalthoff one run: ratio= (h/dx), horizon= [m], safety=, duration= [s], traction= [Pa], speed=
// [m/s]. quick makes all of it small. examples/dynamic-fracture/study.py draws the same plates.
#include "../tests/MovingScenes.h"
#include "../tests/RunningCracks.h"
#include "Keys.h"

#include "core/Communicator.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::peridynamics;

constexpr double degree = std::numbers::pi / 180;

MovingScene sceneOf(const std::string& name, const Keys& keys)
{
  const bool quick = keys.contains("quick");
  if (name == "kalthoff")
  {
    KalthoffWinkler p;
    p.horizon = number(keys, "horizon", quick ? 5e-3 : p.horizon);
    p.ratio = number(keys, "ratio", quick ? 3 : p.ratio);
    p.speed = number(keys, "speed", p.speed);
    p.duration = number(keys, "duration", p.duration);
    return kalthoffWinkler(p);
  }
  if (name != "branching")
    throw ParameterError("no scene '" + name + "'", "branching or kalthoff");
  BranchingPlate p;
  p.horizon = number(keys, "horizon", quick ? 1.5e-3 : p.horizon);
  p.ratio = number(keys, "ratio", quick ? 3 : p.ratio);
  p.traction = number(keys, "traction", p.traction);
  p.duration = number(keys, "duration", p.duration);
  return branchingPlate(p);
}

struct Result
{
  std::vector<DynamicBreak> broken;
  EnergyBalance energies;
  double step = 0;
  std::int64_t steps = 0;
  std::int64_t bonds = 0;
  double seconds = 0; ///< CPU
};

Result run(const MovingScene& scene, const Keys& keys)
{
  const Communicator comm(MPI_COMM_SELF);
  DynamicsOptions options;
  options.safety = number(keys, "safety", options.safety);
  SceneInMotion sample(scene, options, comm);
  BondDynamics& motion = sample.motion();
  Result r;
  r.bonds = sample.bonds().bonds();
  r.step = motion.step();
  r.steps = std::llround(scene.duration / motion.step());
  const double begin = cpu();
  motion.advance(r.steps);
  r.seconds = cpu() - begin;
  r.energies = motion.energies();
  r.broken = motion.broken();
  return r;
}

// ---- what is said of cracks

/// Breaks whose middles f accepts.
template <class F>
std::vector<DynamicBreak> where(const Result& r, const MovingScene& scene, const Stencil& stencil, F&& f)
{
  std::vector<DynamicBreak> some;
  std::copy_if(r.broken.begin(), r.broken.end(), std::back_inserter(some),
    [&](const DynamicBreak& b) { return f(middleOf(b.bond, stencil, scene.lattice)); });
  return some;
}

void common(const std::string& name, const MovingScene& scene, const Result& r)
{
  const Stencil stencil(2, scene.model.horizon);
  const MirrorSymmetry m = mirrorSymmetry(r.broken, stencil, scene.lattice);
  fmt::print("{}: h {:.3g} mm, h/dx {}, {} x {} nodes, {} bonds; {} steps of {:.4g} s, {:.1f} s CPU\n", name,
    1e3 * scene.horizon, scene.model.horizon, scene.lattice.size[0], scene.lattice.size[1], r.bonds, r.steps, r.step,
    r.seconds);
  fmt::print("  {} broken bonds; with mirror image {:.2f} %, in the same step {:.2f} %, all until {:.2f} us\n",
    r.broken.size(), 100 * m.share, 100 * m.sameStep, 1e6 * m.until);
  const EnergyBalance& e = r.energies;
  fmt::print("  energy [J/m]: supplied {:.5g}, initial {:.5g}, kinetic {:.5g}, elastic {:.5g}, broken {:.5g}; defect "
             "{:.1e}\n",
    e.supplied, e.initial, e.kinetic, e.elastic, e.broken, e.defect());
}

double fastest(const std::vector<TipSpeed>& speeds)
{
  double most = 0;
  for (const TipSpeed& s : speeds)
    most = std::max(most, s.speed);
  return most;
}

void branching(const Keys& keys)
{
  const MovingScene scene = sceneOf("branching", keys);
  const Result r = run(scene, keys);
  const Stencil stencil(2, scene.model.horizon);
  common("branching", scene, r);
  const std::vector<TipPoint> tip = tipAdvance(r.broken, stencil, scene.lattice, { 1, 0 }, scene.horizon);
  const std::vector<TipSpeed> speeds = tipSpeeds(tip, 2e-6);
  const auto columns = cracksByColumn(r.broken, stencil, scene.lattice, scene.horizon, 2 * scene.horizon);
  double fork = 0;
  std::size_t most = 0;
  std::vector<PlanePoint> upper;
  for (const ColumnCracks& c : columns)
  {
    most = std::max(most, c.heights.size());
    if (c.heights.size() >= 2)
    {
      fork = fork > 0 ? fork : c.x;
      upper.push_back({ c.x, c.heights.back() });
    }
  }
  fmt::print("  starts at {:.1f} us, tip at {:.1f} mm in the end; {} cracks abreast, fork at {:.1f} mm",
    tip.empty() ? 0 : 1e6 * tip.front().time, tip.empty() ? 0 : 1e3 * tip.back().position, most, 1e3 * fork);
  if (upper.size() > 2)
    fmt::print(", upper branch at {:.1f} deg", fitLine(upper).angle / degree);
  const double rayleigh = rayleighSpeed(72e9, 1.0 / 3, scene.density);
  fmt::print("\n  fastest tip {:.0f} m/s in 2 us, Rayleigh {:.0f} m/s: {:.2f} of it\n", fastest(speeds), rayleigh,
    fastest(speeds) / rayleigh);
}

void kalthoff(const Keys& keys)
{
  const MovingScene scene = sceneOf("kalthoff", keys);
  const Result r = run(scene, keys);
  const Stencil stencil(2, scene.model.horizon);
  common("kalthoff", scene, r);
  const double rayleigh = rayleighSpeed(191e9, 0.25, scene.density);
  for (int side = 0; side < 2; ++side)
  {
    // From half a centimetre off the notch's tip on: the crack's straight part.
    const std::array<double, 2> tip0 = scene.tips[static_cast<std::size_t>(side)];
    const double sign = side == 0 ? -1 : 1;
    const std::vector<DynamicBreak> crack = where(r, scene, stencil,
      [&](const PlanePoint& p)
      { return sign * (p[1] - tip0[1]) > -1e-3 * scene.lattice.spacing && p[0] > tip0[0] - 0.01; });
    std::vector<PlanePoint> points;
    for (const DynamicBreak& b : crack)
      points.push_back(middleOf(b.bond, stencil, scene.lattice));
    if (points.size() < 10)
    {
      fmt::print("  {} crack: none\n", side == 0 ? "lower" : "upper");
      continue;
    }
    const FittedLine line = fitLine(points);
    std::vector<PlanePoint> start;
    std::copy_if(points.begin(), points.end(), std::back_inserter(start),
      [&](const PlanePoint& p) { return std::hypot(p[0] - tip0[0], p[1] - tip0[1]) < 0.03; });
    const double angle = std::abs(line.angle);
    const PlanePoint direction{ std::cos(angle), sign * std::sin(angle) };
    const std::vector<TipPoint> tip = tipAdvance(crack, stencil, scene.lattice, direction, scene.horizon);
    const std::vector<TipSpeed> speeds = tipSpeeds(tip, 5e-6);
    fmt::print("  {} crack: starts at {:.1f} us, {:.1f} mm long; at {:.1f} deg to the notch ({:.1f} over its first 30 "
               "mm), off that line by {:.2f} mm; fastest {:.0f} m/s, {:.2f} of Rayleigh's {:.0f}\n",
      side == 0 ? "lower" : "upper", 1e6 * tip.front().time, 1e3 * line.length, angle / degree,
      std::abs(fitLine(start).angle) / degree, 1e3 * line.deviation, fastest(speeds), fastest(speeds) / rayleigh,
      rayleigh);
  }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(
    argc, argv,
    [](const Keys& keys)
    {
      const std::string scene = text(keys, "scene", "");
      if (scene.empty() || scene == "branching")
        branching(keys);
      if (scene.empty() || scene == "kalthoff")
        kalthoff(keys);
      if (!scene.empty() && scene != "branching" && scene != "kalthoff")
        sceneOf(scene, keys);
    });
}
