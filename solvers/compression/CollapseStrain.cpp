#include "compression/CollapseStrain.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace lamella::compression
{

CollapseStrain::CollapseStrain(std::size_t lumens, double share)
  : share_(share)
  , strain_(lumens, std::numeric_limits<double>::quiet_NaN())
  , ratio_(lumens, 1.0)
{
  if (!(share > 0 && share < 1))
    throw ParameterError(fmt::format("a lumen is to have collapsed at {} of its area", share),
      "give a share between 0 and 1, such as 0.5");
}

void CollapseStrain::add(double strain, std::span<const double> ratio)
{
  if (!std::isfinite(strain) || (states_ > 0 && !(strain > last_)))
    throw InputError(states_ == 0 ? fmt::format("the first state has a strain of {}", strain)
                                  : fmt::format("a state with a strain of {} after one of {}", strain, last_),
      "give states of rising strain, compression positive");
  for (std::size_t i = 0; i < ratio_.size(); ++i)
  {
    if (std::isnan(strain_[i]) && ratio[i] < share_)
    {
      const double before = std::isnan(ratio_[i]) ? ratio[i] : ratio_[i];
      const double t = before > share_ ? (before - share_) / (before - ratio[i]) : 0;
      strain_[i] = last_ + t * (strain - last_);
      ++collapsed_;
    }
    ratio_[i] = ratio[i];
  }
  last_ = strain;
  ++states_;
}

} // namespace lamella::compression
