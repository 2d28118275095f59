#include "commands/BreakRun.h"
#include "commands/CompressionReport.h"
#include "commands/FilterRun.h"
#include "commands/PointInput.h"
#include "files/FractureFiles.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"
#include "session/Workspace.h"

#include "core/Clock.h"
#include "core/Memory.h"
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
#include <utility>

namespace lamella::cli
{

namespace
{

struct CompressionOptions
{
  CommonOptions common;
  PictureOptions picture;
  SettingOptions settings;
  std::string speeds; ///< as in the version before
  std::string output;
  std::string curve;
  CheckpointWords checkpoint;
  bool stiffnessOnly = false;
  std::string constants;
};

/// What can be said without the sample. @throws ParameterError
void apply(const Session& session, const CompressionOptions& o, vtkPointCompression* filter)
{
  if (!o.speeds.empty())
  {
    const std::vector<std::string> parts = split(o.speeds, ',');
    const auto speed = [&](std::size_t i) { return parts.size() == 3 ? toNumber(parts[i]).value_or(-1) : -1; };
    filter->SetFirstSpeed(speed(0));
    filter->SetLeastSpeed(speed(1));
    filter->SetMostSpeed(speed(2));
  }
  o.settings.give(filter);
  for (const char* const word : { "at-strain", "velocity", "stress", "deformation-gradient", "energy-density" })
    if (o.output.empty() && o.settings.given(word))
      throw ParameterError(fmt::format("--{} without a file to write to", word), "add -o FILE.vtp");
  filter->SetComputeDisplacement(!o.output.empty());
  applyCheckpoint(session, o.checkpoint, filter);
  filter->SetKeepStates(session.keepsAllStates());
}

/// @param output with the filter's numbers as field data
BondRun runOf(Session& session, const CompressionOptions& o, const PointSample& sample, vtkPointAlgorithm* filter,
  vtkDataObject* output, const std::string& commandLine)
{
  (void)VtkMessages::takeWarnings(); // the same as in the field data
  o.settings.tellFormer(session);
  if (!o.speeds.empty())
  {
    session.warn(
      "--speeds is called --first-speed, --least-speed, --most-speed now; the next version does not know it");
  }
  for (const std::string& warning : fieldTexts(output, "warnings"))
    session.warn(warning);
  sample.image->GetFieldData()->ShallowCopy(output->GetFieldData());
  BondRun run;
  run.file = o.picture.file;
  run.image = sample.image;
  run.pixelSizeSource = sample.pixelSizeSource;
  run.provenance = recordRun(session, commandLine, o.picture.file, sample.provenance);
  run.threads = filter->GetThreads();
  run.ranks = session.ranks();
  return run;
}

void press(Session& session, const CompressionOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkPointCompression> filter;
  apply(session, o, filter);
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
      states = StateWriter(o.output, 1 + o.settings.count("at-strain"), o.common.overwrite, ".vtp",
        { "points", "the curve goes to --curve FILE.csv" });
      curve.addTable("--curve", o.curve, filter->GetCurve(), o.common.overwrite);
      sample = loadPointSample(session, o.picture, o.settings);
      sample.image->GetExtent(extent.data());
      if (!o.checkpoint.file.empty())
        states.follow(session, io::toJson(recordRun(session, commandLine, o.picture.file, sample.provenance)));
    });
  session.broadcast(extent);
  const auto finish = [&]
  {
    CompressionReport report{ runOf(session, o, sample, filter, filter->GetPoints(), commandLine), filter->GetCurve(),
      {}, {} };
    for (int i = 0; i < filter->GetNumberOfStates(); ++i)
      report.states.push_back(filter->GetStatePoints(i));
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
    throw ParameterError(fmt::format("--stiffness-only on {} processes", session.ranks()), "run one, with --threads");
  std::vector<std::string> ofTheRun = o.settings.idle("vtkPointStiffness");
  for (const auto& [word, text] : { std::pair<const char*, const std::string&>{ "output", o.output },
         { "curve", o.curve }, { "checkpoint", o.checkpoint.file }, { "checkpoint-every", o.checkpoint.every },
         { "continue", o.checkpoint.continueFrom }, { "speeds", o.speeds } })
    if (!text.empty())
      ofTheRun.emplace_back(word);
  if (!ofTheRun.empty())
  {
    throw ParameterError(
      "--stiffness-only with --" + ofTheRun.front(), "leave one of them out: stiffness has no run and no states");
  }
  vtkNew<vtkPointStiffness> filter;
  o.settings.give(filter);
  ResultFiles files;
  files.addTable("--constants", o.constants, filter->GetConstants(), o.common.overwrite);
  const PointSample sample = loadPointSample(session, o.picture, o.settings);
  filter->SetInputData(sample.image);
  const PlanNote plan(session, filter);
  runFilter(session, filter, "stiffness");
  BondRun run = runOf(session, o, sample, filter, filter->GetConstants(), commandLine);
  run.written = files.write(io::toJson(run.provenance));
  run.seconds = secondsSince(start);
  session.print(o.common.json ? pointStiffnessJson(run) : o.common.quiet ? "" : pointStiffnessTable(run));
}

void addFileOptions(CLI::App& app, CompressionOptions& o)
{
  addOutputOptions(app, o.output, o.common, "Write the points with their displacements at the end as .vtp");
  const auto out = [](CLI::Option* option) { return option->group("Output"); };
  out(app.add_option("--curve", o.curve, "Write the stress-strain curve"))->type_name("FILE.csv");
  out(
    app.add_option("--constants", o.constants, "Of --stiffness-only: write moduli and Poisson's ratios, one row each"))
    ->type_name("FILE.csv");
  addCheckpointOptions(app, o.checkpoint, "Steps between two; go on with the number that you began with", "2000");
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
  // Sides are those of the stiffness, which has one more.
  o->settings.declare(*app, "vtkPointCompression",
    { "sides", "keep-states", "state", "displacement", "checkpoint", "checkpoint-every", "checkpoint-seconds",
      "continue" });
  o->settings.declare(*app, "vtkPointStiffness");
  app->add_option("--speeds", o->speeds)->group("");
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
