#include "Commands.h"
#include "GridFile.h"
#include "JsonReport.h"
#include "OutputFile.h"
#include "PackingInput.h"
#include "Record.h"
#include "SampleFile.h"
#include "Text.h"

#include "PackingData.h"
#include "io/Provenance.h"
#include "lattice/Clock.h"
#include "lattice/Error.h"
#include "packing/Bridges.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>

#include <fmt/format.h>

#include <cmath>
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
  TableOptions table;
  packing::BridgeOptions bridges;
  std::string saturation;
  std::int64_t nodes = packing::RasterOptions().nodesAcross;
  std::string spacing;
  std::string platen;
  std::string output;
  std::vector<CLI::Option*> widthOptions; ///< three ways to say how much matrix there is
  std::vector<CLI::Option*> nodesOption;
};

double numberOf(vtkImageData* image, const char* name)
{
  return fieldNumbers(image, name).at(0);
}

Json toJson(const std::string& file, bool filled, const packing::Packing& packing, vtkImageData* image)
{
  const Lattice lattice = latticeOf(image);
  Json json;
  json["file"] = file;
  json["count"] = packing.count();
  json["size"] = std::vector<std::int64_t>(lattice.size.begin(), lattice.size.begin() + lattice.dimension);
  json["pixel_size"] = lattice.spacing;
  for (const char* const name : { "width", "reach" })
  {
    json[name] = numberOf(image, name);
  }
  json["filled"] = filled;
  json["bridges"] = static_cast<std::int64_t>(numberOf(image, "bridges"));
  for (const char* const name :
    { "grain_fraction", "matrix_fraction", "void_fraction", "saturation", "saturation_on_lattice" })
  {
    json[name] = numberOf(image, name);
  }
  json["phases"] = Json::array();
  const PhaseImage sample = toPhaseImage(image);
  const std::vector<double> fractions = sample.fractions();
  for (std::size_t id = 0; id < fractions.size(); ++id)
  {
    json["phases"].push_back({ { "name", sample.phases.names()[id] }, { "fraction", fractions[id] } });
  }
  return json;
}

std::string tableOf(const Json& json, const packing::Packing& packing)
{
  std::string text = fmt::format("{}: {} {}, box {}\n\n", json["file"].get<std::string>(),
    grouped(json["count"].get<std::int64_t>()), packing.dimension == 3 ? "spheres" : "disks", boxText(packing.size));
  const auto line = [&](const char* name, const std::string& value)
  { text += fmt::format("  {:<12} {}\n", name, value); };
  const auto percent = [&](const char* name) { return fmt::format("{:.3f} %", 100 * json[name].get<double>()); };
  line("bridges",
    json["filled"].get<bool>()
      ? "none: the space between the grains is filled"
      : fmt::format("{}, width {:.5g} of the diameter, reach {:g}", grouped(json["bridges"].get<std::int64_t>()),
          json["width"].get<double>(), json["reach"].get<double>()));
  line("grains", percent("grain_fraction"));
  line("matrix", percent("matrix_fraction"));
  line("void", percent("void_fraction"));
  line("saturation", percent("saturation") + ", on the lattice " + percent("saturation_on_lattice"));
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  for (std::size_t axis = 0; axis < json["size"].size(); ++axis)
  {
    size[axis] = json["size"][axis].get<std::int64_t>();
  }
  line("lattice",
    fmt::format("{} nodes of {:.5g} µm", sizeText(size, packing.dimension), 1e6 * json["pixel_size"].get<double>()));
  text += wroteText(json["files"].get<std::vector<std::string>>());
  return text;
}

void refuseContradictions(const BridgesCommandOptions& options)
{
  std::vector<std::string> given;
  for (const CLI::Option* option : options.widthOptions)
  {
    if (option->count() > 0)
    {
      given.push_back(option->get_name());
    }
  }
  if (given.size() > 1)
  {
    throw ParameterError(given[0] + " and " + given[1] + " contradict each other",
      "give one of --width, --saturation and --filled; each says how much matrix there is");
  }
  if (!options.spacing.empty() && !firstGiven(options.nodesOption).empty())
  {
    throw ParameterError("--nodes and --spacing contradict each other", "give one of them");
  }
}

