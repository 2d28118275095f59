#include "lbm/stepping/Accuracy.h"

#include "lbm/stepping/Impl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamella::lbm
{

std::string singleRateWarning(double relaxation, std::span<const Chord> chords)
{
  constexpr double accurate = 1.0;
  constexpr double thin = 0.03;
  const double tau = relaxation + 0.5;
  if (tau > accurate * (1 + 1e-12))
  {
    const double beyond = tau - accurate;
    const double chord = chords.front().length;
    return fmt::format(
      "bgk is accurate up to a relaxation time of 1, and that of the phase that conducts best is {:.4g}: "
      "expect an effective value about {:.0f} % too low in pieces of that phase {:.1f} spacings long; use "
      "trt, whose answer does not depend on it, or a time step {:.3g} times smaller",
      tau, 100 * beyond / (chord + beyond), chord, relaxation / (accurate - 0.5));
  }
  if (chords.size() == 1)
    return {};
  const auto gain = [&](const Chord& c)
  { return c.diffusivity > 0 ? (accurate - 0.5 - relaxation * c.diffusivity) / c.length : 0.0; };
  const Chord& worst =
    *std::max_element(chords.begin(), chords.end(), [&](const Chord& a, const Chord& b) { return gain(a) < gain(b); });
  if (gain(worst) <= thin)
    return {};
  return fmt::format(
    "bgk has interfaces in their places at a relaxation time of 1, and that of a phase whose pieces are "
    "{:.1f} spacings long is {:.4g}: expect an effective value up to about {:.0f} % too high; use trt, "
    "whose answer does not depend on it, or more nodes across the pieces",
    worst.length, 0.5 + relaxation * worst.diffusivity, 100 * gain(worst));
}

// With a large time step diffusion becomes a wave that is damped: κ ∂q/∂t + q/D = −grad u, κ the same everywhere. The
// slowest mode of a homogeneous box of n nodes fades soonest, by e^(−π/(√3 n)) a step, where it just does not oscillate
// any more, at Λ = √3 n/(2π). Elsewhere q/D averages to the flux over the effective diffusivity, and faster modes see
// less of it: measured, half of that is best in tissue.
double LatticeBoltzmann::Impl::restRelaxation(double effective) const
{
  constexpr double share = 0.5;
  return share * std::numbers::sqrt3 * static_cast<double>(lattice.size[options.axis]) / (2 * std::numbers::pi) *
    largest / effective;
}

} // namespace lamella::lbm
