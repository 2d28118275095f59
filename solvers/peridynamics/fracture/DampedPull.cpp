#include "peridynamics/fracture/DampedPull.h"

#include "lattice/Error.h"
#include "peridynamics/Equilibrium.h"

#include <fmt/format.h>

#include <cmath>
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

} // namespace

double travelTime(double length, double modulus, double density) noexcept
{
  return length / std::sqrt(modulus / density);
}

DampedPullRecord pullApart(BondLattice& bonds, const Loading& loading, const DampedPullOptions& options)
{
  if (loading.load != LoadCase::Stretch && loading.load != LoadCase::Shear)
    throw ParameterError("a damped pull by a load that is neither stretch nor shear", "choose one of these");
  if (!(options.strainRate > 0) || !std::isfinite(options.strainRate))
    throw ParameterError(fmt::format("a strain rate of {} 1/s", options.strainRate), "give a number above 0");
  if (!(options.startStrain >= 0) || !std::isfinite(options.startStrain))
    throw ParameterError(fmt::format("a strain of {} to start at", options.startStrain), "give 0 or more");
  if (options.every < 1)
    throw ParameterError(fmt::format("a point of the curve every {} steps", options.every), "give 1 or more");

  Loading unit = loading;
  unit.strain = loading.strain < 0 ? -1 : 1;
  LoadedSample sample = applyLoading(bonds, unit);
  DynamicsOptions o;
  o.density = options.density;
  o.safety = options.safety;
  o.damping = options.damping;
  o.rate = options.rate;
  o.progress = options.progress;
  const int axis = loading.axis < 0 ? bonds.dimension() - 1 : loading.axis;
  const int along = loading.load == LoadCase::Shear ? (axis + 1) % bonds.dimension() : axis;
  const NodeLayout& l = bonds.layout();
  double area = 1;
  for (int a = 0; a < l.dimension; ++a)
    area *= a == axis ? 1 : bonds.spacing() * static_cast<double>(l.global[static_cast<std::size_t>(a)]);

  NodeField<double> u = sample.displacement;
  Equilibrium(bonds, sample.fixed).solve(u);
  NodeField<double> v = u;
  const std::array<double, 3> centre = centreOf(bonds, sample);
  for (int c = 0; c < l.dimension; ++c)
    for (std::int64_t i = 0; i < l.count(); ++i)
    {
      v.component(c)[i] =
        bonds.solid(i) ? options.strainRate * (u.component(c)[i] - centre[static_cast<std::size_t>(c)]) : 0;
      u.component(c)[i] *= options.startStrain;
    }
  BondDynamics motion(bonds, sample.fixed, std::move(o));
  motion.setState(u, v);

  DampedPullRecord r;
  r.startVelocity = std::move(v);
  r.step = motion.step();
  r.viscosity = motion.viscosity();
  double strain = options.startStrain;
  while (r.end == FractureEnd::Running)
  {
    const bool goesOn = motion.advance(options.every);
    strain += static_cast<double>(options.every) * motion.step() * options.strainRate * motion.rate();
    const Reactions forces = reactions(bonds, sample, motion.displacement(), axis, true);
    const auto a = static_cast<std::size_t>(along);
    const double stress = unit.strain * (forces.low[a] - forces.high[a]) / (2 * area);
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
