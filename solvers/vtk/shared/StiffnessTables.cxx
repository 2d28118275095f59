#include "StiffnessTables.h"

#include "FieldNumbers.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

namespace lamella
{
namespace
{

namespace el = elasticity;

/// The values, or as many unknown ones.
std::vector<double> orUnknown(std::span<const double> values, std::size_t count)
{
  return values.empty() ? std::vector<double>(count, unknown) : std::vector<double>(values.begin(), values.end());
}

void addNumbers(vtkTable* table, const std::string& name, const char* unit, const char* words, const char* creator,
  const std::vector<double>& values, std::size_t first, std::size_t step, std::size_t rows)
{
  vtkNew<vtkDoubleArray> column;
  column->SetName(name.c_str());
  for (std::size_t row = 0; row < rows; ++row)
    column->InsertNextValue(values.at(first + step * row));
  describe(column, unit, words, creator);
  table->AddColumn(column);
}

void addTexts(vtkTable* table, const char* name, const std::vector<std::string>& texts)
{
  vtkNew<vtkStringArray> column;
  column->SetName(name);
  for (const std::string& text : texts)
    column->InsertNextValue(text);
  table->AddColumn(column);
}

} // namespace

void setStiffness(vtkImageData* output, const StiffnessFound& f)
{
  const auto set = [output](const char* name, std::span<const double> values)
  { setFieldNumbers(output, name, values); };
  const auto whole = [output](const char* name, std::int64_t value)
  { setFieldNumber(output, name, static_cast<double>(value)); };
  const std::vector<std::string> components = el::voigtNames(f.dimension);
  const std::size_t entries = components.size() * components.size();
  setFieldTexts(output, "stiffness_components", components);
  set("stiffness", orUnknown(f.stiffness, entries));
  set("stiffness_extrapolated", orUnknown(f.error->extrapolated, entries));
  set("stiffness_error", orUnknown(f.error->components, entries));
  set("stiffness_voigt", orUnknown(f.voigt, entries));
  set("stiffness_reuss", orUnknown(f.reuss, entries));
  setFieldNumber(output, "stiffness_asymmetry", f.asymmetry);
  setFieldNumber(output, "estimated_error", f.error->relative);
  const std::vector<std::string> names = el::constantNames(f.dimension);
  setFieldTexts(output, "constant_names", names);
  set("constants", orUnknown(el::constantValues(*f.constants), names.size()));
  set("constants_extrapolated", orUnknown(el::constantValues(f.error->constants), names.size()));
  set("constants_error", orUnknown(f.error->ofConstants, names.size()));
  set("eigenvalues", f.constants->eigenvalues);
  whole("resisting", f.constants->resisting);
  set("crosses", std::vector<double>(f.crosses.begin(), f.crosses.end()));
  whole("pieces", f.pieces);
  whole("loose_pieces", f.loosePieces);
  whole("loose_nodes", f.looseNodes);
  std::vector<double> across;
  std::vector<double> inside;
  for (const el::SideMatch& side : f.sides)
  {
    across.push_back(side.across);
    inside.push_back(side.inside);
  }
  set("seam_mismatch", across);
  set("layer_mismatch", inside);

  std::array<std::vector<double>, 5> steps;
  for (const el::StiffnessStep& step : f.steps)
  {
    std::int64_t iterations = 0;
    for (const std::int64_t n : step.iterations)
      iterations += n;
    steps[0].push_back(step.every);
    steps[1].push_back(step.pictures);
    steps[2].push_back(static_cast<double>(step.nodes));
    steps[3].push_back(static_cast<double>(iterations));
    steps[4].push_back(step.seconds);
  }
  constexpr std::array<const char*, 5> stepNames{ "step_every", "step_pictures", "step_nodes", "step_iterations",
    "step_seconds" };
  for (std::size_t i = 0; i < stepNames.size(); ++i)
    set(stepNames[i], steps[i]);
  if (!f.steps.empty())
    set("iterations", std::vector<double>(f.steps.front().iterations.begin(), f.steps.front().iterations.end()));
}

void fillTensor(vtkTable* table, const StiffnessFound& f, const char* creator)
{
  const std::vector<std::string> names = el::voigtNames(f.dimension);
  const std::size_t n = names.size();
  addTexts(table, "stress", names);
  const auto block = [&](const std::string& prefix, const char* words, std::span<const double> values)
  {
    for (std::size_t strain = 0; strain < n; ++strain)
      addNumbers(table, prefix + names[strain], "Pa", words, creator, orUnknown(values, n * n), strain, n, n);
  };
  block("", "stress over this mean strain", f.stiffness);
  block("extrapolated_", "what the material is expected to have", f.error->extrapolated);
  block("error_", "estimated error against the material", f.error->components);
}

void fillConstants(vtkTable* table, const StiffnessFound& f, const char* creator)
{
  const std::vector<std::string> names = el::constantNames(f.dimension);
  const std::size_t n = names.size();
  addTexts(table, "constant", names);
  const auto column = [&](const char* name, const char* words, const std::vector<double>& values)
  { addNumbers(table, name, "", words, creator, orUnknown(values, n), 0, 1, n); };
  column("value", "moduli in Pa, Poisson's ratios", el::constantValues(*f.constants));
  column("extrapolated", "what the material is expected to have", el::constantValues(f.error->constants));
  column("error", "estimated error against the material", f.error->ofConstants);
  std::vector<std::string> units;
  for (const std::string& name : names)
    units.emplace_back(name.starts_with("nu") ? "1" : "Pa");
  addTexts(table, "unit", units);
}

} // namespace lamella
