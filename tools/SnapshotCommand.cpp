#include "Commands.h"
#include "FilterRun.h"
#include "GridFile.h"
#include "Input.h"
#include "OutputFile.h"
#include "Record.h"
#include "Text.h"

#include "io/Provenance.h"
#include "vtkLatticeConversion.h"
#include "vtkOffScreenWindows.h"
#include "vtkSnapshot.h"

#include <vtkExtractVOI.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

using Json = nlohmann::ordered_json;

struct SnapshotOptions
{
  CommonOptions common;
  PictureOptions picture;
  std::string output;
  std::string preset = "auto";
  std::string array;
  std::string component = "magnitude";
  std::string range;
  std::string colorMap;
  std::vector<std::string> phaseColor;
  std::string overlay = "auto";
  bool streamlines = false;
  bool arrows = false;
  int overlayCount = 0;
  std::string lines;
  bool absoluteFlux = false;
  bool noOutline = false;
  std::string size;
  std::string background = "white";
  bool transparent = false;
  double fontScale = 1;
  std::string title;
  std::string legend;
  std::string unit;
  bool noLegend = false;
  bool noScaleBar = false;
  std::string view = "-60,30";
  double opacity = 1;
};

const std::vector<std::string> presets{ "auto", "phase", "temperature", "concentration", "flux", "grain", "pores",
  "stress", "scalar" };
const std::vector<std::string> overlays{ "auto", "none", "lines", "arrows", "isolines" };
const std::vector<std::string> components{ "magnitude", "x", "y", "z" };
const std::vector<std::string> colorMaps{ "viridis", "inferno", "magma", "cividis", "gray", "coolwarm", "blue-red" };

