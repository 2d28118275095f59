#include "commands/DiffusionReport.h"
#include "commands/FilterRun.h"
#include "files/FieldReport.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "io/Provenance.h"
#include "vtkFluxMap.h"
#include "vtkLatticeConversion.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <fmt/format.h>

#include <cmath>
#include <memory>

namespace lamella::cli
{

namespace
{

struct FluxMapOptions
{
  CommonOptions common;
  std::string file;
  std::vector<std::string> output;
  std::string lines;
  SettingOptions settings;
};

/// {"x": ..., "y": ...} of the entries that are known.
Json byAxis(const std::vector<double>& numbers, std::size_t first, std::size_t step)
{
  Json json = Json::object();
  for (std::size_t axis = 0; axis < 3 && first + axis * step < numbers.size(); ++axis)
    if (const double value = numbers[first + axis * step]; std::isfinite(value))
      json[axisNames[axis]] = value;
  return json;
}

/// A number for people; "-" where it is not known, or no number any more.
std::string numberText(const Json& value, int digits = 6)
{
  return value.is_number() ? fmt::format("{:.{}g}", value.get<double>(), digits) : "-";
}

std::string fluxTable(const Json& json)
{
  std::string text = json["file"].get<std::string>() + "\n\n";
  text += "  direction  effective from flux  tortuosity  tortuosity factor  of the streamlines\n";
  for (const auto& [axis, value] : json["tortuosity"].items())
  {
    const auto cell = [&, key = axis](const char* name, int digits = 6)
    { return numberText(json[name].value(key, Json(nullptr)), digits); };
    text += fmt::format("  {:<9}  {:<19}  {:<10}  {:<17}  {}\n", axis, cell("effective", 7), numberText(value),
      cell("tortuosity_factor"), cell("streamline_tortuosity"));
  }
  if (!json["flux_magnitude"].is_null())
  {
    text += fmt::format("\n  |flux| along {}: {} to {}, mean {}\n", json["direction"].get<std::string>(),
      numberText(json["flux_magnitude"]["smallest"]), numberText(json["flux_magnitude"]["largest"]),
      numberText(json["flux_magnitude"]["mean"]));
  }
  text += fmt::format("  {} streamlines\n", json["streamlines"].get<std::int64_t>());
  text += wroteText(json["files"].get<std::vector<std::string>>());
  return text;
}

/// Is there anything that lamella diffusion, or another solver that calls it so, computed? A name may end in _x, _y,
/// _z.
bool holdsSolution(vtkImageData* image)
{
  const auto hasArray = [](vtkFieldData* data)
  {
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      const std::string name = data->GetArrayName(i) == nullptr ? "" : data->GetArrayName(i);
      for (const char* quantity : { "temperature", "concentration", "flux" })
        if (name.rfind(quantity, 0) == 0)
          return true;
    }
    return false;
  };
  return hasArray(image->GetPointData()) || hasArray(image->GetCellData()); // the filter says what is wrong with cells
}

void fluxMap(Session& session, const FluxMapOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkFluxMap> filter;
  options.settings.give(filter);
  requireFile(options.file);
  ResultFiles files;
  for (const std::string& name : options.output)
  {
    const std::string ending = std::filesystem::path(name).extension().string();
    if (ending != ".vti" && ending != ".vtp")
    {
      throw ParameterError("-o '" + name + "': the map is written as .vti, its streamlines as .vtp",
        "end the name in one of these; -o can be given twice");
    }
    files.addGrid("-o", name, ending, filter->GetOutputDataObject(ending == ".vti" ? 0 : 1), options.common.overwrite);
  }
  files.addGrid("--lines", options.lines, ".vtp", filter->GetOutputDataObject(1), options.common.overwrite);

  const auto data = readGrid(options.file);
  auto* const image = vtkImageData::SafeDownCast(data);
  if (image == nullptr)
    throw InputError("'" + options.file + "' holds no image", "give a .vti file that lamella diffusion wrote");
  if (!holdsSolution(image))
  {
    throw InputError(
      "'" + options.file + "' holds a sample and no solution: neither temperature, concentration nor flux",
      "solve first: lamella diffusion " + options.file + " --conductivity NAME=VALUE ... -o FILE.vti");
  }
  filter->SetInputDataObject(data);
  runFilter(session, filter, "flux map");
  auto* map = vtkImageData::SafeDownCast(filter->GetOutputDataObject(0));
  auto* streamlines = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(1));
  auto* magnitude = map->GetPointData()->GetArray("flux_magnitude");
  tellWarnings(session);

  const io::Provenance run = recordRun(session, commandLine, options.file, provenance(data));
  const std::vector<std::string> written = files.write(io::toJson(run));

  Json json;
  json["file"] = options.file;
  json["effective"] = byAxis(fieldNumbers(map, "effective_from_flux"), 0, 4);
  addKeys(json, { map, latticeOf(map).dimension },
    { { "tensor", Key::Kind::Matrix, "effective_from_flux" }, { "mean_flux", Key::Kind::Matrix } });
  json["tortuosity"] = byAxis(fieldNumbers(map, "tortuosity"), 0, 1);
  json["tortuosity_factor"] = byAxis(fieldNumbers(map, "tortuosity_factor"), 0, 1);
  json["streamline_tortuosity"] = byAxis(fieldNumbers(map, "streamline_tortuosity"), 0, 1);
  const int direction = filter->GetDirection();
  json["direction"] = direction != vtkFluxMap::AUTO ? std::string(axisNames[static_cast<std::size_t>(direction)])
    : json["tortuosity"].empty()                    ? "auto"
                                                    : json["tortuosity"].begin().key();
  double range[2] = { 0, 0 };
  magnitude->GetFiniteRange(range, 0);
  double sum = 0;
  for (vtkIdType i = 0; i < magnitude->GetNumberOfTuples(); ++i)
    sum += magnitude->GetTuple1(i);
  json["flux_magnitude"] = { { "smallest", jsonNumber(range[0]) }, { "largest", jsonNumber(range[1]) },
    { "mean", jsonNumber(sum / static_cast<double>(magnitude->GetNumberOfTuples())) } };
  json["streamlines"] = streamlines == nullptr ? 0 : streamlines->GetNumberOfLines();
  const auto lineFlux = fieldNumbers(map, "line_flux");
  json["line_flux"] = lineFlux.empty() ? Json(nullptr) : jsonNumber(lineFlux.front());
  json["seconds"] = secondsSince(start);
  json["files"] = written;
  printReport(session, options.common, json, run, fluxTable);
}

} // namespace

Command fluxMapCommand(CLI::App& root)
{
  CLI::App* app =
    root.add_subcommand("flux-map", "Where the flux goes: magnitude, streamlines, tortuosity of a diffusion result");
  auto o = std::make_shared<FluxMapOptions>();
  app->add_option("FILE", o->file, "A .vti that lamella diffusion wrote")->required();
  o->settings.declare(*app, "vtkFluxMap");
  addOption(*app, "Output", "-o,--output", o->output,
    "Write the map (.vti) or the streamlines (.vtp); give it twice for both", "FILE")
    ->allow_extra_args(false);
  addResultFile(*app, "--lines", o->lines, "Write the streamlines; the same as -o FILE.vtp", "FILE.vtp");
  addResultOptions(*app, o->common);
  addExamples(*app, { "lamella flux-map heat_y.vti -o map.vti -o lines.vtp", "lamella flux-map heat_y.vti --json" });
  return aloneCommand(app, o, fluxMap);
}

} // namespace lamella::cli
