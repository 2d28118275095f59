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
#include "Workspace.h"

#include "lattice/Clock.h"
#include "vtkLatticeBoltzmann.h"
#include "vtkLatticeConversion.h"
#include "vtkSampleAlgorithm.h"

#include <vtkCallbackCommand.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <algorithm>
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
  int frames = 10;
  std::string collision = "auto";
  std::string lattice;
  std::string step;
  int threads = 1;
  bool flux = false;
  std::string output;
  std::string curve;
};

const std::vector<std::string> directions{ "x", "y", "z" };
const std::vector<std::string> sidesWords{ "insulated", "periodic" };
const std::vector<std::string> quantities{ "temperature", "concentration" };
const std::vector<std::string> collisions{ "auto", "bgk", "trt" };
const std::vector<std::string> lattices{ "auto", "d2q5", "d2q9", "d3q7", "d3q19" };
constexpr const char* seconds = "write it in seconds, such as 0.5";

/// What can be said without the sample. @throws ParameterError
void apply(const TransientOptions& o, vtkLatticeBoltzmann* filter)
{
  for (const std::string& text : o.diffusivity)
  {
    const auto [name, number] = keyValue("--diffusivity", text, "NAME=VALUE");
    const auto value = toNumber(number);
    if (!value || !std::isfinite(*value) || *value < 0)
    {
      throw ParameterError("--diffusivity '" + text + "': '" + number + "' is no diffusivity",
        "write it in m²/s, such as --diffusivity wall=1.8e-7; 0 for a phase that does not conduct");
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
  if (faces.size() != 2 || !inlet || !outlet || !std::isfinite(*inlet) || !std::isfinite(*outlet))
  {
    throw ParameterError("--values '" + o.values + "' is not two numbers",
      "give the value where the direction begins and where it ends, such as 1,0");
  }
  filter->SetInletValue(*inlet);
  filter->SetOutletValue(*outlet);
  filter->SetInitialValue(o.initial);
  if (o.endTime.empty())
  {
    throw ParameterError("no --end-time was given", seconds);
  }
  filter->SetEndTime(positive("--end-time", o.endTime, seconds));
  filter->SetTimeStep(o.step.empty() ? 0 : positive("--step", o.step, seconds));
  if (o.frames < 1 || o.frames > 100000)
  {
    throw ParameterError(fmt::format("--frames {} is not from 1 to 100000", o.frames),
      "it is how many times after 0 are kept, evenly until --end-time");
  }
  filter->SetNumberOfSteps(o.frames);
  checkThreads(o.threads);
  filter->SetThreads(o.threads);
  filter->SetComputeFlux(o.flux);
  filter->SetKeepStates(Workspace::current() == nullptr || !Workspace::current()->lastStateOnly);
  if (o.flux && o.output.empty())
  {
    throw ParameterError("--flux without a file to write to", "add -o FILE.vti");
  }
}

/// A column of a number that each state has in its field data.
struct Column
{
  const char* name;
  const char* unit;
  const char* what;
};
constexpr std::array<Column, 4> columns{ { { "time", "s", "since the start" },
  { "inlet_flux", "m/s", "mean over the face where the direction begins, times the unit of the values" },
  { "outlet_flux", "m/s", "mean over the face where it ends, times the unit of the values" },
  { "mean_value", "1", "over the box, 0 where nothing conducts" } } };

double numberOf(vtkImageData* state, const char* name)
{
  return fieldNumbers(state, name).at(0);
}

using Row = std::array<double, columns.size()>;

/// The numbers of each state that a run comes to, whether it is kept or not.
class History
{
public:
  explicit History(vtkLatticeBoltzmann* filter)
  {
    command_->SetClientData(&rows_);
    command_->SetCallback(
      [](vtkObject*, unsigned long, void* rows, void* state)
      {
        Row row{};
        std::transform(columns.begin(), columns.end(), row.begin(),
          [&](const Column& column)
          { return numberOf(vtkImageData::SafeDownCast(static_cast<vtkDataObject*>(state)), column.name); });
        static_cast<std::vector<Row>*>(rows)->push_back(row);
      });
    filter->AddObserver(vtkSampleAlgorithm::STEP_EVENT, command_);
  }
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

private:
  std::vector<Row> rows_;
  vtkNew<vtkCallbackCommand> command_;
};

vtkNew<vtkTable> curveOf(const std::vector<Row>& rows)
{
  vtkNew<vtkTable> table;
  for (std::size_t c = 0; c < columns.size(); ++c)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(columns[c].name);
    for (const Row& row : rows)
    {
      array->InsertNextValue(row[c]);
    }
    describe(array, columns[c].unit, columns[c].what, "lamella transient");
    table->AddColumn(array);
  }
  return table;
}

std::string words(const Json& json)
{
  std::string text = fmt::format("{:>12}  {:>12}  {:>12}  {:>12}\n", "time [s]", "inlet [m/s]", "outlet [m/s]", "mean");
  for (const Json& row : json.at("curve"))
  {
    text += fmt::format("{:12.5g}  {:12.5g}  {:12.5g}  {:12.5g}\n", row.at("time").get<double>(),
      row.at("inlet_flux").get<double>(), row.at("outlet_flux").get<double>(), row.at("mean_value").get<double>());
  }
  text += fmt::format("{} steps of {:.5g} s, {} on {}, relaxation {:.4g}; {} nodes stored, {} left out\n",
    grouped(json.at("steps").get<std::int64_t>()), json.at("time_step").get<double>(),
    json.at("stepping").get<std::string>(), json.at("lattice").get<std::string>(), json.at("relaxation").get<double>(),
    grouped(json.at("stored_nodes").get<std::int64_t>()), grouped(json.at("skipped_nodes").get<std::int64_t>()));
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
  const History history(filter);
  auto image = vtkSmartPointer<vtkImageData>::New();
  std::array<int, 6> extent{ 0, -1, 0, -1, 0, -1 };
  std::string provenance;
  StateWriter files;
  ResultFiles tables;
  const auto nameTable = [&](vtkTable* table)
  {
    if (!o.curve.empty())
    {
      tables.addTable("--curve", o.curve, table, o.common.overwrite);
    }
  };
  vtkNew<vtkTable> curve;
  session.onRoot(
    [&]
    {
      files = StateWriter(o.output, static_cast<std::size_t>(o.frames) + 1, o.common.overwrite, ".vti",
        { "fields", "the history goes to --curve FILE.csv" });
      nameTable(curve);
      Sample sample = loadSample(o.picture);
      Session::checkInterrupt();
      if (sample.pixelSizeSource == "none")
      {
        throw ParameterError("a run in time needs the size of a pixel, which '" + o.picture.file + "' does not tell",
          "add --pixel-size, such as --pixel-size 0.5um");
      }
      tellDoubts(session, sample);
      files.needs(static_cast<std::uint64_t>(sample.image.lattice.count()) * (o.flux ? 33 : 9));
      provenance = sample.provenance;
      image = toImageData(std::move(sample.image));
      setFieldText(image, "pixel_size_source", sample.pixelSizeSource);
      setProvenance(image, provenance);
      image->GetExtent(extent.data());
    });
  session.broadcast(extent);
  runFilterOnRanks(session, filter.Get(), image, extent, "stepping");
  session.onRoot(
    [&]
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
        setFieldNumbers(states.back(), "states_before", std::array{ 0.0 });
      }
      const io::Provenance record = recordRun(commandLine, o.picture.file, provenance);
      curve->ShallowCopy(curveOf(history.rows()));
      std::vector<std::string> written = files.write(states, io::toJson(record));
      for (const std::string& name : tables.write(io::toJson(record)))
      {
        written.push_back(name);
      }
      files.commit();
      vtkImageData* const last = vtkImageData::SafeDownCast(states.back());
      Json json;
      json["file"] = o.picture.file;
      json["curve"] = jsonRows(curve);
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
      json["warning"] = textOf(last, "warning");
      json["ranks"] = session.ranks();
      json["seconds"] = secondsSince(start);
      json["written"] = written;
      printReport(session, o.common, json, record, words);
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
  option(time, "--frames", o->frames, "Times after 0 that are kept, evenly until the end", "NUMBER")
    ->capture_default_str();
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
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella transient tissue.vti --diffusivity wall=1.8e-7 --diffusivity lumen=2.2e-5 --end-time 0.02 -o heat.vti "
      "--curve heat.csv",
      "lamella transient cells.png --phase 0=lumen --other wall --pixel-size 0.5um --diffusivity lumen=2.6e-5 "
      "--diffusivity wall=1e-9 --end-time 1 --frames 50 --quantity concentration --json",
      "lamella transient tissue.vti --diffusivity wall=1.8e-7 --diffusivity lumen=0 --stepping bgk --lattice d2q9 "
      "--end-time 0.1" });
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      transient(session, *o, line);
    } };
}

} // namespace lamella::cli
