#include "commands/BreakRun.h"

#include "vtkBondFracture.h"

#include <vtkNew.h>

#include <memory>

namespace lamella::cli
{

namespace
{

struct FractureOptions : BreakOptions
{
  bool statistics = false;
};

void fracture(Session& session, const FractureOptions& options, const std::string& commandLine)
{
  vtkNew<vtkBondFracture> filter;
  applyBreak(session, options, filter, nullptr);
  session.sharesAreGuesses(); // what breaks, and when, is to be found
  runBreak(session, options, filter, commandLine, "fracture", "events", options.bonds.settings.count("at-strain"), 0,
    [&](FractureReport report)
    {
      report.statistics = options.statistics;
      return options.common.json ? fractureJson(report) : fractureTable(report);
    });
}

} // namespace

Command fractureCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "fracture", "Strength of a picture or volume, its stress-strain curve, and where it breaks bond by bond");
  auto o = std::make_shared<FractureOptions>();
  addPictureOptions(*app, o->picture);
  addBondOptions(*app, o->bonds, "vtkBondFracture");
  addFileOptions(*app, *o,
    { "Write damage and displacement at the end as .vti, for ParaView", "Write the stress-strain curve",
      "Bonds, or batches, between two; near ties depend on it, so go on with the number that you began with", "500" });
  addReportOptions(*app, o->common);
  app->add_flag("--stats", o->statistics, "Tell what was visited and what was skipped, with times")->group("Report");
  addExamples(*app,
    { "lamella fracture grains.vti --young matrix=1e9 --young grain=4e9 --toughness matrix=1e5 --toughness grain=4e5 "
      "--like matrix-grain=matrix --like grain-grain=matrix --curve curve.csv --broken broken.vtp",
      "lamella fracture tissue.png --phase 0=lumen --other wall --young wall=10e9 --critical-stretch wall=0.01 "
      "--at-broken 50,200 -o torn.vti",
      "lamella fracture plate.png --phase 255=glass --pixel-size 10um --young glass=7e10 --fracture-energy glass=8 "
      "--notch 0,1mm,0.4mm,1mm --json",
      "lamella fracture grains.vti --young matrix=1e9 --young grain=4e9 --critical-stretch matrix=1e-3 --mixing "
      "minimum "
      "--compression --max-strain 0.01",
      "lamella fracture volume.vti --young wall=1e10 --critical-stretch wall=0.01 --checkpoint run.h5 --continue "
      "run.h5 "
      "-o torn.vti",
      "lamella snapshot torn.vti --array damage -o torn.png" });
  return jointCommand(app, o, fracture);
}

} // namespace lamella::cli