/// "#RRGGBB" or one of a few names. @throws ParameterError
std::array<double, 3> parseColor(const std::string& option, const std::string& text)
{
  const std::map<std::string, std::array<double, 3>> names{ { "white", { 1, 1, 1 } }, { "black", { 0, 0, 0 } },
    { "gray", { 0.5, 0.5, 0.5 } }, { "lightgray", { 0.83, 0.83, 0.83 } }, { "darkgray", { 0.25, 0.25, 0.25 } } };
  if (const auto found = names.find(text); found != names.end())
  {
    return found->second;
  }
  std::array<double, 3> color{};
  bool good =
    text.size() == 7 && text[0] == '#' && text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  for (std::size_t i = 0; good && i < 3; ++i)
  {
    color[i] = std::stoi(text.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
  }
  if (!good)
  {
    throw ParameterError(option + " '" + text + "' is not a colour",
      "write white, black, gray, lightgray, darkgray or #RRGGBB, such as '#f4ede4'");
  }
  return color;
}

/// "A,B". @throws ParameterError
std::array<double, 2> parsePair(const std::string& option, const std::string& text, const std::string& form)
{
  const auto parts = split(text, ',');
  const auto first = toNumber(parts[0]);
  const auto second = parts.size() == 2 ? toNumber(parts[1]) : std::nullopt;
  if (!first || !second || !std::isfinite(*first) || !std::isfinite(*second))
  {
    throw ParameterError(
      option + " '" + text + "' is not " + form, "write two numbers with a comma: " + option + " " + form);
  }
  return { *first, *second };
}

/// Everything but the data. @throws ParameterError
void configure(vtkSnapshot* snapshot, const SnapshotOptions& options)
{
  snapshot->SetPreset(static_cast<int>(oneOf("--preset", options.preset, presets)));
  if (!options.array.empty())
  {
    snapshot->SetArrayName(options.array.c_str());
  }
  if (const auto number = toInteger(options.component); number && *number >= 0 && *number <= 1000)
  {
    snapshot->SetComponent(static_cast<int>(*number));
  }
  else
  {
    snapshot->SetComponent(static_cast<int>(oneOf("--component", options.component, components)) - 1);
  }
  if (!options.range.empty())
  {
    const auto [low, high] = parsePair("--range", options.range, "MIN,MAX");
    if (!(low < high))
    {
      throw ParameterError("--range '" + options.range + "' does not rise", "write the smaller value first");
    }
    snapshot->SetRange(low, high);
  }
  if (!options.colorMap.empty())
  {
    snapshot->SetColorMap(colorMaps[oneOf("--color-map", options.colorMap, colorMaps)].c_str());
  }
  for (const std::string& text : listItems(options.phaseColor))
  {
    const auto [name, value] = keyValue("--phase-color", text, "NAME=COLOUR");
    const auto color = parseColor("--phase-color", value);
    snapshot->SetPhaseColor(name.c_str(), color[0], color[1], color[2]);
  }
  const int chosen = (options.overlay != "auto" ? 1 : 0) + (options.streamlines ? 1 : 0) + (options.arrows ? 1 : 0);
  if (chosen > 1)
  {
    throw ParameterError("--overlay, --streamlines and --arrows exclude each other", "give one of them");
  }
  snapshot->SetOverlay(options.streamlines ? vtkSnapshot::OVERLAY_LINES
      : options.arrows                     ? vtkSnapshot::OVERLAY_ARROWS
                                           : static_cast<int>(oneOf("--overlay", options.overlay, overlays)));
  if (options.overlayCount < 0 || options.overlayCount > 500)
  {
    throw ParameterError(fmt::format("--overlay-count {} is outside 1 to 500", options.overlayCount),
      "leave it out for as many as look well");
  }
  snapshot->SetOverlayCount(options.overlayCount);
  snapshot->SetRelativeFlux(!options.absoluteFlux);
  snapshot->SetShowOutline(!options.noOutline);
  if (!options.size.empty())
  {
    const std::size_t counts[] = { 2 };
    const auto size = integerList("--size", options.size, counts, "WIDTH,HEIGHT");
    if (std::min(size[0], size[1]) < 64 || std::max(size[0], size[1]) > 16384)
    {
      throw ParameterError(
        "--size '" + options.size + "' is outside 64 to 16384 pixels", "leave it out for a size that suits the data");
    }
    snapshot->SetSize(static_cast<int>(size[0]), static_cast<int>(size[1]));
  }
  const auto background = parseColor("--background", options.background);
  snapshot->SetBackground(background[0], background[1], background[2]);
  snapshot->SetTransparent(options.transparent);
  if (!(options.fontScale >= 0.2 && options.fontScale <= 5))
  {
    throw ParameterError(
      fmt::format("--font-scale {:g} is outside 0.2 to 5", options.fontScale), "1 is the ordinary size");
  }
  snapshot->SetFontScale(options.fontScale);
  const auto setText = [&](const std::string& text, void (vtkSnapshot::*set)(const char*))
  {
    if (!text.empty())
    {
      (snapshot->*set)(text.c_str());
    }
  };
  setText(options.title, &vtkSnapshot::SetTitle);
  setText(options.legend, &vtkSnapshot::SetLegendTitle);
  setText(options.unit, &vtkSnapshot::SetUnit);
  snapshot->SetShowLegend(!options.noLegend);
  snapshot->SetShowScaleBar(!options.noScaleBar);
  const auto [azimuth, elevation] = parsePair("--view", options.view, "AZIMUTH,ELEVATION");
  if (!(std::abs(elevation) <= 90))
  {
    throw ParameterError(fmt::format("--view '{}': an elevation is between -90 and 90 degrees", options.view),
      "0 looks from the side, 90 from above");
  }
  snapshot->SetAzimuth(azimuth);
  snapshot->SetElevation(elevation);
  if (!(options.opacity >= 0 && options.opacity <= 1))
  {
    throw ParameterError(fmt::format("--opacity {:g} is outside 0 to 1", options.opacity), "1 is opaque");
  }
  snapshot->SetOpacity(options.opacity);
}

/// A part of an image, as --window says. @throws ParameterError
vtkSmartPointer<vtkDataObject> cut(vtkDataObject* data, const std::string& window)
{
  auto* image = vtkImageData::SafeDownCast(data);
  if (image == nullptr)
  {
    throw ParameterError("--window is for images", "leave it out");
  }
  const Window part = *parseWindow(window);
  const Lattice lattice = latticeOf(image);
  requireWindowFits(lattice, part);
  const auto start = firstNode(lattice, part);
  int extent[6];
  image->GetExtent(extent);
  vtkNew<vtkExtractVOI> extract;
  int voi[6];
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::int64_t size = axis == 2 && lattice.dimension == 2 ? 1 : part.size[static_cast<std::size_t>(axis)];
    voi[2 * axis] = extent[2 * axis] + static_cast<int>(start[static_cast<std::size_t>(axis)]);
    voi[2 * axis + 1] = voi[2 * axis] + static_cast<int>(size) - 1;
  }
  extract->SetInputDataObject(image);
  extract->SetVOI(voi);
  extract->Update();
  extract->GetOutput()->GetFieldData()->ShallowCopy(image->GetFieldData());
  return extract->GetOutput();
}

