#include "Commands.h"
#include "GenerateLook.h"
#include "GenerateTissue.h"
#include "GridFile.h"
#include "Input.h"
#include "OutputFile.h"
#include "Record.h"
#include "SampleFile.h"
#include "Text.h"

#include "generators/Generators.h"
#include "io/Provenance.h"
#include "lattice/Clock.h"
#include "lattice/Memory.h"
#include "vtkLatticeConversion.h"

#include <vtkImageData.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

using Json = nlohmann::ordered_json;

/// Everything the kinds take; each declares what it knows.
struct GenerateOptions
{
  CommonOptions common;
  std::string output;
  std::string size;
  std::string pixelSize = "1um";
  std::string fraction;
  int cells = 4;
  int periods = 4;
  std::string axis = "x";
  TissueChoice tissue;
  LookChoice look;
};

struct Box
{
  int dimension;
  std::array<std::int64_t, 3> size;
  double spacing;
};

Box parseBox(const GenerateOptions& options, std::initializer_list<std::size_t> dimensions)
{
  const std::vector<std::size_t> counts(dimensions);
  const std::string form = counts.size() == 2 ? "WIDTH,HEIGHT or WIDTH,HEIGHT,DEPTH"
    : counts[0] == 2                          ? "WIDTH,HEIGHT"
                                              : "WIDTH,HEIGHT,DEPTH";
  const auto v = integerList("--size", options.size, counts, form);
  if (*std::min_element(v.begin(), v.end()) < 2)
  {
    throw ParameterError(
      "--size '" + options.size + "' is below 2 along an axis", "give at least 2 nodes along each axis");
  }
  Box box{ static_cast<int>(v.size()), { v[0], v[1], v.size() == 3 ? v[2] : 1 },
    lengthInMetres("--pixel-size", options.pixelSize) };
  // Sizes are multiplied as doubles here: 64 bits can overflow.
  const double nodes = static_cast<double>(v[0]) * static_cast<double>(v[1]) * static_cast<double>(box.size[2]);
  const double bytes = 10 * nodes; // the phases, their copy in the file, and one double a node that the softwood keeps
  if (const auto available = static_cast<double>(availableMemory()); bytes > available)
  {
    throw MemoryError(fmt::format("a sample of {} nodes needs about {}, and {} are free",
                        sizeText(box.size, box.dimension), bytesText(bytes), bytesText(available)),
      "make it smaller with --size");
  }
  return box;
}

/// The same tissue on a finer lattice.
template <class Options>
Options finerBy(int finer, Options options)
{
  options.size[0] *= finer;
  options.size[1] *= finer;
  options.spacing /= finer;
  return options;
}

/// Writes labels in any of the forms.
void writeSample(const PhaseImage& image, const OutputFile& file, OutputFile* beside, const io::Provenance& provenance)
{
  if (file.path().extension() == ".vti")
  {
    const auto grid = toImageData(image);
    setProvenance(grid, io::toJson(provenance));
    setFieldText(grid, "pixel_size_source", "generated");
    writeGrid(grid, file);
  }
  else
  {
    writeLabels(image, file, beside, provenance);
  }
}

