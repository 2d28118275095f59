#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace lamella
{

/// Whether a phase of this name usually holds nothing: void, pore, lumen, air or 0, in letters of either case.
[[nodiscard]] inline bool isVoidName(std::string name)
{
  std::transform(
    name.begin(), name.end(), name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name == "void" || name == "pore" || name == "lumen" || name == "air" || name == "0";
}

} // namespace lamella
