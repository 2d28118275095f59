#include "commands/BondInput.h"
#include "commands/StiffnessReport.h"
#include "files/ResultFiles.h"
#include "program/Commands.h"
#include "session/OutputFile.h"

#include "core/Clock.h"
#include "vtkBondStiffness.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkTable.h>

#include <filesystem>
#include <memory>
#include <vector>

namespace lamella::cli
{

namespace
{

struct StiffnessOptions
{
  CommonOptions common;
  PictureOptions picture;
  BondOptions bonds;
  std::string output;
  std::string constants;
};

ResultFiles openFiles(const StiffnessOptions& o, vtkBondStiffness* filter)
{
  ResultFiles files;
  files.addTable("-o", o.output, filter->GetTensor(), o.common.overwrite);
  files.addTable("--constants", o.constants, filter->GetConstants(), o.common.overwrite);
  return files;
}

void stiffness(Session& session, const StiffnessOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkBondStiffness> filter;
  applyBonds(options.bonds, filter);
  filter->SetNodesPerPixel(options.bonds.refine);
  BondSample sample;
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
      session.print(options.common.json ? stiffnessJson(report) : options.common.quiet ? "" : stiffnessTable(report));
    });
}

} // namespace

Command stiffnessCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "stiffness", "Effective stiffness tensor of a picture or volume taken as a cell that repeats, with its error");
  auto o = std::make_shared<StiffnessOptions>();
  addPictureOptions(*app, o->picture);
  addBondOptions(*app, o->bonds, "vtkBondStiffness");
  app->add_option("-o,--output,--csv", o->output, "Write the tensor, one row a stress")
    ->type_name("FILE.csv")
    ->group("Output");
  app->add_option("--constants", o->constants, "Write Young's moduli, shear moduli and Poisson's ratios, one row each")
    ->type_name("FILE.csv")
    ->group("Output");
  addResultOptions(*app, o->common);
  addExamples(*app,
    { "lamella stiffness honeycomb.png --phase 0=void --other wall --young wall=10e9",
      "lamella stiffness composite.png --young matrix=3e9 --young inclusion=70e9 --mixing harmonic --continuum "
      "plane-strain --json",
      "lamella stiffness foam_128x128x128_u8.raw --phase 0=void --other solid --young solid=2e9 --horizon 2 "
      "--no-error-estimate",
      "mpirun -n 2 lamella stiffness tissue.vti --young wall=10e9 -o tensor.csv --constants constants.csv" });
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      stiffness(session, *o, line);
    } };
}

} // namespace lamella::cli
