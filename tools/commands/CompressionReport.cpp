#include "commands/CompressionReport.h"

#include "commands/DiffusionReport.h"
#include "files/TableText.h"
#include "session/Text.h"

#include "core/Memory.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::cli
{

namespace
{

constexpr int rowsShown = 12;

double cell(vtkTable* table, vtkIdType row, const char* name)
{
  return vtkDataArray::SafeDownCast(table->GetColumnByName(name))->GetTuple1(row);
}

/// Walls, plane and grid.
void addPoints(Json& json, const BondFields& f)
{
  const Json model = Json::parse(f.text("point_model"), nullptr, false);
  for (const char* key : { "law", "plane", "walls", "points_per_node", "cells_per_node" })
    json[key] = model[key];
  json["points"] = f.whole("points");
  json["grid_spacing"] = f("grid_spacing");
  json["cells_across_walls"] = f("cells_across_walls");
  json["thin_wall_share"] = f("thin_wall_share");
  json["warnings"] = fieldTexts(f.image, "warnings");
}

std::string headText(const BondRun& run, const BondFields& f)
{
  const Lattice lattice = latticeOf(run.image);
  const bool known = run.pixelSizeSource != "none";
  std::string text = fmt::format("{}: {} nodes{}\n", run.file, sizeText(lattice.size, lattice.dimension),
    known ? fmt::format(" of {:g} µm", lattice.spacing * 1e6) : ", pixel size unknown");
  const Json model = Json::parse(f.text("point_model"), nullptr, false);
  for (const auto& [phase, constants] : model["walls"].items())
  {
    std::string list;
    for (const auto& [name, number] : constants.items())
    {
      list += fmt::format("{}{} {}", list.empty() ? "" : ", ", name,
        number.is_number() ? fmt::format("{:g}", number.get<double>()) : "inf");
    }
    text += fmt::format("  {}: {}\n", phase, list);
  }
  text += fmt::format("  {}, {}; {} points on a grid of {:.3g} pixels, walls of {:.3g} cells (median)\n", f.text("law"),
    f.text("plane"), grouped(f.whole("points")), f("grid_spacing") / lattice.spacing, f("cells_across_walls"));
  return text;
}

/// What the sides do to a modulus; empty where nothing is to be said.
std::string sidesNote(const BondFields& f)
{
  return f.text("sides") == "straight"
    ? "straight sides are stiffer than free ones (--sides open), in wood by 1 to 50 %"
    : "";
}

} // namespace

std::string compressionJson(const CompressionReport& report)
{
  const BondFields f(report.run);
  Json json;
  using enum Key::Kind;
  addKeys(json, f, { { "strain" }, { "stress" }, { "axis", Text, "load_axis" }, { "sides", Text } });
  json["sides_note"] = sidesNote(f);
  addKeys(json, f,
    { { "worst_energy_ratio" }, { "worst_energy_ratio_strain" }, { "early_energy_ratio" },
      { "early_energy_ratio_strain" }, { "calm_from" }, { "worst_lateral" }, { "worst_imbalance" },
      { "first_touch_strain" }, { "wave_speed" }, { "slowdowns", Whole }, { "steps", Whole }, { "continued_at", Whole },
      { "states_before", Whole }, { "checkpoints", Whole }, { "last_checkpoint", Whole } });
  json["states"] = statesJson(report.states, report.stateFiles, { { "strain" }, { "stress" } });
  json["curve"] = jsonRows(report.curve);
  addPoints(json, f);
  addKeys(json, f,
    { { "bytes_per_point" }, { "updates_per_second" }, { "setup_seconds", Number, "seconds", 0 },
      { "run_seconds", Number, "seconds", 1 } });
  json["seconds"] = report.run.seconds;
  addRun(json, report.run);
  return dump(json);
}

std::string compressionTable(const CompressionReport& report)
{
  const BondFields f(report.run);
  std::string text = headText(report.run, f);
  text += fmt::format("\n  pressed along {}, sides {}\n  {:>8}  {:>12}  {:>9}  {:>10}  {:>15}\n", f.text("load_axis"),
    f.text("sides"), "strain", "stress [Pa]", "porosity", "across", "kinetic/elastic");
  vtkTable* const curve = report.curve;
  const vtkIdType last = curve->GetNumberOfRows() - 1;
  const vtkIdType shown = std::min<vtkIdType>(last, rowsShown);
  for (vtkIdType k = 1; k <= shown; ++k)
  {
    const vtkIdType row = k * last / shown;
    const double elastic = cell(curve, row, "elastic_energy");
    text += fmt::format("  {:>8.4f}  {:>12.5g}  {:>9.4f}  {:>10.4f}  {:>15}\n", cell(curve, row, "strain"),
      cell(curve, row, "stress"), cell(curve, row, "porosity"), cell(curve, row, "lateral_strain"),
      elastic > 0 ? fmt::format("{:.2g} %", 100 * cell(curve, row, "kinetic_energy") / elastic) : "-");
  }
  text += fmt::format(
    "\n  from strain {:.3g} on kinetic energy at most {:.2g} % of the elastic (strain {:.3g}), stress on the "
    "sides {:.2g} %,\n  difference of the platens' {:.2g} %; before it kinetic energy up to {:.2g} % (strain "
    "{:.2g})\n",
    f("calm_from"), 100 * f("worst_energy_ratio"), f("worst_energy_ratio_strain"), 100 * f("worst_lateral"),
    100 * f("worst_imbalance"), 100 * f("early_energy_ratio"), f("early_energy_ratio_strain"));
  text += fmt::format("  {} steps, slowed down {} times: {:.1f} million points a second (run: {:.2f} s, everything: "
                      "{:.2f} s, {})\n",
    grouped(f.whole("steps")), grouped(f.whole("slowdowns")), f("updates_per_second") / 1e6, f("seconds", 1),
    report.run.seconds, bytesText(static_cast<double>(peakMemoryBytes())));
  text += checkpointsText(f, "steps");
  text += "  Strain: of the height between the platens; stress: force on the platens over the section at the start,\n"
          "  voids included; both are positive in compression.\n";
  return text + wroteText(report.run.written);
}

std::string pointStiffnessJson(const BondRun& run)
{
  const BondFields f(run);
  Json json;
  json["constants"] = Json::object();
  const std::vector<std::string> names = fieldTexts(run.image, "constant_names");
  for (std::size_t i = 0; i < names.size(); ++i)
    json["constants"][names[i]] = jsonNumber(f("constants", i));
  json["components"] = fieldTexts(run.image, "stiffness_components");
  const std::size_t n = json["components"].size();
  json["stiffness"] = Json::array();
  const std::vector<double> tensor = f.numbers("stiffness");
  for (std::size_t row = 0; row < n; ++row)
  {
    const auto begin = tensor.begin() + static_cast<std::ptrdiff_t>(row * n);
    json["stiffness"].push_back(std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(n)));
  }
  json["sides"] = f.text("sides");
  json["sides_note"] = sidesNote(f);
  addPoints(json, f);
  addKeys(json, f,
    { { "grid_nodes", Key::Kind::Whole, "nodes" }, { "iterations", Key::Kind::Whole }, { "residual" },
      { "setup_seconds", Key::Kind::Number, "seconds", 0 }, { "solve_seconds", Key::Kind::Number, "seconds", 1 } });
  json["seconds"] = run.seconds;
  addRun(json, run);
  return dump(json);
}

std::string pointStiffnessTable(const BondRun& run)
{
  const BondFields f(run);
  const std::string note = sidesNote(f);
  std::string text =
    headText(run, f) + fmt::format("\n  sides {}{}\n", f.text("sides"), note.empty() ? "" : ": " + note);
  const std::vector<std::string> names = fieldTexts(run.image, "constant_names");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    const double value = f("constants", i);
    text += fmt::format("    {:<6}  {}\n", names[i],
      names[i].starts_with("nu") ? std::isfinite(value) ? fmt::format("{:.5g}", value) : "-" : pascal(value));
  }
  text +=
    fmt::format("\n  {} nodes of the grid, {} iterations, residual {:.2g} (set-up {:.2f} s, solve {:.2f} s, everything "
                "{:.2f} s, {})\n",
      grouped(f.whole("nodes")), grouped(f.whole("iterations")), f("residual"), f("seconds", 0), f("seconds", 1),
      run.seconds, bytesText(static_cast<double>(peakMemoryBytes())));
  return text + wroteText(run.written);
}

} // namespace lamella::cli
