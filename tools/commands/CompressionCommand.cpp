#include "commands/BondReport.h"
#include "commands/BreakRun.h"
#include "commands/DiffusionReport.h"
#include "commands/FilterRun.h"
#include "commands/SampleRun.h"
#include "files/FractureFiles.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "files/TableText.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"
#include "session/Workspace.h"

#include "core/Clock.h"
#include "core/Memory.h"
#include "vtkLatticeConversion.h"
#include "vtkPointCompression.h"
#include "vtkPointStiffness.h"

#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lamella::cli
{

namespace
{

struct CompressionReport
{
  BondRun run; ///< its image: the sample, with the filter's numbers as field data
  vtkTable* curve = nullptr;
  std::vector<vtkDataObject*> states;
  std::vector<std::string> stateFiles;
};

constexpr int rowsShown = 12;

double cell(vtkTable* table, vtkIdType row, const char* name)
{
  return vtkDataArray::SafeDownCast(table->GetColumnByName(name))->GetTuple1(row);
}

/// Walls, plane and grid.
void addPoints(Json& json, const BondFields& f)
{
  const Json model = Json::parse(f.text("point_model"), nullptr, false);
  for (const char* key : { "law", "plane", "walls", "points_per_node", "cells_per_node" })
    json[key] = model[key];
  json["points"] = f.whole("points");
  json["grid_spacing"] = f("grid_spacing");
  json["cells_across_walls"] = f("cells_across_walls");
  json["thin_wall_share"] = f("thin_wall_share");
  json["warnings"] = fieldTexts(f.image, "warnings");
}

std::string headText(const BondRun& run, const BondFields& f)
{
  const Lattice lattice = latticeOf(run.image);
  const bool known = run.pixelSizeSource != "none";
  std::string text = fmt::format("{}: {} nodes{}\n", run.file, sizeText(lattice.size, lattice.dimension),
    known ? fmt::format(" of {:g} µm", lattice.spacing * 1e6) : ", pixel size unknown");
  const Json model = Json::parse(f.text("point_model"), nullptr, false);
  for (const auto& [phase, constants] : model["walls"].items())
  {
    std::string list;
    for (const auto& [name, number] : constants.items())
    {
      list += fmt::format("{}{} {}", list.empty() ? "" : ", ", name,
        number.is_number() ? fmt::format("{:g}", number.get<double>()) : "inf");
    }
    text += fmt::format("  {}: {}\n", phase, list);
  }
  text += fmt::format("  {}, {}; {} points on a grid of {:.3g} pixels, walls of {:.3g} cells (median)\n", f.text("law"),
    f.text("plane"), grouped(f.whole("points")), f("grid_spacing") / lattice.spacing, f("cells_across_walls"));
  return text;
}

/// What the sides do to a modulus; empty where nothing is to be said.
std::string sidesNote(const BondFields& f)
{
  return f.text("sides") == "straight"
    ? "straight sides are stiffer than free ones (--sides open), in wood by 1 to 50 %"
    : "";
}

std::string compressionJson(const CompressionReport& report)
{
  const BondFields f(report.run);
  Json json;
  using enum Key::Kind;
  addKeys(json, f, { { "strain" }, { "stress" }, { "axis", Text, "load_axis" }, { "sides", Text } });
  json["sides_note"] = sidesNote(f);
  addKeys(json, f,
    { { "worst_energy_ratio" }, { "worst_energy_ratio_strain" }, { "early_energy_ratio" },
      { "early_energy_ratio_strain" }, { "calm_from" }, { "worst_lateral" }, { "worst_imbalance" },
      { "first_touch_strain" }, { "wave_speed" }, { "slowdowns", Whole }, { "steps", Whole }, { "continued_at", Whole },
      { "states_before", Whole }, { "checkpoints", Whole }, { "last_checkpoint", Whole } });
  json["states"] = statesJson(report.states, report.stateFiles, { { "strain" }, { "stress" } });
  json["curve"] = jsonRows(report.curve);
  addPoints(json, f);
  addKeys(json, f,
    { { "bytes_per_point" }, { "updates_per_second" }, { "setup_seconds", Number, "seconds", 0 },
      { "run_seconds", Number, "seconds", 1 } });
  json["seconds"] = report.run.seconds;
  addRun(json, report.run);
  return dump(json);
}

std::string compressionTable(const CompressionReport& report)
{
  const BondFields f(report.run);
  std::string text = headText(report.run, f);
  text += fmt::format("\n  pressed along {}, sides {}\n  {:>8}  {:>12}  {:>9}  {:>10}  {:>15}\n", f.text("load_axis"),
    f.text("sides"), "strain", "stress [Pa]", "porosity", "across", "kinetic/elastic");
  vtkTable* const curve = report.curve;
  const vtkIdType last = curve->GetNumberOfRows() - 1;
  const vtkIdType shown = std::min<vtkIdType>(last, rowsShown);
  for (vtkIdType k = 1; k <= shown; ++k)
  {
    const vtkIdType row = k * last / shown;
    const double elastic = cell(curve, row, "elastic_energy");
    text += fmt::format("  {:>8.4f}  {:>12.5g}  {:>9.4f}  {:>10.4f}  {:>15}\n", cell(curve, row, "strain"),
      cell(curve, row, "stress"), cell(curve, row, "porosity"), cell(curve, row, "lateral_strain"),
      elastic > 0 ? fmt::format("{:.2g} %", 100 * cell(curve, row, "kinetic_energy") / elastic) : "-");
  }
  text += fmt::format(
    "\n  from strain {:.3g} on kinetic energy at most {:.2g} % of the elastic (strain {:.3g}), stress on the "
    "sides {:.2g} %,\n  difference of the platens' {:.2g} %; before it kinetic energy up to {:.2g} % (strain "
    "{:.2g})\n",
    f("calm_from"), 100 * f("worst_energy_ratio"), f("worst_energy_ratio_strain"), 100 * f("worst_lateral"),
    100 * f("worst_imbalance"), 100 * f("early_energy_ratio"), f("early_energy_ratio_strain"));
  text += fmt::format("  {} steps, slowed down {} times: {:.1f} million points a second (run: {:.2f} s, everything: "
                      "{:.2f} s, {})\n",
    grouped(f.whole("steps")), grouped(f.whole("slowdowns")), f("updates_per_second") / 1e6, f("seconds", 1),
    report.run.seconds, bytesText(static_cast<double>(peakMemoryBytes())));
  text += checkpointsText(f, "steps");
  text += "  Strain: of the height between the platens; stress: force on the platens over the section at the start,\n"
          "  voids included; both are positive in compression.\n";
  return text + wroteText(report.run.written);
}

std::string pointStiffnessJson(const BondRun& run)
{
  const BondFields f(run);
  Json json;
  json["constants"] = Json::object();
  const std::vector<std::string> names = fieldTexts(run.image, "constant_names");
  for (std::size_t i = 0; i < names.size(); ++i)
    json["constants"][names[i]] = jsonNumber(f("constants", i));
  json["components"] = fieldTexts(run.image, "stiffness_components");
  json["stiffness"] = rowsOf(f.numbers("stiffness"), json["components"].size());
  json["sides"] = f.text("sides");
  json["sides_note"] = sidesNote(f);
  addPoints(json, f);
  addKeys(json, f,
    { { "grid_nodes", Key::Kind::Whole, "nodes" }, { "iterations", Key::Kind::Whole }, { "residual" },
      { "setup_seconds", Key::Kind::Number, "seconds", 0 }, { "solve_seconds", Key::Kind::Number, "seconds", 1 } });
  json["seconds"] = run.seconds;
  addRun(json, run);
  return dump(json);
}

std::string pointStiffnessTable(const BondRun& run)
{
  const BondFields f(run);
  const std::string note = sidesNote(f);
  std::string text =
    headText(run, f) + fmt::format("\n  sides {}{}\n", f.text("sides"), note.empty() ? "" : ": " + note);
  const std::vector<std::string> names = fieldTexts(run.image, "constant_names");
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    const double value = f("constants", i);
    text += fmt::format("    {:<6}  {}\n", names[i],
      names[i].starts_with("nu") ? std::isfinite(value) ? fmt::format("{:.5g}", value) : "-" : pascal(value));
  }
  text +=
    fmt::format("\n  {} nodes of the grid, {} iterations, residual {:.2g} (set-up {:.2f} s, solve {:.2f} s, everything "
                "{:.2f} s, {})\n",
      grouped(f.whole("nodes")), grouped(f.whole("iterations")), f("residual"), f("seconds", 0), f("seconds", 1),
      run.seconds, bytesText(static_cast<double>(peakMemoryBytes())));
  return text + wroteText(run.written);
}

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
BondRun runOf(Session& session, const CompressionOptions& o, const ImageSample& sample, vtkPointAlgorithm* filter,
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

/// An image of phases, with the directions along the walls where its file has them.
ImageSample loadPoints(Session& session, const PictureOptions& picture, const SettingOptions& settings)
{
  ImageSample sample = loadImage(session, picture, settings);
  const bool directed = sample.image->GetPointData()->HasArray("axis") != 0;
  for (const char* const word : { "transverse", "transverse-poisson", "shear" })
  {
    if (settings.given(word) && !settings.given("law") && !directed)
    {
      throw ParameterError(
        fmt::format("--{} of walls that have no direction: '{}' has no array 'axis'", word, picture.file),
        "leave it out, for isotropic walls have one modulus; lamella micrograph writes directions along the walls");
    }
  }
  return sample;
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
  ImageSample sample;
  session.onRoot(
    [&]
    {
      checkCheckpoint(o.checkpoint, o.common.overwrite);
      states = StateWriter(o.output, 1 + o.settings.count("at-strain"), o.common.overwrite, ".vtp",
        { "points", "the curve goes to --curve FILE.csv" });
      curve.addTable("--curve", o.curve, filter->GetCurve(), o.common.overwrite);
      sample = loadPoints(session, o.picture, o.settings);
      if (!o.checkpoint.file.empty())
        states.follow(session, io::toJson(recordRun(session, commandLine, o.picture.file, sample.provenance)));
    });
  session.broadcast(sample.extent);
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
      runFilterOnRanks(session, filter.GetPointer(), piece, sample.extent, "compression");
      session.onRoot(finish);
    });
}

