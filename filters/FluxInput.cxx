#include "FluxInput.h"

#include "vtkLatticeConversion.h"

#include "core/Error.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace lamella
{
namespace
{

using nlohmann::json;

constexpr std::array<const char*, 3> suffixes{ "_x", "_y", "_z" };

std::string chosenName(vtkInformation* choice)
{
  return choice != nullptr && choice->Has(vtkDataObject::FIELD_NAME()) ? choice->Get(vtkDataObject::FIELD_NAME()) : "";
}

/// @throws InputError when it is missing or not at points
void requireArray(vtkImageData* piece, const std::string& name)
{
  if (piece->GetPointData()->GetArray(name.c_str()) != nullptr)
    return;
  if (piece->GetCellData()->HasArray(name.c_str()))
  {
    throw InputError("array '" + name + "' is cell data; fluxes are read at points",
      "compute the field with Steady Diffusion, which works at points");
  }
  throw InputError("the image has no point array '" + name + "'", "choose an array that is there");
}

bool has(vtkImageData* piece, const std::string& name)
{
  return !name.empty() && piece->GetPointData()->GetArray(name.c_str()) != nullptr;
}

std::vector<SolvedDirection> findDirections(vtkImageData* piece, const std::vector<std::string>& quantities)
{
  std::vector<SolvedDirection> found;
  const auto axisText = fieldText(piece, "direction").value_or("");
  const int axis = axisText == "x" ? 0 : axisText == "y" ? 1 : axisText == "z" ? 2 : -1;
  const auto add = [&](const std::string& value, const std::string& flux, int along, const std::string& suffix)
  {
    if (has(piece, value) || has(piece, flux))
      found.push_back({ along, has(piece, value) ? value : "", has(piece, flux) ? flux : "", suffix });
  };
  for (const std::string& quantity : quantities)
  {
    if (found.empty() && has(piece, quantity))
      add(quantity, "flux", axis, "");
    for (int a = 0; a < 3 && (found.empty() || !found.front().suffix.empty()); ++a)
    {
      const std::string suffix = suffixes[static_cast<std::size_t>(a)];
      if (has(piece, quantity + suffix))
        add(quantity + suffix, "flux" + suffix, a, suffix);
    }
    if (!found.empty())
      return found;
  }
  add("", "flux", axis, "");
  for (int a = 0; a < 3 && (found.empty() || !found.front().suffix.empty()); ++a)
  {
    const std::string suffix = suffixes[static_cast<std::size_t>(a)];
    add("", "flux" + suffix, a, suffix);
  }
  return found;
}

void requireNumbers(vtkImageData* piece, const std::string& name, int components, bool gaps)
{
  if (name.empty())
    return;
  vtkDataArray* const array = piece->GetPointData()->GetArray(name.c_str());
  if (array == nullptr)
    throw InputError("a piece of the image has no point array '" + name + "'", "give every piece the same arrays");
  if (array->GetNumberOfComponents() != components)
  {
    throw InputError("array '" + name + "' has " + std::to_string(array->GetNumberOfComponents()) + " component(s)",
      "choose one with " + std::to_string(components));
  }
  for (vtkIdType node = 0; node < array->GetNumberOfTuples(); ++node)
  {
    for (int component = 0; component < components; ++component)
    {
      const double value = array->GetComponent(node, component);
      if (std::isinf(value) || (!gaps && std::isnan(value)))
      {
        throw InputError("array '" + name + "' holds " + std::to_string(value) + " at node " + std::to_string(node),
          "compute the field again; a solve that diverged leaves such values");
      }
    }
  }
}

/// Phases and conductivities, where the piece has them.
void findPhases(vtkImageData* piece, FluxInput& input)
{
  const std::string name = fieldText(piece, "phase_array").value_or("phase");
  const auto* const array = vtkUnsignedCharArray::SafeDownCast(piece->GetPointData()->GetArray(name.c_str()));
  input.conductivity = fieldNumbers(piece, "phase_conductivity");
  for (const double value : input.conductivity)
  {
    if (!(value >= 0) || std::isinf(value))
    {
      throw InputError("field array 'phase_conductivity' holds " + std::to_string(value),
        "apply Steady Diffusion to the image as it is now");
    }
  }
  // Conductivities along and across walls, membranes: the links need more than the phases, the nodes' fluxes have to
  // do.
  const bool directed = !fieldNumbers(piece, "phase_conductivity_across").empty() ||
    !fieldNumbers(piece, "membrane_resistance").empty() ||
    fieldText(piece, "lattice").value_or("") == lbm::name(lbm::Stencil::Q1);
  if (array != nullptr && array->GetNumberOfComponents() == 1 && !input.conductivity.empty() && !directed)
    input.phaseArray = name;
}

json toJson(const FluxInput& input)
{
  json directions = json::array();
  for (const SolvedDirection& direction : input.directions)
    directions.push_back({ direction.axis, direction.value, direction.flux, direction.suffix });
  return { { "directions", directions }, { "quantity", input.quantity }, { "periodic", input.periodic },
    { "transient", input.transient }, { "stencil", input.stencil ? static_cast<int>(*input.stencil) : -1 },
    { "phase", input.phaseArray }, { "conductivity", input.conductivity } };
}

FluxInput fromJson(const json& text)
{
  FluxInput input;
  for (const json& direction : text.at("directions"))
  {
    input.directions.push_back({ direction.at(0).get<int>(), direction.at(1).get<std::string>(),
      direction.at(2).get<std::string>(), direction.at(3).get<std::string>() });
  }
  input.quantity = text.at("quantity").get<std::string>();
  input.periodic = text.at("periodic").get<bool>();
  input.transient = text.at("transient").get<bool>();
  if (const int stencil = text.at("stencil").get<int>(); stencil >= 0)
    input.stencil = static_cast<lbm::Stencil>(stencil);
  input.phaseArray = text.at("phase").get<std::string>();
  input.conductivity = text.at("conductivity").get<std::vector<double>>();
  return input;
}

} // namespace

FluxInput fluxInput(vtkImageData* piece, vtkInformation* value, vtkInformation* flux, const Team& team)
{
  const bool empty = piece->GetNumberOfPoints() == 0;
  FluxInput input;
  std::string text;
  team.agree(
    [&]
    {
      if (empty)
        return;
      const std::string valueName = chosenName(value);
      const std::string fluxName = chosenName(flux);
      for (const std::string& name : { valueName, fluxName })
        if (!name.empty())
          requireArray(piece, name);
      input.quantity = fieldText(piece, "quantity").value_or("temperature");
      if (valueName.empty() && fluxName.empty())
      {
        input.directions = findDirections(piece, { input.quantity, "temperature", "concentration" });
      }
      else
      {
        const auto axis = fieldText(piece, "direction").value_or("");
        input.directions = { { axis == "x" ? 0 : axis == "y" ? 1 : axis == "z" ? 2 : -1, valueName, fluxName, "" } };
      }
      if (input.directions.empty())
      {
        if (piece->GetCellData()->HasArray("flux") || piece->GetCellData()->HasArray(input.quantity.c_str()))
          throw InputError("the field is cell data; fluxes are read at points",
            "compute the field with Steady Diffusion, which works at points");
        throw InputError("the image has no point array 'temperature', 'concentration' or 'flux'",
          "apply Steady Diffusion first, or choose the arrays with SetInputArrayToProcess");
      }
      const std::string sides = fieldText(piece, "sides").value_or("insulated");
      if (sides == "mixed")
        throw InputError("the field was solved with mixed sides, and a flux map knows insulated and periodic ones",
          "solve it with one of these, or draw the flux of the solver");
      input.periodic = sides == "periodic";
      const std::string lattice = fieldText(piece, "lattice").value_or("");
      for (const auto stencil : { lbm::Stencil::D2Q5, lbm::Stencil::D2Q9, lbm::Stencil::D3Q7, lbm::Stencil::D3Q19 })
        if (lattice == lbm::name(stencil))
          input.stencil = stencil;
      input.transient = !fieldNumbers(piece, "time").empty() && !fieldNumbers(piece, "inlet_flux").empty();
      if (!input.transient) // its flux is more than what the links carry between values 1 and 0
        findPhases(piece, input);
      for (const SolvedDirection& direction : input.directions)
      {
        requireNumbers(piece, direction.value, 1, true);
        requireNumbers(piece, direction.flux, 3, false);
        if (direction.flux.empty() && input.phaseArray.empty())
          throw InputError("there is no flux, and it cannot be computed from '" + direction.value +
              "' without phases and their conductivities",
            input.transient ? "write the states with their flux: it is a setting of what computes them"
                            : "apply Steady Diffusion with its flux output on");
      }
      text = toJson(input).dump();
    });
  input = fromJson(json::parse(team.share(text, !empty)));
  team.agree(
    [&]
    {
      vtkDataArray* const phases = piece->GetPointData()->GetArray(input.phaseArray.c_str());
      if (!empty && phases != nullptr && phases->GetRange()[1] >= static_cast<double>(input.conductivity.size()))
        throw InputError("phase " + std::to_string(static_cast<int>(phases->GetRange()[1])) + " has no conductivity",
          "apply Steady Diffusion to the image as it is now");
    });
  return input;
}

} // namespace lamella
