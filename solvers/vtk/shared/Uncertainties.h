#pragma once

#include "core/Error.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>

/// Not installed.
namespace lamella
{

/// Refuses uncertainties that are of nothing, or no numbers. @param what they are of, as "Young's modulus"
/// @throws ParameterError
inline void requireUncertainties(
  const std::map<std::string, double>& values, const std::map<std::string, double>& uncertainty, const char* what)
{
  for (const auto& [name, half] : uncertainty)
  {
    if (!values.contains(name))
      throw ParameterError(fmt::format("'{}' has an uncertainty of its {}, and no such number", name, what),
        "give both by the same name, or by the same number");
    if (!std::isfinite(half) || half < 0)
      throw ParameterError(fmt::format("the uncertainty of the {} of '{}' is {}", what, name, half), "give 0 or more");
  }
}

} // namespace lamella
