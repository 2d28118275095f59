#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lamella
{

/// What stands between the separators; empty parts are parts.
[[nodiscard]] std::vector<std::string> split(std::string_view text, char separator);

/// A number, all of the text; "nan" and "inf" are numbers here, whether they make sense is the caller's to say.
[[nodiscard]] std::optional<double> toNumber(std::string_view text);
[[nodiscard]] std::optional<std::int64_t> toInteger(std::string_view text);

/// Numbers with spaces between them; or the first word that is none.
struct NumberRow
{
  std::vector<double> numbers;
  std::optional<std::string> wrong;
};
[[nodiscard]] NumberRow toNumbers(std::string_view text);

/// "VALUE±HALF", or with +-: both; without: the value alone, and nothing.
[[nodiscard]] std::pair<std::string, std::string> splitUncertainty(const std::string& text);

} // namespace lamella
