#pragma once

#include "vtkLatticeConversion.h"

#include "vtkDoubleArray.h"

#include <limits>
#include <span>
#include <string>

/// Short ways to setFieldNumbers(); not installed.
namespace lamella
{

/// Stands for what is not known.
inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// One number.
inline vtkDoubleArray* setFieldNumber(vtkDataObject* data, const char* name, double value)
{
  return setFieldNumbers(data, name, std::span(&value, 1));
}

/// With their unit, a description and their creator, as describe() takes them.
inline void setFieldNumbers(vtkDataObject* data, const char* name, std::span<const double> values,
  const std::string& unit, const std::string& text, const std::string& creator)
{
  describe(setFieldNumbers(data, name, values), unit, text, creator);
}

inline void setFieldNumber(vtkDataObject* data, const char* name, double value, const std::string& unit,
  const std::string& text, const std::string& creator)
{
  describe(setFieldNumber(data, name, value), unit, text, creator);
}

} // namespace lamella
