#include "BondInput.h"
#include "Commands.h"
#include "FractureFiles.h"
#include "FractureReport.h"
#include "GridFile.h"
#include "TableFiles.h"
#include "Text.h"

#include "vtkBondFracture.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

struct FractureOptions
{
  CommonOptions common;
  PictureOptions picture;
  BondOptions bonds;
  PlatenOptions platens;
  std::string load = "stretch";
  bool compression = false;
  double lateralRatio = 0;
  std::string breaking = "strict";
  std::string stop = "5%";
  double strainStep = 0;
  std::string maxStrain;
  std::string maxBroken;
  std::string method = "auto";
  bool noRivals = false;
  double tolerance = 1e-6;
  std::vector<std::string> atStrains;
  std::vector<std::string> atBroken;
  bool stress = false;
  bool strainEnergy = false;
  std::string output;
  std::string broken;
  std::string curve;
  CheckpointWords checkpoint;
  bool statistics = false;
};

const std::vector<std::string> loads{ "stretch", "shear", "biaxial" };
const std::vector<std::string> breakings{ "strict", "batched" };
const std::vector<std::string> methods{ "auto", "events", "accurate" };

double positive(const char* option, const std::string& text)
{
  const auto value = toNumber(text);
  if (!value || !(*value > 0) || !std::isfinite(*value))
  {
    throw ParameterError(fmt::format("{} '{}' is not a number above 0", option, text),
      "strains count along the load, in compression too: write it as 0.002");
  }
  return *value;
}

std::int64_t count(const char* option, const std::string& text)
{
  const auto value = toInteger(text);
  if (!value || *value < 1)
  {
    throw ParameterError(fmt::format("{} '{}' is not a whole number above 0", option, text),
      "it is a number of broken bonds, such as 100");
  }
  return *value;
}

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
  applyPlatens(o.platens, filter);
  filter->SetCompression(o.compression);
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
  applyBonds(o.bonds, filter);
  applyLoad(o, filter);
  filter->SetBreaking(static_cast<int>(oneOf("--breaking", o.breaking, breakings)));
  filter->SetMethod(static_cast<int>(oneOf("--method", o.method, methods)));
  filter->SetRivals(!o.noRivals);
  checkTolerance(o.tolerance);
  filter->SetTolerance(o.tolerance);
  filter->SetStopShare(share("--stop", o.stop));
  if (!(filter->GetStopShare() >= 0 && filter->GetStopShare() < 1))
  {
    throw ParameterError("--stop '" + o.stop + "' is not from 0 up to 100 %",
      "5% of the peak is usual; hinges never part, so 0 may never be reached");
  }
  filter->SetStrainStep(o.strainStep);
  filter->SetMaximumStrain(o.maxStrain.empty() ? 0 : positive("--max-strain", o.maxStrain));
  filter->SetMaximumBroken(o.maxBroken.empty() ? 0 : count("--max-broken", o.maxBroken));
  for (const std::string& list : o.atStrains)
  {
    for (const std::string& text : split(list, ','))
    {
      filter->AddStateAtStrain(positive("--at-strain", text));
    }
  }
  for (const std::string& list : o.atBroken)
  {
    for (const std::string& text : split(list, ','))
    {
      filter->AddStateAtBroken(count("--at-broken", text));
    }
  }
  applyCheckpoint(o.checkpoint, filter);
  const char* const forFields = !o.atStrains.empty() ? "--at-strain"
    : !o.atBroken.empty()                            ? "--at-broken"
    : o.stress                                       ? "--stress"
    : o.strainEnergy                                 ? "--strain-energy"
                                                     : nullptr;
  if (o.output.empty() && forFields != nullptr)
  {
    throw ParameterError(fmt::format("{} without a file to write to", forFields), "add -o FILE.vti");
  }
  filter->SetComputeDisplacement(!o.output.empty());
  filter->SetComputeStress(o.stress);
  filter->SetComputeStrainEnergy(o.strainEnergy);
}

std::size_t mostStates(const FractureOptions& o)
{
  std::size_t states = 1; // the end
  for (const std::vector<std::string>* lists : { &o.atStrains, &o.atBroken })
  {
    for (const std::string& list : *lists)
    {
      states += split(list, ',').size();
    }
  }
  return states;
}

/// What rank 0 writes.
struct Files
{
  StateFiles states;
  std::optional<OutputFile> broken;
  TableFiles curve;

  void open(const FractureOptions& o, vtkBondFracture* filter)
  {
    states = StateFiles(o.output, mostStates(o), o.common.overwrite);
    if (!o.broken.empty())
    {
      if (std::filesystem::path(o.broken).extension() != ".vtp")
      {
        throw ParameterError("--broken '" + o.broken + "': broken bonds are written as .vtp", "end the name in .vtp");
      }
      broken.emplace(o.broken, o.common.overwrite);
    }
    curve.add("--curve", o.curve, filter->GetCurve(), o.common.overwrite);
  }

  /// All are written before the first appears under its name.
  void write(vtkBondFracture* filter, FractureReport& report)
  {
    const std::string provenance = io::toJson(report.run.provenance);
    if (broken)
    {
      setProvenance(report.broken, provenance);
      writeGrid(report.broken, *broken);
    }
    report.run.written = states.write(filter, provenance);
    report.stateFiles = report.run.written;
    const std::vector<std::string> tables = curve.write(Json::parse(provenance));
    states.commit();
    if (broken)
    {
      broken->commit();
      report.run.written.push_back(broken->path().string());
    }
    report.run.written.insert(report.run.written.end(), tables.begin(), tables.end());
  }
};

