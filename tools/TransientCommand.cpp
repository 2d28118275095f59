#include "BreakRun.h"
#include "CommandLine.h"
#include "Commands.h"
#include "FilterRun.h"
#include "FractureFiles.h"
#include "GridFile.h"
#include "Input.h"
#include "JsonReport.h"
#include "Record.h"
#include "ResultFiles.h"
#include "SampleRun.h"
#include "TableText.h"
#include "Text.h"
#include "Units.h"
#include "Workspace.h"

#include "lattice/Clock.h"
#include "lattice/PhaseNames.h"
#include "vtkLatticeBoltzmann.h"
#include "vtkLatticeConversion.h"

#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <array>
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
  std::vector<std::string> diffusivity;
  std::string direction = "x";
  std::string values = "1,0";
  double initial = 0;
  std::string sides = "insulated";
  std::string quantity = "temperature";
  std::string endTime;
  std::string frames;
  std::vector<std::string> atTimes;
  std::vector<std::string> atSteps;
  std::string collision = "auto";
  std::string lattice;
  std::string step;
  int threads = 1;
  bool flux = false;
  std::string output;
  std::string curve;
  CheckpointWords checkpoint;
};

const std::vector<std::string> directions{ "x", "y", "z" };
const std::vector<std::string> sidesWords{ "insulated", "periodic" };
const std::vector<std::string> quantities{ "temperature", "concentration" };
const std::vector<std::string> collisions{ "auto", "bgk", "trt" };
const std::vector<std::string> lattices{ "auto", "d2q5", "d2q9", "d3q7", "d3q19" };
constexpr const char* seconds = "write it in seconds, such as 0.5";
constexpr int usualFrames = 10;

/// When states are kept. @returns how many @throws ParameterError
std::size_t applyTimes(const TransientOptions& o, vtkLatticeBoltzmann* filter)
{
  const std::vector<std::string> times = listed(o.atTimes);
  const std::vector<std::string> steps = listed(o.atSteps);
  if (times.empty() && steps.empty())
  {
    if (o.endTime.empty())
    {
      throw ParameterError(
        "no --end-time was given", "write it in seconds, such as 0.5, or name states with --at-time");
    }
    filter->SetEndTime(positive("--end-time", o.endTime, seconds));
    const auto frames = o.frames.empty() ? usualFrames : toInteger(o.frames).value_or(0);
    if (frames < 1 || frames > 100000)
    {
      throw ParameterError(fmt::format("--frames {} is not from 1 to 100000", o.frames),
        "it is how many times after 0 are kept, evenly until --end-time");
    }
    filter->SetNumberOfSteps(static_cast<int>(frames));
    return static_cast<std::size_t>(frames) + 1;
  }
  if (!o.endTime.empty() || !o.frames.empty())
  {
    throw ParameterError(fmt::format("{} with {}", times.empty() ? "--at-step" : "--at-time",
                           o.endTime.empty() ? "--frames" : "--end-time"),
      "states are kept evenly until --end-time, or where --at-time and --at-step say, the last of which is the end");
  }
  for (const std::string& text : times)
  {
    const auto time = toNumber(text);
    if (!time || !std::isfinite(*time) || *time < 0)
    {
      throw ParameterError("--at-time '" + text + "' is not a time", "write times in seconds, such as 0,1e-3,1e-2");
    }
    filter->AddStateAtTime(*time);
  }
  for (const std::string& text : steps)
  {
    const auto step = toInteger(text);
    if (!step || *step < 0 || *step % 2 != 0)
    {
      throw ParameterError(
        "--at-step '" + text + "' is not an even number of steps", "steps come in pairs: write 0,100,1000");
    }
    filter->AddStateAtStep(*step);
  }
  return times.size() + steps.size();
}

/// @throws ParameterError for a diffusivity of a phase that the sample has not
void checkNames(const TransientOptions& o, const std::vector<std::string>& phases)
{
  for (const std::string& text : listItems(o.diffusivity))
  {
    const std::string name = keyValue("--diffusivity", text, "NAME=VALUE").first;
    if (!phaseMeant(phases, name))
    {
      throw ParameterError("--diffusivity names '" + name + "', which is no phase of this sample",
        suggestion(name, phases, "its phases are " + quotedList(phases, "and")));
    }
  }
}

