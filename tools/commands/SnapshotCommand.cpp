#include "commands/FilterRun.h"
#include "commands/SampleRun.h"
#include "files/GridFile.h"
#include "files/Input.h"
#include "files/Record.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "Failures.h"
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

#include <exception>
#include <filesystem>
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
  SettingOptions settings;
  std::string output;
  std::string lines;
  std::string view; ///< as in the version before, and these
  bool streamlines = false;
  bool arrows = false;
};

/// Words of the version before that are no setting of their own now. @throws ParameterError
void configureFormer(Session& session, vtkSnapshot* snapshot, const SnapshotOptions& options)
{
  const auto tell = [&session](const char* old, const char* now)
  { session.warn(fmt::format("{0} is called {1} now; the next version does not know {0} any more", old, now)); };
  if (!options.view.empty())
  {
    tell("--view", "--azimuth and --elevation");
    const std::vector<std::string> parts = split(options.view, ',');
    const auto azimuth = toNumber(parts[0]);
    const auto elevation = parts.size() == 2 ? toNumber(parts[1]) : std::nullopt;
    if (!azimuth || !elevation)
      throw ParameterError("--view '" + options.view + "' is not two numbers", "give --azimuth and --elevation");
    snapshot->SetAzimuth(*azimuth);
    snapshot->SetElevation(*elevation);
  }
  if (options.streamlines || options.arrows)
  {
    tell(options.arrows ? "--arrows" : "--streamlines", options.arrows ? "--overlay arrows" : "--overlay lines");
    if ((options.streamlines && options.arrows) || options.settings.given("overlay"))
      throw ParameterError("--overlay, --streamlines and --arrows exclude each other", "give --overlay alone");
    snapshot->SetOverlay(options.arrows ? vtkSnapshot::ARROWS_OVERLAY : vtkSnapshot::LINES_OVERLAY);
  }
}

/// A part of an image, as --window says. @throws ParameterError
vtkSmartPointer<vtkDataObject> cut(vtkDataObject* data, const Window& part)
{
  auto* image = vtkImageData::SafeDownCast(data);
  if (image == nullptr)
    throw ParameterError("--window is for images", "leave it out");
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
  const bool mapped = !options.picture.settings.firstGiven({ "phase", "other", "segment" }).empty();
  if (ending == ".vtp" || (ending == ".vti" && !mapped))
  {
    const auto data = readGrid(options.picture.file);
    const auto window = readerOptions(options.picture).window;
    return window ? cut(data, *window) : data;
  }
  Sample sample = loadSample(options.picture);
  tellDoubts(session, sample);
  return imageOf(sample);
}

void snapshot(Session& session, const SnapshotOptions& options, const std::string& commandLine)
{
  vtkNew<vtkSnapshot> drawing;
  options.settings.tellFormer(session);
  options.settings.give(drawing);
  configureFormer(session, drawing, options);
  if (std::filesystem::path(options.output).extension() != ".png")
    throw ParameterError("-o '" + options.output + "': pictures are written as PNG", "end the name in .png");
  OutputFile file(options.output, options.common.overwrite);
  const auto data = load(session, options);
  Session::checkInterrupt();
  drawing->SetInputData(data);
  if (!options.lines.empty())
  {
    const auto lines = readGrid(options.lines);
    auto* polyData = vtkPolyData::SafeDownCast(lines);
    auto* volume = vtkImageData::SafeDownCast(data);
    const bool inside = volume != nullptr && volume->GetDataDimension() == 3;
    if (polyData == nullptr || (inside ? polyData->GetNumberOfCells() : polyData->GetNumberOfLines()) == 0)
    {
      throw InputError("'" + options.lines + "' holds no " + (inside ? "lines, surfaces or points" : "lines"),
        "give the .vtp that lamella flux-map or crack-path wrote, or on grains that of lamella packing --contacts");
    }
    drawing->SetOverlayLines(polyData);
  }

  const io::Provenance record = recordRun(session, commandLine, options.picture.file, provenance(data));
  drawing->SetProvenance(io::toJson(record).c_str());
  drawing->SetOverwrite(true); // the temporary file; whether the name may be replaced was asked above
  (void)takeFailure();
  const bool drawn = drawing->Write(file.temporary().c_str());
  Session::checkInterrupt();
  if (!drawn)
  {
    if (const std::exception_ptr failure = takeFailure())
      std::rethrow_exception(failure);
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
  o->settings.declare(*app, "vtkSnapshot", { "overwrite", "provenance" });
  addOption(*app, "Drawing", "--lines", o->lines,
    "Draw this file: streamlines of flux-map; on grains the contacts of packing; in the phases of a volume, which a "
    "small opacity makes see-through, cracks of crack-path or broken bonds of fracture",
    "FILE.vtp");
  app->add_option("--view", o->view)->group("");
  app->add_flag("--streamlines", o->streamlines)->group("");
  app->add_flag("--arrows", o->arrows)->group("");
  addOutputOptions(*app, o->output, o->common, "Picture to write: .png")->required();
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella snapshot heat_y.vti --preset flux -o flux.png",
      "lamella snapshot heat_y.vti --array temperature --overlay isolines --size 1600,1200 -o heat.png",
      "lamella snapshot tissue.png --phase 0=lumen --phase 255=wall --pixel-size 0.5um --transparent -o "
      "tissue_figure.png" });
  return aloneCommand(app, o, snapshot);
}

} // namespace lamella::cli
