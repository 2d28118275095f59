#pragma once

#include "FitModel.h"

#include "statistics/Fit.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

class vtkDataObject;

/// A fit of phases' properties to what was measured of samples: what all front ends share. Not installed.
namespace lamella
{

/// One number that was measured, and the sample that it is of.
struct FitMeasured
{
  std::size_t sample = 0;
  std::string quantity;
  statistics::FitMeasurement value; ///< whose name is as it was given
};

/// What fits best, and how well it is told.
struct VTKLAMELLASOLVERSVTK_EXPORT FoundFit
{
  std::vector<FitUnknown> unknowns;
  std::vector<FitMeasured> measured;
  /// Intervals by the measurements, and by the error of lattice and picture where that is known.
  statistics::FitResult best;
  std::vector<statistics::FittedParameter> byMeasurement; ///< by the measurements alone
  std::vector<double> errors;                             ///< by measurement: of lattice and picture, absolute; NaN
  bool withLattice = false;                               ///< whether all of them are known
  int solves = 0;                                         ///< of all samples together

  /// Of the logarithms of two unknowns.
  [[nodiscard]] double correlation(std::size_t a, std::size_t b) const;
  /// What the intervals hold, in words.
  [[nodiscard]] std::string interval() const;
};

/// "PHASE", "PROPERTY:PHASE", each with "=START" behind it or not. @throws ParameterError
[[nodiscard]] std::vector<FitUnknown> fitUnknowns(const FitModel& model, const std::vector<std::string>& texts);

/// "QUANTITY=VALUE±HALF", of the second sample "2/QUANTITY=VALUE±HALF"; +- for ±. @throws ParameterError
[[nodiscard]] std::vector<FitMeasured> fitMeasured(const std::vector<std::string>& texts, std::size_t samples);

/// Fits (statistics/Fit.h), and solves all samples once more at the fit, the first one last.
/// @param phases of the first sample, where unknowns are looked up
/// @param solve solves one of the samples
/// @throws ParameterError for a phase or a quantity that the samples do not have; as statistics::fit(), and `solve`
[[nodiscard]] FoundFit fitSamples(FitModel& model, std::vector<FitUnknown> unknowns, std::vector<FitMeasured> measured,
  std::size_t samples, const std::vector<std::string>& phases, const std::function<void(std::size_t sample)>& solve,
  bool fields);

/// Writes it into field data, as vtkMaterialFit tells.
void describe(vtkDataObject* output, const FoundFit& found);

} // namespace lamella
