#include "commands/CrackReport.h"
#include "commands/FilterRun.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"

#include "core/Clock.h"
#include "io/Provenance.h"
#include "vtkCrackPath.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkTable.h>

#include <fmt/format.h>

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
  SettingOptions settings;
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
  for (const auto& [option, name] : { std::pair{ "--fragments", o.fragments }, std::pair{ "--image", o.image } })
    if (!name.empty() && o.phases.empty())
      throw ParameterError(std::string(option) + " needs the image of phases", "give it with --phases IMAGE.vti");
  o.settings.give(filter);
}

ResultFiles openFiles(const CrackPathOptions& o, vtkCrackPath* filter)
{
  ResultFiles files;
  const bool overwrite = o.common.overwrite;
  files.addGrid("-o", o.output, ".vtp", filter->GetOutput(), overwrite);
  files.addGrid("--image", o.image, ".vti", filter->GetImage(), overwrite);
  files.addTable("--table", o.table, filter->GetPathTable(), overwrite);
  files.addTable("--pairs", o.pairs, filter->GetPairTable(), overwrite);
  files.addTable("--growth", o.growth, filter->GetGrowthTable(), overwrite);
  files.addTable("--fragments", o.fragments, filter->GetFragmentTable(), overwrite);
  return files;
}

void crackPath(Session& session, const CrackPathOptions& o, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkCrackPath> filter;
  configure(filter, o);
  requireFile(o.file);
  if (!o.phases.empty())
    requireFile(o.phases);
  ResultFiles files = openFiles(o, filter);
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
  tellWarnings(session);
  Json json = reportOf({ o.file, o.phases, filter });
  if (json["broken_bonds"] == 0)
    session.warn("'" + o.file + "' holds no broken bond: there is no crack");
  const io::Provenance run = recordRun(session, commandLine, o.file, provenance(bonds));
  json["files"] = files.write(io::toJson(run));
  json["seconds"] = secondsSince(start);
  printReport(session, o.common, json, run, tableOf);
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
  o->settings.declare(*app, "vtkCrackPath", { "fragments" });
  addResultFile(*app, "-o,--output", o->output, "Write the paths", "FILE.vtp");
  addResultFile(*app, "--table", o->table, "Write one row a path");
  addResultFile(*app, "--pairs", o->pairs, "Write one row a pair of phases");
  addResultFile(*app, "--growth", o->growth, "Write the length after every event");
  addResultFile(*app, "--fragments", o->fragments, "Write one row a fragment");
  addResultFile(*app, "--image", o->image, "Write the image with its fragments", "FILE.vti");
  addResultOptions(*app, o->common);
  addExamples(*app,
    { "lamella crack-path broken.vtp --json",
      "lamella crack-path broken.vtp --phases sample.vti -o path.vtp --table path.csv",
      "lamella crack-path broken.vtp --phases state.vti --image pieces.vti --fragments pieces.csv" });
  return aloneCommand(app, o, crackPath);
}

} // namespace lamella::cli
