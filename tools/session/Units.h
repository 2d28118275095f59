#pragma once

#include "core/Plausible.h"

#include <optional>
#include <string>
#include <string_view>

/// Physical quantities as users type them: in SI units, or with a unit behind the number. Everything that reads an
/// option throws ParameterError.
namespace lamella::cli
{

/// "7.2e9", "7.2GPa", "7.2 GPa"; Pa, kPa, MPa, GPa. Nothing where it is none.
[[nodiscard]] std::optional<double> pascals(std::string_view text);
/// "4e5", "0.4MPa√m"; also written as MPam^0.5, MPa*sqrt(m), MPa.sqrt(m) or MPa m^0.5. Nothing where it is none.
[[nodiscard]] std::optional<double> pascalRootMetres(std::string_view text);

/// A time in seconds: "30s", "10min", "1.5h"; nothing where it is none, or has no unit.
[[nodiscard]] std::optional<double> secondsFrom(std::string_view text);

/// A coordinate [m]: a number, or one with a unit. 0 and negative ones are coordinates too. @throws ParameterError
[[nodiscard]] double coordinate(const std::string& option, const std::string& text);

} // namespace lamella::cli
