#include "pores/PoreLabelling.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace lamella::pores
{

std::vector<SizeClass> sizeDistribution(std::span<const Pore> pores)
{
  if (pores.empty())
    return {};
  const auto classOf = [](std::int64_t size)
  { return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(size))) - 1; };
  const auto [smallest, largest] =
    std::minmax_element(pores.begin(), pores.end(), [](const Pore& a, const Pore& b) { return a.size < b.size; });
  const int lowest = classOf(smallest->size);
  std::vector<SizeClass> classes;
  for (int k = lowest; k <= classOf(largest->size); ++k)
    classes.push_back({ std::int64_t{ 1 } << k, 2 * (std::int64_t{ 1 } << k) - 1, 0, 0 });
  for (const Pore& pore : pores)
  {
    SizeClass& c = classes[static_cast<std::size_t>(classOf(pore.size) - lowest)];
    ++c.count;
    c.nodes += pore.size;
  }
  return classes;
}

double equivalentDiameter(double size, double spacing, int dimension) noexcept
{
  return dimension == 3 ? spacing * std::cbrt(6 * size / std::numbers::pi)
                        : spacing * 2 * std::sqrt(size / std::numbers::pi);
}

} // namespace lamella::pores
