#include "packing/Grading.h"

#include "core/Error.h"
#include "core/Plausible.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <string>

namespace lamella::packing
{

std::vector<double> diameters(const PackingOptions& o)
{
  const auto n = static_cast<std::size_t>(o.count);
  const double dim = o.dimension;
  std::vector<double> d(n);
  for (std::size_t i = 0; i < n; ++i)
  {
    const double q = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    const double k = o.diameterRatio;
    if (o.sizes == Sizes::Diameter)
      d[i] = 1 + (k - 1) * q;
    else if (o.sizes == Sizes::Volume)
      d[i] = std::pow(1 + (std::pow(k, dim) - 1) * q, 1 / dim);
    else // number density ~ d^-dim
      d[i] = dim == 2 ? 1 / (1 - q * (1 - 1 / k)) : 1 / std::sqrt(1 - q * (1 - 1 / (k * k)));
  }
  const double mean = std::accumulate(d.begin(), d.end(), 0.0) / static_cast<double>(n);
  for (double& value : d)
    value /= mean;
  return d;
}

void check(const PackingOptions& o)
{
  const auto refuse = [](const std::string& what, const std::string& remedy) { throw ParameterError(what, remedy); };
  const auto positive = [&](double value, const char* what)
  {
    if (!(value > 0 && plausible(value)))
      refuse(fmt::format("{} is {:g}", what, value), "it must be a positive number, between 1e-30 and 1e30");
  };
  if (o.dimension != 2 && o.dimension != 3)
    refuse(fmt::format("grains in {} dimensions", o.dimension), "2: disks, 3: spheres");
  const std::int64_t fewest = o.dimension == 2 ? 10 : 30;
  if (o.count < fewest || o.count > 10'000'000)
    refuse(fmt::format("{} grains", o.count), fmt::format("{} to 10000000 grains can be packed", fewest));
  positive(o.meanDiameter, "the mean diameter");
  if (!(o.diameterRatio >= 1 && o.diameterRatio <= 10))
    refuse(fmt::format("the ratio of the diameters is {}", o.diameterRatio),
      "it is that of the largest to the smallest, from 1 to 10");
  if (!(o.aspect >= 0.2 && o.aspect <= 5))
    refuse(fmt::format("the aspect is {}", o.aspect), "it is that of the box's last edge to its first, from 0.2 to 5");
  if (!(o.friction >= 0 && o.friction <= 2))
    refuse(fmt::format("the friction coefficient is {}", o.friction), "from 0 (none) to 2");
  positive(o.pressure, "the pressure");
  if (!(o.softness >= 1e-7 && o.softness <= 1e-2))
    refuse(fmt::format("the softness is {}", o.softness), "from 1e-7 (hard) to 1e-2 (overlaps of a hundredth)");
  if (!(o.tolerance >= 1e-8 && o.tolerance <= 1e-2))
    refuse(fmt::format("the tolerance is {}", o.tolerance), "from 1e-8 to 1e-2");
  if (o.packingFraction && !(*o.packingFraction >= 0.05 && *o.packingFraction < 1))
    refuse(fmt::format("the packing fraction is {}", *o.packingFraction),
      "from 0.05 to below jamming, about 0.8 for disks "
      "and 0.6 for spheres");
}

} // namespace lamella::packing