vtkSmartPointer<vtkDataObject> load(Session& session, const SnapshotOptions& options)
{
  const std::string ending = std::filesystem::path(options.picture.file).extension().string();
  const bool mapped = !options.picture.phase.empty() || !options.picture.other.empty() || options.picture.segment;
  if (ending == ".vtp" || (ending == ".vti" && !mapped))
  {
    const auto data = readGrid(options.picture.file);
    return options.picture.window.empty() ? data : cut(data, options.picture.window);
  }
  Sample sample = loadSample(options.picture);
  for (const std::string& warning : sample.warnings)
  {
    session.warn(warning);
  }
  const auto image = toImageData(std::move(sample.image));
  setFieldText(image, "pixel_size_source", sample.pixelSizeSource);
  setProvenance(image, sample.provenance);
  return image;
}

void snapshot(Session& session, const SnapshotOptions& options, const std::string& commandLine)
{
  vtkNew<vtkSnapshot> drawing;
  configure(drawing, options);
  if (std::filesystem::path(options.output).extension() != ".png")
  {
    throw ParameterError("-o '" + options.output + "': pictures are written as PNG", "end the name in .png");
  }
  OutputFile file(options.output, options.common.overwrite);
  const auto data = load(session, options);
  Session::checkInterrupt();
  drawing->SetInputData(data);
  if (!options.lines.empty())
  {
    const auto lines = readGrid(options.lines);
    auto* polyData = vtkPolyData::SafeDownCast(lines);
    if (polyData == nullptr || polyData->GetNumberOfLines() == 0)
    {
      throw InputError("'" + options.lines + "' holds no lines",
        "give the .vtp that lamella flux-map wrote, or on grains that of lamella packing --contacts");
    }
    drawing->SetOverlayLines(polyData);
  }

  const io::Provenance record = recordRun(session, commandLine, options.picture.file, provenance(data));
  drawing->SetProvenance(io::toJson(record).c_str());
  drawing->SetOverwrite(true); // the temporary file; whether the name may be replaced was asked above
  const bool drawn = drawing->Write(file.temporary().c_str());
  Session::checkInterrupt();
  if (!drawn)
  {
    const InputError error(drawing->GetErrorMessage(), drawing->GetErrorHint());
    file.rethrow(error);
    throw error;
  }
  tellWarnings(session);
  file.commit();

  const double* range = drawing->GetDrawnRange();
  const int* rectangle = drawing->GetDataRectangle();
  if (options.common.json)
  {
    Json json;
    json["file"] = options.output;
    json["range"] = { range[0], range[1] };
    json["data_rectangle"] = { rectangle[0], rectangle[1], rectangle[2], rectangle[3] };
    json["backend"] = vtkOffScreenWindows::GetBackend();
    json["version"] = record.version;
    json["commit"] = record.commit;
    session.print(json.dump(2) + "\n");
  }
  else if (!options.common.quiet)
  {
    session.print("wrote " + options.output + "\n");
  }
}

} // namespace