/// An interruption after which something is left.
class Stopped : public Cancelled
{
public:
  explicit Stopped(const std::string& hint) { static_cast<Error&>(*this) = Error(what(), hint); }
};

void fracture(Session& session, const FractureOptions& options, const std::string& commandLine)
{
  const auto start = std::chrono::steady_clock::now();
  vtkNew<vtkBondFracture> filter;
  apply(options, filter);
  BondSample sample;
  Files files; // rank 0
  session.onRoot(
    [&]
    {
      checkCheckpoint(options.checkpoint, options.common.overwrite);
      files.open(options, filter);
      sample = loadBondSample(session, options.picture, options.bonds);
      const int perNode = 1 + 12 + 24 + (options.stress ? 48 : 0) + (options.strainEnergy ? 8 : 0);
      files.states.needs(
        static_cast<std::uint64_t>(sample.image->GetNumberOfPoints()) * static_cast<std::uint64_t>(perNode));
    });
  const auto finish = [&]
  {
    FractureReport report{ bondRun(session, filter, options.picture, options.bonds, sample, commandLine),
      filter->GetBrokenBonds(), {}, {}, options.statistics };
    for (int i = 0; i < filter->GetNumberOfStates(); ++i)
    {
      report.states.push_back(filter->GetStateImage(i));
    }
    files.write(filter, report);
    report.run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    session.print(options.common.json ? fractureJson(report) : options.common.quiet ? "" : fractureTable(report));
  };
  const auto left = [&] { return howToContinue(options.checkpoint, filter, commandLine, session.ranks()); };
  try
  {
    runBonds(session, filter, sample, "fracture");
    session.onRoot(finish);
  }
  catch (const Cancelled&)
  {
    const std::string hint = left();
    if (hint.empty())
    {
      throw;
    }
    throw Stopped(hint);
  }
  catch (const Error&)
  {
    if (filter->GetLastCheckpoint() > 0)
    {
      session.warn(left());
    }
    throw;
  }
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
  load(app->add_flag("--compression", o->compression, "The high platen moves the other way, towards the low one"));
  load(app->add_option(
         "--lateral-ratio", o->lateralRatio, "Of --load biaxial: strain along the other axes over that along the axis"))
    ->type_name("NUMBER");
  addPlatenOptions(*app, o->platens);
  const auto breaks = [](CLI::Option* option) { return option->group("Breaking"); };
  breaks(app->add_option("--breaking", o->breaking, "One bond at a time, or all that are critical at once"))
    ->type_name("strict|batched")
    ->capture_default_str();
  breaks(app->add_option("--strain-step", o->strainStep,
           "Raise the strain to multiples of this; 0: to where the next bond just is critical"))
    ->type_name("STRAIN")
    ->capture_default_str();
  breaks(app->add_option("--stop", o->stop, "End when the stress has fallen to this share of the peak"))
    ->type_name("SHARE")
    ->capture_default_str();
  breaks(app->add_option("--max-strain", o->maxStrain, "End at this strain"))->type_name("NUMBER");
  breaks(app->add_option("--max-broken", o->maxBroken, "End after so many broken bonds"))->type_name("NUMBER");
  const auto numerics = [](CLI::Option* option) { return option->group("Accuracy and cost"); };
  numerics(app->add_option("--method", o->method,
             "Correct the sample around each break, or all of it to the tolerance; auto: events where it can be had"))
    ->type_name("auto|events|accurate")
    ->capture_default_str();
  numerics(app->add_flag("--no-rivals", o->noRivals,
    "Of events: do not look closer where two bonds are nearly as critical; three times as fast"));
  addToleranceOption(*app, o->tolerance);
  addOutputOptions(*app, o->output, o->common, "Write damage and displacement at the end as .vti, for ParaView");
  const auto out = [](CLI::Option* option) { return option->group("Output"); };
  out(
    app->add_option("--at-strain", o->atStrains, "Write the state at these strains too: FILE_000.vti ... and FILE.pvd"))
    ->type_name("LIST")
    ->allow_extra_args(false);
  out(app->add_option("--at-broken", o->atBroken, "Likewise at these numbers of broken bonds"))
    ->type_name("LIST")
    ->allow_extra_args(false);
  out(app->add_flag("--stress", o->stress, "Write the stress of every node too"));
  out(app->add_flag("--strain-energy", o->strainEnergy, "Write the strain energy of every node too"));
  out(app->add_option("--broken", o->broken, "Write the broken bonds in order, a point each"))->type_name("FILE.vtp");
  out(app->add_option("--curve", o->curve, "Write the stress-strain curve"))->type_name("FILE.csv");
  const auto checkpoints = [](CLI::Option* option) { return option->group("Checkpoints"); };
  checkpoints(app->add_option("--checkpoint", o->checkpoint.file, "Keep where the run stands, to go on from it"))
    ->type_name("FILE.h5");
  checkpoints(app->add_option("--checkpoint-every", o->checkpoint.every,
                "Bonds, or batches, between two; near ties depend on it, so go on with the number that you began with"))
    ->type_name("NUMBER")
    ->default_str("500");
  checkpoints(app->add_option("--continue", o->checkpoint.continueFrom,
                "Go on from a checkpoint of the same run; where it is that of --checkpoint and not there yet, begin"))
    ->type_name("FILE.h5");
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
