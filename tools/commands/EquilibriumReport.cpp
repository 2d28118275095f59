#include "commands/EquilibriumReport.h"

#include "commands/DiffusionReport.h"
#include "session/Text.h"

#include "core/Memory.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>

#include <fmt/format.h>

#include <cmath>

namespace lamella::cli
{

namespace
{

Json firstBreak(const BondFields& f)
{
  if (!std::isfinite(f("first_break_strain")))
    return nullptr;
  return { { "strain", f("first_break_strain") }, { "stress", f("first_break_stress") },
    { "position", f.vector("first_break_position") }, { "phases", fieldTexts(f.image, "first_break_phases") } };
}

} // namespace

std::string equilibriumJson(const BondRun& report)
{
  const BondFields f(report);
  Json json;
  using enum Key::Kind;
  addKeys(json, f, { { "effective_modulus" }, { "effective_stress" }, { "strain" } });
  json["first_break"] = firstBreak(f);
  json["largest_stretch_ratio"] = jsonNumber(f("largest_stretch_ratio"));
  Json mean;
  const std::array<const char*, 6> components{ "xx", "yy", "zz", "xy", "yz", "xz" };
  for (std::size_t c = 0; c < 6; ++c)
    if (f.dimension == 3 || c == 0 || c == 1 || c == 3)
      mean[components[c]] = jsonNumber(f("mean_stress", c));
  json["mean_stress"] = std::move(mean);
  json["reactions"] = { { "low", f.vector("reaction_low") }, { "high", f.vector("reaction_high") } };
  json["elastic_energy"] = sizeKnown(report) ? jsonNumber(f("elastic_energy")) : Json(nullptr);
  addKeys(json, f, { { "load", Text }, { "axis", Text, "load_axis" } });
  addPlatens(json, f);
  addModel(json, f);
  addKeys(json, f, { { "solver", Text }, { "iterations", Whole }, { "newton_steps", Whole } });
  addSolve(json, f);
  addSizes(json, f);
  json["seconds"] = report.seconds;
  addKeys(json, f,
    { { "bond_seconds", Number, "seconds", 0 }, { "load_seconds", Number, "seconds", 1 },
      { "setup_seconds", Number, "seconds", 2 }, { "solve_seconds", Number, "seconds", 3 },
      { "measure_seconds", Number, "seconds", 4 } });
  addRun(json, report);
  return dump(json);
}

std::string equilibriumTable(const BondRun& report)
{
  const BondFields f(report);
  std::string text = sampleText(report, true);
  const bool shear = f.text("load") == "shear";
  text += fmt::format("\n  {} along {} at a strain of {:g}\n", f.text("load"), f.text("load_axis"), f("strain"));
  text += fmt::format(
    "    effective {}  {}\n", shear ? "shear modulus  " : "modulus        ", pascal(f("effective_modulus")));
  text += fmt::format("    stress on the platen       {}\n", pascal(f("effective_stress")));
  if (sizeKnown(report))
  {
    text +=
      fmt::format("    elastic energy             {:.6g} {}\n", f("elastic_energy"), f.dimension == 2 ? "J/m" : "J");
  }
  if (std::isfinite(f("first_break_strain")))
  {
    const std::vector<std::string> ends = fieldTexts(report.image, "first_break_phases");
    std::vector<double> where = f.numbers("first_break_position");
    where.resize(static_cast<std::size_t>(f.dimension));
    text += fmt::format("    first bond breaks at       strain {:.6g}, stress {}\n", f("first_break_strain"),
      pascal(f("first_break_stress")));
    text += fmt::format("      between {} and {}, at {}\n", ends.at(0), ends.at(1), lengthsText(report, where));
  }
  else if (f("largest_stretch_ratio") > 0)
  {
    text += fmt::format("    most stretched bond        {:.4g} of what breaks it\n", f("largest_stretch_ratio"));
  }
  const double solve = f("seconds", 2) + f("seconds", 3);
  text += fmt::format("\n  {}, horizon {:g}, {}; {} iterations, residual {:.1e}, {:.3f} s (everything: {:.2f} s, {})\n",
    f.text("continuum"), f("horizon"), f.text("solver"), f.whole("iterations"), f("residual"), solve, report.seconds,
    bytesText(static_cast<double>(peakMemoryBytes())));
  text += sizesText(f);
  text += platensText(report);
  text += wroteText(report.written);
  return text;
}

} // namespace lamella::cli
