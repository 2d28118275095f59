#include "lbm/Shares.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::lbm
{

AcrossSurface ruleFor(bool betterPercolates) noexcept
{
  return betterPercolates ? AcrossSurface::Parallel : AcrossSurface::Series;
}

PairTable shareLinks(std::span<const double> share, double first, double second, AcrossSurface rule)
{
  for (const double k : { first, second })
    if (!std::isfinite(k) || k < 0)
      throw ParameterError(fmt::format("conductivity {} is not a finite number of at least 0", k),
        "give a positive value, or 0 for a phase that does not conduct");
  PairTable table;
  table.ids = share.size();
  table.link.resize(table.ids * table.ids);
  for (std::size_t i = 0; i < table.ids; ++i)
  {
    if (!(share[i] >= 0 && share[i] <= 1))
      throw ParameterError(
        fmt::format("share {} of id {} is outside 0 to 1", share[i], i), "give the part of a node in the second phase");
    for (std::size_t j = 0; j <= i; ++j)
    {
      double g = 0;
      if (rule == AcrossSurface::Parallel)
      {
        const double s = 0.5 * (share[i] + share[j]);
        g = s * second + (1 - s) * first;
      }
      else
      {
        const double s = std::clamp(share[i] + share[j] - 0.5, 0.0, 1.0);
        const double resistance = (s > 0 ? s / second : 0) + (s < 1 ? (1 - s) / first : 0);
        g = std::isfinite(resistance) ? 1 / resistance : 0;
      }
      table.link[i * table.ids + j] = table.link[j * table.ids + i] = g;
    }
  }
  return table;
}

} // namespace lamella::lbm
