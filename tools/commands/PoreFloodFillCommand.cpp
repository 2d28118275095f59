#include "commands/FilterRun.h"
#include "commands/PoreReport.h"
#include "commands/SampleRun.h"
#include "files/GridFile.h"
#include "files/Input.h"
#include "files/JsonReport.h"
#include "files/Record.h"
#include "files/TableText.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "core/Memory.h"
#include "io/Provenance.h"
#include "lattice/PhaseNames.h"
#include "vtkLatticeConversion.h"
#include "vtkPoreFloodFill.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSMPTools.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

struct PoreFloodFillOptions
{
  CommonOptions common;
  PictureOptions picture;
  std::string fill;
  SettingOptions settings;
  int threads = 1;
  std::vector<std::string> output;
  std::string distribution;
};

/// @throws ParameterError for a phase that the sample does not have
void checkFill(const std::string& fill, const std::vector<std::string>& names)
{
  if (!fill.empty() && !phaseMeant(names, fill))
  {
    throw ParameterError("--fill names '" + fill + "', which is no phase of this sample",
      suggestion(fill, names, "its phases are " + quotedList(names, "and")));
  }
}

/// A table and the record beside it.
struct TableFile
{
  OutputFile table;
  OutputFile record;
};

struct PoreFiles
{
  std::vector<OutputFile> labels; ///< .vti
  std::vector<TableFile> pores;   ///< .csv
  std::vector<TableFile> classes;
};

PoreFiles openFiles(const PoreFloodFillOptions& options)
{
  PoreFiles files;
  const bool overwrite = options.common.overwrite;
  const auto table = [&](const std::string& name) {
    return TableFile{ OutputFile(name, overwrite), OutputFile(name + ".json", overwrite) };
  };
  for (const std::string& name : options.output)
  {
    const std::string ending = std::filesystem::path(name).extension().string();
    if (ending == ".vti")
    {
      files.labels.emplace_back(name, overwrite);
    }
    else if (ending == ".csv")
    {
      files.pores.push_back(table(name));
    }
    else
    {
      throw ParameterError("-o '" + name + "': labels are written as .vti, the table of the pores as .csv",
        "end the name in one of these; -o can be given twice");
    }
  }
  if (!options.distribution.empty())
  {
    if (std::filesystem::path(options.distribution).extension() != ".csv")
    {
      throw ParameterError(
        "--distribution '" + options.distribution + "': it is written as .csv", "end the name in .csv");
    }
    files.classes.push_back(table(options.distribution));
  }
  return files;
}

void writeFiles(PoreFiles& files, vtkPoreFloodFill* filter, bool metres, const std::string& record)
{
  vtkImageData* const image = vtkImageData::SafeDownCast(filter->GetOutputDataObject(0));
  setProvenance(image, record);
  for (const OutputFile& file : files.labels)
    writeGrid(image, file);
  const auto write = [&](const std::vector<TableFile>& list, vtkTable* table)
  {
    for (const TableFile& file : list)
    {
      file.table.write(toCsv(table));
      const Json beside{ { "provenance", Json::parse(record) }, { "columns", unitsOf(table, metres) } };
      file.record.write(dump(beside));
    }
  };
  write(files.pores, filter->GetPores());
  write(files.classes, filter->GetSizeDistribution());
  Session::checkInterrupt();
  for (OutputFile& file : files.labels)
    file.commit();
  for (std::vector<TableFile>* const list : { &files.pores, &files.classes })
  {
    for (TableFile& file : *list)
    {
      file.table.commit();
      file.record.commit();
    }
  }
}

/// Refuses what cannot be labelled for want of memory, before the file is read. @throws MemoryError
void requireMemory(const Lattice& lattice, bool sizes, int ranks, int ranksOnMachine)
{
  const auto nodes = static_cast<double>(lattice.count());
  const double arrays = 1 + 4 + (sizes ? 4 : 0); // phase, labels, sizes
  const double runs = 12.0 / 64 + 0.5;           // bits with counts; runs and pieces of an ordinary sample
  // Rank 0 holds the whole; where there are several, each holds its block as well.
  const double need =
    nodes * (arrays + runs * ranksOnMachine / ranks + (ranks > 1 ? arrays * ranksOnMachine / ranks : 0));
  if (const auto available = static_cast<double>(availableMemory()); need > available)
  {
    throw MemoryError(fmt::format("the pores of {} {} need about {} of memory, and {} are free",
                        sizeText(lattice.size, lattice.dimension), lattice.dimension == 3 ? "voxels" : "pixels",
                        bytesText(need), bytesText(available)),
      "take a part of it with --window");
  }
}

