#include "peridynamics/fracture/SurfaceStrength.h"

#include "core/Error.h"
#include "lattice/LabelShares.h"
#include "lattice/SubWindows.h"
#include "lattice/SurfaceMotions.h"
#include "peridynamics/BondLattice.h"
#include "peridynamics/fracture/WindowStrength.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace lamella::peridynamics
{
namespace
{

constexpr double mostStep = 1.0 / 3;
constexpr double leastLeft = 0.1; // of a bond: a speck loses more than it has
constexpr int levelsAPixel = 2;   // gains are told in halves

/// What the voxel of every node gains where the solid grows by one, in halves; 0 in voids. @param solid 0 or 1
template <int D>
std::vector<int> gains(const Lattice& lattice, std::span<const std::uint8_t> solid, const std::array<bool, 3>& periodic)
{
  std::array<std::int64_t, D> size{};
  std::array<double, D> edge{};
  std::array<bool, D> wraps{};
  for (std::size_t a = 0; a < D; ++a)
  {
    size[a] = lattice.size[a];
    wraps[a] = periodic[a];
  }
  const SurfaceMotions<D> surfaces(solid, size, edge, wraps);
  std::vector<int> gain(solid.size(), 0);
  std::vector<typename SurfaceMotions<D>::Motion> motions;
  for (std::size_t i = 0; i < solid.size(); ++i)
  {
    const auto n = static_cast<std::int64_t>(i);
    typename SurfaceMotions<D>::Place place{};
    place[0] = n % lattice.size[0];
    place[1] = n / lattice.size[0] % lattice.size[1];
    if constexpr (D == 3)
      place[2] = n / (lattice.size[0] * lattice.size[1]);
    if (solid[i] == 0 || surfaces.alone(place))
      continue;
    surfaces.motions(place, motions);
    double growth = 0; // the motions are those of the voids
    for (const auto& motion : motions)
      growth -= motion.gradient.trace();
    gain[i] = std::max(0, static_cast<int>(std::lround(levelsAPixel * growth)));
  }
  return gain;
}

/// The nodes of a sample, each of a phase and of a grain.
struct Nodes
{
  std::vector<std::uint8_t> phase;
  std::vector<std::int32_t> grain; ///< or empty
};

/// Where the smooth surface through the labels (lattice/LabelShares.h) lies within the step of the middle of a node
/// that it would pass, the node changes sides: into a solid that is next to it, or into a void.
/// @param shares of the solid  @param step outwards, or inwards where negative
Nodes passed(const Lattice& lattice, Nodes nodes, std::span<const std::uint8_t> solid,
  std::span<const std::uint8_t> shares, std::uint8_t empty, double step)
{
  const Nodes before = nodes;
  const double least = (0.5 - step) * (shareLevels - 1); // that a node must hold to be solid
  for (std::size_t i = 0; i < solid.size(); ++i)
  {
    const bool holds = shares[i] >= least;
    if (step < 0 && solid[i] != 0 && !holds)
      nodes.phase[i] = empty;
    if (!(step > 0) || solid[i] != 0 || !holds)
      continue;
    const auto n = static_cast<std::int64_t>(i);
    std::array<std::int64_t, 3> place{ n % lattice.size[0], n / lattice.size[0] % lattice.size[1],
      n / (lattice.size[0] * lattice.size[1]) };
    for (int side = 0; side < 2 * lattice.dimension; ++side)
    {
      const auto axis = static_cast<std::size_t>(side / 2);
      const std::int64_t at = place[axis] + (side % 2 == 0 ? -1 : 1);
      if (at < 0 || at >= lattice.size[axis])
        continue;
      std::array<std::int64_t, 3> next = place;
      next[axis] = at;
      const auto j = static_cast<std::size_t>(lattice.index(next[0], next[1], next[2]));
      if (solid[j] == 0)
        continue;
      nodes.phase[i] = before.phase[j];
      if (!nodes.grain.empty())
        nodes.grain[i] = before.grain[j];
      break;
    }
  }
  return nodes;
}

/// Energy of a node in a flat surface over that of one inside, under a strain along the surface.
double energyInSurface(const BondModel& model)
{
  if (model.surfaceCorrection)
    return 1;
  const Stencil stencil = bondStencil(model);
  double inside = 0;
  double all = 0;
  for (const Offset& o : stencil.half())
  {
    const double energy = o.weight * std::pow(o.step[1], 4) / std::pow(o.length, 3);
    all += 2 * energy;
    inside += o.step[0] == 0 ? 2 * energy : energy; // of each bond and its mirror image one leads out
  }
  return inside / all;
}

/// A sample whose nodes are of so many phases more.
struct Regrown
{
  BondModel model;
  std::vector<std::uint8_t> phase;
};

/// @param step by which the solid grows, or shrinks where negative
Regrown regrown(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const int> gain, double step)
{
  Regrown s{ model, std::vector<std::uint8_t>(phase.size(), 0) };
  std::map<std::pair<std::uint8_t, int>, std::uint8_t> ids; // of a phase and what it gains
  const auto isVoid = [&](std::uint8_t id)
  { return std::find(model.voids.begin(), model.voids.end(), id) != model.voids.end(); };
  for (std::size_t i = 0; i < phase.size(); ++i)
  {
    if (isVoid(phase[i]))
      continue;
    const auto next = static_cast<std::uint8_t>(ids.size() + 1);
    const auto [found, fresh] = ids.try_emplace({ phase[i], gain[i] }, next);
    if (fresh && ids.size() > 255)
      throw ParameterError("surfaces of more than 255 kinds of nodes", "take phases of one material together");
    s.phase[i] = found->second;
  }
  s.model.voids = { 0 };
  s.model.phaseNames.clear();
  s.model.pairs.clear();
  const Stencil stencil(lattice.dimension, model.horizon);
  const double perGain = step / levelsAPixel / 2 / energyInSurface(model);
  for (const auto& [a, first] : ids)
    for (const auto& [b, second] : ids)
    {
      const auto pair = model.pairs.find({ std::min(a.first, b.first), std::max(a.first, b.first) });
      if (first > second || pair == model.pairs.end())
        continue;
      const auto changed = [&](const BondMaterial& material)
      {
        const double s0 =
          bondConstants(material, stencil, lattice.spacing, model.continuum, model.micromodulus, "a pair")
            .criticalStretch;
        const double left = std::max(leastLeft, 1 + perGain * (a.second + b.second));
        BondMaterial other{ .youngsModulus = material.youngsModulus * left };
        if (std::isfinite(s0))
          other.criticalStretch = s0;
        return other;
      };
      PhasePair& to = s.model.pairs[{ first, second }];
      to.material = changed(pair->second.material);
      if (pair->second.betweenGrains)
        to.betweenGrains = changed(*pair->second.betweenGrains);
    }
  return s;
}

} // namespace

SurfaceStrengths surfaceStrengths(const BondModel& model, const Lattice& lattice, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const FractureStudyOptions& options, double doubt, const Communicator& comm)
{
  std::array<bool, 256> isVoid{};
  for (const std::uint8_t id : model.voids)
    isVoid[id] = true;
  const auto solidOf = [&](std::span<const std::uint8_t> ids)
  {
    std::vector<std::uint8_t> solid(ids.size());
    std::ranges::transform(
      ids, solid.begin(), [&](std::uint8_t id) { return static_cast<std::uint8_t>(isVoid[id] ? 0 : 1); });
    return solid;
  };
  const std::vector<std::uint8_t> solid = solidOf(phase);
  const auto bare = std::ranges::find(solid, std::uint8_t{ 0 });
  if (bare == solid.end())
    throw ParameterError("a segmentation error of a strength without a surface between solid and void",
      "surfaces between two solids are not moved: leave it out");
  const std::uint8_t empty = phase[static_cast<std::size_t>(bare - solid.begin())];
  const std::vector<std::uint8_t> shares = labelShares(lattice, solid, 1, model.periodic, options.threads);
  SurfaceStrengths found{ std::min(doubt, mostStep) };
  FractureStudyOptions own = toThePeak(options);
  const Block slabOf = slab(lattice, Stencil(lattice.dimension, model.horizon), comm);
  const SubWindow mine{ slabOf.start, slabOf.size };
  double done = 0;
  own.fracture.progress = [&](const FractureProgress& p)
  {
    if (!options.fracture.progress)
      return false;
    FractureProgress told = p;
    told.share = (done + p.share) / 2;
    return options.fracture.progress(told);
  };
  const Nodes asFound{ { phase.begin(), phase.end() }, { grain.begin(), grain.end() } };
  for (const auto& [step, peak] : { std::pair{ found.step, &found.grown }, { -found.step, &found.shrunk } })
  {
    const Nodes nodes = passed(lattice, asFound, solid, shares, empty, step);
    const std::vector<std::uint8_t> now = solidOf(nodes.phase);
    const Regrown moved = regrown(model, lattice, nodes.phase,
      lattice.dimension == 3 ? gains<3>(lattice, now, model.periodic) : gains<2>(lattice, now, model.periodic), step);
    try
    {
      const std::vector<std::int32_t> grains =
        nodes.grain.empty() ? std::vector<std::int32_t>{} : cut<std::int32_t>(lattice, nodes.grain, mine);
      *peak = studyFracture(moved.model, lattice, cut<std::uint8_t>(lattice, moved.phase, mine), grains, own, comm)
                .peak.stress;
    }
    catch (const NoPathError&)
    {
      *peak = 0;
    }
    catch (const InputError&)
    {
      *peak = 0; // but hinges
    }
    done += 1;
  }
  return found;
}

double strengthDoubt(double peak, const SurfaceStrengths& moved, double doubt) noexcept
{
  return weakestPlace * doubt / moved.step * std::max(std::abs(moved.grown - peak), std::abs(moved.shrunk - peak));
}

} // namespace lamella::peridynamics
