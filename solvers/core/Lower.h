#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

namespace lamella
{

/// A text in small letters; those of ASCII.
[[nodiscard]] inline std::string lower(std::string text)
{
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// The ending of a name in small letters, of a file that gzip packed both: ".png", ".json.gz"; empty without one.
[[nodiscard]] inline std::string endingOf(const std::filesystem::path& name)
{
  const std::string ending = lower(name.extension().string());
  return ending == ".gz" ? lower(name.stem().extension().string()) + ending : ending;
}

} // namespace lamella