void poreFloodFill(Session& session, const PoreFloodFillOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  vtkNew<vtkPoreFloodFill> filter;
  options.settings.give(filter);
  filter->SetPhase(options.fill);
  vtkSmartPointer<vtkImageData> image = vtkSmartPointer<vtkImageData>::New();
  Sample sample;
  PoreFiles files;
  std::array<int, 6> extent{ 0, -1, 0, -1, 0, -1 };
  const int neighbours = session.ranksOnMachine();
  session.onRoot(
    [&]
    {
      sample = loadSample(options.picture,
        [&](const Lattice& lattice) { requireMemory(lattice, !options.output.empty(), session.ranks(), neighbours); });
      Session::checkInterrupt();
      tellDoubts(session, sample);
      checkFill(options.fill, sample.image.phases.names());
      files = openFiles(options);
      const auto nodes = static_cast<std::uint64_t>(sample.image.lattice.count());
      for (const OutputFile& file : files.labels)
        file.needs(nodes); // compressed; the whole is nine bytes a node
      image = imageOf(sample);
      image->GetExtent(extent.data());
    });
  session.broadcast(extent);
  if (options.settings.text("periodic") == "all" && extent[4] == extent[5]) // of a picture
    filter->SetPeriodic(1, 1, 0);

  vtkSMPTools::Initialize(options.threads); // 0: one a core
  if (options.threads != 1)
    vtkSMPTools::SetBackend("STDThread");
  filter->SetComputeLabels(!options.output.empty());
  filter->SetComputePoreSize(!options.output.empty());
  runFilterOnRanks(session, filter.Get(), image, extent, "pores");
  session.onRoot(
    [&]
    {
      tellWarnings(session);
      options.settings.tellFormer(session);
      const io::Provenance record = recordRun(session, commandLine, options.picture.file, sample.provenance);
      PoreReport report{ options.picture.file, filter.Get(), sample.pixelSizeSource != "none", record, options.output };
      if (!options.distribution.empty())
        report.written.push_back(options.distribution);
      report.ranks = session.ranks();
      writeFiles(files, filter, report.metres, io::toJson(record));
      report.seconds = secondsSince(start);
      session.print(options.common.json ? toJson(report) : options.common.quiet ? "" : toTable(report));
    });
}

} // namespace

Command poreFloodFillCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "pore-flood-fill", "Pores of a picture or volume: number, sizes, table, labels, which of them percolate");
  auto o = std::make_shared<PoreFloodFillOptions>();
  addPictureOptions(*app, o->picture);
  const auto pore = [](CLI::Option* option) { return option->group("Pores"); };
  pore(app->add_option(
         "--fill", o->fill, "The phase that the pores are; the one called void, pore, lumen or air when not given"))
    ->type_name("PHASE");
  o->settings.declare(*app, "vtkPoreFloodFill", { "phase", "labels", "pore-size", "maximum-number-of-labels" });
  o->settings.formerly(*app, "order", "sort-by-size", "memory");
  pore(app->add_option("--threads", o->threads, "Threads of each process; 0: one for each core"))
    ->type_name("NUMBER")
    ->capture_default_str();
  app->add_option("-o,--output", o->output, "Write labels (.vti) or the table of the pores (.csv); twice for both")
    ->type_name("FILE")
    ->allow_extra_args(false)
    ->group("Output");
  app->add_option("--distribution", o->distribution, "Write how sizes are distributed")
    ->type_name("FILE.csv")
    ->group("Output");
  addResultOptions(*app, o->common);
  addExamples(*app,
    { "lamella pore-flood-fill tissue.png --phase 0=void --other solid --connectivity 4 --json",
      "lamella pore-flood-fill tissue.png --phase 0=lumen --other wall --minimum-size 10 -o pores.csv -o labels.vti",
      "lamella pore-flood-fill rock_200x200x200_u8.raw --phase 1=pore --other grain --connectivity 26",
      "mpirun -n 4 lamella pore-flood-fill rock_200x200x200_u8.raw --phase 1=pore --other grain --json",
      "lamella snapshot labels.vti --preset pores -o pores.png" });
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      poreFloodFill(session, *o, line);
    } };
}

} // namespace lamella::cli
