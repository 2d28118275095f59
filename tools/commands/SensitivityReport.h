#pragma once

#include "ErrorParts.h"

#include <string>
#include <utility>
#include <vector>

/// What commands tell of how a value changes with the phases', and of its whole error.
namespace lamella::cli
{

/// "2.3 %", or "unknown".
[[nodiscard]] std::string percent(double share);

/// Of one value, by name of what phases are told by.
struct Sensitivity
{
  std::string name;                                    ///< of the value
  std::vector<std::pair<std::string, double>> changes; ///< relative, over what is relative of the phase
  std::vector<std::pair<std::string, double>> inputs;  ///< what the phases' uncertainty leaves, relative
};

/// A line of changes, and another where there are uncertainties.
/// @param width of the name
/// @param of    whose uncertainty: "the conductivities'"
[[nodiscard]] std::string sensitivityText(const Sensitivity& one, int width, const char* of);

/// "value ± error (parts); most of it: part"; empty where the total is not known.
/// @param unit with a space before it, or empty; @param factor to it from the unit of value and parts
[[nodiscard]] std::string totalText(
  const std::string& name, int width, double value, const std::string& unit, double factor, const ErrorParts& parts);
inline constexpr const char* totalHeading = "  in all, of what was asked for\n";

} // namespace lamella::cli
