#include "SettingTable.h"
#include "Settings.h"
#include "commands/FilterRun.h"
#include "files/GridFile.h"
#include "files/Input.h"
#include "files/JsonReport.h"
#include "files/SampleFile.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "io/Provenance.h"
#include "vtkLatticeConversion.h"
#include "vtkMicrostructureSource.h"

#include <vtkDataArrayRange.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

/// One kind of sample, a command of its own.
struct SampleKind
{
  const char* name;
  const char* text;
  int kind;                                         ///< of vtkMicrostructureSource
  std::vector<int> dimensions;                      ///< that it can have
  std::map<std::string, std::string> defaults;      ///< where they are not the class's
  std::vector<std::array<const char*, 2>> formerly; ///< option of the version before, and of this one
};

using Microstructure = vtkMicrostructureSource;

const std::vector<SampleKind>& kinds()
{
  static const std::array ring{ "ring", "ring-position" };
  static const std::array rays{ "ray-every", "ray-distance" };
  static const std::array fraction{ "fraction", "solid-fraction" };
  static const std::vector<SampleKind> all{
    { "softwood", "Cross-section of softwood, or with a depth the tissue in 3D", Microstructure::SOFTWOOD, { 2, 3 }, {},
      { ring, rays } },
    { "hardwood", "Cross-section of hardwood: vessels among fibres, rays", Microstructure::HARDWOOD, { 2 },
      { { "size", "400,400" }, { "solid-fraction", "0.38" } }, { ring, rays } },
    { "honeycomb", "Regular hexagonal cells with straight walls", Microstructure::HONEYCOMB, { 2, 3 }, {}, {} },
    { "checkerboard", "Fields of two phases that alternate along every axis", Microstructure::CHECKERBOARD, { 2, 3 },
      {}, {} },
    { "disks", "Square array of disks", Microstructure::INCLUSIONS, { 2 },
      { { "cells", "1" }, { "solid-fraction", "0.5" } }, { fraction } },
    { "spheres", "Simple cubic array of spheres", Microstructure::INCLUSIONS, { 3 },
      { { "size", "64,64,64" }, { "cells", "1" }, { "solid-fraction", "0.5" } }, { fraction } },
    { "laminate", "Layers of two phases", Microstructure::LAMINATE, { 2, 3 }, { { "solid-fraction", "0.5" } },
      { fraction, { "periods", "cells" } } },
  };
  return all;
}

struct GenerateOptions
{
  CommonOptions common;
  SettingOptions settings;
  std::string output;
  std::string truth;
};

/// Where a sample goes: its micrograph, its labels, or both.
struct SampleFiles
{
  std::optional<OutputFile> scan;
  std::optional<SampleOutput> labels;

  SampleFiles(const GenerateOptions& options, bool drawn, int dimension);
  void commit();
};

/// Names that cannot be what they are asked to be. @throws ParameterError
void checkFiles(const GenerateOptions& options, bool drawn, int dimension)
{
  checkSampleEnding(options.output, dimension);
  if (!drawn)
  {
    if (!options.truth.empty())
    {
      throw ParameterError(
        "--truth is for micrographs, and labels are to be written", "add --look magenta, blue or grey");
    }
    return;
  }
  if (std::filesystem::path(options.output).extension() != ".png")
    throw ParameterError("-o '" + options.output + "' cannot hold a micrograph", "end its name in .png");
  if (!options.truth.empty())
  {
    checkSampleEnding(options.truth, dimension, "--truth");
    if (std::filesystem::path(options.truth).lexically_normal() ==
      std::filesystem::path(options.output).lexically_normal())
      throw ParameterError("-o and --truth name the same file", "give the labels another name");
  }
}

SampleFiles::SampleFiles(const GenerateOptions& options, bool drawn, int dimension)
{
  checkFiles(options, drawn, dimension);
  if (drawn)
    scan.emplace(options.output, options.common.overwrite);
  if (const std::string& name = drawn ? options.truth : options.output; !name.empty())
    labels.emplace(name, options.common.overwrite);
}

void SampleFiles::commit()
{
  Session::checkInterrupt();
  if (scan)
    scan->commit();
  if (labels)
    labels->commit();
}

void writeSample(vtkImageData* image, const PhaseImage& phases, const SampleFiles& files, const io::Provenance& record)
{
  if (files.scan)
  {
    vtkDataArray* const array = image->GetPointData()->GetArray("micrograph");
    micrograph::Picture picture;
    picture.lattice = phases.lattice;
    std::vector<std::uint16_t>& values = array->GetNumberOfComponents() == 3 ? picture.colour : picture.grey;
    const auto bytes = vtk::DataArrayValueRange(vtkUnsignedCharArray::SafeDownCast(array));
    values.assign(bytes.begin(), bytes.end());
    writeScan(picture, *files.scan, record);
  }
  if (files.labels)
    files.labels->write(image, record);
}

