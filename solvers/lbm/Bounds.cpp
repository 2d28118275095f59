#include "lbm/Bounds.h"

#include <algorithm>
#include <limits>

namespace lamella::lbm
{
namespace
{

// [Σ fᵢ / (kᵢ + (d-1) k₀)]⁻¹ - (d-1) k₀: the bound for a comparison medium k₀, the least or the greatest kᵢ.
double hashinShtrikman(std::span<const double> f, std::span<const double> k, double k0, int dimension)
{
  const double shift = (dimension - 1) * k0;
  double sum = 0;
  for (std::size_t i = 0; i < f.size(); ++i)
  {
    if (f[i] == 0)
      continue;
    if (k[i] + shift == 0)
      return 0;
    sum += f[i] / (k[i] + shift);
  }
  return sum > 0 ? 1 / sum - shift : 0;
}

} // namespace

Bounds bounds(std::span<const double> fractions, std::span<const double> conductivities, int dimension)
{
  double least = std::numeric_limits<double>::max();
  double greatest = 0;
  Bounds b;
  for (std::size_t i = 0; i < fractions.size(); ++i)
  {
    if (fractions[i] == 0)
      continue;
    least = std::min(least, conductivities[i]);
    greatest = std::max(greatest, conductivities[i]);
    b.parallel += fractions[i] * conductivities[i];
  }
  b.series = hashinShtrikman(fractions, conductivities, 0.0, dimension);
  b.hashinShtrikmanLower = hashinShtrikman(fractions, conductivities, least, dimension);
  b.hashinShtrikmanUpper = hashinShtrikman(fractions, conductivities, greatest, dimension);
  return b;
}

} // namespace lamella::lbm
