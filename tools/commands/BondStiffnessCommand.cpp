#include "commands/BondInput.h"
#include "commands/BondReport.h"
#include "commands/DiffusionReport.h"
#include "commands/StiffnessReport.h"
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

#include <memory>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

std::string bondStiffnessJson(const BondRun& report)
{
  const BondFields f(report);
  Json json;
  addStiffness(json, f);
  json["error_leaves_out"] =
    "another Poisson's ratio than poissons_ratio; what no pixel shows; how far the cell speaks "
    "for more of its material";
  addModel(json, f);
  addSolve(json, f);
  addSizes(json, f);
  addStiffnessSolves(json, f, report.refine);
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
  text += stiffnessText(f);
  const double solve = f("seconds", 1) + f("seconds", 2);
  text += fmt::format("\n  {}, horizon {:g}; {} iterations, residual {:.1e}, {:.3f} s, error {:.3f} s (everything: "
                      "{:.2f} s, {})\n",
    f.text("continuum"), f("horizon"), iterationsText(f), f("residual"), solve, f("seconds", 4), report.seconds,
    bytesText(static_cast<double>(peakMemoryBytes())));
  text += sizesText(f);
  text +=
    "  Every side goes on at the opposite one. Mean stress over the whole cell, voids included; shear strains as\n"
    "  angles.\n";
  return text +
    stiffnessEnd(f,
      { "pixels and lattice", fmt::format("a solid of Poisson's ratio {:.4g}", f("poissons_ratio")),
        "another Poisson's ratio, what no pixel shows" },
      report.written);
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
