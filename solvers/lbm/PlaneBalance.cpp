#include "lbm/PlaneBalance.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <cstddef>

namespace lamella::lbm
{

PlaneBalance::PlaneBalance(const PlaneSums& sums, double fieldEnergy, bool periodic, bool onFaces)
{
  const std::size_t planes = sums.conductance.size();
  const std::size_t layers = periodic ? planes : planes - 1;
  // fall of the linear profile in a plane; a face lies half a spacing from its layer
  const auto linear = [&](std::size_t i)
  {
    const bool half = !periodic && !onFaces && (i == 0 || i == layers);
    return (half ? 0.5 : 1.0) / static_cast<double>(onFaces ? planes : layers);
  };

  // v = u − linear profile, its plane fluxes F and energy
  std::vector<double> flux(planes);
  double energyOfV = fieldEnergy;
  double energyOfLinear = 0;
  double s1 = 0; // Σ 1/C
  double s2 = 0; // Σ F/C
  double s3 = 0; // Σ F²/C
  for (std::size_t i = 0; i < planes; ++i)
  {
    const double c = sums.conductance[i];
    const double fall = linear(i);
    flux[i] = sums.flux[i] - c * fall;
    energyOfV += fall * (c * fall - 2 * sums.flux[i]);
    energyOfLinear += c * fall * fall;
    s1 += 1 / c;
    s2 += flux[i] / c;
    s3 += flux[i] * flux[i] / c;
  }
  // Plane i: C_i Δg_i + θ F_i = Q with Σ Δg = 1; along v: Σ F_i Δg_i + θ a(v, v) = 0.
  const double beyondPlanes = energyOfV - s3; // of the part of v that no profile can replace
  if (beyondPlanes > 1e-13 * energyOfLinear)
  {
    energy = 1 / (s1 + s2 * s2 / beyondPlanes);
    factor = -energy * s2 / beyondPlanes;
  }
  else
  {
    energy = 1 / s1;
    factor = 0;
  }
  shift.resize(layers);
  double ahead = 0; // g less θ times the linear profile, from the face of value 1 on
  if (!periodic)
    ahead = 1 - factor;
  for (std::size_t i = 0; i < layers; ++i)
  {
    const double fall = (energy - factor * flux[i]) / sums.conductance[i];
    // a periodic field is what is left without the linear profile, and its constant is free
    ahead -= fall - (periodic ? 1.0 : factor) * linear(i);
    shift[i] = ahead;
  }
}

FieldSums PlaneBalance::of(const FieldSums& sums, const PlaneSums& planes) const
{
  const std::size_t layers = shift.size();
  const bool periodic = planes.conductance.size() == layers;
  const double n = static_cast<double>(layers);
  // the profile that takes the place of the linear one behind so many layers
  const auto profile = [&](std::size_t behind)
  {
    if (behind == 0)
      return 1.0;
    return behind > layers ? 0.0 : shift[behind - 1] + factor * (1 - (static_cast<double>(behind) - 0.5) / n);
  };
  const auto through = [&](std::size_t i)
  {
    const bool face = !periodic && (i == 0 || i == layers);
    const double linear = (face ? 0.5 : 1.0) / n;
    const double drop = periodic ? shift[(i + layers - 1) % layers] - shift[i] + linear : profile(i) - profile(i + 1);
    return factor * (planes.flux[i] - planes.conductance[i] * linear) + planes.conductance[i] * drop;
  };
  FieldSums all = sums;
  all.energy = energy;
  all.inlet = through(0);
  all.outlet = through(periodic ? layers / 2 : layers);
  for (double& q : all.flux)
    q *= factor; // shifts drive nothing across
  return all;
}

void PlaneBalance::requireGain(double before, double after)
{
  if (!(after <= before * (1 + loosest)))
    throw DivergenceError(
      fmt::format("the flux is round-off: the planes of nodes say {:.1e} times as much as the field", after / before),
      beyondDouble);
}

} // namespace lamella::lbm
