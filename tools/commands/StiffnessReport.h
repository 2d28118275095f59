#pragma once

#include "files/FieldReport.h"

#include <string>
#include <vector>

/// What the reports of commands share that find a stiffness tensor.
namespace lamella::cli
{

/// The tensor, its errors and bounds, constants, sides and pieces, as keys.
void addStiffness(Json& json, const Fields& f);
/// Iterations, and the solves of the box and of the coarser pictures. @param refine how often pixels were split
void addStiffnessSolves(Json& json, const Fields& f, int refine);

/// `sensitivity`, `relative_sensitivity`, `input_errors`, `surface_sensitivity`, `segmentation_errors`, `total_errors`
/// by constant, the first two of a load alone by `energy`, and `surface_doubt`; null where they were not asked for.
void addSensitivity(Json& json, const Fields& f);
/// The same of the moduli, for people; empty where nothing was asked for.
[[nodiscard]] std::string sensitivityText(const Fields& f);

/// The tensor, the constants and the bounds, each with its error, for people.
[[nodiscard]] std::string stiffnessText(const Fields& f);
/// What a method's error is of, in words.
struct ErrorWords
{
  std::string of, against, leavesOut;
};
/// The last lines: what the error is where there is one, whose the constants of plane strain are, and the files.
[[nodiscard]] std::string stiffnessEnd(
  const Fields& f, const ErrorWords& error, const std::vector<std::string>& written);
/// "8 + 8 + 8"
[[nodiscard]] std::string iterationsText(const Fields& f);

/// A power of 1000 in which a stress is a number people read.
struct StressUnit
{
  double value;
  const char* name;
};
[[nodiscard]] StressUnit stressUnit(double largest);

} // namespace lamella::cli
