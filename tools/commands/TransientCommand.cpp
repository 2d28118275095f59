#include "commands/BreakRun.h"
#include "commands/FilterRun.h"
#include "commands/SampleRun.h"
#include "files/FieldReport.h"
#include "files/FractureFiles.h"
#include "files/GridFile.h"
#include "files/Input.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "files/TableText.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"
#include "session/Workspace.h"

#include "core/Clock.h"
#include "vtkLatticeBoltzmann.h"
#include "vtkLatticeConversion.h"

#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

struct TransientOptions
{
  CommonOptions common;
  PictureOptions picture;
  SettingOptions settings;
  std::string values; ///< as in the version before
  std::string output;
  std::string curve;
  CheckpointWords checkpoint;
};

/// What can be said without the sample. @returns how many states there may be @throws ParameterError
std::size_t apply(const Session& session, const TransientOptions& o, vtkLatticeBoltzmann* filter)
{
  o.settings.give(filter);
  if (!o.values.empty())
  {
    const std::vector<std::string> faces = split(o.values, ',');
    const auto inlet = toNumber(faces.front());
    const auto outlet = toNumber(faces.back());
    if (faces.size() != 2 || !inlet || !outlet)
    {
      throw ParameterError("--values '" + o.values + "' is not two numbers",
        "give --inlet-value and --outlet-value, which is what the next version calls it");
    }
    filter->SetInletValue(*inlet);
    filter->SetOutletValue(*outlet);
  }
  if (filter->GetComputeFlux() && o.output.empty())
    throw ParameterError("--flux without a file to write to", "add -o FILE.vti");
  filter->SetKeepStates(session.keepsAllStates());
  applyCheckpoint(session, o.checkpoint, filter);
  const std::size_t named = o.settings.count("at-time") + o.settings.count("at-step");
  if (named > 0 && (o.settings.given("end-time") || o.settings.given("frames")))
  {
    throw ParameterError(fmt::format("--{} with --{}", o.settings.given("at-time") ? "at-time" : "at-step",
                           o.settings.given("end-time") ? "end-time" : "frames"),
      "states are kept evenly until --end-time, or where --at-time and --at-step say, the last of which is the end");
  }
  return named > 0 ? named : static_cast<std::size_t>(filter->GetNumberOfSteps()) + 1;
}

std::string words(const Json& json)
{
  std::string text = fmt::format("{:>12}  {:>12}  {:>12}  {:>12}\n", "time [s]", "inlet [m/s]", "outlet [m/s]", "mean");
  const auto flux = [](const Json& row, const char* name)
  {
    const Json& value = row.at(name);
    return value.is_number() && std::isfinite(value.get<double>()) ? fmt::format("{:12.5g}", value.get<double>())
                                                                   : fmt::format("{:>12}", "not known");
  };
  for (const Json& row : json.at("curve"))
  {
    text += fmt::format("{:12.5g}  {}  {}  {:12.5g}\n", row.at("time").get<double>(), flux(row, "inlet_flux"),
      flux(row, "outlet_flux"), row.at("mean_value").get<double>());
  }
  text += fmt::format("{} steps of {:.5g} s, {} on {}, relaxation {:.4g}; {} nodes stored, {} left out\n",
    counted(json.at("steps")), json.at("time_step").get<double>(), json.at("stepping").get<std::string>(),
    json.at("lattice").get<std::string>(), json.at("relaxation").get<double>(), counted(json.at("stored_nodes")),
    counted(json.at("skipped_nodes")));
  if (const auto at = json.at("continued_at").get<std::int64_t>(); at > 0)
    text += fmt::format("  continued after {} steps\n", grouped(at));
  if (const auto last = json.at("last_checkpoint").get<std::int64_t>(); last > 0)
    text += fmt::format("  {} checkpoints, the last after {} steps\n", counted(json.at("checkpoints")), grouped(last));
  return text + wroteText(json.at("written").get<std::vector<std::string>>());
}

