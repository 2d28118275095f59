#include "session/Units.h"

#include "session/Text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lamella::cli
{

namespace
{

/// The exponent of a prefix; nothing where it is none.
std::optional<int> exponentOf(std::string_view prefix)
{
  constexpr std::array<std::pair<std::string_view, int>, 4> prefixes{ { { "", 0 }, { "k", 3 }, { "M", 6 },
    { "G", 9 } } };
  const auto* const found =
    std::find_if(prefixes.begin(), prefixes.end(), [&](const auto& p) { return p.first == prefix; });
  return found == prefixes.end() ? std::nullopt : std::optional(found->second);
}

/// A number, perhaps with a prefix and this unit behind it.
std::optional<double> quantity(std::string_view text, std::string_view unit)
{
  if (const auto plain = toNumber(text))
    return plain;
  if (!text.ends_with(unit))
    return std::nullopt;
  text.remove_suffix(unit.size());
  const std::size_t end = text.find_last_of("0123456789.");
  if (end == std::string_view::npos)
    return std::nullopt;
  std::string_view prefix = text.substr(end + 1);
  prefix.remove_prefix(std::min(prefix.find_first_not_of(' '), prefix.size()));
  const auto exponent = exponentOf(prefix);
  const std::string number(text.substr(0, end + 1));
  if (!exponent || !toNumber(number))
    return std::nullopt;
  // as one number: 7.2 times 1e9 is rounded twice
  return number.find_first_of("eE") == std::string::npos ? toNumber(number + "e" + std::to_string(*exponent))
                                                         : *toNumber(number) * std::pow(10.0, *exponent);
}

} // namespace

std::optional<double> pascals(std::string_view text)
{
  return quantity(text, "Pa");
}

std::optional<double> pascalRootMetres(std::string_view text)
{
  for (const char* const root : { "√m", "m^0.5", "m^(1/2)", "sqrt(m)" })
  {
    if (text.ends_with(root))
    {
      std::string_view stress = text.substr(0, text.size() - std::string_view(root).size());
      while (!stress.empty() && (stress.back() == ' ' || stress.back() == '*' || stress.back() == '.'))
        stress.remove_suffix(1);
      return stress.ends_with("Pa") ? pascals(stress) : std::nullopt;
    }
  }
  return toNumber(text);
}

std::optional<double> secondsFrom(std::string_view text)
{
  constexpr std::array<std::pair<std::string_view, double>, 3> units{ { { "min", 60 }, { "s", 1 }, { "h", 3600 } } };
  for (const auto& [unit, seconds] : units)
  {
    if (text.ends_with(unit))
    {
      const auto number = toNumber(text.substr(0, text.size() - unit.size()));
      return number && *number >= 0 && *number < 1e9 ? std::optional(*number * seconds) : std::nullopt;
    }
  }
  return std::nullopt;
}

double coordinate(const std::string& option, const std::string& text)
{
  if (const auto number = toNumber(text); number && std::isfinite(*number))
    return *number;
  const bool negative = !text.empty() && text.front() == '-';
  return (negative ? -1 : 1) * lengthInMetres(option, negative ? text.substr(1) : text);
}

} // namespace lamella::cli
