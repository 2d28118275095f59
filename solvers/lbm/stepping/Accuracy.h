#pragma once

#include <string>

namespace lamella::lbm
{

/// What to say of one relaxation time when the largest that occurs is `tau`; empty where it is accurate.
[[nodiscard]] std::string singleRateWarning(double tau);

} // namespace lamella::lbm
