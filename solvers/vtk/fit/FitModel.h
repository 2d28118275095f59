#pragma once

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <memory>
#include <optional>
#include <string>
#include <vector>

class vtkAlgorithm;
class vtkImageData;

/// Solvers as models that can be fitted. Not installed.
namespace lamella
{

/// A phase's property that is looked for, or its slope: how much it changes by where moisture changes by 1.
struct FitUnknown
{
  std::string property; ///< as the word of its setting
  std::string phase;
  std::optional<double> start;
  bool slope = false;

  [[nodiscard]] std::string name() const { return (slope ? "slope of " : "") + property + " of " + phase; }
  [[nodiscard]] std::string key() const { return (slope ? "slope:" : "") + property + ":" + phase; }
};

/// A solver, what can be looked for with it, and what it gives.
class FitModel
{
public:
  virtual ~FitModel() = default;
  FitModel() = default;
  FitModel(const FitModel&) = delete;
  FitModel& operator=(const FitModel&) = delete;

  /// The first is meant where none is named.
  [[nodiscard]] virtual std::vector<std::string> properties() const = 0;
  [[nodiscard]] virtual std::string form() const = 0; ///< of an unknown
  /// No slopes: these are the fit's own.
  virtual void set(const FitUnknown& unknown, double value) = 0;
  /// Where a search begins that nobody told to.
  [[nodiscard]] virtual double startOf(const FitUnknown& unknown, double measured) const = 0;
  /// Whether values are multiplied by what all such are multiplied by; a search then begins with that.
  [[nodiscard]] virtual bool scales(const FitUnknown&) const { return false; }
  /// Of what was solved last: quantities by name, their values and derivatives.
  [[nodiscard]] virtual std::vector<std::string> quantities() const = 0;
  [[nodiscard]] virtual double value(const std::string& quantity) const = 0;
  [[nodiscard]] virtual double derivative(const std::string& quantity, const FitUnknown& by) const = 0;
  /// From now on the error against the material's value, where the solver was asked for it, and fields or none.
  virtual void finish(bool fields) = 0;
  [[nodiscard]] virtual double error(const std::string& quantity) const = 0; ///< of the value, absolute; NaN: not known
  [[nodiscard]] virtual vtkImageData* output() const = 0;
};

/// A solver's model. The solver is told to give derivatives and nothing else; it has its own settings again with
/// finish(), or where the model goes before. @throws ParameterError for a solver that cannot be fitted
[[nodiscard]] std::unique_ptr<FitModel> fitModelOf(vtkAlgorithm* solver);

/// Words of a solver's settings that a fit sees to itself, or has no use for; none of a class that cannot be fitted.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT const std::vector<std::string>& settingsLeftOut(const std::string& className);

} // namespace lamella
