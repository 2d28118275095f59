#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lamella::statistics
{

/// Of 1.96 standard deviations on either side, which hold a normal variable 19 times out of 20.
inline constexpr double coverage95 = 1.959963984540054;

/// A number that is looked for, above 0.
struct FitParameter
{
  std::string name;
  double start = 1;
  /// All that scale at once multiply the model's values by what they are multiplied by, or nearly: the search begins
  /// with that.
  bool scales = false;
};

/// What was measured, with half of the interval that holds it 19 times out of 20.
struct FitMeasurement
{
  std::string name;
  double value = 0;
  double halfWidth = 0; ///< above 0
};

/// What a model gives for some parameters.
struct FitEvaluation
{
  std::vector<double> values;      ///< one a measurement
  std::vector<double> derivatives; ///< by measurement and parameter, row by row; empty: they are not told
};

struct FitOptions
{
  /// Steps end where none is more than this share of a parameter, or changes a value by more than a twentieth of its
  /// measurement's standard deviation.
  double tolerance = 1e-4;
  int mostEvaluations = 40;
  /// Told how many evaluations are done; false cancels.
  std::function<bool(int evaluations)> progress;
};

struct FittedParameter
{
  double value = 0;
  /// Interval that holds it 19 times out of 20, by the measurements alone: value / factor to value × factor.
  double low = 0, high = 0;
};

struct FitResult
{
  std::vector<FittedParameter> parameters;
  std::vector<double> values;      ///< of the model there
  std::vector<double> derivatives; ///< of the model there, by measurement and parameter
  std::vector<double> covariance;  ///< of the parameters' logarithms, by rows
  double misfit = 0;               ///< sum of squared differences over their standard deviations
  int freedom = 0;                 ///< measurements less parameters
  double chance = 1;               ///< of a misfit at least as large, if the model is right; 1 without freedom
  int evaluations = 0;
};

/// Parameters that fit measurements best, by least squares: Gauss–Newton with Levenberg's damping in the parameters'
/// logarithms, on the model's derivatives, or where it tells none on differences that Broyden's updates keep (Nocedal &
/// Wright, Numerical Optimization, 2006, chapters 10 and 11), made anew at the end. With derivatives a step that went
/// up is followed by one more, and both are taken back where that is no better (a watchdog: Chamberlain, Powell,
/// Lemarechal & Pedersen, Math. Program. Study 16 (1982) 1).
///
/// Intervals are those of the model made linear there. Where `model` throws a ParameterError a step was too long, and
/// half of it is tried: what fits best may lie where the model ends.
///
/// @throws ParameterError: fewer measurements than parameters, values not finite or not positive; InputError where the
///   measurements do not tell a parameter (its interval would span more than two decades), with its name and the
///   reason, or where no value of a parameter fits; DivergenceError; Cancelled; what `model` throws
[[nodiscard]] FitResult fit(const std::vector<FitParameter>& parameters,
  const std::vector<FitMeasurement>& measurements,
  const std::function<FitEvaluation(std::span<const double> parameters)>& model, const FitOptions& options = {});

/// What else a value of the model may be off by: half of the interval that holds it 19 times out of 20. Errors of one
/// cause go together: all are up or down at once; others are independent.
struct FitError
{
  double halfWidth = 0;
  int cause = 0;
};

/// Intervals of the same fit once more, where the model's values are uncertain as well: the covariance that
/// measurements and errors leave of an estimate that weighs measurements by their own uncertainty.
/// @param errors one a measurement
void widen(
  FitResult& result, const std::vector<FitMeasurement>& measurements, const std::vector<FitError>& errors = {});

} // namespace lamella::statistics
