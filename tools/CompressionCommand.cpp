#include "BreakRun.h"
#include "Commands.h"
#include "CompressionReport.h"
#include "FilterRun.h"
#include "FractureFiles.h"
#include "GridFile.h"
#include "PointInput.h"
#include "Record.h"
#include "ResultFiles.h"
#include "Text.h"
#include "Units.h"
#include "Workspace.h"

#include "lattice/Clock.h"
#include "lattice/Memory.h"
#include "vtkLatticeConversion.h"
#include "vtkPointCompression.h"
#include "vtkPointStiffness.h"

#include <vtkCallbackCommand.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <array>
#include <memory>

namespace lamella::cli
{

namespace
{

const std::vector<std::string> axisNames{ "x", "y", "z" };
const std::vector<std::string> sidesNames{ "straight", "open", "fixed", "periodic", "sticky" };
const std::vector<std::string> shapes{ "linear", "gimp", "spline" };
const std::vector<std::string> transfers{ "flip", "pic", "apic", "xpic" };

struct CompressionOptions
{
  CommonOptions common;
  PictureOptions picture;
  PointOptions points;
  std::string axis;
  double strain = 0.48;
  std::string sides = sidesNames.front();
  bool grip = false;
  double energyRatio = 0.01;
  double calmFrom = 0.05;
  std::string speeds = "1e-3,5e-5,2e-2";
  double damping = 0;
  int rows = 240;
  std::string shape = "spline";
  std::string transfer = "apic";
  bool consistentMass = false;
  bool modifiedUpdate = false;
  std::string timeStep;
  std::vector<std::string> atStrains;
  bool velocity = false;
  bool stress = false;
  bool deformationGradient = false;
  bool energyDensity = false;
  std::string output;
  std::string curve;
  CheckpointWords checkpoint;
  bool stiffnessOnly = false;
  std::string constants;
  std::vector<CLI::Option*> ofTheRun; ///< options that --stiffness-only makes useless
};

std::array<double, 3> speedsOf(const std::string& text)
{
  const std::vector<std::string> parts = split(text, ',');
  std::array<double, 3> speeds{};
  for (std::size_t i = 0; i < 3; ++i)
  {
    const auto number = parts.size() == 3 ? toNumber(parts[i]) : std::nullopt;
    if (!number)
    {
      throw ParameterError("--speeds '" + text + "' is not three numbers",
        "write first, least and most speed over the wave's: 1e-3,5e-5,2e-2");
    }
    speeds[i] = *number;
  }
  return speeds;
}

/// What can be said without the sample. @throws ParameterError
void apply(const CompressionOptions& o, vtkPointCompression* filter)
{
  applyPoints(o.points, filter);
  filter->SetLoadAxis(o.axis.empty() ? -1 : static_cast<int>(oneOf("--axis", o.axis, axisNames)));
  filter->SetStrain(o.strain);
  const std::size_t sides = oneOf("--sides", o.sides, sidesNames);
  if (sides > vtkPointCompression::PERIODIC)
  {
    throw ParameterError("--sides sticky of a compression", "it is for --stiffness-only");
  }
  filter->SetSides(static_cast<int>(sides));
  filter->SetGrip(o.grip);
  filter->SetEnergyRatio(o.energyRatio);
  filter->SetCalmFrom(o.calmFrom);
  const std::array<double, 3> speeds = speedsOf(o.speeds);
  filter->SetFirstSpeed(speeds[0]);
  filter->SetLeastSpeed(speeds[1]);
  filter->SetMostSpeed(speeds[2]);
  filter->SetDamping(o.damping);
  filter->SetRows(o.rows);
  filter->SetShape(static_cast<int>(oneOf("--shape", o.shape, shapes)));
  filter->SetTransfer(static_cast<int>(oneOf("--transfer", o.transfer, transfers)));
  filter->SetConsistentMass(o.consistentMass);
  filter->SetModifiedUpdate(o.modifiedUpdate);
  filter->SetTimeStep(o.timeStep.empty() ? 0 : positive("--time-step", o.timeStep, "it is in seconds"));
  for (const std::string& text : listed(o.atStrains))
  {
    filter->AddStateAtStrain(
      positiveStrain("--at-strain", text, "strains are positive in compression: write it as 0.12"));
  }
  const char* const forFields = !o.atStrains.empty() ? "--at-strain"
    : o.velocity                                     ? "--velocity"
    : o.stress                                       ? "--stress"
    : o.deformationGradient                          ? "--deformation-gradient"
    : o.energyDensity                                ? "--energy-density"
                                                     : nullptr;
  if (o.output.empty() && forFields != nullptr)
  {
    throw ParameterError(fmt::format("{} without a file to write to", forFields), "add -o FILE.vtp");
  }
  filter->SetComputeDisplacement(!o.output.empty());
  filter->SetComputeVelocity(o.velocity);
  filter->SetComputeStress(o.stress);
  filter->SetComputeDeformationGradient(o.deformationGradient);
  filter->SetComputeEnergyDensity(o.energyDensity);
  applyCheckpoint(o.checkpoint, filter);
  filter->SetKeepStates(Workspace::current() == nullptr || !Workspace::current()->lastStateOnly);
}

/// What a run of the filter said.
void checkRun(vtkPointAlgorithm* filter)
{
  if (filter->GetFailure() != vtkPointAlgorithm::NO_FAILURE)
  {
    throwFailure(filter->GetFailure());
  }
  (void)VtkMessages::takeWarnings(); // the same as in the field data
}

/// @param output with the filter's numbers as field data
BondRun runOf(Session& session, const CompressionOptions& o, const PointSample& sample, vtkDataObject* output,
  const std::string& commandLine)
{
  for (const std::string& warning : fieldTexts(output, "warnings"))
  {
    session.warn(warning);
  }
  sample.image->GetFieldData()->ShallowCopy(output->GetFieldData());
  BondRun run;
  run.file = o.picture.file;
  run.image = sample.image;
  run.pixelSizeSource = sample.pixelSizeSource;
  run.provenance = recordRun(commandLine, o.picture.file, sample.provenance);
  run.threads = o.points.threads;
  run.ranks = session.ranks();
  return run;
}

void press(Session& session, const CompressionOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkPointCompression> filter;
  apply(o, filter);
  if (!o.constants.empty())
  {
    throw ParameterError(
      "--constants of a compression", "it is for --stiffness-only; the curve goes to --curve FILE.csv");
  }
  StateWriter states; // of rank 0
  ResultFiles curve;
  PointSample sample;
  std::array<int, 6> extent{};
  session.onRoot(
    [&]
    {
      checkCheckpoint(o.checkpoint, o.common.overwrite);
      states = StateWriter(o.output, 1 + listed(o.atStrains).size(), o.common.overwrite, ".vtp",
        { "points", "the curve goes to --curve FILE.csv" });
      curve.addTable("--curve", o.curve, filter->GetCurve(), o.common.overwrite);
      sample = loadPointSample(session, o.picture, o.points);
      sample.image->GetExtent(extent.data());
      if (!o.checkpoint.file.empty())
      {
        states.follow(session, io::toJson(recordRun(commandLine, o.picture.file, sample.provenance)));
      }
    });
  session.broadcast(extent);
  const auto finish = [&]
  {
    checkRun(filter); // a mistake is one on every rank, and told once
    CompressionReport report{ runOf(session, o, sample, filter->GetPoints(), commandLine), filter->GetCurve(), {}, {} };
    for (int i = 0; i < filter->GetNumberOfStates(); ++i)
    {
      report.states.push_back(filter->GetStatePoints(i));
    }
    const std::string provenance = io::toJson(report.run.provenance);
    report.run.written = states.write(report.states, provenance);
    report.stateFiles = report.run.written;
    const std::vector<std::string> tables = curve.write(provenance);
    states.commit();
    report.run.written.insert(report.run.written.end(), tables.begin(), tables.end());
    report.run.seconds = secondsSince(start);
    session.print(o.common.json ? compressionJson(report) : o.common.quiet ? "" : compressionTable(report));
  };
  const KeptRun kept{ commandLine, session.ranks(), "steps", [&] { return filter->GetLastCheckpoint(); },
    [&] { return filter->GetCheckpointEvery(); }, [&] { return states.leaves(); } };
  runKept(session, o.checkpoint, kept,
    [&]
    {
      const auto piece = sample.image ? sample.image : vtkSmartPointer<vtkImageData>::New();
      runFilterOnRanks(session, filter.GetPointer(), piece, extent, "compression");
      session.onRoot(finish);
    });
}

/// Says what a stiffness will take, where that is much.
class PlanNote
{
public:
  PlanNote(Session& session, vtkPointStiffness* filter)
    : session_(session)
    , filter_(filter)
  {
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(this);
    command->SetCallback([](vtkObject*, unsigned long, void* self, void* plan)
      { static_cast<PlanNote*>(self)->tell(static_cast<const double*>(plan)); });
    tag_ = filter_->AddObserver(vtkPointStiffness::PLAN_EVENT, command);
  }
  ~PlanNote() { filter_->RemoveObserver(tag_); }
  PlanNote(const PlanNote&) = delete;
  PlanNote& operator=(const PlanNote&) = delete;

private:
  /// @param plan as of PLAN_EVENT
  void tell(const double* plan)
  {
    constexpr double much = 20; // seconds
    if (plan[3] > much)
    {
      const auto seconds = [](double s) { return s < 10 ? fmt::format("{:.1f}", s) : fmt::format("{:.0f}", s); };
      session_.note(fmt::format("the stiffness of {} nodes takes about {} of memory and {} to {} s of processor "
                                "time, the longer the thinner the walls",
        grouped(static_cast<std::int64_t>(plan[0])), bytesText(plan[1]), seconds(plan[2]), seconds(plan[3])));
    }
  }

