#pragma once

#include "files/JsonReport.h"

#include "statistics/ErrorParts.h"

#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

class vtkDataObject;

/// What commands tell of how a value changes with the phases', and of its whole error.
namespace lamella::cli
{

/// "2.3 %", or "unknown".
[[nodiscard]] std::string percent(double share);

/// Of one value, by name of what phases are told by.
struct Sensitivity
{
  std::string name;                                    ///< of the value
  std::vector<std::pair<std::string, double>> changes; ///< relative, over what is relative of the phase
  std::vector<std::pair<std::string, double>> inputs;  ///< what the phases' uncertainty leaves, relative
};

/// A line of changes, and another where there are uncertainties.
/// @param width of the name
/// @param of    whose uncertainty: "the conductivities'"
[[nodiscard]] std::string sensitivityText(const Sensitivity& one, int width, const char* of);

/// What the phases are told by, as field data have it.
struct MaterialNumbers
{
  std::vector<std::string> names;
  std::vector<double> values, uncertainty;

  explicit MaterialNumbers(vtkDataObject* data);
  /// Adds how a value changes with each, and that of the logarithms, by name of the value and of these.
  /// @param by of these in turn; empty: adds nothing
  void add(
    Json& sensitivity, Json& relative, const std::string& name, double value, const std::vector<double>& by) const;
  /// The same in words.
  [[nodiscard]] Sensitivity of(const std::string& name, double value, const std::vector<double>& by) const;
};

/// A number of a table.
struct TableValue
{
  std::string name;
  int width = 1; ///< of the name
  double value = 0;
  std::string unit; ///< with a space before it, or empty
};

/// "value ± error (parts); what would halve it"; empty where the total is not known.
/// @param surfaceDoubt of the part "segmentation" [pixels]
[[nodiscard]] std::string totalText(const TableValue& value, std::span<const statistics::ErrorPart> parts,
  double surfaceDoubt = std::numeric_limits<double>::quiet_NaN());
inline constexpr const char* totalHeading = "  in all, of what was asked for\n";

} // namespace lamella::cli
