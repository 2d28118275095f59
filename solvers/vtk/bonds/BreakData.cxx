#include "BreakData.h"

#include "FieldNumbers.h"
#include "Uncertainties.h"

#include "vtkFieldData.h"
#include "vtkImageData.h"

#include <cmath>
#include <string>
#include <vector>

namespace pd = lamella::peridynamics;

namespace lamella
{

void BondUncertainties::require(const pd::PairTable& table) const
{
  requireUncertainties(table.young, young, "Young's modulus");
  requireUncertainties(table.fractureEnergy, fractureEnergy, "fracture energy");
  requireUncertainties(table.toughness, toughness, "toughness");
  requireUncertainties(table.criticalStretch, criticalStretch, "critical stretch");
}

double BondUncertainties::of(const pd::PairNumber& number) const
{
  const Values& table = number.property == "young" ? young
    : number.property == "fracture-energy"         ? fractureEnergy
    : number.property == "toughness"               ? toughness
                                                   : criticalStretch;
  const auto found = table.find(number.pair);
  return found == table.end() ? 0 : found->second;
}

namespace
{

std::vector<pd::PairNumber> numbersOf(const BondScene& scene, const BondSettings& settings)
{
  return pd::pairNumbers(
    settings.materials, scene.phases().names, scene.nodes(), scene.lattice().spacing, scene.model());
}

} // namespace

pd::BondModel sensitivityModel(const BondScene& scene, const BondSettings& settings)
{
  pd::BondModel model = scene.model();
  model.pairGroups = pd::pairGroups(numbersOf(scene, settings));
  return model;
}

void setBreakSensitivity(vtkImageData* output, const BondScene& scene, const BondSettings& settings,
  const BondUncertainties& uncertainties, double stress, const std::optional<pd::BreakSensitivity>& sensitivity)
{
  for (const char* const name : { "material_numbers", "material_values", "material_uncertainty",
         "first_break_sensitivity", "first_break_input_error" })
    output->GetFieldData()->RemoveArray(name);
  if (!sensitivity)
    return;
  std::vector<std::string> names;
  std::vector<double> values;
  std::vector<double> halves;
  std::vector<double> changes;
  double square = 0; // they are independent
  for (const pd::PairNumber& number : numbersOf(scene, settings))
  {
    names.push_back(number.name());
    values.push_back(number.value);
    halves.push_back(uncertainties.of(number));
    changes.push_back(pd::relativeChange(*sensitivity, number) * stress / number.value);
    square += std::pow(changes.back() * halves.back(), 2);
  }
  setFieldTexts(output, "material_numbers", names);
  setFieldNumbers(output, "material_values", values);
  setFieldNumbers(output, "material_uncertainty", halves);
  setFieldNumbers(output, "first_break_sensitivity", changes);
  if (uncertainties.any())
    setFieldNumber(output, "first_break_input_error", std::sqrt(square));
}

} // namespace lamella
