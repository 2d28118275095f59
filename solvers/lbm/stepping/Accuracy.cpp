#include "lbm/stepping/Accuracy.h"

#include "lbm/stepping/Impl.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace lamella::lbm
{

std::string singleRateWarning(double tau)
{
  if (tau <= 1.0)
    return {};
  return fmt::format("tau {}", tau);
}

double LatticeBoltzmann::Impl::restRelaxation(std::span<const std::uint8_t> phase) const
{
  std::array<double, 2> sums{};
  for (const std::uint8_t id : phase)
    if (diffusivity[id] > 0)
    {
      sums[0] += diffusivity[id];
      sums[1] += 1;
    }
  comm.sum(sums);
  const double mean = sums[0] / sums[1];
  return std::numbers::sqrt3 * static_cast<double>(lattice.size[options.axis]) / (2 * std::numbers::pi) * largest / mean;
}

} // namespace lamella::lbm
