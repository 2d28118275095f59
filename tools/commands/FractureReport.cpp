#include "commands/FractureReport.h"

#include "commands/DiffusionReport.h"
#include "commands/SensitivityReport.h"
#include "commands/WindowReport.h"
#include "session/Text.h"

#include "FractureData.h"
#include "WindowFields.h"
#include "core/Memory.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lamella::cli
{

namespace
{

double share(double part, double whole)
{
  return whole > 0 ? 100 * part / whole : 0;
}

vtkDataArray* column(vtkPolyData* data, const char* name)
{
  return data->GetPointData()->GetArray(name);
}

/// "wall", "wall-lamella", "grain-grain" for two different grains: as pairs are written on the command line.
std::string pairOf(vtkPolyData* broken, const std::vector<std::string>& names, vtkIdType i)
{
  const auto phase = [&](int end)
  { return names.at(static_cast<std::size_t>(column(broken, "phases")->GetComponent(i, end))); };
  const bool between = column(broken, "between_grains")->GetTuple1(i) != 0;
  return phase(0) == phase(1) && !between ? phase(0) : phase(0) + "-" + phase(1);
}

Json firstBreak(const FractureReport& report, const BondFields& f)
{
  if (report.broken->GetNumberOfPoints() == 0)
    return nullptr;
  const double* const at = report.broken->GetPoint(0);
  const std::vector<std::string> names = fieldTexts(report.run.image, "phase_names");
  Json phases = Json::array();
  for (int end = 0; end < 2; ++end)
    phases.push_back(names.at(static_cast<std::size_t>(column(report.broken, "phases")->GetComponent(0, end))));
  return { { "strain", f("first_break_strain") }, { "stress", f("first_break_stress") },
    { "position", std::vector<double>(at, at + f.dimension) }, { "phases", std::move(phases) } };
}

Json statistics(const BondFields& f)
{
  Json json;
  for (const char* name : { "events", "raises", "equilibria", "iterations", "local_cycles", "visited_nodes", "searches",
         "freed_pieces", "freed_nodes", "freed_bonds" })
    json[name] = f.whole(name);
  const std::array<const char*, 8> times{ "bonds", "first", "equilibria", "local", "search", "run", "states",
    "checkpoints" };
  for (std::size_t i = 0; i < times.size(); ++i)
    json[std::string(times[i]) + "_seconds"] = f("seconds", i);
  return json;
}

/// From one turning point of the load to the next.
Json branchesJson(const BondFields& f)
{
  const std::size_t count = fieldNumbers(f.image, "branch_to").size();
  if (count == 0)
    return nullptr;
  Json json = Json::array();
  for (std::size_t k = 0; k < count; ++k)
    json.push_back({ { "from", f("branch_from", k) }, { "to", f("branch_to", k) }, { "stress", f("branch_stress", k) },
      { "modulus", jsonNumber(f("branch_modulus", k)) }, { "work", f("branch_work", k) },
      { "released", f("branch_released", k) }, { "broken", f.whole("branch_broken", k) } });
  return json;
}

std::string branchesText(const BondFields& f)
{
  const std::size_t count = fieldNumbers(f.image, "branch_to").size();
  if (count == 0)
    return "";
  std::string text =
    fmt::format("    trough at         strain {:.6g}, stress {}\n", f("trough_strain"), pascal(f("trough_stress")));
  text += "\n    branch to strain  stress [Pa]   modulus [Pa]  work [J/m³]   of it released  bonds broken\n";
  constexpr std::size_t shown = 20; // the others are in the JSON
  for (std::size_t k = 0; k < std::min(count, shown); ++k)
    text += fmt::format("    {:<16.6g}  {:<12.5g}  {:<12.5g}  {:<12.5g}  {:<14.5g}  {}\n", f("branch_to", k),
      f("branch_stress", k), f("branch_modulus", k), f("branch_work", k), f("branch_released", k),
      grouped(f.whole("branch_broken", k)));
  if (count > shown)
    text += fmt::format("    … {} more, in the JSON\n", count - shown);
  return text + "\n";
}

std::string statisticsText(const BondFields& f)
{
  const double events = std::max(f("events"), 1.0);
  std::string text =
    fmt::format("\n  {} rises of the load, each one step up to the next break\n", grouped(f.whole("raises")));
  text += fmt::format("  {} equilibria of the whole sample with {} iterations   {:.3f} s\n",
    grouped(f.whole("equilibria")), grouped(f.whole("iterations")), f("seconds", 2));
  if (f.text("method") == "events")
  {
    text += fmt::format("  {} local corrections, an event visiting {:.2g} % of the solid   {:.3f} s\n",
      grouped(f.whole("local_cycles")), share(f("visited_nodes") / events, f("solid_nodes")), f("seconds", 3));
  }
  text += fmt::format("  most critical bonds, and {} searches for loose pieces    {:.3f} s\n",
    grouped(f.whole("searches")), f("seconds", 4));
  text += fmt::format("  {} pieces of {} nodes came loose with {} bonds\n", grouped(f.whole("freed_pieces")),
    grouped(f.whole("freed_nodes")), grouped(f.whole("freed_bonds")));
  text += fmt::format("  bonds {:.3f} s, first equilibrium {:.3f} s, fields {:.3f} s; {} for bonds and solver\n",
    f("seconds", 0), f("seconds", 1), f("seconds", 6), bytesText(f("bytes")));
  return text;
}

} // namespace

std::vector<std::pair<std::string, std::int64_t>> brokenByPair(const FractureReport& report)
{
  const std::vector<std::string> names = fieldTexts(report.run.image, "phase_names");
  std::map<std::string, std::int64_t> counts;
  for (vtkIdType i = 0; i < report.broken->GetNumberOfPoints(); ++i)
    ++counts[pairOf(report.broken, names, i)];
  std::vector<std::pair<std::string, std::int64_t>> sorted(counts.begin(), counts.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return sorted;
}

Json brokenByPairJson(const FractureReport& report)
{
  Json json = Json::object();
  for (const auto& [pair, count] : brokenByPair(report))
    json[pair] = count;
  return json;
}

std::string brokenByPairText(const FractureReport& report)
{
  const auto all = static_cast<double>(report.broken->GetNumberOfPoints());
  std::string text;
  for (const auto& [pair, count] : brokenByPair(report))
  {
    text += fmt::format(
      "{}{} {} ({:.3g} %)", text.empty() ? "" : ", ", pair, grouped(count), share(static_cast<double>(count), all));
  }
  return text;
}

std::string fractureJson(const FractureReport& report)
{
  const BondFields f(report.run);
  Json json;
  using enum Key::Kind;
  addKeys(json, f, { { "peak_stress" }, { "peak_strain" }, { "peak_broken", Whole }, { "effective_modulus" } });
  json["first_break"] = firstBreak(report, f);
  addBreakSensitivity(json, f);
  const auto windows = windowFields(report.run.image);
  json["window_errors"] = windowsJson(windows);
  json["size_effect"] = nullptr;
  if (!windows.empty())
    json["size_effect"] = { { "exponent", jsonNumber(f("strength_exponent")) },
      { "weibull_modulus", jsonNumber(f("weibull_modulus")) } };
  const std::vector<double> doubted = fieldNumbers(report.run.image, "strength_segmentation_error");
  const std::vector<double> total = fieldNumbers(report.run.image, "strength_total_error");
  json["surface_doubt"] = doubted.empty() ? Json() : Json(f("surface_doubt"));
  json["segmentation_errors"] = nullptr;
  if (!doubted.empty())
    json["segmentation_errors"] = { { "strength", jsonNumber(doubted[0] / f("peak_stress")) } };
  json["total_errors"] = nullptr;
  if (!total.empty())
    json["total_errors"] = { { "strength", jsonNumber(total[0] / f("peak_stress")) } };
  json["branches"] = branchesJson(f);
  json["trough_stress"] = nullptr;
  json["trough_strain"] = nullptr;
  if (!fieldNumbers(report.run.image, "trough_stress").empty())
    addKeys(json, f, { { "trough_stress" }, { "trough_strain" } });
  json["broken"] = f.whole("total_broken");
  json["broken_by_pair"] = brokenByPairJson(report);
  json["broken_energy"] = sizeKnown(report.run) ? Json(f("broken_energy")) : Json(nullptr);
  addKeys(json, f, { { "end", Text }, { "end_reason", Text } });
  const std::vector<vtkDataObject*> states(report.states.begin(), report.states.end());
  json["states"] = statesJson(states, report.stateFiles,
    { { "strain" }, { "stress" }, { "broken", Whole, "broken_bonds" }, { "hinges", Whole } });
  addKeys(json, f,
    { { "continued_at", Whole }, { "states_before", Whole }, { "checkpoints", Whole }, { "last_checkpoint", Whole },
      { "load", Text }, { "axis", Text, "load_axis" }, { "compression", Flag }, { "suction", Flag },
      { "contact", Flag }, { "method", Text }, { "breaking", Text } });
  addPlatens(json, f);
  addModel(json, f);
  json["statistics"] = statistics(f);
  addSizes(json, f);
  json["seconds"] = report.run.seconds;
  addRun(json, report.run);
  return dump(json);
}

namespace
{

/// What a doubt about surfaces leaves of the strength, and the whole of its error.
std::string doubtText(const BondFields& f)
{
  const std::vector<double> error = fieldNumbers(f.image, "strength_segmentation_error");
  if (error.empty())
    return "";
  const double peak = f("peak_stress");
  std::string text =
    fmt::format("    surfaces within {:.2g} pixels of where the picture has them leave {} of the peak open; rough\n",
      f("surface_doubt"), percent(error[0] / peak));
  const std::string whole = totalText({ "peak", 1, peak, " Pa" }, strengthErrorParts(f.image), f("surface_doubt"));
  return text + whole;
}

/// How far the sample speaks for others, and how strength falls with size.
std::string strengthText(const BondFields& f)
{
  std::string text;
  for (const statistics::WindowError& window : windowFields(f.image))
  {
    text += "    window: samples of this size have in the mean, with 95 % probability\n";
    text += "    " + windowText(window.name + " ", window, " Pa", 1);
    if (const double exponent = f("strength_exponent"); std::isfinite(exponent))
      text += fmt::format("        ten times as large they have {:.2g} of it; Weibull modulus {:.2g} by the windows' "
                          "scatter; both rough\n",
        std::pow(10.0, exponent), f("weibull_modulus"));
  }
  return text;
}

} // namespace

std::string fractureTable(const FractureReport& report)
{
  const BondFields f(report.run);
  std::string text = sampleText(report.run, true);
  const bool shear = f.text("load") == "shear";
  const bool pressure = f.text("load") == "pressure";
  if (pressure)
    text += fmt::format("\n  {} in closed pores\n",
      f("suction") != 0 ? "suction: pressures, and what pores lose of their volume, are positive" : "pressure");
  else
    text += fmt::format("\n  {} along {}{}\n", f.text("load"), f.text("load_axis"),
      f("compression") != 0 ? ", platens approaching: strains and stresses are positive in compression" : "");
  if (f("contact") != 0)
    text += "    cracks close: broken bonds that are pressed bear again\n";
  text += fmt::format("    {}  {}\n",
    pressure  ? "volume modulus  "
      : shear ? "shear modulus   "
              : "modulus         ",
    pascal(f("effective_modulus")));
  if (f("total_broken") > 0)
  {
    const std::vector<std::string> names = fieldTexts(report.run.image, "phase_names");
    text += fmt::format("    first break at    strain {:.6g}, stress {}, in {}\n", f("first_break_strain"),
      pascal(f("first_break_stress")), pairOf(report.broken, names, 0));
    text += breakSensitivityText(f);
  }
  text += fmt::format("    peak at           strain {:.6g}, stress {}, {} bonds broken\n", f("peak_strain"),
    pascal(f("peak_stress")), grouped(f.whole("peak_broken")));
  text += branchesText(f) + strengthText(f) + doubtText(f);
  text += fmt::format(
    "    end at            strain {:.6g}, stress {} ({:.3g} % of the peak), {} bonds broken:\n      {}\n", f("strain"),
    pascal(f("stress")), share(f("stress"), f("peak_stress")), grouped(f.whole("total_broken")), f.text("end_reason"));
  if (f("total_broken") > 0)
  {
    text += "    broken            " + brokenByPairText(report) + "\n";
    if (sizeKnown(report.run))
      text += fmt::format("    energy in them    {:.6g} {}\n", f("broken_energy"), f.dimension == 2 ? "J/m" : "J");
  }
  for (std::size_t i = 0; i + 1 < report.states.size(); ++i)
  {
    const auto number = [&](const char* name) { return fieldNumbers(report.states[i], name).at(0); };
    text += fmt::format("    state kept at     strain {:.6g}, stress {}, {} bonds broken\n", number("strain"),
      pascal(number("stress")), grouped(std::llround(number("broken_bonds"))));
  }
  const double run = f("seconds", 5);
  text +=
    fmt::format("\n  {}, horizon {:g}; {}, {}: {} events, {:.3g} ms each (run: {:.2f} s, everything: {:.2f} s, {})\n",
      f.text("continuum"), f("horizon"), f.text("method"), f.text("breaking"), grouped(f.whole("events")),
      f("events") > 0 ? 1e3 * run / f("events") : 0.0, run, report.run.seconds,
      bytesText(static_cast<double>(peakMemoryBytes())));
  if (f("continued_at") > 0)
  {
    text += fmt::format("  continued after {} events; events and the time of the run are those of all its parts\n",
      grouped(f.whole("continued_at")));
  }
  if (f("last_checkpoint") > 0)
  {
    text += fmt::format("  {} checkpoints in {:.2f} s, the last after {} events\n", grouped(f.whole("checkpoints")),
      f("seconds", 7), grouped(f.whole("last_checkpoint")));
  }
  text += sizesText(f);
  if (report.statistics)
    text += statisticsText(f);
  text += platensText(report.run);
  text += wroteText(report.run.written);
  return text;
}

} // namespace lamella::cli
