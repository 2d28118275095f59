#pragma once

#include <string>

namespace lamella::cli
{

/// A name or text of a table of comma-separated values, in quotes where it must be.
[[nodiscard]] inline std::string csvField(const std::string& text)
{
  if (text.find_first_of(",\"\n\r") == std::string::npos)
    return text;
  std::string result = "\"";
  for (const char c : text)
    result += c == '"' ? "\"\"" : std::string(1, c);
  return result + "\"";
}

} // namespace lamella::cli
