#include "lbm/Links.h"

#include <algorithm>
#include <cmath>

namespace lamella::lbm
{

Links::Links(const Lattice& lattice, Stencil stencil, std::array<Boundary, 3> boundary,
  std::span<const double> diffusivity, const LinkTable* table, const PairTable* pairs)
  : dimension_(lattice.dimension)
  , byAxis_(pairs != nullptr && pairs->link.size() > pairs->ids * pairs->ids)
  , size_(lattice.size)
  , boundary_(boundary)
  , phases_(diffusivity.size())
  , diffusivity_(diffusivity.begin(), diffusivity.end())
{
  for (std::size_t a = 0; a < 3; ++a)
    factor_[a] = std::pow(lattice.aspect[0] / lattice.aspect[a], 2);
  if (stencil == Stencil::D2Q9)
    straight_ = 2.0 / 3.0;
  else if (stencil == Stencil::D3Q19)
    straight_ = 1.0 / 3.0;
  if (stencil == Stencil::D2Q9 || stencil == Stencil::D3Q19)
    diagonal_ = 1.0 / 6.0;

  const int reach = dimension_ == 3 ? 1 : 0;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
      {
        const Direction d{ x, y, z };
        if (d.axes() == 0 || d.axes() > (diagonal_ != 0.0 ? 2 : 1))
          continue;
        all_.push_back(d);
        if (z > 0 || (z == 0 && (y > 0 || (y == 0 && x > 0))))
          forward_.push_back(d);
      }

  scale_ = *std::max_element(diffusivity_.begin(), diffusivity_.end());
  if (table != nullptr)
  {
    given_ = *table;
    for (auto* values : { &given_.x, &given_.y, &given_.rising, &given_.falling })
      for (double& g : *values)
        g /= scale_;
  }
  if (scale_ > 0.0)
    for (double& d : diffusivity_)
      d /= scale_;
  if (pairs != nullptr)
  {
    table_ = pairs->link;
    for (double& g : table_)
      g /= scale_;
    return;
  }
  table_.resize(phases_ * phases_);
  for (std::size_t a = 0; a < phases_; ++a)
    for (std::size_t b = 0; b < phases_; ++b)
      table_[a * phases_ + b] = harmonicMean(diffusivity_[a], diffusivity_[b]);
}

} // namespace lamella::lbm