/// Says what a stiffness will take, where that is much. @param plan as of PLAN_EVENT
void tellPlan(Session& session, const double* plan)
{
  constexpr double much = 20; // seconds
  if (plan[3] > much)
  {
    const auto seconds = [](double s) { return s < 10 ? fmt::format("{:.1f}", s) : fmt::format("{:.0f}", s); };
    session.note(fmt::format("the stiffness of {} nodes takes about {} of memory and {} to {} s of processor "
                             "time, the longer the thinner the walls",
      grouped(static_cast<std::int64_t>(plan[0])), bytesText(plan[1]), seconds(plan[2]), seconds(plan[3])));
  }
}

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
  const ImageSample sample = loadPoints(session, o.picture, o.settings);
  filter->SetInputData(sample.image);
  const Observer plan(filter, vtkPointStiffness::PLAN_EVENT,
    [&](void* numbers) { tellPlan(session, static_cast<const double*>(numbers)); });
  runFilter(session, filter, "stiffness");
  BondRun run = runOf(session, o, sample, filter, filter->GetConstants(), commandLine);
  run.written = files.write(io::toJson(run.provenance));
  run.seconds = secondsSince(start);
  session.print(o.common.json ? pointStiffnessJson(run) : o.common.quiet ? "" : pointStiffnessTable(run));
}

void addFileOptions(CLI::App& app, CompressionOptions& o)
{
  addOutputOptions(app, o.output, o.common, "Write the points with their displacements at the end as .vtp");
  addResultFile(app, "--curve", o.curve, "Write the stress-strain curve");
  addResultFile(
    app, "--constants", o.constants, "Of --stiffness-only: write moduli and Poisson's ratios, one row each");
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
  return jointCommand(app, o,
    [](Session& session, const CompressionOptions& options, const std::string& line)
    { options.stiffnessOnly ? stiffness(session, options, line) : press(session, options, line); });
}

} // namespace lamella::cli
