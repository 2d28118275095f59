#include "commands/BondInput.h"
#include "commands/BondReport.h"
#include "commands/DiffusionReport.h"
#include "files/GridFile.h"
#include "program/Commands.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "core/Memory.h"
#include "vtkBondEquilibrium.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>

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

std::string equilibriumJson(const BondRun& report)
{
  const BondFields f(report);
  Json json;
  using enum Key::Kind;
  addKeys(json, f, { { "effective_modulus" }, { "effective_stress" }, { "strain" } });
  json["first_break"] = firstBreak(f);
  addBreakSensitivity(json, f);
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
      { "measure_seconds", Number, "seconds", 4 }, { "sensitivity_seconds", Number, "seconds", 5 } });
  addRun(json, report);
  return dump(json);
}

std::string equilibriumTable(const BondRun& report)
{
  const BondFields f(report);
  std::string text = sampleText(report, true);
  const bool shear = f.text("load") == "shear";
  if (f.text("load") == "pressure")
  {
    text += fmt::format("\n  a pressure of {} in closed pores\n", pascal(f("effective_stress")));
    text += fmt::format("    pores grow by              {:.6g}\n", f("strain"));
    text += fmt::format("    volumetric modulus         {}\n", pascal(f("effective_modulus")));
  }
  else
  {
    text += fmt::format("\n  {} along {} at a strain of {:g}\n", f.text("load"), f.text("load_axis"), f("strain"));
    text += fmt::format(
      "    effective {}  {}\n", shear ? "shear modulus  " : "modulus        ", pascal(f("effective_modulus")));
    text += fmt::format("    stress on the platen       {}\n", pascal(f("effective_stress")));
  }
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
    text += breakSensitivityText(f);
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

struct EquilibriumOptions
{
  CommonOptions common;
  PictureOptions picture;
  BondOptions bonds;
  std::string output;
};

void equilibrium(Session& session, const EquilibriumOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkBondEquilibrium> filter;
  applyBonds(options.bonds, filter);
  for (const char* const word : { "stress", "strain-energy" })
    if (options.output.empty() && options.bonds.settings.given(word))
      throw ParameterError(fmt::format("--{} without a file to write it to", word), "add -o FILE.vti");
  if (!options.output.empty() && !isVtkImage(options.output))
  {
    throw ParameterError("-o '" + options.output + "': the fields are written as .vti",
      "end the name in .vti; numbers go to standard output, as JSON with --json");
  }
  ImageSample sample;
  std::optional<OutputFile> file; // rank 0
  session.onRoot(
    [&]
    {
      sample = loadBondSample(session, options.picture, options.bonds, filter);
      if (!options.output.empty())
      {
        file.emplace(options.output, options.common.overwrite);
        const int perNode = 1 + 24 + (filter->GetComputeStress() ? 48 : 0) + (filter->GetComputeStrainEnergy() ? 8 : 0);
        file->needs(
          static_cast<std::uint64_t>(sample.image->GetNumberOfPoints()) * static_cast<std::uint64_t>(perNode));
      }
    });
  runBonds(session, filter, sample, "equilibrium");
  session.onRoot(
    [&]
    {
      BondRun report = bondRun(session, filter, options.picture, options.bonds, sample, commandLine);
      vtkImageData* const image = report.image;
      if (file)
      {
        setProvenance(image, io::toJson(report.provenance));
        writeGrid(image, *file);
        Session::checkInterrupt();
        file->commit();
        report.written.push_back(options.output);
      }
      report.seconds = secondsSince(start);
      session.print(options.common.json ? equilibriumJson(report)
          : options.common.quiet        ? ""
                                        : equilibriumTable(report));
    });
}

} // namespace

Command equilibriumCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "equilibrium", "Stiffness of a picture or volume, stress, and the load at which its first bond breaks");
  auto o = std::make_shared<EquilibriumOptions>();
  addPictureOptions(*app, o->picture);
  addBondOptions(*app, o->bonds, "vtkBondEquilibrium");
  addOutputOptions(*app, o->output, o->common, "Write phases and displacement as .vti, for ParaView");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella equilibrium tissue.png --phase 0=lumen --other wall --young wall=10e9 --critical-stretch wall=0.01",
      "lamella equilibrium grains.vti --young matrix=1e9 --young grain=4e9 --toughness matrix=1e5 --toughness "
      "grain=4e5 --like matrix-grain=matrix --like grain-grain=matrix --stress -o stretched.vti",
      "lamella equilibrium grains.vti --young matrix=1e9 --young grain=4 --relative-to matrix --mixing harmonic --json",
      "mpirun -n 2 lamella equilibrium rock_200x200x200_u8.raw --phase 1=pore --other grain --young grain=7e10",
      "lamella snapshot stretched.vti --preset stress -o stress.png" });
  return jointCommand(app, o, equilibrium);
}

} // namespace lamella::cli
