#include "WindowFields.h"

#include "FieldNumbers.h"
#include "vtkLatticeConversion.h"

#include "statistics/Distributions.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"

#include <cmath>
#include <string>

namespace lamella
{
namespace
{

using statistics::WindowError;

struct Column
{
  const char* name;
  double (*read)(const WindowError&);
};

constexpr Column columns[] = {
  { "window_errors", [](const WindowError& w) { return w.relative(); } },
  { "window_value", [](const WindowError& w) { return w.value; } },
  { "window_low", [](const WindowError& w) { return w.low; } },
  { "window_high", [](const WindowError& w) { return w.high; } },
  { "window_deviation", [](const WindowError& w) { return w.deviation; } },
  { "window_freedom", [](const WindowError& w) { return w.freedom; } },
  { "window_bias", [](const WindowError& w) { return w.bias; } },
  { "window_gradient",
    [](const WindowError& w) { return w.gradient ? static_cast<double>(w.gradient->axis) : unknown; } },
  { "window_doubt", [](const WindowError& w) { return w.doubt; } },
  { "window_layered_low", [](const WindowError& w) { return w.gradient ? w.gradient->low : unknown; } },
  { "window_layered_high", [](const WindowError& w) { return w.gradient ? w.gradient->high : unknown; } },
  { "window_layered", [](const WindowError& w) { return w.gradient ? w.gradient->layered : unknown; } },
};

} // namespace

void setWindowFields(vtkDataObject* data, std::span<const WindowError> errors)
{
  data->GetFieldData()->RemoveArray("window_of");
  for (const Column& column : columns)
    data->GetFieldData()->RemoveArray(column.name);
  if (errors.empty())
    return;
  std::vector<std::string> names;
  for (const WindowError& error : errors)
    names.push_back(error.name);
  setFieldTexts(data, "window_of", names);
  for (const Column& column : columns)
  {
    std::vector<double> values;
    for (const WindowError& error : errors)
      values.push_back(column.read(error));
    setFieldNumbers(data, column.name, values);
  }
}

std::vector<WindowError> windowFields(vtkDataObject* data)
{
  std::vector<WindowError> errors;
  if (!data->GetFieldData()->HasArray("window_of"))
    return errors;
  const auto numbers = [&](const char* name, std::size_t i) { return fieldNumbers(data, name)[i]; };
  const std::vector<std::string> names = fieldTexts(data, "window_of");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    WindowError error;
    error.name = names[i];
    error.value = numbers("window_value", i);
    error.low = numbers("window_low", i);
    error.high = numbers("window_high", i);
    error.deviation = numbers("window_deviation", i);
    error.freedom = numbers("window_freedom", i);
    error.quantile = statistics::studentQuantile(0.95, error.freedom);
    error.bias = numbers("window_bias", i);
    error.doubt = numbers("window_doubt", i);
    error.expected = error.high - error.quantile * std::hypot(error.deviation, error.doubt);
    if (const double axis = numbers("window_gradient", i); std::isfinite(axis))
    {
      error.gradient.emplace();
      error.gradient->axis = static_cast<std::size_t>(axis);
      error.gradient->layered = numbers("window_layered", i);
      error.gradient->low = numbers("window_layered_low", i);
      error.gradient->high = numbers("window_layered_high", i);
    }
    errors.push_back(error);
  }
  return errors;
}

} // namespace lamella
