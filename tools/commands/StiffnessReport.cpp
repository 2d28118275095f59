#include "commands/StiffnessReport.h"

#include "commands/SensitivityReport.h"
#include "session/Text.h"

#include "StiffnessSensitivity.h"
#include "vtkLatticeConversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace lamella::cli
{

namespace
{

/// A tensor by rows; null where it is not known.
Json matrix(const Fields& f, const char* name)
{
  const std::vector<double> values = f.numbers(name);
  return std::isfinite(values.front()) ? rowsOf(values, values.size() == 36 ? 6 : 3) : Json(nullptr);
}

Json constantsJson(const Fields& f)
{
  Json json = Json::object();
  const std::vector<std::string> names = fieldTexts(f.data, "constant_names");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    json[names[i]] = { { "value", jsonNumber(f("constants", i)) },
      { "extrapolated", jsonNumber(f("constants_extrapolated", i)) },
      { "estimated_error", jsonNumber(f("constants_error", i)) } };
  }
  return json;
}

Json stepsJson(const Fields& f, int refine)
{
  Json steps = Json::array();
  for (std::size_t i = 0; i < f.numbers("step_nodes").size(); ++i)
  {
    Json step = { { "refine", refine }, { "nodes", f.whole("step_nodes", i) },
      { "iterations", f.whole("step_iterations", i) }, { "seconds", f("step_seconds", i) } };
    if (i > 0)
    {
      step["every_pixel"] = f("step_every", i);
      step["pictures"] = f.whole("step_pictures", i);
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

std::string percentOrDash(double share)
{
  return std::isfinite(share) ? fmt::format("{:.2g} %", 100 * share) : "-";
}

double largestOf(const std::vector<double>& values)
{
  return std::accumulate(
    values.begin(), values.end(), 0.0, [](double most, double v) { return std::max(most, std::abs(v)); });
}

} // namespace

StressUnit stressUnit(double largest)
{
  constexpr std::array<StressUnit, 4> units{ { { 1e9, "GPa" }, { 1e6, "MPa" }, { 1e3, "kPa" }, { 1, "Pa" } } };
  for (const StressUnit& unit : units)
    if (largest >= unit.value)
      return unit;
  return units.back();
}

void addStiffness(Json& json, const Fields& f)
{
  json["components"] = fieldTexts(f.data, "stiffness_components");
  json["stiffness"] = matrix(f, "stiffness");
  json["extrapolated"] = matrix(f, "stiffness_extrapolated");
  json["estimated_errors"] = matrix(f, "stiffness_error");
  json["estimated_error"] = jsonNumber(f("estimated_error"));
  json["constants"] = constantsJson(f);
  json["bounds"] = { { "voigt", matrix(f, "stiffness_voigt") }, { "reuss", matrix(f, "stiffness_reuss") } };
  json["eigenvalues"] = f.numbers("eigenvalues");
  json["resisting"] = f.whole("resisting");
  json["asymmetry"] = f("stiffness_asymmetry");
  Json crosses = Json::object();
  Json seams = Json::object();
  for (std::size_t a = 0; a < static_cast<std::size_t>(f.dimension); ++a)
  {
    const std::string axis(1, "xyz"[a]);
    crosses[axis] = f.whole("crosses", a) != 0;
    seams[axis] = { { "seam", f("seam_mismatch", a) }, { "layers", f("layer_mismatch", a) } };
  }
  json["crosses"] = std::move(crosses);
  json["mismatch"] = std::move(seams);
  json["pieces"] = f.whole("pieces");
}

void addStiffnessSolves(Json& json, const Fields& f, int refine)
{
  std::vector<std::int64_t> iterations;
  for (const double n : f.numbers("iterations"))
    iterations.push_back(std::llround(n));
  json["iterations"] = iterations;
  json["steps"] = stepsJson(f, refine);
}

namespace
{

/// One of what each of so many has in turn. @param all none: nothing
std::vector<double> oneOfEach(const std::vector<double>& all, std::size_t count, std::size_t i)
{
  std::vector<double> by;
  for (std::size_t p = 0; p < count && !all.empty(); ++p)
    by.push_back(all.at(p * (all.size() / count) + i));
  return by;
}

} // namespace

void addSensitivity(Json& json, const Fields& f)
{
  Json sensitivity;
  Json relative;
  Json inputs;
  Json totals;
  Json surfaces;
  Json segmentation;
  const MaterialNumbers numbers(f.data);
  const std::vector<std::string> names = fieldTexts(f.data, "constant_names");
  const std::vector<double> input = fieldNumbers(f.data, "constants_input_error");
  const std::vector<double> total = fieldNumbers(f.data, "constants_total_error");
  const std::vector<std::string> pairs = fieldTexts(f.data, "surface_pairs");
  const std::vector<double> doubts = fieldNumbers(f.data, "constants_segmentation_error");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    const double value = f("constants", i);
    numbers.add(sensitivity, relative, names[i], value,
      oneOfEach(fieldNumbers(f.data, "constants_sensitivity"), numbers.names.size(), i));
    if (!input.empty())
      inputs[names[i]] = jsonNumber(input[i] / std::abs(value));
    const std::vector<double> moved = oneOfEach(fieldNumbers(f.data, "constants_surface_sensitivity"), pairs.size(), i);
    for (std::size_t p = 0; p < moved.size(); ++p)
      surfaces[names[i]][pairs[p]] = jsonNumber(moved[p]);
    if (!doubts.empty())
      segmentation[names[i]] = jsonNumber(doubts[i] / std::abs(value));
    if (!total.empty())
      totals[names[i]] = jsonNumber(total[i] / std::abs(value));
  }
  if (const std::vector<double> energy = fieldNumbers(f.data, "load_energy_sensitivity"); !energy.empty())
    numbers.add(sensitivity, relative, "energy", f("load_energy"), energy);
  json["sensitivity"] = std::move(sensitivity);
  json["relative_sensitivity"] = std::move(relative);
  json["input_errors"] = std::move(inputs);
  json["surface_doubt"] = doubts.empty() ? Json() : Json(f("surface_doubt"));
  json["surface_sensitivity"] = std::move(surfaces);
  json["segmentation_errors"] = std::move(segmentation);
  json["total_errors"] = std::move(totals);
}

std::string sensitivityText(const Fields& f)
{
  const MaterialNumbers numbers(f.data);
  std::string text;
  std::string moved;
  std::string whole;
  const auto add = [&](const std::string& name, double value, const std::vector<double>& by)
  {
    if (value > 0)
      text += sensitivityText(numbers.of(name, value, by), 6, "the constants'");
  };
  const std::vector<std::string> names = fieldTexts(f.data, "constant_names");
  const std::vector<double> sensitivity = fieldNumbers(f.data, "constants_sensitivity");
  const bool total = !fieldNumbers(f.data, "constants_total_error").empty();
  const std::vector<double> doubts = fieldNumbers(f.data, "constants_segmentation_error");
  const double doubt = doubts.empty() ? std::numeric_limits<double>::quiet_NaN() : f("surface_doubt");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    const double value = f("constants", i);
    if (names[i].starts_with("nu") || !(value > 0))
      continue;
    add(names[i], value, oneOfEach(sensitivity, numbers.names.size(), i));
    if (!doubts.empty())
      moved += fmt::format("    {:<6}  {}\n", names[i], percent(doubts[i] / value));
    const auto [unit, unitName] = stressUnit(value);
    if (total)
      whole +=
        totalText({ names[i], 6, value / unit, std::string(" ") + unitName }, constantErrorParts(f.data, i), doubt);
  }
  if (const std::vector<double> energy = fieldNumbers(f.data, "load_energy_sensitivity"); !energy.empty())
    add("energy", f("load_energy"), energy);
  if (!text.empty())
    text = "  1 % more of a phase's constant changes the box's by\n" + text;
  if (!moved.empty())
    text +=
      fmt::format("  surfaces within {:.2g} pixels of where the picture has them change the box's by\n", doubt) + moved;
  return text + (whole.empty() ? whole : totalHeading + whole);
}

std::string stiffnessText(const Fields& f)
{
  const std::vector<std::string> names = fieldTexts(f.data, "stiffness_components");
  const std::vector<double> c = f.numbers("stiffness");
  const std::size_t n = names.size();
  const auto [unit, unitName] = stressUnit(largestOf(c));
  const bool known = std::isfinite(f("estimated_error"));

  std::string text = fmt::format("\n  stiffness [{}], stress by row, mean strain by column{}\n  {:>4}", unitName,
    known ? "; after ± its error" : "", "");
  const std::vector<double> errors = f.numbers("stiffness_error");
  for (const std::string& name : names)
    text += fmt::format("{:>{}}", name, known ? 19 : 11);
  // what round-off leaves of nothing is none
  const auto shown = [&](double v) { return std::abs(v) < 1e-6 * largestOf(c) ? 0 : v / unit; };
  for (std::size_t a = 0; a < n; ++a)
  {
    text += fmt::format("\n  {:>4}", names[a]);
    for (std::size_t b = 0; b < n; ++b)
    {
      const std::size_t i = a * n + b;
      text += fmt::format("{:>11.5g}", shown(c[i]));
      text += known ? fmt::format(" ±{:>6.2g}", shown(errors[i])) : "";
    }
  }

  text += fmt::format("\n\n  {:<7}{:>16}{:>10}{:>19}\n", "", "value", "error", "extrapolated");
  const std::vector<std::string> constants = fieldTexts(f.data, "constant_names");
  for (std::size_t i = 0; i < constants.size(); ++i)
  {
    const double value = f("constants", i);
    const double limit = f("constants_extrapolated", i);
    const bool ratio = constants[i].starts_with("nu");
    const auto number = [&](double v)
    {
      return !std::isfinite(v) ? std::string("-")
        : ratio                ? fmt::format("{:.4f}", v)
                               : fmt::format("{:.5g} {}", v / unit, unitName);
    };
    const double error = f("constants_error", i);
    text += fmt::format("  {:<7}{:>16}{:>10}{:>19}\n", constants[i], number(value),
      ratio         ? (std::isfinite(error) ? fmt::format("{:.2g}", error) : "-")
        : value > 0 ? percentOrDash(error / value)
                    : "-",
      number(limit));
  }
  const std::vector<double> lower = f.numbers("stiffness_reuss");
  const std::vector<double> upper = f.numbers("stiffness_voigt");
  text += "\n  bounds of the diagonal (Reuss, Voigt)\n";
  for (std::size_t a = 0; a < n; ++a)
  {
    text += fmt::format(
      "    {:<4}{:.5g} to {:.5g} {}\n", names[a], lower[a * n + a] / unit, upper[a * n + a] / unit, unitName);
  }
  return text;
}

std::string stiffnessEnd(const Fields& f, const ErrorWords& error, const std::vector<std::string>& written)
{
  std::string text;
  if (std::isfinite(f("estimated_error")))
    text += fmt::format("  The error is that of {} against {},\n"
                        "  from every second, third and fourth pixel. Not in it: {}.\n",
      error.of, error.against, error.leavesOut);
  if (f.text("continuum") == "plane-strain")
    text += "  Constants of the plane: an isotropic material would have E/(1 - nu²) and nu/(1 - nu).\n";
  return text + wroteText(written);
}

std::string iterationsText(const Fields& f)
{
  std::string iterations;
  for (const double count : f.numbers("iterations"))
    iterations += fmt::format("{}{:g}", iterations.empty() ? "" : " + ", count);
  return iterations;
}

} // namespace lamella::cli
