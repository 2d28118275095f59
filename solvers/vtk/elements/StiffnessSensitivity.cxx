#include "StiffnessSensitivity.h"

#include "FieldNumbers.h"
#include "WindowFields.h"
#include "vtkLatticeConversion.h"

#include "vtkDataObject.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace lamella
{

void setSensitivity(
  vtkDataObject* data, const elasticity::VoxelStiffness& found, std::span<const MaterialNumber> numbers)
{
  std::vector<std::string> names;
  std::vector<double> values;
  std::vector<double> uncertainty;
  for (const MaterialNumber& number : numbers)
  {
    names.push_back(number.name());
    values.push_back(number.value);
    uncertainty.push_back(number.uncertainty);
  }
  setFieldTexts(data, "material_numbers", names);
  setFieldNumbers(data, "material_values", values);
  setFieldNumbers(data, "material_uncertainty", uncertainty);
  const auto rows = [data](const char* name, const std::vector<std::vector<double>>& all)
  {
    std::vector<double> flat;
    for (const std::vector<double>& row : all)
      flat.insert(flat.end(), row.begin(), row.end());
    if (!flat.empty())
      setFieldNumbers(data, name, flat);
  };
  rows("stiffness_sensitivity", found.changes);
  rows("constants_sensitivity", found.constantChanges);
  if (!found.loaded || found.loaded->changes.empty())
    return;
  std::vector<double> energy = found.loaded->changes;
  for (double& change : energy)
    change *= 0.5;
  setFieldNumbers(data, "load_energy_sensitivity", energy);
}

void setConstantErrors(
  vtkDataObject* data, const elasticity::VoxelStiffness& found, std::span<const MaterialNumber> numbers, bool uncertain)
{
  const std::vector<double> values = elasticity::constantValues(found.constants);
  if (uncertain)
  {
    std::vector<double> inputs;
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      double sum = 0; // they are independent
      for (std::size_t p = 0; p < numbers.size(); ++p)
        sum += std::pow(found.constantChanges[p][i] * numbers[p].uncertainty, 2);
      inputs.push_back(std::sqrt(sum));
    }
    setFieldNumbers(data, "constants_input_error", inputs);
  }
  std::vector<double> totals;
  for (std::size_t i = 0; i < values.size(); ++i)
    totals.push_back(statistics::totalError(constantErrorParts(data, i)) * std::abs(values[i]));
  setFieldNumbers(data, "constants_total_error", totals);
}

std::vector<statistics::ErrorPart> constantErrorParts(vtkDataObject* data, std::size_t constant)
{
  std::vector<statistics::ErrorPart> parts;
  const auto at = [&](const char* name)
  {
    const std::vector<double> values = fieldNumbers(data, name);
    return constant < values.size() ? values[constant] : unknown;
  };
  const double value = std::abs(at("constants"));
  const auto add = [&](const char* name, double relative)
  {
    if (std::isfinite(relative))
      parts.push_back({ name, relative });
  };
  add("lattice and picture", at("constants_error") / value);
  const std::vector<statistics::WindowError> windows = windowFields(data);
  const auto window =
    std::ranges::find(windows, fieldTexts(data, "constant_names").at(constant), &statistics::WindowError::name);
  add("window", window != windows.end() ? window->relative() : unknown);
  add("constants", at("constants_input_error") / value);
  return parts;
}

} // namespace lamella