/// Generates, writes, reports.
void generate(Session& session, const GenerateOptions& options, const std::string& kind, const std::string& commandLine,
  const Box& box, std::optional<std::uint64_t> seed, const std::function<PhaseImage()>& make,
  const std::optional<Look>& look = std::nullopt)
{
  checkSampleEnding(options.output, box.dimension);
  const auto start = Clock::now();
  session.onRoot(
    [&]
    {
      OutputFile file(options.output, options.common.overwrite);
      // Where the labels go: into the file itself, or beside a micrograph, or nowhere.
      std::optional<OutputFile> truth;
      if (look && !look->truth.empty())
      {
        truth.emplace(look->truth, options.common.overwrite);
      }
      OutputFile* const labels = truth ? &*truth : look ? nullptr : &file;
      std::optional<OutputFile> beside;
      if (labels != nullptr && labels->path().extension() == ".raw")
      {
        beside.emplace(recordBeside(labels->path()), options.common.overwrite);
      }
      if (const std::string doubt = pixelSizeDoubt(options.pixelSize); !doubt.empty())
      {
        session.warn(doubt);
      }
      const PhaseImage image = make();
      Session::checkInterrupt();
      io::Provenance provenance = io::makeProvenance(commandLine);
      provenance.seed = seed;
      if (look)
      {
        const micrograph::Picture picture = look->draw();
        Session::checkInterrupt();
        writeScan(picture, file, provenance);
      }
      if (labels != nullptr)
      {
        writeSample(image, *labels, beside ? &*beside : nullptr, provenance);
      }
      Session::checkInterrupt();
      file.commit();
      if (truth)
      {
        truth->commit();
      }
      if (beside)
      {
        beside->commit();
      }

      const std::vector<double> fractions = image.fractions();
      const double seconds = secondsSince(start);
      if (options.common.json)
      {
        Json json;
        json["file"] = options.output;
        json["kind"] = kind;
        json["size"] =
          std::vector<std::int64_t>(image.lattice.size.begin(), image.lattice.size.begin() + box.dimension);
        json["pixel_size"] = box.spacing;
        json["phases"] = Json::array();
        const auto values = valuesInFile(image.phases, (labels ? labels : &file)->path().extension().string());
        for (std::size_t id = 0; id < fractions.size(); ++id)
        {
          Json phase{ { "name", image.phases.names()[id] } };
          if (labels != nullptr)
          {
            phase["value"] = values[id];
          }
          phase["fraction"] = fractions[id];
          json["phases"].push_back(std::move(phase));
        }
        if (look)
        {
          json["look"] = look->toJson();
        }
        if (truth)
        {
          json["truth"] = look->truth;
        }
        if (seed)
        {
          json["seed"] = *seed;
        }
        json["seconds"] = seconds;
        json["version"] = provenance.version;
        json["commit"] = provenance.commit;
        session.print(json.dump(2) + "\n");
      }
      else if (!options.common.quiet)
      {
        std::string shares;
        for (std::size_t id = 0; id < fractions.size(); ++id)
        {
          shares += fmt::format("{}{} {:.4f}", id == 0 ? "" : ", ", image.phases.names()[id], fractions[id]);
        }
        session.print(fmt::format("wrote {}: {}{}, {} {} of {:g} µm; {}\n", options.output, kind,
          look ? " as a micrograph, " + look->stain : "", sizeText(box.size, box.dimension), look ? "pixels" : "nodes",
          box.spacing * 1e6, shares));
        if (truth)
        {
          session.print(fmt::format("wrote {}: its labels\n", look->truth));
        }
      }
    });
}