/// What can be said without the sample. @throws ParameterError
void apply(const TransientOptions& o, vtkLatticeBoltzmann* filter)
{
  for (const std::string& text : listItems(o.diffusivity))
  {
    const auto [name, number] = keyValue("--diffusivity", text, "NAME=VALUE");
    const auto value = toNumber(number);
    if (!value || !(*value == 0 || (*value > 0 && plausible(*value))))
    {
      throw ParameterError("--diffusivity '" + text + "': '" + number + "' is no diffusivity",
        fmt::format("write it in m²/s, such as --diffusivity {}=1.8e-7; 0 for a phase that does not conduct", name));
    }
    filter->SetDiffusivity(name.c_str(), *value);
  }
  filter->SetDirection(static_cast<int>(oneOf("--direction", o.direction, directions)));
  filter->SetSides(static_cast<int>(oneOf("--sides", o.sides, sidesWords)));
  filter->SetQuantity(static_cast<int>(oneOf("--quantity", o.quantity, quantities)));
  filter->SetCollision(static_cast<int>(oneOf("--stepping", o.collision, collisions)));
  filter->SetLattice(o.lattice.empty() ? 0 : static_cast<int>(oneOf("--lattice", o.lattice, lattices)));
  const std::vector<std::string> faces = split(o.values, ',');
  const auto inlet = toNumber(faces.front());
  const auto outlet = toNumber(faces.back());
  const auto fine = [](double value) { return value == 0 || plausible(value); };
  if (faces.size() != 2 || !inlet || !outlet || !fine(*inlet) || !fine(*outlet))
  {
    throw ParameterError("--values '" + o.values + "' is not two numbers",
      "give the value where the direction begins and where it ends, such as 1,0");
  }
  filter->SetInletValue(*inlet);
  filter->SetOutletValue(*outlet);
  if (!fine(o.initial))
  {
    throw ParameterError(fmt::format("--initial {} is no value", o.initial), "it is of the size of --values");
  }
  filter->SetInitialValue(o.initial);
  filter->SetTimeStep(o.step.empty() ? 0 : positive("--step", o.step, seconds));
  checkThreads(o.threads);
  filter->SetThreads(o.threads);
  filter->SetComputeFlux(o.flux);
  filter->SetKeepStates(Workspace::current() == nullptr || !Workspace::current()->lastStateOnly);
  if (o.flux && o.output.empty())
  {
    throw ParameterError("--flux without a file to write to", "add -o FILE.vti");
  }
  applyCheckpoint(o.checkpoint, filter);
}

double numberOf(vtkImageData* state, const char* name)
{
  return fieldNumbers(state, name).at(0);
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
    grouped(json.at("steps").get<std::int64_t>()), json.at("time_step").get<double>(),
    json.at("stepping").get<std::string>(), json.at("lattice").get<std::string>(), json.at("relaxation").get<double>(),
    grouped(json.at("stored_nodes").get<std::int64_t>()), grouped(json.at("skipped_nodes").get<std::int64_t>()));
  if (const auto at = json.at("continued_at").get<std::int64_t>(); at > 0)
  {
    text += fmt::format("  continued after {} steps\n", grouped(at));
  }
  if (const auto last = json.at("last_checkpoint").get<std::int64_t>(); last > 0)
  {
    text += fmt::format("  {} checkpoints, the last after {} steps\n",
      grouped(json.at("checkpoints").get<std::int64_t>()), grouped(last));
  }
  return text + wroteText(json.at("written").get<std::vector<std::string>>());
}

std::string textOf(vtkDataObject* data, const char* name)
{
  return data->GetFieldData()->GetAbstractArray(name)->GetVariantValue(0).ToString();
}

