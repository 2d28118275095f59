#include "session/Text.h"

#include "core/Error.h"
#include "core/Plausible.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::cli
{

double lengthInMetres(const std::string& option, const std::string& text)
{
  const std::size_t end = text.find_first_not_of("+-.0123456789eE");
  std::string number = text.substr(0, end);
  std::string unit = end == std::string::npos ? "" : text.substr(end);
  unit.erase(0, unit.find_first_not_of(' '));
  const std::pair<const char*, double> units[] = { { "", 1 }, { "m", 1 }, { "mm", 1e-3 }, { "um", 1e-6 },
    { "µm", 1e-6 }, { "μm", 1e-6 }, { "nm", 1e-9 } };
  const auto* found = std::find_if(std::begin(units), std::end(units), [&](const auto& u) { return unit == u.first; });
  const auto value = toNumber(number);
  if (!value || found == std::end(units))
  {
    throw ParameterError(
      option + " '" + text + "' is not a length", "write it in metres, " + option + " 0.5e-6, or with a unit: 0.5um");
  }
  // Dividing keeps 0.5um the same number as 0.5e-6: 1e-6 has no exact binary form, 1e6 has.
  const double metres = found->second == 1 ? *value : *value / std::round(1 / found->second);
  if (!(metres > 0) || !std::isfinite(metres))
  {
    throw ParameterError(
      option + " '" + text + "' is not a length above 0", "write it in metres, such as " + option + " 0.5e-6");
  }
  if (!plausible(metres))
  {
    throw ParameterError(fmt::format("{} '{}' is not between 1e-30 and 1e30 metres", option, text),
      "write it in metres, such as " + option + " 0.5e-6");
  }
  return metres;
}

double share(const std::string& option, const std::string& text)
{
  const bool percent = text.ends_with('%');
  const auto value = toNumber(percent ? std::string_view(text).substr(0, text.size() - 1) : std::string_view(text));
  if (!value || !std::isfinite(*value))
    throw ParameterError(option + " '" + text + "' is not a share", "write it as 1% or 0.01");
  return percent ? *value / 100 : *value;
}

double positive(const std::string& option, const std::string& text, const std::string& hint)
{
  const auto value = toNumber(text);
  if (!value || !(*value > 0) || !std::isfinite(*value))
    throw ParameterError(fmt::format("{} '{}' is not a number above 0", option, text), hint);
  if (!plausible(*value))
    throw ParameterError(fmt::format("{} '{}' is not between 1e-30 and 1e30", option, text), hint);
  return *value;
}

void checkThreads(int threads, const char* hint)
{
  if (threads < 1 || threads > 1024)
    throw ParameterError(fmt::format("--threads {} is outside 1 to 1024", threads), hint);
}

std::pair<std::string, std::string> keyValue(
  const std::string& option, const std::string& text, const std::string& form)
{
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw ParameterError(option + " '" + text + "' is not " + form, "write it as " + option + " " + form);
  return { text.substr(0, equals), text.substr(equals + 1) };
}

std::vector<std::string> listItems(const std::vector<std::string>& texts)
{
  std::vector<std::string> items;
  for (const std::string& text : texts)
  {
    bool first = true;
    for (std::string& part : split(text, ','))
    {
      if (first || part.find('=') != std::string::npos)
        items.push_back(std::move(part));
      else
        items.back() += "," + part;
      first = false;
    }
  }
  return items;
}

std::size_t oneOf(const std::string& option, const std::string& text, std::span<const std::string> words)
{
  const auto found = std::find(words.begin(), words.end(), text);
  if (found == words.end())
  {
    throw ParameterError(
      option + " '" + text + "' is not known", suggestion(text, words, "it takes " + quotedList(words)));
  }
  return static_cast<std::size_t>(found - words.begin());
}

std::string grouped(std::int64_t count)
{
  return count < 1000 ? std::to_string(count) : fmt::format("{} {:03}", grouped(count / 1000), count % 1000);
}

std::string wroteText(const std::vector<std::string>& files)
{
  std::string text;
  for (const std::string& file : files)
    text += "  wrote " + file + "\n";
  return text;
}

std::string sizeText(const std::array<std::int64_t, 3>& size, int dimension)
{
  return dimension == 3 ? fmt::format("{} × {} × {}", size[0], size[1], size[2])
                        : fmt::format("{} × {}", size[0], size[1]);
}

} // namespace lamella::cli
