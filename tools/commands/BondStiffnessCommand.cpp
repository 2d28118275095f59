#include "commands/BondInput.h"
#include "commands/BondReport.h"
#include "commands/DiffusionReport.h"
#include "files/ResultFiles.h"
#include "program/Commands.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "core/Memory.h"
#include "vtkBondStiffness.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

/// A tensor by rows; null where it is not known.
Json matrix(const BondFields& f, const char* name)
{
  const std::vector<double> values = f.numbers(name);
  return std::isfinite(values.front()) ? rowsOf(values, values.size() == 36 ? 6 : 3) : Json(nullptr);
}

Json constantsJson(const BondFields& f)
{
  Json json = Json::object();
  const std::vector<std::string> names = fieldTexts(f.image, "constant_names");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    json[names[i]] = { { "value", jsonNumber(f("constants", i)) },
      { "extrapolated", jsonNumber(f("constants_extrapolated", i)) },
      { "estimated_error", jsonNumber(f("constants_error", i)) } };
  }
  return json;
}

Json stepsJson(const BondFields& f, int refine)
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

/// A power of 1000 in which the largest value is a number people read.
std::pair<double, const char*> unitFor(double largest)
{
  constexpr std::array<std::pair<double, const char*>, 4> units{ { { 1e9, "GPa" }, { 1e6, "MPa" }, { 1e3, "kPa" },
    { 1, "Pa" } } };
  for (const auto& unit : units)
    if (largest >= unit.first)
      return unit;
  return units.back();
}

double largestOf(const std::vector<double>& values)
{
  return std::accumulate(
    values.begin(), values.end(), 0.0, [](double most, double v) { return std::max(most, std::abs(v)); });
}

std::string bondStiffnessJson(const BondRun& report)
{
  const BondFields f(report);
  Json json;
  json["components"] = fieldTexts(report.image, "stiffness_components");
  json["stiffness"] = matrix(f, "stiffness");
  json["extrapolated"] = matrix(f, "stiffness_extrapolated");
  json["estimated_errors"] = matrix(f, "stiffness_error");
  json["estimated_error"] = jsonNumber(f("estimated_error"));
  json["error_leaves_out"] =
    "another Poisson's ratio than poissons_ratio; what no pixel shows; how far the cell speaks "
    "for more of its material";
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
  addModel(json, f);
  std::vector<std::int64_t> iterations;
  for (const double n : f.numbers("iterations"))
    iterations.push_back(std::llround(n));
  json["iterations"] = iterations;
  addSolve(json, f);
  addSizes(json, f);
  json["steps"] = stepsJson(f, report.refine);
  json["seconds"] = report.seconds;
  addKeys(json, f,
    { { "bond_seconds", Key::Kind::Number, "seconds", 0 }, { "setup_seconds", Key::Kind::Number, "seconds", 1 },
      { "solve_seconds", Key::Kind::Number, "seconds", 2 }, { "measure_seconds", Key::Kind::Number, "seconds", 3 },
      { "estimate_seconds", Key::Kind::Number, "seconds", 4 } });
  addRun(json, report);
  return dump(json);
}

std::string bondStiffnessTable(const BondRun& report)
{
  const BondFields f(report);
  std::string text = sampleText(report, false);
  const std::vector<std::string> names = fieldTexts(report.image, "stiffness_components");
  const std::vector<double> c = f.numbers("stiffness");
  const std::size_t n = names.size();
  const auto [unit, unitName] = unitFor(largestOf(c));
  const bool known = std::isfinite(f("estimated_error"));

  text += fmt::format("\n  stiffness [{}], stress by row, mean strain by column{}\n  {:>4}", unitName,
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
  const std::vector<std::string> constants = fieldTexts(report.image, "constant_names");
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
  std::string iterations;
  for (const double count : f.numbers("iterations"))
    iterations += fmt::format("{}{:g}", iterations.empty() ? "" : " + ", count);
  const double solve = f("seconds", 1) + f("seconds", 2);
  text += fmt::format("\n  {}, horizon {:g}; {} iterations, residual {:.1e}, {:.3f} s, error {:.3f} s (everything: "
                      "{:.2f} s, {})\n",
    f.text("continuum"), f("horizon"), iterations, f("residual"), solve, f("seconds", 4), report.seconds,
    bytesText(static_cast<double>(peakMemoryBytes())));
  text += sizesText(f);
  text +=
    "  Every side goes on at the opposite one. Mean stress over the whole cell, voids included; shear strains as\n"
    "  angles.";
  text += known
    ? fmt::format(" The error is that of pixels and lattice against a solid of Poisson's ratio {:.4g}, from every\n"
                  "  second, third and fourth pixel. Not in it: another Poisson's ratio, what no pixel shows.\n",
        f("poissons_ratio"))
    : "\n";
  if (f.text("continuum") == "plane-strain")
    text += "  Constants of the plane: an isotropic material would have E/(1 - nu²) and nu/(1 - nu).\n";
  text += wroteText(report.written);
  return text;
}

struct BondStiffnessOptions
{
  CommonOptions common;
  PictureOptions picture;
  BondOptions bonds;
  std::string output;
  std::string constants;
};

ResultFiles openFiles(const BondStiffnessOptions& o, vtkBondStiffness* filter)
{
  ResultFiles files;
  files.addTable("-o", o.output, filter->GetTensor(), o.common.overwrite);
  files.addTable("--constants", o.constants, filter->GetConstants(), o.common.overwrite);
  return files;
}

void bondStiffness(Session& session, const BondStiffnessOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkBondStiffness> filter;
  applyBonds(options.bonds, filter);
  filter->SetNodesPerPixel(options.bonds.refine);
  ImageSample sample;
  ResultFiles files; // rank 0
  session.onRoot(
    [&]
    {
      files = openFiles(options, filter);
      sample = loadBondSample(session, options.picture, options.bonds, filter);
    });
  runBonds(session, filter, sample, "stiffness");
  session.onRoot(
    [&]
    {
      BondRun report = bondRun(session, filter, options.picture, options.bonds, sample, commandLine);
      report.written = files.write(io::toJson(report.provenance));
      report.seconds = secondsSince(start);
      session.print(options.common.json ? bondStiffnessJson(report)
          : options.common.quiet        ? ""
                                        : bondStiffnessTable(report));
    });
}

} // namespace

Command bondStiffnessCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "bond-stiffness", "Effective stiffness tensor of a cell that repeats, with its error, by bonds (peridynamics)");
  auto o = std::make_shared<BondStiffnessOptions>();
  addPictureOptions(*app, o->picture);
  addBondOptions(*app, o->bonds, "vtkBondStiffness");
  addResultFile(*app, "-o,--output,--csv", o->output, "Write the tensor, one row a stress");
  addResultFile(
    *app, "--constants", o->constants, "Write Young's moduli, shear moduli and Poisson's ratios, one row each");
  addResultOptions(*app, o->common);
  addExamples(*app,
    { "lamella bond-stiffness honeycomb.png --phase 0=void --other wall --young wall=10e9",
      "lamella bond-stiffness composite.png --young matrix=3e9 --young inclusion=70e9 --mixing harmonic --continuum "
      "plane-strain --json",
      "lamella bond-stiffness foam_128x128x128_u8.raw --phase 0=void --other solid --young solid=2e9 --horizon 2 "
      "--no-error-estimate",
      "mpirun -n 2 lamella bond-stiffness tissue.vti --young wall=10e9 -o tensor.csv --constants constants.csv" });
  return jointCommand(app, o, bondStiffness);
}

} // namespace lamella::cli