Json toJson(const GenerateOptions& options, const SampleKind& kind, vtkMicrostructureSource* source,
  const PhaseImage& phases, const SampleFiles& files, bool drawn)
{
  const Json settings = settingsAsJson(source);
  Json json;
  json["file"] = options.output;
  json["kind"] = kind.name;
  json["size"] =
    std::vector<std::int64_t>(phases.lattice.size.begin(), phases.lattice.size.begin() + phases.lattice.dimension);
  json["pixel_size"] = phases.lattice.spacing;
  json["phases"] = Json::array();
  const std::vector<double> fractions = phases.fractions();
  const std::vector<std::uint8_t> values = valuesInFile(phases.phases, files.labels ? files.labels->ending() : ".png");
  for (std::size_t id = 0; id < fractions.size(); ++id)
  {
    Json phase{ { "name", phases.phases.names()[id] } };
    if (files.labels)
      phase["value"] = values[id];
    phase["fraction"] = fractions[id];
    json["phases"].push_back(std::move(phase));
  }
  if (drawn)
  {
    json["look"]["stain"] = settings.at("look");
    for (const char* const word : { "blur", "noise", "uneven_light", "dirt", "tears", "rim", "scale_bar" })
      json["look"][word] = settings.at(word);
  }
  if (!options.truth.empty())
    json["truth"] = options.truth;
  if (settings.contains("seed"))
    json["seed"] = settings["seed"];
  return json;
}

void generate(Session& session, const GenerateOptions& options, const SampleKind& kind, const std::string& commandLine)
{
  const auto start = Clock::now();
  options.settings.tellFormer(session);
  vtkNew<vtkMicrostructureSource> source;
  options.settings.give(source);
  const int dimension = source->GetSize()[2] > 1 ? 3 : 2;
  if (std::find(kind.dimensions.begin(), kind.dimensions.end(), dimension) == kind.dimensions.end())
  {
    throw ParameterError(
      fmt::format("size {} is that of a {}, and {} are {}", fmt::join(source->GetSize(), source->GetSize() + 3, ","),
        dimension == 3 ? "volume" : "picture", kind.name, dimension == 3 ? "flat" : "volumes"),
      dimension == 3 ? "write it as --size X,Y" : "write it as --size X,Y,Z");
  }
  const bool drawn = source->GetLook() != vtkMicrostructureSource::LABELS;
  SampleFiles files(options, drawn, dimension);
  if (const std::string doubt = pixelSizeDoubt(options.settings.text("pixel-size")); !doubt.empty())
    session.warn(doubt);
  runFilter(session, source, "generating");
  vtkImageData* const image = source->GetOutput();
  const PhaseImage phases = toPhaseImage(image);
  io::Provenance record = io::makeProvenance(commandLine);
  if (settingsAsJson(source).contains("seed"))
    record.seed = source->GetSeed();
  writeSample(image, phases, files, record);
  files.commit();
  if (options.common.json)
  {
    Json json = toJson(options, kind, source, phases, files, drawn);
    json["seconds"] = secondsSince(start);
    json["version"] = record.version;
    json["commit"] = record.commit;
    session.print(dump(json));
  }
  else if (!options.common.quiet)
  {
    std::vector<std::string> shares;
    const std::vector<double> fractions = phases.fractions();
    for (std::size_t id = 0; id < fractions.size(); ++id)
      shares.push_back(fmt::format("{} {:.4f}", phases.phases.names()[id], fractions[id]));
    session.print(fmt::format("wrote {}: {}{}, {} {} of {:g} µm; {}\n", options.output, kind.name,
      drawn ? " as a micrograph, " + settingsAsJson(source).at("look").get<std::string>() : "",
      sizeText(phases.lattice.size, dimension), drawn ? "pixels" : "nodes", phases.lattice.spacing * 1e6,
      fmt::join(shares, ", ")));
    if (!options.truth.empty())
      session.print(fmt::format("wrote {}: its labels\n", options.truth));
  }
}

} // namespace

Command generateCommand(CLI::App& root)
{
  CLI::App* generator =
    root.add_subcommand("generate", "Make a sample: wood tissue, honeycomb, checkerboard, disks, spheres, laminate");
  generator->require_subcommand(1);
  addExamples(*generator,
    { "lamella generate softwood --size 400,400 --solid-fraction 0.40 --seed 7 -o tissue.png",
      "lamella generate softwood --size 128,128,128 -o tissue.vti",
      "lamella generate hardwood --look magenta -o scan.png --truth labels.png",
      "lamella generate disks --solid-fraction 0.5 -o disks.png" });

  std::vector<std::pair<CLI::App*, std::shared_ptr<GenerateOptions>>> commands;
  for (const SampleKind& kind : kinds())
  {
    auto options = std::make_shared<GenerateOptions>();
    CLI::App* const command = generator->add_subcommand(kind.name, kind.text);
    addOutputOptions(
      *command, options->output, options->common, "File to write: .vti, .png, .tif (volumes: a stack) or .raw")
      ->required();
    options->settings.declareKind(*command, "vtkMicrostructureSource", { "kind", kind.kind }, kind.defaults);
    for (const auto& [old, word] : kind.formerly)
      options->settings.formerly(*command, old, word);
    if (kind.kind == vtkMicrostructureSource::SOFTWOOD)
    {
      options->settings.formerly(*command, "radial-early", "radial-diameter", "", 0);
      options->settings.formerly(*command, "radial-late", "radial-diameter", "", 1);
    }
    if (command->get_option_no_throw("--look") != nullptr)
      addResultFile(
        *command, "--truth", options->truth, "With --look: write the labels: .vti, .png, .tif or .raw", "FILE");
    addReportOptions(*command, options->common);
    commands.emplace_back(command, std::move(options));
  }
  return { generator,
    [commands](Session& session, const std::string& line)
    {
      for (std::size_t i = 0; i < commands.size(); ++i)
        if (commands[i].first->parsed())
          session.onRoot([&] { generate(session, *commands[i].second, kinds()[i], line); });
    } };
}

} // namespace lamella::cli
