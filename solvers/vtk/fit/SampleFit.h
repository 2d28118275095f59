#pragma once

#include "FitModel.h"

#include "statistics/Fit.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

class vtkDataObject;
class vtkTable;

/// A fit of phases' properties to what was measured of samples: what all front ends share. Not installed.
namespace lamella
{

/// One number that was measured, the sample that it is of, and that sample's moisture where it was told.
struct FitMeasured
{
  std::size_t sample = 0;
  std::string quantity;
  std::optional<double> moisture;
  statistics::FitMeasurement value; ///< whose name is as it was given
};

/// What fits best, and how well it is told.
struct VTKLAMELLASOLVERSVTK_EXPORT FoundFit
{
  std::vector<FitUnknown> unknowns;
  std::vector<FitMeasured> measured;
  statistics::FitResult best; ///< of the search: what has a slope by its values at the least and the most moisture
  /// By unknown, with intervals by the measurements, and by the error of lattice and picture where that is known.
  std::vector<statistics::FittedParameter> values;
  std::vector<statistics::FittedParameter> byMeasurement; ///< by the measurements alone
  std::vector<double> covariance; ///< of the unknowns by rows: of logarithms, but where there is a slope
  std::vector<double> errors;     ///< by measurement: of lattice and picture, absolute; NaN
  bool withLattice = false;       ///< whether all of them are known
  int solves = 0;                 ///< of all samples together

  /// Of two unknowns, or their logarithms, which is the same.
  [[nodiscard]] double correlation(std::size_t a, std::size_t b) const;
  /// What the intervals hold, in words.
  [[nodiscard]] std::string interval() const;
};

/// "PHASE", "PROPERTY:PHASE", each with "slope:" before and "=START" behind it or not. @throws ParameterError
[[nodiscard]] std::vector<FitUnknown> fitUnknowns(const FitModel& model, const std::vector<std::string>& texts);

/// "QUANTITY=VALUE±HALF", of the second sample "2/QUANTITY=VALUE±HALF", at some moisture
/// "QUANTITY@MOISTURE=VALUE±HALF";
/// +- for ±. @throws ParameterError
[[nodiscard]] std::vector<FitMeasured> fitMeasured(const std::vector<std::string>& texts, std::size_t samples);

/// Fits (statistics/Fit.h), and solves all samples once more at the fit, at each moisture, the first one last.
///
/// A property with a slope is value + slope × moisture. The search has instead its values at the least and the most
/// moisture, which are positive and so are all between; their covariance gives that of value and slope, of which the
/// interval is symmetric, but that of a value at the least moisture.
/// @param phases of the first sample, where unknowns are looked up
/// @param solve solves one of the samples
/// @throws ParameterError for a phase or a quantity that the samples do not have; as statistics::fit(), and `solve`
[[nodiscard]] FoundFit fitSamples(FitModel& model, std::vector<FitUnknown> unknowns, std::vector<FitMeasured> measured,
  std::size_t samples, const std::vector<std::string>& phases, const std::function<void(std::size_t sample)>& solve,
  bool fields);

/// Writes it into field data, as vtkMaterialFit tells.
void describe(vtkDataObject* output, const FoundFit& found);
/// A row an unknown, and a row a measurement.
void fillTables(vtkTable* unknowns, vtkTable* measured, const FoundFit& found);

} // namespace lamella
