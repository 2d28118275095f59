#include "commands/FilterRun.h"
#include "files/FieldReport.h"
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
#include "lattice/AxisNames.h"
#include "vtkCrackPath.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkTable.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
  SettingOptions settings;
  std::string output;
  std::string image;
  std::string table;
  std::string pairs;
  std::string growth;
  std::string fragments;
};

std::string micrometres(const Json& metres)
{
  return shown(metres, "{:.4g} µm", 1e6);
}

std::string line(const std::string& name, const std::string& words)
{
  return fmt::format("  {:<14}{}\n", name, words);
}

std::string axes(const Json& names)
{
  return fmt::format("{}", fmt::join(names.get<std::vector<std::string>>(), " and "));
}

std::string pathsText(const Json& json)
{
  std::string rows = fmt::format("\n  {:>5}{:>6}{:>14}{:>11}{:>10}{:>9}{:>10}  {}\n", "path", "crack", "length",
    "tortuosity", "angle", "spread", "bonds", "from, to");
  constexpr std::size_t most = 12;
  for (std::size_t i = 0; i < std::min(most, json["paths"].size()); ++i)
  {
    const Json& p = json["paths"][i];
    rows += fmt::format("  {:>5}{:>6}{:>15}{:>11}{:>11}{:>10}{:>10}  {}\n", p["path"].get<int>(), p["crack"].get<int>(),
      micrometres(p["length"]), shown(p["tortuosity"], "{:.4f}"), shown(p["angle"], "{:.1f}°"),
      shown(p["angle_spread"], "{:.1f}°"), counted(p["bonds"]),
      p["begins_at"].get<std::string>() + ", " + p["ends_at"].get<std::string>());
  }
  if (json["paths"].size() > most)
    rows += fmt::format("  and {} more\n", json["paths"].size() - most);
  return rows;
}

std::string squares(const Json& area)
{
  return shown(area, "{:.4g} mm²", 1e6);
}

std::string surfacesText(const Json& json)
{
  std::string rows = fmt::format(
    "\n  {:>5}{:>16}{:>22}{:>11}{:>13}{:>13}\n", "crack", "area", "normal", "alignment", "first event", "last event");
  constexpr std::size_t most = 12;
  for (std::size_t i = 0; i < std::min(most, json["paths"].size()); ++i)
  {
    const Json& p = json["paths"][i];
    rows += fmt::format("  {:>5}{:>17}{:>22}{:>11}{:>13}{:>13}\n", p["crack"].get<int>(), squares(p["area"]),
      fmt::format("{:.2f}, {:.2f}, {:.2f}", p["normal_x"].get<double>(), p["normal_y"].get<double>(),
        p["normal_z"].get<double>()),
      shown(p["alignment"], "{:.3f}"), counted(p["first_event"]), counted(p["last_event"]));
  }
  if (json["paths"].size() > most)
    rows += fmt::format("  and {} more\n", json["paths"].size() - most);
  return rows;
}

std::string pairsText(const Json& json)
{
  const bool space = json["dimension"] == 3;
  std::string rows =
    fmt::format("\n  {:<24}{:>14}{:>10}{:>10}\n", "between", space ? "area" : "length", "share", "bonds");
  for (const Json& p : json["pairs"])
  {
    rows += fmt::format("  {:<24}{:>{}}{:>10}{:>10}\n", p["pair"].get<std::string>(),
      space ? squares(p["area"]) : micrometres(p["length"]), 15, shown(p["share"], "{:.2f} %", 100),
      counted(p["bonds"]));
  }
  return rows;
}

