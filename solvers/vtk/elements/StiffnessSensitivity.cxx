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
namespace
{

void setRows(vtkDataObject* data, const char* name, const std::vector<std::vector<double>>& rows)
{
  std::vector<double> flat;
  for (const std::vector<double>& row : rows)
    flat.insert(flat.end(), row.begin(), row.end());
  if (!flat.empty())
    setFieldNumbers(data, name, flat);
}

} // namespace

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
  setRows(data, "stiffness_sensitivity", found.changes);
  setRows(data, "constants_sensitivity", found.constantChanges);
  if (!found.loaded || found.loaded->changes.empty())
    return;
  std::vector<double> energy = found.loaded->changes;
  for (double& change : energy)
    change *= 0.5;
  setFieldNumbers(data, "load_energy_sensitivity", energy);
}

void setSurfaces(
  vtkDataObject* data, const elasticity::VoxelStiffness& found, std::span<const std::string> names, double doubt)
{
  std::vector<std::string> pairs;
  std::vector<std::vector<double>> changes;
  std::vector<std::vector<double>> constants;
  std::vector<double> errors(elasticity::constantValues(found.constants).size(), 0.0);
  const auto nameOf = [&](std::size_t id) { return id < names.size() ? names[id] : std::to_string(id); };
  for (const elasticity::StiffnessSurface& surface : found.surfaces)
  {
    pairs.push_back(nameOf(surface.first) + ":" + nameOf(surface.second));
    changes.push_back(surface.change);
    constants.push_back(surface.constantChange);
    for (std::size_t i = 0; i < errors.size(); ++i)
      errors[i] += std::pow(doubt * surface.constantChange[i], 2); // they are independent
  }
  for (double& error : errors)
    error = std::sqrt(error);
  setFieldNumber(data, "surface_doubt", doubt);
  setFieldTexts(data, "surface_pairs", pairs);
  setRows(data, "stiffness_surface_sensitivity", changes);
  setRows(data, "constants_surface_sensitivity", constants);
  setFieldNumbers(data, "constants_segmentation_error", errors);
}

void setInputErrors(
  vtkDataObject* data, const elasticity::VoxelStiffness& found, std::span<const MaterialNumber> numbers)
{
  std::vector<double> inputs;
  for (std::size_t i = 0; i < elasticity::constantValues(found.constants).size(); ++i)
  {
    double sum = 0; // they are independent
    for (std::size_t p = 0; p < numbers.size(); ++p)
      sum += std::pow(found.constantChanges[p][i] * numbers[p].uncertainty, 2);
    inputs.push_back(std::sqrt(sum));
  }
  setFieldNumbers(data, "constants_input_error", inputs);
}

void setTotalErrors(vtkDataObject* data, const elasticity::VoxelStiffness& found)
{
  const std::vector<double> values = elasticity::constantValues(found.constants);
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
  add("segmentation", at("constants_segmentation_error") / value);
  add("constants", at("constants_input_error") / value);
  return parts;
}

} // namespace lamella
