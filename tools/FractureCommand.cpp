#include "BreakRun.h"
#include "Text.h"
#include "Units.h"

#include "vtkBondFracture.h"

#include <vtkNew.h>

#include <fmt/format.h>

#include <cmath>
#include <memory>

namespace lamella::cli
{

namespace
{

struct FractureOptions : BreakOptions
{
  std::string load = "stretch";
  double lateralRatio = 0;
  std::string breaking = "strict";
  double strainStep = 0;
  std::string method = "auto";
  bool noRivals = false;
  double tolerance = 1e-6;
  std::vector<std::string> atStrains;
  bool statistics = false;
};

const std::vector<std::string> loads{ "stretch", "shear", "biaxial" };
const std::vector<std::string> breakings{ "strict", "batched" };
const std::vector<std::string> methods{ "auto", "events", "accurate" };

void applyLoad(const FractureOptions& o, vtkBondFracture* filter)
{
  if (o.load == "traction")
  {
    throw ParameterError("--load traction: nothing can hold a force after the peak",
      "strain the sample; critical_strain and critical_stress of --curve follow every snap-back");
  }
  filter->SetLoad(static_cast<int>(oneOf("--load", o.load, loads)));
  if (filter->GetLoad() != vtkBondFracture::BIAXIAL && o.lateralRatio != 0)
  {
    throw ParameterError("--lateral-ratio is for --load biaxial", "leave it out, or add --load biaxial");
  }
  if (!(std::fabs(o.lateralRatio) <= 1))
  {
    throw ParameterError(fmt::format("--lateral-ratio {} is not between -1 and 1", o.lateralRatio),
      "load along the axis that is strained most: --axis");
  }
  filter->SetLateralRatio(o.lateralRatio);
}

/// What can be said without the sample. @throws ParameterError
void apply(const FractureOptions& o, vtkBondFracture* filter)
{
  if (o.bonds.criticalStretch.empty() && o.bonds.toughness.empty() && o.bonds.fractureEnergy.empty())
  {
    throw ParameterError("nothing can break: there is no --critical-stretch, --toughness or --fracture-energy",
      "give one of them for the pairs of phases that are to break");
  }
  applyBreak(o, filter, o.atStrains.empty() ? nullptr : "--at-strain");
  applyLoad(o, filter);
  filter->SetBreaking(static_cast<int>(oneOf("--breaking", o.breaking, breakings)));
  filter->SetMethod(static_cast<int>(oneOf("--method", o.method, methods)));
  filter->SetRivals(!o.noRivals);
  checkTolerance(o.tolerance);
  filter->SetTolerance(o.tolerance);
  filter->SetStrainStep(o.strainStep);
  for (const std::string& text : listed(o.atStrains))
  {
    filter->AddStateAtStrain(positiveStrain("--at-strain", text, alongTheLoad));
  }
}

void fracture(Session& session, const FractureOptions& options, const std::string& commandLine)
{
  vtkNew<vtkBondFracture> filter;
  apply(options, filter);
  session.sharesAreGuesses(); // what breaks, and when, is to be found
  runBreak(session, options, filter, commandLine, "fracture", "events", listed(options.atStrains).size(), 0,
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
  addBondOptions(*app, o->bonds, BondUse::Fracture);
  const auto load = [](CLI::Option* option) { return option->group("Load"); };
  load(app->add_option("--load", o->load, "The low platen stays; the high one moves along the axis, across it, ..."))
    ->type_name("stretch|shear|biaxial")
    ->capture_default_str();
  load(app->add_option(
         "--lateral-ratio", o->lateralRatio, "Of --load biaxial: strain along the other axes over that along the axis"))
    ->type_name("NUMBER");
  addPullOptions(*app, *o);
  const auto breaks = [](CLI::Option* option) { return option->group("Breaking"); };
  breaks(app->add_option("--breaking", o->breaking, "One bond at a time, or all that are critical at once"))
    ->type_name("strict|batched")
    ->capture_default_str();
  breaks(takesShares(app->add_option("--strain-step", o->strainStep,
           "Raise the strain to multiples of this; 0: to where the next bond just is critical")))
    ->type_name("STRAIN")
    ->capture_default_str();
  addEndOptions(*app, *o);
  const auto numerics = [](CLI::Option* option) { return option->group("Accuracy and cost"); };
  numerics(app->add_option("--method", o->method,
             "Correct the sample around each break, or all of it to the tolerance; auto: events where it can be had"))
    ->type_name("auto|events|accurate")
    ->capture_default_str();
  numerics(app->add_flag("--no-rivals", o->noRivals,
    "Of events: do not look closer where two bonds are nearly as critical; sooner by a third to a half"));
  addToleranceOption(*app, o->tolerance);
  addFileOptions(*app, *o,
    { "Write damage and displacement at the end as .vti, for ParaView", "Write the stress-strain curve",
      "Bonds, or batches, between two; near ties depend on it, so go on with the number that you began with", "500" });
  app->add_option("--at-strain", o->atStrains, "Likewise at these strains")
    ->type_name("LIST")
    ->allow_extra_args(false)
    ->group("Output");
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
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      fracture(session, *o, line);
    } };
}

} // namespace lamella::cli
