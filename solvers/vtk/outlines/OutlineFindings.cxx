#include "OutlineFindings.h"

#include "FieldNumbers.h"

#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkSmartPointer.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace lamella
{
namespace
{

constexpr const char* kCreator = "vtkOutlineDiffusion";

/// By direction, NaN where that was not solved.
template <class Read>
std::array<double, 3> byDirection(const OutlineFindings& found, Read&& read)
{
  std::array<double, 3> numbers{};
  numbers.fill(std::numeric_limits<double>::quiet_NaN());
  for (const lbm::ContourAnswer& answer : found.answers)
    numbers[static_cast<std::size_t>(answer.axis)] = static_cast<double>(read(answer));
  return numbers;
}

/// Distance of nodes and value of every lattice, the coarsest first.
void addLattices(vtkDataObject* output, const lbm::ContourAnswer& answer)
{
  const auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(answer.axis == 0 ? "lattices_x" : "lattices_y");
  array->SetNumberOfComponents(2);
  array->SetComponentName(0, "spacing");
  array->SetComponentName(1, "conductivity");
  for (const lbm::ContourStep& step : answer.steps)
    array->InsertNextTuple2(step.spacing, step.value);
  describe(
    array, "m, conductivity", "distance of nodes and conductivity of each lattice, the coarsest first", kCreator);
  output->GetFieldData()->AddArray(array);
}

} // namespace

void describe(vtkDataObject* output, const OutlineFindings& found)
{
  std::array<double, 9> tensor{};
  tensor.fill(std::numeric_limits<double>::quiet_NaN());
  for (const lbm::ContourAnswer& answer : found.answers)
  {
    tensor[static_cast<std::size_t>(4 * answer.axis)] = answer.value;
    addLattices(output, answer);
  }
  setFieldNumbers(output, "effective_conductivity", tensor, "conductivity",
    "tensor by rows, its diagonal, extrapolated to a spacing of zero; NaN elsewhere", kCreator);
  const auto write = [&](const char* name, const char* text, auto&& read)
  { setFieldNumbers(output, name, byDirection(found, read), "1", text, kCreator); };
  for (const auto& [name, kind, text] :
    { std::tuple{ "estimated_error", &lbm::ContourAnswer::error, "relative error bar of the conductivity" },
      std::tuple{ "lattice_error", &lbm::ContourAnswer::latticeError, "the part of it that the lattices leave" },
      std::tuple{ "picture_error", &lbm::ContourAnswer::pictureError,
        "the part of it that the picture's pixels leave; 0 where the outlines are taken as they are" } })
  {
    setFieldNumber(output, name, lbm::worst(found.answers, kind), "1", text, kCreator);
    write((std::string(name) + "_by_direction").c_str(), text, [kind = kind](const auto& a) { return a.*kind; });
  }
  if (found.picture)
  {
    write(
      "border_doubt", "change of the conductivity by wall that may lie along the picture's border",
      [](const auto& a) { return std::abs(a.sealed); });
    write("segmentation_doubt", "change of the conductivity by what is in doubt about where a scan's walls begin",
      [](const auto& a) { return std::abs(a.moved); });
  }
  write(
    "balance", "relative difference of the flux through the worse face",
    [](const auto& a) { return a.result.balance; });
  write(
    "iterations", "on the finest lattice", [](const auto& a) { return a.fine.iterations; });
  write("nodes", "of the finest lattice", [](const auto& a) { return a.fine.nodes; });
  std::vector<std::string> names;
  std::vector<double> values;
  for (const auto& [name, value] : found.conductivity)
  {
    names.push_back(name);
    values.push_back(value);
  }
  setFieldTexts(output, "phase_names", names);
  setFieldNumbers(output, "phase_conductivity", values);
  setFieldText(output, "direction", found.direction);
  if (found.targetError > 0)
    setFieldText(output, "target", lbm::name(lbm::targetOf(found.answers, found.targetError)));
}

} // namespace lamella
