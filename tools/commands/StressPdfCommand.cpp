#include "commands/FilterRun.h"
#include "files/FieldReport.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "files/TableText.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "io/Provenance.h"
#include "vtkLatticeConversion.h"
#include "vtkStressPDF.h"

#include <vtkCellData.h>
#include <vtkDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSMPTools.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <memory>

namespace lamella::cli
{

namespace
{

struct StressPdfOptions
{
  CommonOptions common;
  std::string file;
  std::string array = "stress";
  std::string phaseArray = "phase";
  SettingOptions settings;
  int threads = 1;
  std::string output;
  std::string phases;
  std::string thresholds;
};

ResultFiles openFiles(const StressPdfOptions& o, vtkStressPDF* filter)
{
  ResultFiles files;
  files.addTable("-o", o.output, filter->GetOutput(), o.common.overwrite);
  files.addTable("--phases", o.phases, filter->GetPhaseTable(), o.common.overwrite);
  files.addTable("--thresholds", o.thresholds, filter->GetThresholdTable(), o.common.overwrite);
  return files;
}

/// Where an array of this name is; at points if it is nowhere, so that the filter tells what there is.
int associationOf(vtkDataSet* data, const std::string& name)
{
  return data->GetPointData()->GetArray(name.c_str()) == nullptr &&
      data->GetCellData()->GetArray(name.c_str()) != nullptr
    ? vtkDataObject::FIELD_ASSOCIATION_CELLS
    : vtkDataObject::FIELD_ASSOCIATION_POINTS;
}

Json reportOf(const StressPdfOptions& o, vtkStressPDF* filter)
{
  vtkTable* const density = filter->GetOutput();
  Json json;
  json["file"] = o.file;
  json["array"] = o.array;
  using enum Key::Kind;
  addKeys(json, { density },
    { { "component", Text }, { "count", Whole }, { "mean" }, { "deviation" }, { "mean_tensile" },
      { "mean_compressive" }, { "tensile_share" }, { "compressive_share" }, { "smallest" }, { "largest" },
      { "reference" } },
    "stress_");
  if (filter->GetReferenceStress() == 0)
    json["reference"] = nullptr;
  json["tail"] = keysOf({ density },
    { { "threshold", Number, "tail_threshold" }, { "count", Whole, "tail_count" }, { "share", Number, "tail_share" },
      { "theta" }, { "theta_error" }, { "distance", Number, "tail_distance" } },
    "stress_");
  json["phases"] = jsonRows(filter->GetPhaseTable());
  json["thresholds"] = jsonRows(filter->GetThresholdTable());
  json["bins"] = density->GetNumberOfRows();
  json["bin_width"] = filter->GetBinWidth();
  return json;
}

std::string stressTable(const Json& json)
{
  std::string text = fmt::format("{}: {} of {}, {} values\n\n", json["file"].get<std::string>(),
    json["component"].get<std::string>(), json["array"].get<std::string>(), counted(json["count"]));
  text += fmt::format("  {:<12}{:>12}{:>14}{:>9}{:>14}{:>9}{:>16}\n", "phase", "values", "mean tensile", "share",
    "compressive", "share", "theta");
  for (const Json& row : json["phases"])
  {
    const std::string theta = row["theta"].is_null()
      ? std::string("-")
      : fmt::format("{:.3f} ± {:.3f}", row["theta"].get<double>(), row["theta_error"].get<double>());
    text += fmt::format("  {:<12}{:>12}{:>14}{:>9}{:>14}{:>9}{:>17}\n", row["phase"].get<std::string>(),
      counted(row["count"]), shown(row["mean_tensile"], "{:.4g} Pa"), shown(row["tensile_share"], "{:.4f}"),
      shown(row["mean_compressive"], "{:.4g} Pa"), shown(row["compressive_share"], "{:.4f}"), theta);
  }
  if (!json["reference"].is_null())
  {
    const double reference = json["reference"].get<double>();
    text += fmt::format("\n  over the reference stress of {:.4g} Pa: mean tensile {:.4f}, mean compressive {:.4f}\n",
      reference, json["mean_tensile"].get<double>() / reference, json["mean_compressive"].get<double>() / reference);
  }
  const Json& tail = json["tail"];
  text += fmt::format("\n  tail: beyond {} mean tensile stresses, {} values, distance from the law {}\n",
    shown(tail["threshold"], "{:.4g}"), counted(tail["count"]), shown(tail["distance"], "{:.4f}"));
  text += "  beyond other thresholds:\n";
  for (const Json& row : json["thresholds"])
  {
    text += fmt::format("    {:>7.3f}  {:>6.1f} % of the tensile   theta {:.3f} ± {:.3f}   distance {}\n",
      row["threshold"].get<double>(), 100 * row["tail_share"].get<double>(), row["theta"].get<double>(),
      row["theta_error"].get<double>(), shown(row["distance"], "{:.4f}"));
  }
  text += wroteText(json["files"].get<std::vector<std::string>>());
  return text;
}

void stressPdf(Session& session, const StressPdfOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkStressPDF> filter;
  o.settings.give(filter);
  checkThreads(o.threads);
  requireFile(o.file);
  ResultFiles files = openFiles(o, filter);
  const auto data = readGrid(o.file);
  auto* const grid = vtkDataSet::SafeDownCast(data);
  if (grid == nullptr)
    throw InputError("'" + o.file + "' holds no grid", "give a .vti or .vtp file with stresses");
  const int association = associationOf(grid, o.array);
  filter->SetInputDataObject(data);
  filter->SetInputArrayToProcess(0, 0, 0, association, o.array.c_str());
  filter->SetInputArrayToProcess(1, 0, 0, association, o.phaseArray.c_str());
  vtkSMPTools::Initialize(o.threads);
  if (o.threads > 1)
    vtkSMPTools::SetBackend("STDThread");
  runFilter(session, filter, "stresses");
  tellWarnings(session);
  Json json = reportOf(o, filter);
  if (json["tail"]["theta"].is_null())
    session.warn("fewer than two stresses are in the tail: theta is not known");

  const io::Provenance run = recordRun(session, commandLine, o.file, provenance(data));
  json["files"] = files.write(io::toJson(run));
  json["seconds"] = secondsSince(start);
  printReport(session, o.common, json, run, stressTable);
}

} // namespace

Command stressPdfCommand(CLI::App& root)
{
  CLI::App* app =
    root.add_subcommand("stress-pdf", "How stresses are distributed: density, means and exponential tail, by phase");
  auto o = std::make_shared<StressPdfOptions>();
  app->add_option("FILE", o->file, "A .vti or .vtp with stresses, such as lamella equilibrium writes")->required();
  addOption(
    *app, "Stresses", "--array", o->array, "The stresses: 6 or 9 components, or 1, which is taken as it is", "NAME")
    ->capture_default_str();
  addOption(*app, "Stresses", "--phase-array", o->phaseArray, "The phases: whole numbers", "NAME")
    ->capture_default_str();
  o->settings.declare(*app, "vtkStressPDF");
  addOption(*app, "Tail and density", "--threads", o->threads, "Threads", "NUMBER")->capture_default_str();
  addResultFile(*app, "-o,--output,--csv", o->output, "Write the density, one row a bin");
  addResultFile(*app, "--phases", o->phases, "Write the means and the tail, one row a phase");
  addResultFile(*app, "--thresholds", o->thresholds, "Write theta against the threshold");
  addResultOptions(*app, o->common);
  addExamples(*app,
    { "lamella stress-pdf loaded.vti --json", "lamella stress-pdf loaded.vti --component von-mises --phase matrix",
      "lamella stress-pdf loaded.vti --threshold 2 --reference 1.7e6 -o pdf.csv --phases means.csv" });
  return aloneCommand(app, o, stressPdf);
}

} // namespace lamella::cli