using Run = std::function<void(Session&, const std::string&)>;

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
      "lamella generate disks --fraction 0.5 -o disks.png" });

  auto runs = std::make_shared<std::vector<std::pair<CLI::App*, Run>>>();
  const auto kind = [&](const std::string& name, const std::string& description, const std::string& size)
  {
    auto options = std::make_shared<GenerateOptions>();
    options->size = size;
    options->fraction =
      name == "honeycomb" ? fmt::format("{:.2f}", generators::HoneycombOptions().solidFraction) : "0.5";
    CLI::App* command = generator->add_subcommand(name, description);
    addOutputOptions(
      *command, options->output, options->common, "File to write: .png, .tif (volumes: a stack), .vti or .raw")
      ->required();
    command->add_option("--size", options->size, "Nodes along each axis")
      ->type_name(name == "disks" || name == "honeycomb" || name == "hardwood" ? "WIDTH,HEIGHT"
          : name == "spheres"                                                  ? "WIDTH,HEIGHT,DEPTH"
                                                                               : "WIDTH,HEIGHT[,DEPTH]")
      ->capture_default_str();
    command->add_option("--pixel-size", options->pixelSize, "Distance of the nodes, as 0.5e-6 or 0.5um")
      ->type_name("METRES")
      ->capture_default_str();
    addReportOptions(*command, options->common);
    return std::pair(command, options);
  };
  const auto add = [&](CLI::App* command, Run run) { runs->emplace_back(command, std::move(run)); };

  {
    const auto made = kind("softwood", "Cross-section of softwood, or with a depth the tissue in 3D", "200,200");
    CLI::App* const command = made.first;
    const auto o = made.second;
    addSoftwoodOptions(*command, o->tissue);
    addLookOptions(*command, o->look);
    add(command,
      [o, command](Session& session, const std::string& line)
      {
        const Box box = parseBox(*o, { 2, 3 });
        generators::SoftwoodOptions softwood = softwoodOptions(o->tissue);
        softwood.dimension = box.dimension;
        softwood.size = box.size;
        softwood.spacing = box.spacing;
        const auto look = parseLook(*command, o->look, o->output, box.dimension, softwood.seed,
          [softwood](int finer) { return generators::softwood(finerBy(finer, softwood)); });
        generate(
          session, *o, "softwood", line, box, softwood.seed, [&] { return generators::softwood(softwood); }, look);
      });
  }
  {
    const auto made = kind("hardwood", "Cross-section of hardwood: vessels among fibres, rays", "400,400");
    CLI::App* const command = made.first;
    const auto o = made.second;
    addHardwoodOptions(*command, o->tissue);
    addLookOptions(*command, o->look);
    add(command,
      [o, command](Session& session, const std::string& line)
      {
        const Box box = parseBox(*o, { 2 });
        generators::HardwoodOptions hardwood = hardwoodOptions(o->tissue);
        hardwood.size = box.size;
        hardwood.spacing = box.spacing;
        const auto look = parseLook(*command, o->look, o->output, box.dimension, hardwood.seed,
          [hardwood](int finer) { return generators::hardwood(finerBy(finer, hardwood)); });
        generate(
          session, *o, "hardwood", line, box, hardwood.seed, [&] { return generators::hardwood(hardwood); }, look);
      });
  }
  {
    auto [command, o] = kind("honeycomb", "Regular hexagonal cells with straight walls", "200,200");
    command->add_option("--solid-fraction", o->fraction, "Share of the wall")
      ->type_name("SHARE")
      ->capture_default_str();
    command->add_option("--cells", o->cells, "Cells along x")->type_name("NUMBER")->capture_default_str();
    add(command,
      [o](Session& session, const std::string& line)
      {
        const Box box = parseBox(*o, { 2 });
        generators::HoneycombOptions honeycomb{ box.size, box.spacing,
          fractionBetween("--solid-fraction", o->fraction, 0, 1), o->cells };
        generate(session, *o, "honeycomb", line, box, {}, [&] { return generators::honeycomb(honeycomb); });
      });
  }
  {
    auto [command, o] = kind("checkerboard", "Fields of two phases that alternate along every axis", "200,200");
    command->add_option("--cells", o->cells, "Fields along each axis")->type_name("NUMBER")->capture_default_str();
    add(command,
      [o](Session& session, const std::string& line)
      {
        const Box box = parseBox(*o, { 2, 3 });
        generate(session, *o, "checkerboard", line, box, {},
          [&] { return generators::checkerboard(box.dimension, box.size, box.spacing, o->cells); });
      });
  }
  for (const bool spheres : { false, true })
  {
    const std::string name = spheres ? "spheres" : "disks";
    auto [command, o] =
      kind(name, spheres ? "Simple cubic array of spheres" : "Square array of disks", spheres ? "64,64,64" : "200,200");
    o->cells = 1;
    command->add_option("--fraction", o->fraction, "Share of the " + name)->type_name("SHARE")->capture_default_str();
    command->add_option("--cells", o->cells, "Unit cells along each axis")->type_name("NUMBER")->capture_default_str();
    add(command,
      [o, name, spheres](Session& session, const std::string& line)
      {
        const Box box = parseBox(*o, { spheres ? std::size_t{ 3 } : std::size_t{ 2 } });
        const double fraction = fractionBetween("--fraction", o->fraction, 0, 1);
        generate(session, *o, name, line, box, {},
          [&] { return generators::inclusionArray(box.dimension, box.size, box.spacing, fraction, o->cells); });
      });
  }
  {
    auto [command, o] = kind("laminate", "Layers of two phases", "200,200");
    command->add_option("--fraction", o->fraction, "Share of the inclusion")->type_name("SHARE")->capture_default_str();
    command->add_option("--periods", o->periods, "Pairs of layers")->type_name("NUMBER")->capture_default_str();
    command->add_option("--axis", o->axis, "Axis that the layers are perpendicular to")
      ->type_name("x|y|z")
      ->capture_default_str();
    add(command,
      [o](Session& session, const std::string& line)
      {
        const Box box = parseBox(*o, { 2, 3 });
        const std::vector<std::string> axes{ "x", "y", "z" };
        const auto axis =
          static_cast<int>(oneOf("--axis", o->axis, std::span(axes).first(static_cast<std::size_t>(box.dimension))));
        const double fraction = fractionBetween("--fraction", o->fraction, 0, 1);
        generate(session, *o, "laminate", line, box, {},
          [&] { return generators::laminate(box.dimension, box.size, box.spacing, axis, fraction, o->periods); });
      });
  }

  return { generator,
    [runs](Session& session, const std::string& line)
    {
      for (const auto& [command, run] : *runs)
      {
        if (command->parsed())
        {
          run(session, line);
        }
      }
    } };
}

} // namespace lamella::cli
