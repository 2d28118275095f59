#include "commands/FilterRun.h"
#include "commands/PackingInput.h"
#include "files/FieldReport.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "files/SampleFile.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "io/Provenance.h"
#include "vtkLatticeConversion.h"
#include "vtkMatrixBridges.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include <fmt/format.h>

#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

struct BridgesCommandOptions
{
  CommonOptions common;
  std::string file;
  SettingOptions table; ///< of vtkPackingReader
  SettingOptions settings;
  std::string output;
};

Json toJson(const std::string& file, bool filled, vtkPolyData* grains, vtkImageData* image)
{
  const Lattice lattice = latticeOf(image);
  Json json;
  json["file"] = file;
  json["count"] = grains->GetNumberOfPoints();
  json["size"] = std::vector<std::int64_t>(lattice.size.begin(), lattice.size.begin() + lattice.dimension);
  json["pixel_size"] = lattice.spacing;
  addKeys(json, { image }, { { "width" }, { "reach" } });
  json["filled"] = filled;
  addKeys(json, { image },
    { { "bridges", Key::Kind::Whole }, { "grain_fraction" }, { "matrix_fraction" }, { "void_fraction" },
      { "saturation" }, { "saturation_on_lattice" } });
  const PhaseImage sample = toPhaseImage(image);
  json["phases"] = phasesJson(sample.phases.names(), sample.fractions());
  return json;
}

std::string tableOf(const Json& json, const std::array<double, 3>& box)
{
  const bool spheres = box[2] > 0;
  std::string text = fmt::format("{}: {} {}, box {}\n\n", json["file"].get<std::string>(), counted(json["count"]),
    spheres ? "spheres" : "disks", boxText(box));
  const auto line = [&](const char* name, const std::string& value)
  { text += fmt::format("  {:<12} {}\n", name, value); };
  const auto percent = [&](const char* name) { return shown(json[name], "{:.3f} %", 100); };
  line("bridges",
    json["filled"].get<bool>() ? "none: the space between the grains is filled"
                               : fmt::format("{}, width {:.5g} of the diameter, reach {:g}", counted(json["bridges"]),
                                   json["width"].get<double>(), json["reach"].get<double>()));
  line("grains", percent("grain_fraction"));
  line("matrix", percent("matrix_fraction"));
  line("void", percent("void_fraction"));
  line("saturation", percent("saturation") + ", on the lattice " + percent("saturation_on_lattice"));
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  for (std::size_t axis = 0; axis < json["size"].size(); ++axis)
    size[axis] = json["size"][axis].get<std::int64_t>();
  line("lattice",
    fmt::format("{} nodes of {:.5g} µm", sizeText(size, spheres ? 3 : 2), 1e6 * json["pixel_size"].get<double>()));
  text += wroteText(json["files"].get<std::vector<std::string>>());
  return text;
}

void refuseContradictions(const SettingOptions& settings)
{
  std::vector<std::string> given;
  for (const char* const word : { "width", "saturation", "filled" })
    if (settings.given(word))
      given.emplace_back(word);
  if (given.size() > 1)
  {
    throw ParameterError(given[0] + " and " + given[1] + " contradict each other",
      "give one of width, saturation and filled; each says how much matrix there is");
  }
  if (settings.given("spacing") && settings.given("nodes"))
    throw ParameterError("nodes and spacing contradict each other", "give one of them");
}

void bridgesRun(Session& session, const BridgesCommandOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  refuseContradictions(options.settings);
  vtkNew<vtkMatrixBridges> filter;
  options.settings.give(filter);
  requireFile(options.file);
  std::optional<SampleOutput> file;
  if (!options.output.empty())
  {
    checkSampleEnding(options.output, 2); // a PNG of spheres is refused once it is known that they are
    file.emplace(options.output, options.common.overwrite);
  }
  const vtkSmartPointer<vtkPolyData> grains = readPacking(session, options.file, options.table).grains;
  const std::vector<double> edges = fieldNumbers(grains, "box");
  const std::array<double, 3> box{ edges.at(0), edges.at(1), edges.at(2) };
  if (!options.output.empty())
    checkSampleEnding(options.output, box[2] > 0 ? 3 : 2);
  const std::string origin = provenance(grains);
  filter->SetInputData(grains);
  runFilter(session, filter, "bridges");
  (void)VtkMessages::takeWarnings(); // the same as in the field data
  vtkImageData* const image = filter->GetOutput();
  const io::Provenance record = recordRun(session, commandLine, options.file, origin);
  options.settings.tellFormer(session);
  const std::vector<std::string> warnings = fieldTexts(image, "warnings");
  for (const std::string& warning : warnings)
    session.warn(warning);
  const bool filled = filter->GetFilled() || filter->GetSaturation() == 1.0;
  Json json = toJson(options.file, filled, grains, image);
  if (file)
  {
    file->write(image, record);
    Session::checkInterrupt();
    file->commit();
  }
  json["files"] = options.output.empty() ? Json::array() : Json::array({ options.output });
  json["warnings"] = warnings;
  json["seconds"] = secondsSince(start);
  printReport(session, options.common, json, record, [&](const Json& all) { return tableOf(all, box); });
}

} // namespace

Command bridgesCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand("bridges", "Cement a packing: bridges of matrix between grains, on a lattice");
  auto o = std::make_shared<BridgesCommandOptions>();
  app->add_option("FILE", o->file, "Grains: the .vtp of lamella packing, or a table x,z,r or x,y,z,r")->required();
  o->settings.declare(*app, "vtkMatrixBridges");
  addTableOptions(*app, o->table);
  addOutputOptions(*app, o->output, o->common, "Write the sample: .vti, .png (disks), .tif or .raw");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella bridges grains.vtp --saturation 40% -o cemented.vti",
      "lamella bridges measured.csv --unit 1mm --width 0.7 --spacing 25um -o cemented.png",
      "lamella bridges spheres.vtp --nodes 120 --filled --json" });
  return aloneCommand(app, o, bridgesRun);
}

} // namespace lamella::cli
