#include "peridynamics/fracture/DampedPull.h"

#include "core/Error.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/Equilibrium.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

namespace lamella::peridynamics
{
namespace
{

/// Mean displacement of what is held, by component: where the middle is.
std::array<double, 3> centreOf(const BondLattice& bonds, const LoadedSample& sample)
{
  const NodeLayout& l = bonds.layout();
  std::array<double, 6> sums{};
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        for (int c = 0; c < l.dimension; ++c)
          if (bonds.solid(i) && ((sample.fixed[i] >> c) & 1U) != 0)
          {
            sums[static_cast<std::size_t>(c)] += sample.displacement.component(c)[i];
            sums[static_cast<std::size_t>(c) + 3] += 1;
          }
  bonds.communicator().sum(sums);
  std::array<double, 3> centre{};
  for (std::size_t c = 0; c < 3; ++c)
    centre[c] = sums[c + 3] > 0 ? sums[c] / sums[c + 3] : 0;
  return centre;
}

/// A strain of one, in the direction that is asked for.
Loading unitOf(const Loading& loading)
{
  if (loading.load != LoadCase::Stretch && loading.load != LoadCase::Shear)
    throw ParameterError("a damped pull by a load that is neither stretch nor shear", "choose one of these");
  Loading unit = loading;
  unit.strain = loading.strain < 0 ? -1 : 1;
  return unit;
}

} // namespace

double travelTime(double length, double modulus, double density) noexcept
{
  return length / std::sqrt(modulus / density);
}

SlowPull::SlowPull(const BondLattice& bonds, const Loading& loading, std::function<bool(double)> progress)
  : bonds_(bonds)
  , loading_(unitOf(loading))
  , axis_(loading.axis < 0 ? bonds.dimension() - 1 : loading.axis)
  , along_(loading.load == LoadCase::Shear ? (axis_ + 1) % bonds.dimension() : axis_)
  , sample_(applyLoading(bonds, loading_))
  , force_(bonds, loading_, sample_)
  , unit_(sample_.displacement)
{
  EquilibriumOptions o;
  o.progress = std::move(progress);
  Equilibrium(bonds, sample_.fixed, o).solve(unit_);
  bonds.exchange(unit_);
  centre_ = centreOf(bonds, sample_);
  NodeField<double> force(bonds.layout());
  linearForce(bonds, unit_, force);
  modulus_ = stress(force);
  const double ratio = largestStretch(bonds, unit_, false).ratio;
  firstBreak_ = ratio > 0 ? 1 / ratio : std::numeric_limits<double>::infinity();
}

NodeField<double> SlowPull::displacement(double strain) const
{
  NodeField<double> u = unit_;
  for (int c = 0; c < u.components(); ++c)
    for (std::int64_t i = 0; i < u.layout().count(); ++i)
      u.component(c)[i] *= strain;
  return u;
}

NodeField<double> SlowPull::velocity(double strainRate) const
{
  NodeField<double> v(unit_.layout());
  for (int c = 0; c < v.components(); ++c)
    for (std::int64_t i = 0; i < v.layout().count(); ++i)
      if (bonds_.solid(i))
        v.component(c)[i] = strainRate * (unit_.component(c)[i] - centre_[static_cast<std::size_t>(c)]);
  return v;
}

DampedPullRecord pullApart(BondLattice& bonds, const Loading& loading, const DampedPullOptions& options)
{
  if (!(options.strainRate > 0) || !std::isfinite(options.strainRate))
    throw ParameterError(fmt::format("a strain rate of {} 1/s", options.strainRate), "give a number above 0");
  if (!(options.startStrain >= 0) || !std::isfinite(options.startStrain))
    throw ParameterError(fmt::format("a strain of {} to start at", options.startStrain), "give 0 or more");
  if (options.every < 1)
    throw ParameterError(fmt::format("a point of the curve every {} steps", options.every), "give 1 or more");

  const SlowPull pull(bonds, loading);
  DynamicsOptions o;
  o.density = options.density;
  o.safety = options.safety;
  o.damping = options.damping;
  o.rate = options.rate;
  o.progress = options.progress;
  DampedPullRecord r;
  r.startVelocity = pull.velocity(options.strainRate);
  BondDynamics motion(bonds, pull.sample().fixed, std::move(o));
  motion.setState(pull.displacement(options.startStrain), r.startVelocity);
  r.step = motion.step();
  r.viscosity = motion.viscosity();
  double strain = options.startStrain;
  while (r.end == FractureEnd::Running)
  {
    const std::int64_t before = motion.steps();
    const bool goesOn = motion.advance(options.every);
    strain += static_cast<double>(motion.steps() - before) * motion.step() * options.strainRate * motion.rate();
    const double stress = pull.stress(motion.force());
    r.curve.push_back({ strain, stress, static_cast<std::int64_t>(motion.broken().size()) });
    if (stress > r.peak.stress)
    {
      r.peak = r.curve.back();
      const EnergyBalance e = motion.energies();
      r.kineticShare = e.elastic > 0 ? e.kinetic / e.elastic : 0;
    }
    if (!goesOn)
      r.end = FractureEnd::Interrupted;
    else if (r.peak.stress > 0 && !motion.broken().empty() && stress < options.stopShare * r.peak.stress)
      r.end = FractureEnd::StressFell;
    else if (strain >= options.maxStrain)
      r.end = FractureEnd::MaxStrain;
  }
  r.broken = motion.broken();
  r.steps = motion.steps();
  r.energies = motion.energies();
  return r;
}

} // namespace lamella::peridynamics
