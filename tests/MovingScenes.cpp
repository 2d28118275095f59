#include "MovingScenes.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace lamella::peridynamics
{
namespace
{

void positive(const char* what, double value)
{
  if (!(value > 0) || !std::isfinite(value))
    throw ParameterError(fmt::format("{} of {}", what, value), "give a number above 0");
}

/// Whole nodes; across an axis of symmetry an even number.
MovingScene plate(double horizon, double ratio, double length, double height)
{
  positive("a horizon", horizon);
  positive("a ratio of horizon and spacing", ratio);
  positive("a length", length);
  positive("a height", height);
  MovingScene s;
  const double spacing = horizon / ratio;
  s.lattice = makeLattice(std::llround(length / spacing), 2 * std::llround(height / (2 * spacing)), 1, 2, spacing);
  s.phase.assign(static_cast<std::size_t>(s.lattice.count()), 1);
  s.model.horizon = ratio;
  s.horizon = horizon;
  return s;
}

BondLattice bondsOf(const MovingScene& s, const Communicator& comm)
{
  const Block block = slab(s.lattice, Stencil(s.lattice.dimension, s.model.horizon), comm);
  const std::int64_t layer = s.lattice.count() / s.lattice.size[static_cast<std::size_t>(s.lattice.dimension - 1)];
  const std::int64_t first = layer * block.start[static_cast<std::size_t>(s.lattice.dimension - 1)];
  return BondLattice(s.model, s.lattice,
    std::span(s.phase).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(block.count())), {}, comm);
}

} // namespace

MovingScene branchingPlate(const BranchingPlate& p)
{
  MovingScene s = plate(p.horizon, p.ratio, p.length, p.height);
  positive("a notch", p.notch);
  s.model.continuum = Continuum::PlaneStress;
  s.density = 2440;
  s.duration = p.duration;
  const BondMaterial glass{ .youngsModulus = 72e9, .fractureEnergy = 3.8 };
  const BondMaterial unbreakable{ .youngsModulus = 72e9 };
  s.model.pairs[{ 1, 1 }].material = glass;
  s.model.pairs[{ 1, 2 }].material = unbreakable;
  s.model.pairs[{ 2, 2 }].material = unbreakable;
  const auto rim = static_cast<std::int64_t>(std::ceil(3 * p.ratio));
  const std::int64_t ny = s.lattice.size[1];
  if (ny <= 2 * rim)
    throw ParameterError(fmt::format("a plate of {} layers, of which {} on either side do not break", ny, rim),
      "a higher plate, or a smaller horizon");
  const auto row = static_cast<std::ptrdiff_t>(s.lattice.size[0]);
  std::fill(s.phase.begin(), s.phase.begin() + rim * row, std::uint8_t{ 2 });
  std::fill(s.phase.end() - rim * row, s.phase.end(), std::uint8_t{ 2 });
  const double middle = s.lattice.length(1) / 2;
  s.model.notches.push_back({ { 0, middle, 0 }, { p.notch, 0, 0 }, {} });
  s.tips.push_back({ p.notch, middle });
  s.tractions.push_back({ 1, false, { 0, -p.traction, 0 }, 0 });
  s.tractions.push_back({ 1, true, { 0, p.traction, 0 }, 0 });
  return s;
}

MovingScene kalthoffWinkler(const KalthoffWinkler& p)
{
  constexpr double notch = 0.05;
  constexpr double apart = 0.025; // from the middle
  MovingScene s = plate(p.horizon, p.ratio, 0.1, 0.2);
  s.model.continuum = Continuum::PlaneStrain;
  s.density = 8000;
  s.duration = p.duration;
  s.model.pairs[{ 1, 1 }].material = { .youngsModulus = 191e9, .fractureEnergy = 42408 };
  const double middle = s.lattice.length(1) / 2;
  // Where a notch runs through nodes it gives way to its right: both away from the middle.
  s.model.notches.push_back({ { 0, middle - apart, 0 }, { notch, 0, 0 }, {} });
  s.model.notches.push_back({ { notch, middle + apart, 0 }, { -notch, 0, 0 }, {} });
  for (const double y : { middle - apart, middle + apart })
    s.tips.push_back({ notch, y });
  MovedNodes struck;
  const double depth = (std::floor(p.ratio) - 0.5) * s.lattice.spacing;
  struck.box = nodesBetween(s.lattice, { 0, middle - apart, 0 }, { depth, middle + apart, 0 });
  struck.velocity[0] = p.speed;
  s.moved.push_back(struck);
  return s;
}

SceneInMotion::SceneInMotion(const MovingScene& scene, DynamicsOptions options, const Communicator& comm)
  : bonds_(bondsOf(scene, comm))
{
  ImposedMotion imposed = imposeMotion(bonds_, scene.moved);
  options.density = scene.density;
  const bool goesOn = !options.continueFrom.empty(); // with its velocities and loads
  motion_ = std::make_unique<BondDynamics>(bonds_, std::move(imposed.fixed), std::move(options));
  if (goesOn)
    return;
  motion_->setState(NodeField<double>(bonds_.layout()), imposed.velocity);
  if (!scene.tractions.empty())
    motion_->setLoad(tractionLoad(bonds_, scene.tractions));
}

} // namespace lamella::peridynamics
