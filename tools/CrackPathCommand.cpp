#include "Commands.h"
#include "CrackReport.h"
#include "FilterRun.h"
#include "GridFile.h"
#include "OutputFile.h"
#include "Record.h"
#include "TableFiles.h"

#include "io/Provenance.h"
#include "vtkCrackPath.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <memory>

namespace lamella::cli
{

namespace
{

struct CrackPathOptions
{
  CommonOptions common;
  std::string file;
  std::string phases;
  std::string phaseArray = "phase";
  double minimumLength = -1;
  double spurLength = -1;
  double horizon = 0;
  std::string output;
  std::string image;
  std::string table;
  std::string pairs;
  std::string growth;
  std::string fragments;
};

/// What can be said without the files, handed to the filter. @throws ParameterError
void configure(vtkCrackPath* filter, const CrackPathOptions& o)
{
  for (const auto& [option, length] :
    { std::pair{ "--minimum-length", o.minimumLength }, std::pair{ "--spur-length", o.spurLength } })
  {
    if (!std::isfinite(length) || (length < 0 && length != -1))
    {
      throw ParameterError(
        fmt::format("{} {} is not a length", option, length), "give it in spacings, 0 or more, or leave it out");
    }
  }
  if (o.horizon != 0 && !(o.horizon >= 1 && o.horizon <= 8))
  {
    throw ParameterError(
      fmt::format("--horizon {} is outside 1 to 8", o.horizon), "give it in spacings; leave it out for the bonds' own");
  }
  for (const auto& [option, name] : { std::pair{ "--fragments", o.fragments }, std::pair{ "--image", o.image } })
  {
    if (!name.empty() && o.phases.empty())
    {
      throw ParameterError(std::string(option) + " needs the image of phases", "give it with --phases IMAGE.vti");
    }
  }
  filter->SetMinimumLength(o.minimumLength);
  filter->SetSpurLength(o.spurLength);
  filter->SetHorizon(o.horizon);
}

struct Files
{
  std::vector<std::pair<OutputFile, int>> grids; ///< and the output of the filter
  TableFiles tables;
};

Files openFiles(const CrackPathOptions& o, vtkCrackPath* filter)
{
  Files files;
  const bool overwrite = o.common.overwrite;
  if (!o.output.empty())
  {
    files.grids.emplace_back(openGrid("-o", o.output, ".vtp", overwrite), 0);
  }
  if (!o.image.empty())
  {
    files.grids.emplace_back(openGrid("--image", o.image, ".vti", overwrite), 4);
  }
  files.tables.add("--table", o.table, filter->GetPathTable(), overwrite);
  files.tables.add("--pairs", o.pairs, filter->GetPairTable(), overwrite);
  files.tables.add("--growth", o.growth, filter->GetGrowthTable(), overwrite);
  files.tables.add("--fragments", o.fragments, filter->GetFragmentTable(), overwrite);
  return files;
}

void crackPath(Session& session, const CrackPathOptions& o, const std::string& commandLine)
{
  const auto start = std::chrono::steady_clock::now();
  vtkNew<vtkCrackPath> filter;
  configure(filter, o);
  requireFile(o.file);
  if (!o.phases.empty())
  {
    requireFile(o.phases);
  }
  Files files = openFiles(o, filter);
  const auto bonds =
    readAs<vtkPolyData>(o.file, "broken bonds", "give the broken bonds that lamella fracture writes (.vtp)");
  filter->SetInputDataObject(0, bonds);
  if (!o.phases.empty())
  {
    const auto image = readAs<vtkImageData>(o.phases, "image", "give the image that was broken (.vti)");
    filter->SetImageData(image);
    filter->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, o.phaseArray.c_str());
  }
  runFilter(session, filter, "cracks");
  if (fieldNumbers(filter->GetOutput(), "broken_bonds").empty())
  {
    throwVtkErrors("");
  }
  tellWarnings(session);
  Json json = reportOf({ o.file, o.phases, filter });
  if (json["broken_bonds"] == 0)
  {
    session.warn("'" + o.file + "' holds no broken bond: there is no crack");
  }
  const io::Provenance run = recordRun(commandLine, o.file, provenance(bonds));
  const std::string record = io::toJson(run);
  json["files"] = Json::array();
  for (const auto& [file, port] : files.grids)
  {
    vtkDataObject* const data = filter->GetOutputDataObject(port);
    setProvenance(data, record);
    writeGrid(data, file);
    json["files"].push_back(file.path().string());
  }
  for (const std::string& name : files.tables.write(Json::parse(record)))
  {
    json["files"].push_back(name);
  }
  for (auto& [file, port] : files.grids)
  {
    file.commit();
  }
  json["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  addRecord(json, run);
  session.print(o.common.json ? dump(json) : o.common.quiet ? "" : tableOf(json));
}

} // namespace

Command crackPathCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "crack-path", "Cracks from broken bonds: lines, length, tortuosity, direction, phases along them, fragments");
  auto o = std::make_shared<CrackPathOptions>();
  app->add_option("FILE", o->file, "Broken bonds, a .vtp that lamella fracture writes")->required();
  const auto cracks = [](CLI::Option* option) { return option->group("Cracks"); };
  cracks(app->add_option("--phases", o->phases, "The image of phases: tells voids, and finds fragments"))
    ->type_name("FILE.vti");
  cracks(app->add_option("--phase-array", o->phaseArray, "The image's array of phases: whole numbers"))
    ->type_name("NAME")
    ->capture_default_str();
  cracks(app->add_option("--minimum-length", o->minimumLength,
           "Leave out shorter cracks, unless they part a wall; the horizon when not given"))
    ->type_name("SPACINGS");
  cracks(app->add_option("--spur-length", o->spurLength,
           "Take away branches that end after no more; twice the horizon when not given"))
    ->type_name("SPACINGS");
  cracks(app->add_option("--horizon", o->horizon, "Length of the longest bonds; as the bonds tell when not given"))
    ->type_name("SPACINGS");
  const auto file = [&](const char* names, std::string& target, const char* words, const char* type = "FILE.csv")
  { app->add_option(names, target, words)->type_name(type)->group("Output"); };
  file("-o,--output", o->output, "Write the paths", "FILE.vtp");
  file("--table", o->table, "Write one row a path");
  file("--pairs", o->pairs, "Write one row a pair of phases");
  file("--growth", o->growth, "Write the length after every event");
  file("--fragments", o->fragments, "Write one row a fragment");
  file("--image", o->image, "Write the image with its fragments", "FILE.vti");
  app->add_flag("--overwrite", o->common.overwrite, "Replace a file that exists")->group("Output");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella crack-path broken.vtp --json",
      "lamella crack-path broken.vtp --phases sample.vti -o path.vtp --table path.csv",
      "lamella crack-path broken.vtp --phases state.vti --image pieces.vti --fragments pieces.csv" });
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      session.onRoot([&] { crackPath(session, *o, line); });
    } };
}

} // namespace lamella::cli