Json reportOf(const CrackPathOptions& o, vtkCrackPath* filter)
{
  vtkPolyData* const paths = filter->GetOutput();
  const Fields f{ paths };
  using enum Key::Kind;
  const bool plane = !f.numbers("crack_length").empty();
  Json json;
  json["file"] = o.file;
  json["phases_file"] = o.phases.empty() ? Json(nullptr) : Json(o.phases);
  json["dimension"] = plane ? 2 : 3;
  addKeys(json, f, { { "horizon" }, { "broken_bonds", Whole } });
  if (plane)
  {
    addKeys(json, f, { { "cracks", Whole, "crack_count" }, { "length", Number, "crack_length" } });
    const auto place = [&](const char* name) { return keysOf(f, { { "x", Number, name }, { "y", Number, name, 1 } }); };
    json["main"] = { { "length", jsonNumber(f("main_length")) }, { "through", axesOf(f.numbers("main_through")) },
      { "start", place("main_start") }, { "tip", place("main_tip") },
      { "extension", jsonNumber(f("main_extension")) } };
    json["through"] = Json::object();
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      if (std::isfinite(f("through_length", axis)))
      {
        json["through"][axisNames[axis]] = keysOf(f,
          { { "length", Number, nullptr, axis }, { "in_voids", Number, nullptr, axis },
            { "in_solid", Number, nullptr, axis }, { "chord", Number, nullptr, axis },
            { "tortuosity", Number, nullptr, axis } },
          "through_");
      }
    }
    addKeys(json, f, { { "angle" }, { "angle_spread" } }, "crack_");
    json["left_out"] =
      keysOf(f, { { "cracks", Whole }, { "length" }, { "spurs", Whole }, { "bonds", Whole } }, "left_out_");
    addKeys(json, f, { { "crushed_pieces", Whole } });
  }
  else
  {
    addKeys(json, f, { { "cracks", Whole, "crack_count" }, { "area", Number, "crack_area" } });
    json["main"] = { { "area", jsonNumber(f("main_area")) } };
    json["left_out"] = keysOf(f, { { "cracks", Whole }, { "faces", Whole } }, "left_out_");
  }
  addKeys(json, f, { { plane ? "counted_length" : "counted_area", Number, "counted_size" }, { "count_anisotropy" } });
  json["normals"] = f.numbers("crack_normals");
  json["paths"] = jsonRows(filter->GetPathTable());
  json["pairs"] = jsonRows(filter->GetPairTable());
  if (!f.numbers("fragment_count").empty())
  {
    json["fragments"] =
      keysOf(f, { { "count", Whole, "fragment_count" }, { "largest_share", Number, "fragment_largest" } });
    json["fragments"]["severed"] = axesOf(f.numbers("severed"));
  }
  return json;
}

std::string tableOf(const Json& json)
{
  const bool plane = json["dimension"] == 2;
  std::string words = fmt::format("{}: {} broken bonds, horizon {:g}\n\n", json["file"].get<std::string>(),
    counted(json["broken_bonds"]), json["horizon"].get<double>());
  if (plane)
  {
    const std::string through = axes(json["main"]["through"]);
    words += line("cracks", fmt::format("{}, {} together", counted(json["cracks"]), micrometres(json["length"])));
    words += line("longest",
      micrometres(json["main"]["length"]) +
        (through.empty() ? ", ends within the sample" : ", from side to side along " + through));
    if (const Json& tip = json["main"]["tip"]; !tip["x"].is_null())
    {
      const Json& start = json["main"]["start"];
      words += line("tip",
        fmt::format("at {}, {}; {} along the crack from {}, {}", micrometres(tip["x"]), micrometres(tip["y"]),
          micrometres(json["main"]["extension"]), micrometres(start["x"]), micrometres(start["y"])));
    }
    for (const auto& [axis, way] : json["through"].items())
    {
      words += line("through",
        fmt::format("along {}: {}, of which {} across voids, {} unbroken; tortuosity {}", axis,
          micrometres(way["length"]), micrometres(way["in_voids"]), micrometres(way["in_solid"]),
          shown(way["tortuosity"], "{:.4f}")));
    }
    words +=
      line("direction", shown(json["angle"], "{:.1f}°") + " to x, spread " + shown(json["angle_spread"], "{:.1f}°"));
    words += line("counted",
      micrometres(json["counted_length"]) + " by the number of broken bonds" +
        shown(json["count_anisotropy"], " (± {:.1f} % by direction)", 100));
    const Json& left = json["left_out"];
    words += line("left out",
      fmt::format("{} cracks too short, {} spurs; {} broken bonds lie off the paths", counted(left["cracks"]),
        counted(left["spurs"]), counted(left["bonds"])));
  }
  else
  {
    words += line("cracks", fmt::format("{}, {} together", counted(json["cracks"]), squares(json["area"])));
    words += line("counted",
      squares(json["counted_area"]) + " by the number of broken bonds" +
        shown(json["count_anisotropy"], " (± {:.1f} % by direction)", 100));
    words += line("left out", fmt::format("{} cracks too small", counted(json["left_out"]["cracks"])));
  }
  if (json.contains("fragments"))
  {
    const Json& f = json["fragments"];
    const std::string severed = axes(f["severed"]);
    words += line("fragments",
      fmt::format("{}, the largest {} of the solid; {}", counted(f["count"]),
        shown(f["largest_share"], "{:.2f} %", 100),
        severed.empty() ? "some reach from side to side" : "severed along " + severed));
  }
  if (!json["paths"].empty())
    words += plane ? pathsText(json) : surfacesText(json);
  if (!json["pairs"].empty())
    words += pairsText(json);
  words += wroteText(json["files"].get<std::vector<std::string>>());
  return words;
}

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
  Json json = reportOf(o, filter);
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
  addOption(*app, "Cracks", "--phases", o->phases, "The image of phases: tells voids, and finds fragments", "FILE.vti");
  addOption(*app, "Cracks", "--phase-array", o->phaseArray, "The image's array of phases: whole numbers", "NAME")
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