void transient(Session& session, const TransientOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkLatticeBoltzmann> filter;
  apply(o, filter);
  const std::size_t frames = applyTimes(o, filter);
  auto image = vtkSmartPointer<vtkImageData>::New();
  std::array<int, 6> extent{ 0, -1, 0, -1, 0, -1 };
  std::string provenance;
  StateWriter files;
  ResultFiles tables;
  session.onRoot(
    [&]
    {
      checkCheckpoint(o.checkpoint, o.common.overwrite);
      files =
        StateWriter(o.output, frames, o.common.overwrite, ".vti", { "fields", "the history goes to --curve FILE.csv" });
      if (!o.curve.empty())
      {
        tables.addTable("--curve", o.curve, filter->GetCurve(), o.common.overwrite);
      }
      Sample sample = loadSample(o.picture);
      Session::checkInterrupt();
      checkNames(o, sample.image.phases.names());
      if (sample.pixelSizeSource == "none")
      {
        throw ParameterError("a run in time needs the size of a pixel, which '" + o.picture.file + "' does not tell",
          "add --pixel-size, such as --pixel-size 0.5um");
      }
      tellDoubts(session, sample);
      files.needs(static_cast<std::uint64_t>(sample.image.lattice.count()) * (o.flux ? 33 : 9));
      provenance = sample.provenance;
      if (!o.checkpoint.file.empty())
      {
        files.follow(session, io::toJson(recordRun(commandLine, o.picture.file, provenance)));
      }
      image = toImageData(std::move(sample.image));
      setFieldText(image, "pixel_size_source", sample.pixelSizeSource);
      setProvenance(image, provenance);
      image->GetExtent(extent.data());
    });
  session.broadcast(extent);
  const auto finish = [&]
  {
    if (filter->GetNumberOfStates() == 0)
    {
      throwFailure(filter->GetFailure());
    }
    tellWarnings(session);
    std::vector<vtkDataObject*> states;
    for (int k = 0; k < filter->GetNumberOfStates(); ++k)
    {
      states.push_back(filter->GetStateImage(k));
    }
    const io::Provenance record = recordRun(commandLine, o.picture.file, provenance);
    std::vector<std::string> written = files.write(states, io::toJson(record));
    for (const std::string& name : tables.write(io::toJson(record)))
    {
      written.push_back(name);
    }
    files.commit();
    vtkImageData* const last = vtkImageData::SafeDownCast(states.back());
    Json json;
    json["file"] = o.picture.file;
    json["curve"] = jsonRows(filter->GetCurve());
    json["stepping"] = textOf(last, "collision");
    json["lattice"] = textOf(last, "lattice");
    json["direction"] = o.direction;
    json["sides"] = o.sides;
    json["steps"] = static_cast<std::int64_t>(numberOf(last, "steps"));
    json["time_step"] = numberOf(last, "time_step");
    json["relaxation"] = numberOf(last, "relaxation");
    json["stored_nodes"] = static_cast<std::int64_t>(numberOf(last, "stored_nodes"));
    json["skipped_nodes"] = static_cast<std::int64_t>(numberOf(last, "skipped_nodes"));
    json["updates_per_second"] = numberOf(last, "updates_per_second");
    json["bytes"] = numberOf(last, "bytes");
    for (const char* name : { "continued_at", "states_before", "checkpoints", "last_checkpoint" })
    {
      json[name] = static_cast<std::int64_t>(numberOf(last, name));
    }
    json["warning"] = textOf(last, "warning");
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
      runFilterOnRanks(session, filter.Get(), image, extent, "stepping");
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
  const auto option = [&](const char* group, const char* name, auto& value, const char* text, const char* type)
  { return app->add_option(name, value, text)->type_name(type)->group(group); };
  const char* const diffusion = "Diffusion";
  option(diffusion, "--diffusivity", o->diffusivity, "Of a phase [m²/s]; 0: does not conduct", "NAME=VALUE")
    ->allow_extra_args(false);
  option(diffusion, "--direction", o->direction, "From which face to which", "x|y|z")->capture_default_str();
  option(diffusion, "--values", o->values, "On the face where it begins and on that where it ends", "INLET,OUTLET")
    ->capture_default_str();
  option(diffusion, "--initial", o->initial, "Value inside at time 0", "NUMBER")->capture_default_str();
  option(diffusion, "--sides", o->sides, "The other sides", "insulated|periodic")->capture_default_str();
  option(diffusion, "--quantity", o->quantity, "Names the field", "temperature|concentration")->capture_default_str();
  const char* const time = "Time";
  option(time, "--end-time", o->endTime, "The last time [s]", "NUMBER");
  option(time, "--frames", o->frames, "Times after 0 that are kept, evenly until the end", "NUMBER")->default_str("10");
  option(time, "--at-time", o->atTimes, "Keep these times [s] instead; the last is the end", "LIST")
    ->allow_extra_args(false);
  option(time, "--at-step", o->atSteps, "Keep the ends of these numbers of steps instead, likewise", "LIST")
    ->allow_extra_args(false);
  const char* const numerics = "Accuracy and cost";
  option(numerics, "--stepping", o->collision, "Two relaxation times, or one as in the first paper; auto is trt",
    "auto|bgk|trt")
    ->capture_default_str();
  option(numerics, "--lattice", o->lattice, "d2q5 or d3q7 where nothing is said", "d2q5|d2q9|d3q7|d3q19");
  option(numerics, "--step", o->step, "Time step [s]; short enough to be accurate where nothing is said", "NUMBER");
  option(numerics, "--threads", o->threads, "Of each process", "NUMBER")->capture_default_str();
  addOutputOptions(*app, o->output, o->common, "Write the field at each time: FILE_000.vti ... and FILE.pvd");
  app->add_flag("--flux", o->flux, "With its flux")->group("Output");
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
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      transient(session, *o, line);
    } };
}

} // namespace lamella::cli
