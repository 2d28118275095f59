#include "lattice/SpacingError.h"

#include <algorithm>
#include <cmath>

namespace lamella
{
namespace
{

constexpr double certainty = 1.5;
constexpr double leastMixed = 0.02;

} // namespace

SpacingError spacingError(double fine, double coarse, std::optional<double> coarser)
{
  const double change = fine - coarse;
  const double before = coarser ? coarse - *coarser : 0.0;
  const double ratio = coarser && change != 0 ? std::clamp(before / change, 2.0, 4.0) : 2.0;
  return { fine + change * (5 - ratio) / 3, certainty * std::max(std::abs(change), std::abs(before) / 3) };
}

double mixedPart(std::span<const std::uint8_t> ids, std::span<const double> shares)
{
  const auto count =
    std::ranges::count_if(ids, [&](std::uint8_t id) { return shares[id] > leastMixed && shares[id] < 1 - leastMixed; });
  return static_cast<double>(count) / static_cast<double>(ids.size());
}

} // namespace lamella
