#pragma once

#include "files/JsonReport.h"
#include "statistics/WindowError.h"

#include <span>
#include <string>

/// What commands tell of how far a sample speaks for its material.
namespace lamella::cli
{

inline constexpr const char* windowHeading =
  "  window: the material that the sample was cut out of has, with 95 % probability\n";

/// One line of a table, and another where the sample changes along an axis.
/// @param name    of the value
/// @param unit    with a space before it; or empty
/// @param factor  from the value's unit to that one
[[nodiscard]] std::string windowText(
  const std::string& name, const statistics::WindowError& window, const std::string& unit, double factor);

/// `low`, `high`, `error` (relative), `deviation`, `freedom`, `bias`, `decay`, `pictures_for` by share, `gradient`.
[[nodiscard]] Json windowJson(const statistics::WindowError& window);
/// By name; null: none.
[[nodiscard]] Json windowsJson(std::span<const statistics::WindowError> windows);

} // namespace lamella::cli
