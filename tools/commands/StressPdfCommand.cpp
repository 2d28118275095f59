#include "commands/FilterRun.h"
#include "files/GridFile.h"
#include "files/JsonReport.h"
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
  const auto number = [&](const char* name) { return jsonNumber(fieldNumbers(density, name).at(0)); };
  const auto whole = [&](const char* name) { return Json(std::llround(fieldNumbers(density, name).at(0))); };
  Json json;
  json["file"] = o.file;
  json["array"] = o.array;
  json["component"] = fieldText(density, "stress_component").value_or("");
  json["count"] = whole("stress_count");
  json["mean"] = number("stress_mean");
  json["deviation"] = number("stress_deviation");
  json["mean_tensile"] = number("stress_mean_tensile");
  json["mean_compressive"] = number("stress_mean_compressive");
  json["tensile_share"] = number("stress_tensile_share");
  json["compressive_share"] = number("stress_compressive_share");
  json["smallest"] = number("stress_smallest");
  json["largest"] = number("stress_largest");
  json["reference"] = filter->GetReferenceStress() == 0 ? Json(nullptr) : number("stress_reference");
  json["tail"] = { { "threshold", number("stress_tail_threshold") }, { "count", whole("stress_tail_count") },
    { "share", number("stress_tail_share") }, { "theta", number("stress_theta") },
    { "theta_error", number("stress_theta_error") }, { "distance", number("stress_tail_distance") } };
  json["phases"] = jsonRows(filter->GetPhaseTable());
  json["thresholds"] = jsonRows(filter->GetThresholdTable());
  json["bins"] = density->GetNumberOfRows();
  json["bin_width"] = filter->GetBinWidth();
  return json;
}

std::string cell(const Json& value, const char* form)
{
  return value.is_null() ? std::string("-") : fmt::format(fmt::runtime(form), value.get<double>());
}

std::string stressTable(const Json& json)
{
  std::string text = fmt::format("{}: {} of {}, {} values\n\n", json["file"].get<std::string>(),
    json["component"].get<std::string>(), json["array"].get<std::string>(), grouped(json["count"].get<std::int64_t>()));
  text += fmt::format("  {:<12}{:>12}{:>14}{:>9}{:>14}{:>9}{:>16}\n", "phase", "values", "mean tensile", "share",
    "compressive", "share", "theta");
  for (const Json& row : json["phases"])
  {
    const std::string theta = row["theta"].is_null()
      ? std::string("-")
      : fmt::format("{:.3f} ± {:.3f}", row["theta"].get<double>(), row["theta_error"].get<double>());
    text += fmt::format("  {:<12}{:>12}{:>14}{:>9}{:>14}{:>9}{:>17}\n", row["phase"].get<std::string>(),
      grouped(row["count"].get<std::int64_t>()), cell(row["mean_tensile"], "{:.4g} Pa"),
      cell(row["tensile_share"], "{:.4f}"), cell(row["mean_compressive"], "{:.4g} Pa"),
      cell(row["compressive_share"], "{:.4f}"), theta);
  }
  if (!json["reference"].is_null())
  {
    const double reference = json["reference"].get<double>();
    text += fmt::format("\n  over the reference stress of {:.4g} Pa: mean tensile {:.4f}, mean compressive {:.4f}\n",
      reference, json["mean_tensile"].get<double>() / reference, json["mean_compressive"].get<double>() / reference);
  }
  const Json& tail = json["tail"];
  text += fmt::format("\n  tail: beyond {} mean tensile stresses, {} values, distance from the law {}\n",
    cell(tail["threshold"], "{:.4g}"), grouped(tail["count"].get<std::int64_t>()), cell(tail["distance"], "{:.4f}"));
  text += "  beyond other thresholds:\n";
  for (const Json& row : json["thresholds"])
  {
    text += fmt::format("    {:>7.3f}  {:>6.1f} % of the tensile   theta {:.3f} ± {:.3f}   distance {}\n",
      row["threshold"].get<double>(), 100 * row["tail_share"].get<double>(), row["theta"].get<double>(),
      row["theta_error"].get<double>(), cell(row["distance"], "{:.4f}"));
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
  const auto what = [](CLI::Option* option) { return option->group("Stresses"); };
  what(app->add_option("--array", o->array, "The stresses: 6 or 9 components, or 1, which is taken as it is"))
    ->type_name("NAME")
    ->capture_default_str();
  what(app->add_option("--phase-array", o->phaseArray, "The phases: whole numbers"))
    ->type_name("NAME")
    ->capture_default_str();
  o->settings.declare(*app, "vtkStressPDF");
  app->add_option("--threads", o->threads, "Threads")
    ->type_name("NUMBER")
    ->capture_default_str()
    ->group("Tail and density");
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
