#include "convert/Conversion.h"
#include "files/Input.h"
#include "files/JsonReport.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"

#include "core/Error.h"
#include "vtkFileConverter.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <vtkNew.h>

#include <array>
#include <memory>

namespace lamella::cli
{

namespace
{

struct ConvertOptions
{
  CommonOptions common;
  std::string file;
  std::string output;
  SettingOptions settings; ///< of vtkFileConverter
  bool formats = false;
};

std::string reportText(const Json& json)
{
  std::string what = json["kind"].get<std::string>();
  if (json.contains("size"))
  {
    const auto size = json["size"].get<std::array<std::int64_t, 3>>();
    what += " of " + sizeText(size, size[2] > 1 ? 3 : 2);
  }
  else if (json.contains("points"))
  {
    what += fmt::format(" of {} points and {} cells", grouped(json["points"].get<std::int64_t>()),
      grouped(json["cells"].get<std::int64_t>()));
  }
  std::string arrays;
  for (const Json& array : json["arrays"])
  {
    const int components = array["components"].get<int>();
    arrays += fmt::format("{}{} ({}{})", arrays.empty() ? "; " : ", ", array["name"].get<std::string>(),
      components > 1 ? fmt::format("{} × ", components) : "", array["type"].get<std::string>());
  }
  if (const auto surface = json.find("surface"); surface != json.end())
  {
    arrays += fmt::format("; closed surface of {}: area {:.6g} m², volume {:.6g} m³",
      quotedList((*surface)["phases"].get<std::vector<std::string>>(), "and"), (*surface)["area"].get<double>(),
      (*surface)["volume"].get<double>());
  }
  const auto steps = json["steps"].get<std::int64_t>();
  auto files = json["files"].get<std::vector<std::string>>();
  constexpr std::size_t most = 6;
  if (files.size() > most) // slices of a volume, steps of a series
  {
    const std::size_t left = files.size() - 3;
    files = { files[0], files[1], fmt::format("... ({} more)", left), files.back() };
  }
  return fmt::format("{}: {}{}{}\n", json["file"].get<std::string>(), what,
           steps > 1 ? fmt::format(", {} steps", steps) : "", arrays) +
    wroteText(files);
}

void runConvert(Session& session, const ConvertOptions& o, const std::string& commandLine)
{
  H5dont_atexit(); // it would try once more to fill a disk that is full, and crash
  if (o.formats)
  {
    session.print(formatsText());
    return;
  }
  if (o.file.empty() || o.output.empty())
  {
    throw ParameterError(o.file.empty() ? "FILE is missing" : "-o is missing",
      o.file.empty() ? "see lamella convert --help" : "add -o FILE; see lamella convert --help");
  }
  vtkNew<vtkFileConverter> converter;
  o.settings.give(converter);
  converter->SetFileName(o.file);
  converter->SetOutputFileName(o.output);
  converter->SetOverwrite(o.common.overwrite);
  if (o.settings.given("range") && !converter->GetWords().range)
    throw ParameterError("range 0 to 0 is empty", "give the lower end first");
  const Converted done = convert(session, converter->GetWords(), commandLine);
  printReport(session, o.common, done.report, done.run, reportText);
}

} // namespace

Command convertCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "convert", "From any format to any other: pictures, stacks, raw volumes, VTK, VTKHDF, tables, series");
  auto o = std::make_shared<ConvertOptions>();
  app->add_option("FILE", o->file,
    "What to convert: a file, a folder or pattern of slices, a .pvd, or a pattern of steps such as step_*.vti");
  o->settings.declareSome(*app, "vtkFileConverter", { "array", "step", "type", "range", "lossy" }, "Values");
  o->settings.declareSome(*app, "vtkFileConverter", { "phase", "smooth" }, "Surface");
  o->settings.declareSome(*app, "vtkFileConverter", rawWords(), "Sample");
  addOutputOptions(*app, o->output, o->common,
    "File to write; its ending tells the format (.vti for a single -). A pattern such as slice_%04d.png for slices or "
    "steps");
  app->add_flag("--formats", o->formats, "List the formats and what they hold, and exit")->group("Report");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella convert stack.tif -o stack.hdf --pixel-size 0.5um",
      "lamella convert berea_400x400x400_u16.raw -o slices_%04d.png",
      "lamella convert heat_y.vti --array temperature --range 0,1 -o heat.png",
      "lamella convert tissue.vti --phase wall -o wall.stl", "lamella convert torn.pvd -o torn.xdmf",
      "lamella convert torn.pvd -o torn_%03d.hdf", "lamella convert grains.csv -o grains.vtp" });
  return aloneCommand(app, o, runConvert);
}

} // namespace lamella::cli