Command snapshotCommand(CLI::App& root)
{
  CLI::App* app =
    root.add_subcommand("snapshot", "Draw a picture of a sample or a result, fit for a paper; no display is needed");
  auto o = std::make_shared<SnapshotOptions>();
  app->add_option("FILE", o->picture.file, "A .vti or .vtp that lamella wrote, or any picture or volume")->required();
  addPhaseOptions(*app, o->picture);
  addRawOptions(*app, o->picture);
  const auto in = [](const char* group) { return [group](CLI::Option* option) { return option->group(group); }; };
  const auto draw = in("Drawing");
  draw(app->add_option("--preset", o->preset,
         "Kind of field: auto, phase, temperature, concentration, flux, grain, pores, stress or scalar"))
    ->type_name("KIND")
    ->capture_default_str();
  draw(app->add_option("--array", o->array, "Array to draw, when it is not the preset's own"))->type_name("NAME");
  draw(app->add_option("--component", o->component, "Of a vector: magnitude, x, y, z or a number from 0"))
    ->type_name("WHICH")
    ->capture_default_str();
  draw(app->add_option("--range", o->range, "Values at the ends of the colours; fix it for a series"))
    ->type_name("MIN,MAX");
  draw(app->add_option("--color-map", o->colorMap, "viridis, inferno, magma, cividis, gray, coolwarm or blue-red"))
    ->type_name("NAME");
  draw(app->add_option("--phase-color", o->phaseColor, "Colour of a phase, as wall=#8c5a2b"))
    ->type_name("NAME=COLOUR")
    ->allow_extra_args(false);
  draw(app->add_option("--overlay", o->overlay, "What is drawn on top: auto, none, lines, arrows or isolines"))
    ->type_name("KIND")
    ->capture_default_str();
  draw(app->add_flag("--streamlines", o->streamlines, "The same as --overlay lines"));
  draw(app->add_flag("--arrows", o->arrows, "The same as --overlay arrows"));
  draw(app->add_option("--overlay-count", o->overlayCount, "How many lines, or arrows along the longer side, 1 to 500"))
    ->type_name("NUMBER");
  draw(app->add_option(
         "--lines", o->lines, "Draw this file: streamlines of flux-map, or on grains the contacts of packing"))
    ->type_name("FILE.vtp");
  draw(app->add_flag("--absolute-flux", o->absoluteFlux, "The flux or stress itself, not over its mean"));
  draw(app->add_flag("--no-outline", o->noOutline, "Leave out the thin line between void and solid"));
  const auto page = in("Page");
  page(app->add_option("--size", o->size, "Of the whole picture in pixels; follows from the data when not given"))
    ->type_name("WIDTH,HEIGHT");
  page(app->add_option("--background", o->background, "white, black, gray, lightgray, darkgray or #RRGGBB"))
    ->type_name("COLOUR")
    ->capture_default_str();
  page(app->add_flag("--transparent", o->transparent, "Leave the background out"));
  page(app->add_option("--font-scale", o->fontScale, "Size of all text, 0.2 to 5"))
    ->type_name("NUMBER")
    ->capture_default_str();
  page(app->add_option("--title", o->title, "A line above the data"))->type_name("TEXT");
  page(app->add_option("--legend-title", o->legend, "Name of the quantity in the legend"))->type_name("TEXT");
  page(app->add_option("--unit", o->unit, "Unit in the legend"))->type_name("TEXT");
  page(app->add_flag("--no-legend", o->noLegend, "Leave out the legend"));
  page(app->add_flag("--no-scale-bar", o->noScaleBar, "Leave out the scale bar"));
  page(app->add_option("--view", o->view, "Volumes: where from, in degrees"))
    ->type_name("AZIMUTH,ELEVATION")
    ->capture_default_str();
  page(app->add_option("--opacity", o->opacity, "Volumes: opacity of the phases' surface, 0 to 1"))
    ->type_name("NUMBER")
    ->capture_default_str();
  addOutputOptions(*app, o->output, o->common, "PNG to write")->required();
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella snapshot heat_y.vti --preset flux -o flux.png",
      "lamella snapshot heat_y.vti --array temperature --overlay isolines --size 1600,1200 -o heat.png",
      "lamella snapshot tissue.png --phase 0=lumen --phase 255=wall --pixel-size 0.5um --transparent -o "
      "tissue_figure.png" });
  return aloneCommand(app, o, snapshot);
}

} // namespace lamella::cli