  Session& session_;
  vtkPointStiffness* filter_;
  unsigned long tag_ = 0;
};

void stiffness(Session& session, const CompressionOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  if (session.ranks() > 1)
  {
    throw ParameterError(fmt::format("--stiffness-only on {} processes", session.ranks()), "run one, with --threads");
  }
  for (const CLI::Option* option : o.ofTheRun)
  {
    if (option->count() > 0)
    {
      throw ParameterError(
        "--stiffness-only with " + option->get_name(), "leave one of them out: stiffness has no run and no states");
    }
  }
  vtkNew<vtkPointStiffness> filter;
  applyPoints(o.points, filter);
  filter->SetSides(static_cast<int>(oneOf("--sides", o.sides, sidesNames)));
  ResultFiles files;
  files.addTable("--constants", o.constants, filter->GetConstants(), o.common.overwrite);
  const PointSample sample = loadPointSample(session, o.picture, o.points);
  filter->SetInputData(sample.image);
  const PlanNote plan(session, filter);
  runFilter(session, filter, "stiffness");
  checkRun(filter);
  BondRun run = runOf(session, o, sample, filter->GetConstants(), commandLine);
  run.written = files.write(io::toJson(run.provenance));
  run.seconds = secondsSince(start);
  session.print(o.common.json ? pointStiffnessJson(run) : o.common.quiet ? "" : pointStiffnessTable(run));
}

void addRunOptions(CLI::App& app, CompressionOptions& o)
{
  const auto run = [&](CLI::Option* option, const char* group)
  {
    o.ofTheRun.push_back(option);
    return option->group(group);
  };
  const char* const load = "Load";
  run(app.add_option("--axis", o.axis, "Axis of loading; y of a picture, z of a volume when not given"), load)
    ->type_name("x|y|z");
  run(takesShares(app.add_option("--strain", o.strain, "Strain to end at, below 1")), load)
    ->type_name("STRAIN")
    ->capture_default_str();
  app.add_option("--sides", o.sides, "Straight sides move so that they feel no force; sticky: of --stiffness-only")
    ->type_name("straight|open|fixed|periodic|sticky")
    ->capture_default_str()
    ->group(load);
  run(app.add_flag("--grip", o.grip, "Platens do not let slide"), load);
  app.add_flag("--fit-platens", o.points.fitPlatens, "Platens stand where the tissue begins and ends")->group(load);
  const char* const calm = "How slowly";
  run(takesShares(app.add_option("--energy-ratio", o.energyRatio, "Kinetic over elastic energy allowed")), calm)
    ->type_name("SHARE")
    ->capture_default_str();
  run(
    takesShares(app.add_option("--calm-from", o.calmFrom, "From this strain on; from half of --strain at most")), calm)
    ->type_name("STRAIN")
    ->capture_default_str();
  run(app.add_option("--speeds", o.speeds, "Of the platens, over the fastest wave in the wall"), calm)
    ->type_name("FIRST,LEAST,MOST")
    ->capture_default_str();
  run(app.add_option("--damping", o.damping, "Friction against an even deformation, over the lowest frequency"), calm)
    ->type_name("NUMBER")
    ->capture_default_str();
  const char* const points = "Points and grid";
  run(app.add_option("--shape", o.shape, "Shape functions"), points)
    ->type_name("linear|gimp|spline")
    ->capture_default_str();
  run(app.add_option("--transfer", o.transfer, "How points get their velocities back"), points)
    ->type_name("flip|pic|apic|xpic")
    ->capture_default_str();
  run(app.add_flag("--consistent-mass", o.consistentMass, "Instead of lumped mass"), points);
  run(app.add_flag("--modified-update", o.modifiedUpdate, "Stress from what points give back to the grid (MUSL)"),
    points);
  run(app.add_option("--time-step", o.timeStep, "0.9 of the largest stable one when not given"), points)
    ->type_name("SECONDS");
}

void addFileOptions(CLI::App& app, CompressionOptions& o)
{
  const auto out = [&](CLI::Option* option)
  {
    o.ofTheRun.push_back(option);
    return option->group("Output");
  };
  o.ofTheRun.push_back(
    addOutputOptions(app, o.output, o.common, "Write the points with their displacements at the end as .vtp"));
  out(app.add_option("--at-strain", o.atStrains, "At these strains too: FILE_000.vtp ... and FILE.pvd"))
    ->type_name("LIST")
    ->allow_extra_args(false);
  out(app.add_flag("--velocity", o.velocity, "Write the points' velocities too"));
  out(app.add_flag("--stress", o.stress, "Write the points' stresses (Cauchy's) too"));
  out(app.add_flag("--deformation-gradient", o.deformationGradient, "Write the points' deformation gradients too"));
  out(app.add_flag("--energy-density", o.energyDensity, "Write the points' elastic energy too"));
  out(app.add_option("--curve", o.curve, "Write the stress-strain curve"))->type_name("FILE.csv");
  out(app.add_option("--rows", o.rows, "Rows of the curve"))->type_name("NUMBER")->capture_default_str();
  app.add_option("--constants", o.constants, "Of --stiffness-only: write moduli and Poisson's ratios, one row each")
    ->type_name("FILE.csv")
    ->group("Output");
  addCheckpointOptions(app, o.checkpoint, "Steps between two; go on with the number that you began with", "2000");
  for (const char* name : { "--checkpoint", "--checkpoint-every", "--continue" })
  {
    o.ofTheRun.push_back(app.get_option(name));
  }
}

} // namespace

Command compressionCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand("compression",
    "Presses a picture or volume between platens: stress-strain curve to densification, deformed points");
  auto o = std::make_shared<CompressionOptions>();
  addPictureOptions(*app, o->picture);
  app->add_flag("--stiffness-only", o->stiffnessOnly, "Only moduli along every axis, without time: seconds")
    ->group("Load");
  addRunOptions(*app, *o);
  addPointOptions(*app, o->points);
  addFileOptions(*app, *o);
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella compression tissue.png --phase 0=lumen --other wall --stiffness-only",
      "lamella compression tissue.vti --curve curve.csv --at-strain 0.05,0.12,0.25 -o pressed.vtp",
      "lamella compression tissue.png --phase 0=lumen --other wall --law plastic --yield 1.5e8 --axis x --strain 0.3 "
      "--json",
      "lamella compression tissue.vti --checkpoint run.h5 --continue run.h5 --curve curve.csv --overwrite" });
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      o->stiffnessOnly ? stiffness(session, *o, line) : press(session, *o, line);
    } };
}

} // namespace lamella::cli
