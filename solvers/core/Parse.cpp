#include "core/Parse.h"

#include <charconv>
#include <cstdlib>
#include <sstream>
#include <system_error>

namespace lamella
{

std::vector<std::string> split(std::string_view text, char separator)
{
  std::vector<std::string> parts;
  for (;;)
  {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos)
      return parts;
    text.remove_prefix(end + 1);
  }
}

std::optional<double> toNumber(std::string_view text)
{
  double value = 0;
  if (text.starts_with('+'))
    text.remove_prefix(1);
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || text.empty())
    return std::nullopt;
  if (failed == std::errc::result_out_of_range)
    return std::strtod(std::string(text).c_str(), nullptr); // 1e999 is infinite, 1e-999 is zero
  return failed == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<std::int64_t> toInteger(std::string_view text)
{
  std::int64_t value = 0;
  if (text.starts_with('+'))
    text.remove_prefix(1);
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size() || text.empty())
    return std::nullopt;
  return value;
}

NumberRow toNumbers(std::string_view text)
{
  NumberRow row;
  std::istringstream words{ std::string(text) };
  for (std::string word; words >> word;)
  {
    const std::optional<double> value = toNumber(word);
    if (!value)
    {
      row.wrong = word;
      break;
    }
    row.numbers.push_back(*value);
  }
  return row;
}

std::pair<std::string, std::string> splitUncertainty(const std::string& text)
{
  for (const std::string sign : { "±", "+-" })
    if (const std::size_t at = text.find(sign); at != std::string::npos)
      return { text.substr(0, at), text.substr(at + sign.size()) };
  return { text, "" };
}

} // namespace lamella
