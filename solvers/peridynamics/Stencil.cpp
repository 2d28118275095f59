#include "peridynamics/Stencil.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

namespace lamella::peridynamics
{

Stencil::Stencil(int dimension, double horizon)
  : dimension_(dimension)
  , horizon_(horizon)
  , layers_(0)
{
  if (dimension != 2 && dimension != 3)
    throw ParameterError(fmt::format("peridynamics in {} dimensions", dimension), "2 or 3");
  if (!(horizon >= 1 && horizon <= 8))
    throw ParameterError(fmt::format("the horizon is {} spacings", horizon),
      "from 1 to 8; 3 is usual, 2 is strongly anisotropic, and cost grows with its square (cube in 3D)");
  // a horizon of 5 takes (3, 4): lengths are compared as whole numbers where the horizon is one
  const double square = horizon * horizon * (1 + 1e-12);
  layers_ = static_cast<int>(std::floor(std::sqrt(square)));
  const int deep = dimension == 3 ? layers_ : 0;
  for (int z = 0; z <= deep; ++z)
    for (int y = z > 0 ? -layers_ : 0; y <= layers_; ++y)
      for (int x = z > 0 || y > 0 ? -layers_ : 1; x <= layers_; ++x)
      {
        const int sum = x * x + y * y + z * z;
        if (sum <= square)
          half_.push_back({ { x, y, z }, std::sqrt(static_cast<double>(sum)) });
      }
}

Stencil Stencil::weighted(std::span<const double> weights) const
{
  assert(weights.size() == half_.size());
  Stencil result = *this;
  for (std::size_t o = 0; o < half_.size(); ++o)
  {
    assert(weights[o] > 0);
    result.half_[o].weight = weights[o];
  }
  return result;
}

} // namespace lamella::peridynamics