void bridgesRun(Session& session, const BridgesCommandOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  refuseContradictions(options);
  packing::BridgeOptions bridges = options.bridges;
  if (!options.saturation.empty())
  {
    bridges.saturation = share("--saturation", options.saturation);
  }
  packing::RasterOptions raster;
  raster.nodesAcross = options.nodes;
  raster.platen = options.platen.empty() ? 0 : lengthInMetres("--platen", options.platen);
  const double spacing = options.spacing.empty() ? 0 : lengthInMetres("--spacing", options.spacing);

  requireFile(options.file);
  std::optional<OutputFile> file;
  std::optional<OutputFile> beside;
  if (!options.output.empty())
  {
    checkSampleEnding(options.output, 2); // a PNG of spheres is refused once it is known that they are
    file.emplace(options.output, options.common.overwrite);
    if (file->path().extension() == ".raw")
    {
      beside.emplace(recordBeside(file->path()), options.common.overwrite);
    }
  }
  const PackingFile source = loadPacking(options.file, options.table);
  if (!options.output.empty())
  {
    checkSampleEnding(options.output, source.packing.dimension);
  }
  if (spacing > 0)
  {
    const double nodes = std::round(source.packing.size[0] / spacing);
    if (!(nodes >= 2 && nodes <= 1e6))
    {
      throw ParameterError(fmt::format("--spacing '{}' makes {:g} nodes across a box of {}", options.spacing, nodes,
                             boxText(source.packing.size)),
        "give a length that goes into it 2 to 1000000 times");
    }
    raster.nodesAcross = static_cast<std::int64_t>(nodes);
  }

  static_cast<void>(session.progress(0, "bridges"));
  const auto image = cementedImage(source.packing, bridges, raster, "lamella bridges");
  session.endProgress();
  Session::checkInterrupt();
  const io::Provenance record = recordRun(commandLine, options.file, source.provenance);
  setProvenance(image, io::toJson(record));
  const std::vector<std::string> warnings = fieldTexts(image, "warnings");
  for (const std::string& warning : warnings)
  {
    session.warn(warning);
  }
  const bool filled = bridges.filled || bridges.saturation == 1.0;
  Json json = toJson(options.file, filled, source.packing, image);
  if (file)
  {
    if (file->path().extension() == ".vti")
    {
      writeGrid(image, *file);
    }
    else
    {
      writeLabels(toPhaseImage(image), *file, beside ? &*beside : nullptr, record);
    }
    Session::checkInterrupt();
    file->commit();
    if (beside)
    {
      beside->commit();
    }
  }
  json["files"] = options.output.empty() ? Json::array() : Json::array({ options.output });
  json["warnings"] = warnings;
  json["seconds"] = secondsSince(start);
  printReport(session, options.common, json, record, [&](const Json& all) { return tableOf(all, source.packing); });
}

} // namespace

Command bridgesCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand("bridges", "Cement a packing: bridges of matrix between grains, on a lattice");
  auto o = std::make_shared<BridgesCommandOptions>();
  app->add_option("FILE", o->file, "Grains: the .vtp of lamella packing, or a table x,z,r or x,y,z,r")->required();
  const auto in = [](const char* group, const char* type, CLI::Option* option)
  { return option->type_name(type)->group(group); };
  o->widthOptions = {
    in("Matrix", "RATIO",
      app->add_option("--width", o->bridges.width, "Width of a bridge at a grain's centre over its diameter, 0 to 2")
        ->capture_default_str()),
    in("Matrix", "SHARE",
      app->add_option("--saturation", o->saturation, "Share of the space between grains; the width is found for it")),
    app->add_flag("--filled", o->bridges.filled, "All of the space between the grains is matrix")->group("Matrix")
  };
  in("Matrix", "RATIO",
    app->add_option("--reach", o->bridges.reach, "Centres nearer than this times both radii get a bridge, 1 to 2")
      ->capture_default_str());
  app->add_flag("--wall-bridges", o->bridges.walls, "Bridges to the walls below and above too")->group("Matrix");
  o->nodesOption = { in(
    "Lattice", "NUMBER", app->add_option("--nodes", o->nodes, "Nodes along x")->capture_default_str()) };
  in("Lattice", "LENGTH",
    app->add_option("--spacing", o->spacing, "Distance of nodes, as 50um, instead: the nearest that divides the box"));
  in("Lattice", "LENGTH",
    app->add_option("--platen", o->platen, "Thickness of a plate of grain material below and above"));
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