void transient(Session& session, const TransientOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkLatticeBoltzmann> filter;
  const std::size_t frames = apply(session, o, filter);
  ImageSample sample;
  StateWriter files;
  ResultFiles tables;
  session.onRoot(
    [&]
    {
      checkCheckpoint(o.checkpoint, o.common.overwrite);
      files =
        StateWriter(o.output, frames, o.common.overwrite, ".vti", { "fields", "the history goes to --curve FILE.csv" });
      if (!o.curve.empty())
        tables.addTable("--curve", o.curve, filter->GetCurve(), o.common.overwrite);
      sample = loadImage(session, o.picture, o.settings);
      files.needs(static_cast<std::uint64_t>(sample.image->GetNumberOfPoints()) * (filter->GetComputeFlux() ? 33 : 9));
      if (!o.checkpoint.file.empty())
        files.follow(session, io::toJson(recordRun(session, commandLine, o.picture.file, sample.provenance)));
    });
  session.broadcast(sample.extent);
  const auto finish = [&]
  {
    tellWarnings(session);
    if (!o.values.empty())
      session.warn(
        "--values is called --inlet-value and --outlet-value now; the next version does not know --values any more");
    o.settings.tellFormer(session);
    std::vector<vtkDataObject*> states;
    for (int k = 0; k < filter->GetNumberOfStates(); ++k)
      states.push_back(filter->GetStateImage(k));
    const io::Provenance record = recordRun(session, commandLine, o.picture.file, sample.provenance);
    std::vector<std::string> written = files.write(states, io::toJson(record));
    for (const std::string& name : tables.write(io::toJson(record)))
      written.push_back(name);
    files.commit();
    Json json;
    json["file"] = o.picture.file;
    json["curve"] = jsonRows(filter->GetCurve());
    using enum Key::Kind;
    addKeys(json, { states.back() },
      { { "stepping", Text, "collision" }, { "lattice", Text }, { "direction", Text }, { "sides", Text },
        { "steps", Whole }, { "time_step" }, { "relaxation" }, { "stored_nodes", Whole }, { "skipped_nodes", Whole },
        { "updates_per_second" }, { "bytes" }, { "continued_at", Whole }, { "states_before", Whole },
        { "checkpoints", Whole }, { "last_checkpoint", Whole }, { "warning", Text } });
    json["ranks"] = session.ranks();
    json["seconds"] = secondsSince(start);
    json["written"] = written;
    printReport(session, o.common, json, record, words);
  };
  const KeptRun kept{ commandLine, session.ranks(), "steps", [&] { return filter->GetLastCheckpoint(); },
    [&] { return filter->GetCheckpointEvery(); }, [&] { return files.leaves(); } };
  runKept(session, o.checkpoint, kept,
    [&]
    {
      const auto piece = sample.image ? sample.image : vtkSmartPointer<vtkImageData>::New();
      runFilterOnRanks(session, filter.Get(), piece, sample.extent, "stepping");
      session.onRoot(finish);
    });
}

} // namespace

Command transientCommand(CLI::App& root)
{
  CLI::App* app =
    root.add_subcommand("transient", "Heat or vapour through a picture or volume in time, by lattice Boltzmann steps");
  auto o = std::make_shared<TransientOptions>();
  addPictureOptions(*app, o->picture);
  o->settings.declare(
    *app, "vtkLatticeBoltzmann", { "checkpoint", "checkpoint-every", "checkpoint-seconds", "continue", "keep-states" });
  o->settings.formerly(*app, "initial", "initial-value");
  o->settings.formerly(*app, "step", "time-step");
  app->add_option("--values", o->values)->group("");
  addOutputOptions(*app, o->output, o->common, "Write the field at each time: FILE_000.vti ... and FILE.pvd");
  addResultFile(*app, "--curve", o->curve, "Write times, fluxes through both faces and the mean value");
  addCheckpointOptions(*app, o->checkpoint, "Steps between two", "10000");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella transient tissue.vti --diffusivity wall=1.8e-7 --diffusivity lumen=2.2e-5 --end-time 1e-4 -o heat.vti "
      "--curve heat.csv",
      "lamella transient cells.png --phase 0=lumen --other wall --pixel-size 0.5um --diffusivity lumen=2.6e-5 "
      "--diffusivity wall=1e-9 --end-time 1 --frames 50 --quantity concentration --json",
      "lamella transient tissue.vti --diffusivity wall=1.8e-7 --diffusivity lumen=0 --stepping bgk --lattice d2q9 "
      "--end-time 0.1",
      "lamella transient volume.vti --diffusivity wall=1.8e-7 --diffusivity lumen=0 --at-time 1e-4,1e-3,1e-2 "
      "--checkpoint run.h5 --continue run.h5 -o heat.vti --overwrite" });
  return jointCommand(app, o, transient);
}

} // namespace lamella::cli
