#include "commands/FilterRun.h"
#include "files/FieldReport.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "files/StateFiles.h"
#include "files/TableText.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "io/Provenance.h"
#include "vtkCollapseMap.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

struct CollapseMapOptions
{
  CommonOptions common;
  std::string image;
  std::vector<std::string> points;
  std::string strains;
  std::string phaseArray = "phase";
  SettingOptions settings;
  std::string output;
  std::string table;
  std::string states;
};

/// One a file, rising. @throws ParameterError
std::vector<double> strainsOf(const CollapseMapOptions& o)
{
  std::vector<double> strains;
  for (const std::string& text : o.strains.empty() ? std::vector<std::string>{} : split(o.strains, ','))
  {
    const std::optional<double> strain = toNumber(text);
    if (!strain || !std::isfinite(*strain) || (!strains.empty() && !(*strain > strains.back())))
    {
      throw ParameterError(
        "--strains '" + o.strains + "' are not rising numbers", "write them as --strains 0.05,0.12,0.25");
    }
    strains.push_back(*strain);
  }
  if (!strains.empty() && strains.size() != o.points.size())
  {
    throw ParameterError(
      fmt::format("--strains gives {} strains for {} files of points", strains.size(), o.points.size()),
      "give one strain a file");
  }
  return strains;
}

/// What can be said without the files, handed to the filter. @throws ParameterError
void configure(vtkCollapseMap* filter, const CollapseMapOptions& o)
{
  o.settings.give(filter);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, o.phaseArray.c_str());
}

Json reportOf(const CollapseMapOptions& o, vtkCollapseMap* filter)
{
  Json json;
  json["file"] = o.image;
  json["points"] = o.points;
  using enum Key::Kind;
  addKeys(json, { filter->GetOutput() },
    { { "phase", Text, "lumen_phase" }, { "share", Number, "collapse_share" }, { "lumens", Whole, "lumen_count" },
      { "cut", Whole, "lumen_cut" }, { "collapsed", Whole, "lumen_collapsed" }, { "first_collapse_strain" },
      { "ratio", Number, "lumen_ratio" } });
  json["states"] = jsonRows(filter->GetStateTable());
  return json;
}

std::string collapseTable(const Json& json)
{
  std::string text = fmt::format("{}: {} lumens of '{}', {} cut by the rim\n\n", json["file"].get<std::string>(),
    counted(json["lumens"]), json["phase"].get<std::string>(), counted(json["cut"]));
  text += fmt::format("  {:>8}  {:>10}  {:>9}  {:>22}\n", "strain", "collapsed", "share", "area over the start's");
  for (const Json& row : json["states"])
  {
    text += fmt::format("  {:>8.4f}  {:>10}  {:>8.2f}%  {:>22}\n", row["strain"].get<double>(),
      counted(row["collapsed"]), 100 * row["collapsed_share"].get<double>(), shown(row["ratio"], "{:.4f}"));
  }
  text += json["first_collapse_strain"].is_null()
    ? std::string("\n  none collapsed\n")
    : fmt::format("\n  the first at a strain of {:.4g}\n", json["first_collapse_strain"].get<double>());
  text += wroteText(json["files"].get<std::vector<std::string>>());
  return text;
}

void collapseMap(Session& session, const CollapseMapOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkCollapseMap> filter;
  configure(filter, o);
  const std::vector<double> strains = strainsOf(o);
  requireFile(o.image);
  for (const std::string& name : o.points)
    requireFile(name);
  ResultFiles files;
  files.addGrid("-o", o.output, ".vti", filter->GetOutput(), o.common.overwrite);
  files.addTable("--table", o.table, filter->GetLumenTable(), o.common.overwrite);
  files.addTable("--states", o.states, filter->GetStateTable(), o.common.overwrite);
  const auto image = readAs<vtkImageData>(o.image, "image", "give the image that the points were made from (.vti)");
  vtkNew<StateFiles> states;
  states->SetFiles(o.points, strains);
  filter->SetInputData(image);
  filter->SetPointsConnection(states->GetOutputPort());
  runFilter(session, filter, "collapse");
  tellWarnings(session);
  Json json = reportOf(o, filter);
  const io::Provenance run = recordRun(session, commandLine, o.image, provenance(filter->GetOutput()));
  json["files"] = files.write(io::toJson(run));
  json["seconds"] = secondsSince(start);
  printReport(session, o.common, json, run, collapseTable);
}

} // namespace

Command collapseMapCommand(CLI::App& root)
{
  CLI::App* app =
    root.add_subcommand("collapse-map", "Which cells of a tissue give way in compression, and at which strain");
  auto o = std::make_shared<CollapseMapOptions>();
  app->add_option("IMAGE", o->image, "The image of phases that the points were made from (.vti)")->required();
  app->add_option("POINTS", o->points, "Material points, a .vtp a state, in the order of their strains")->required();
  addOption(*app, "Lumens", "--strains", o->strains, "Strains of the states; as the files tell when not given", "LIST");
  addOption(*app, "Lumens", "--phase-array", o->phaseArray, "The image's array of phases: whole numbers", "NAME")
    ->capture_default_str();
  o->settings.declare(*app, "vtkCollapseMap");
  addResultFile(*app, "-o,--output", o->output, "Write the map", "FILE.vti");
  addResultFile(*app, "--table", o->table, "Write one row a lumen");
  addResultFile(*app, "--states", o->states, "Write one row a state");
  addResultOptions(*app, o->common);
  addExamples(*app,
    { "lamella collapse-map tissue.vti state_*.vtp --json",
      "lamella collapse-map tissue.vti state_*.vtp -o map.vti --table lumens.csv",
      "lamella collapse-map tissue.vti a.vtp b.vtp --strains 0.1,0.2 --share 30%" });
  return aloneCommand(app, o, collapseMap);
}

} // namespace lamella::cli
