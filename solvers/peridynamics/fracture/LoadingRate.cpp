#include "peridynamics/fracture/LoadingRate.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{

RegulatedRate::RegulatedRate(double relaxation, double reference, double start)
  : relaxation_(relaxation)
  , reference_(reference)
  , rate_(start)
{
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  if (!positive(relaxation))
    throw ParameterError(fmt::format("a relaxation time of {} s", relaxation), "give a time above 0");
  if (!positive(reference))
    throw ParameterError(fmt::format("a reference energy of {} for the loading rate", reference),
      "give the energy of a short crack: fracture energy times a hundredth of the sample's size");
  if (!(start >= 0 && start <= 1))
    throw ParameterError(fmt::format("a loading rate that starts at {} of the imposed one", start), "give 0 to 1");
}

void RegulatedRate::advance(double step, double brokenEnergy)
{
  damage_ += brokenEnergy;
  const int parts = std::max(1, static_cast<int>(std::ceil(100 * step / relaxation_)));
  const double kept = std::exp(-step / parts / relaxation_);
  const double half = std::sqrt(kept);
  for (int i = 0; i < parts; ++i)
  {
    // The middle of the part stands for ω in the exponential: of second order.
    rate_ = rate_ * kept + std::exp(-damage_ * half / reference_) * (1 - kept);
    damage_ *= kept;
  }
}

} // namespace lamella::peridynamics
