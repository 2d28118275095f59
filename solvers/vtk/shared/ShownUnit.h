#pragma once

#include "vtkLatticeConversion.h"

#include <string>
#include <utility>

namespace lamella
{

/// The unit that describe() gave an array, as labels of pictures have it: "J/m³" for "J/m^3"; empty for a ratio, and
/// where none is told.
[[nodiscard]] inline std::string shownUnit(vtkDataArray* array)
{
  std::string unit = description(array)[0];
  for (const auto& [plain, raised] : { std::pair("^2", "²"), std::pair("^3", "³") })
    for (std::size_t at = unit.find(plain); at != std::string::npos; at = unit.find(plain))
      unit.replace(at, 2, raised);
  return unit == "1" ? "" : unit;
}

} // namespace lamella
