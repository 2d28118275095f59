#include "lbm/stepping/Accuracy.h"

#include "lbm/stepping/Impl.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace lamella::lbm
{

std::string singleRateWarning(double tau, double chord)
{
  constexpr double accurate = 1.0;
  if (tau <= accurate * (1 + 1e-12))
    return {};
  const double beyond = tau - accurate;
  return fmt::format(
    "bgk is accurate up to a relaxation time of 1, and that of the phase that conducts best is {:.4g}: "
    "expect an effective value about {:.0f} % too low in pieces of that phase {:.1f} spacings long; use "
    "trt, whose answer does not depend on it, or a time step {:.3g} times smaller",
    tau, 100 * beyond / (chord + beyond), chord, (tau - 0.5) / (accurate - 0.5));
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
