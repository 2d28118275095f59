#pragma once

#include "BondScene.h"

class vtkImageData;

/// How the stress of the first break changes with the materials, as field data. Not installed.
namespace lamella
{

/// How far the values of a table of materials may be off, half of an interval of 95 %, by the words of the table.
struct BondUncertainties
{
  using Values = peridynamics::PairTable::Values;
  Values young{}, fractureEnergy{}, toughness{}, criticalStretch{};

  [[nodiscard]] bool any() const
  {
    return !young.empty() || !fractureEnergy.empty() || !toughness.empty() || !criticalStretch.empty();
  }
  /// @throws ParameterError for those of nothing, and those that are no numbers
  void require(const peridynamics::PairTable& table) const;
  /// @return 0 where none was given
  [[nodiscard]] double of(const peridynamics::PairNumber& number) const;
};

/// The scene's model, with the pairs told apart that a value of the table tells apart.
[[nodiscard]] peridynamics::BondModel sensitivityModel(const BondScene& scene, const BondSettings& settings);

/// `material_numbers`, `material_values`, `material_uncertainty`; by these in turn `first_break_sensitivity` [Pa over
/// the value's unit]; with uncertainties `first_break_input_error` [Pa]. What an image has of them from before goes.
/// @param stress of the first break [Pa]
/// @param sensitivity none: nothing else
void setBreakSensitivity(vtkImageData* output, const BondScene& scene, const BondSettings& settings,
  const BondUncertainties& uncertainties, double stress,
  const std::optional<peridynamics::BreakSensitivity>& sensitivity);

} // namespace lamella
