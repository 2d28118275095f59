#include "commands/FilterRun.h"
#include "commands/SampleRun.h"
#include "commands/WindowReport.h"
#include "files/FieldReport.h"
#include "files/GridFile.h"
#include "files/Input.h"
#include "files/JsonReport.h"
#include "files/Record.h"
#include "files/ResultFiles.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "WindowFields.h"
#include "core/Clock.h"
#include "core/Memory.h"
#include "io/Provenance.h"
#include "lattice/AxisNames.h"
#include "lattice/PhaseNames.h"
#include "vtkLatticeConversion.h"
#include "vtkPoreFloodFill.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSMPTools.h>
#include <vtkTable.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

struct PoreReport
{
  std::string file;
  vtkPoreFloodFill* filter; ///< updated
  bool metres;              ///< the pixel size is known
  io::Provenance provenance;
  std::vector<std::string> written;
  int ranks = 1;
  double seconds = 0;
};

double cell(vtkTable* table, vtkIdType row, const std::string& column)
{
  return vtkDataArray::SafeDownCast(table->GetColumnByName(column.c_str()))->GetTuple1(row);
}

std::int64_t wholeCell(vtkTable* table, vtkIdType row, const std::string& column)
{
  return std::llround(cell(table, row, column));
}

vtkIdType largestOf(vtkTable* pores, const Fields& numbers)
{
  vtkIdType row = 0;
  while (wholeCell(pores, row, "size") != numbers.whole("pore_largest"))
    ++row;
  return row;
}

/// The box of a pore as --window takes it: of a picture from the top row. A box that goes on over a periodic side is
/// given as it is.
std::vector<std::int64_t> window(vtkTable* table, vtkIdType row, const Lattice& lattice)
{
  std::vector<std::int64_t> start;
  std::vector<std::int64_t> size;
  for (int axis = 0; axis < lattice.dimension; ++axis)
  {
    const std::string name = axisNames[static_cast<std::size_t>(axis)];
    const std::int64_t first = wholeCell(table, row, name + "_first");
    const std::int64_t last = wholeCell(table, row, name + "_last");
    const bool fromTop = lattice.dimension == 2 && axis == 1;
    start.push_back(fromTop ? lattice.size[1] - 1 - last : first);
    size.push_back(last - first + 1);
  }
  start.insert(start.end(), size.begin(), size.end());
  return start;
}

/// The sides that a pore touches, as people see them.
std::vector<std::string> sides(vtkTable* table, vtkIdType row, int dimension)
{
  static const std::array<std::pair<const char*, const char*>, 6> names{ { { "touches_x_min", "left" },
    { "touches_x_max", "right" }, { "touches_y_max", "top" }, { "touches_y_min", "bottom" },
    { "touches_z_min", "z_min" }, { "touches_z_max", "z_max" } } };
  std::vector<std::string> found;
  for (const auto& [column, word] : names)
    if (cell(table, row, column) != 0)
      found.push_back(dimension == 3 ? std::string(column).substr(8) : word);
  return found;
}

std::string toJson(const PoreReport& report)
{
  auto* const image = vtkImageData::SafeDownCast(report.filter->GetOutputDataObject(0));
  const Lattice lattice = latticeOf(image);
  const Fields f{ image, lattice.dimension };
  vtkTable* const pores = report.filter->GetPores();
  vtkTable* const classes = report.filter->GetSizeDistribution();
  using enum Key::Kind;
  Json json;
  json["file"] = report.file;
  addKeys(json, f, { { "phase", Text }, { "connectivity", Whole } }, "pore_");
  json["periodic"] = axesOf(f.numbers("pore_periodic"));
  json["size"] = std::vector<std::int64_t>(lattice.size.begin(), lattice.size.begin() + lattice.dimension);
  json["unit"] = lattice.dimension == 3 ? "voxels" : "pixels";
  json["pixel_size"] = report.metres ? Json(lattice.spacing) : Json(nullptr);
  addKeys(json, f, { { "count", Whole }, { "largest", Whole }, { "mean" }, { "total", Whole } }, "pore_");
  addKeys(json, f, { { "porosity" } });
  json["window_errors"] = windowsJson(windowFields(image));
  json["minimum_size"] = report.filter->GetMinimumSize();
  json["dropped"] = keysOf(f, { { "count", Whole, "dropped" }, { "total", Whole, "dropped", 1 } }, "pore_");
  json["open"] = keysOf(f, { { "count", Whole, "open_count" }, { "share", Number, "open" } }, "pore_");
  json["closed"] = { { "count", f.whole("pore_count") - f.whole("pore_open_count") }, { "share", f("pore_closed") } };
  json["percolates"] = axesOf(f.numbers("pore_percolates"));
  json["largest_pore"] = nullptr;
  if (pores->GetNumberOfRows() > 0)
  {
    const vtkIdType row = largestOf(pores, f);
    json["largest_pore"] = { { "pore", wholeCell(pores, row, "pore") }, { "size", wholeCell(pores, row, "size") },
      { "equivalent_diameter", report.metres ? Json(cell(pores, row, "equivalent_diameter")) : Json(nullptr) },
      { "window", window(pores, row, lattice) }, { "touches", sides(pores, row, lattice.dimension) } };
  }
  json["distribution"] = Json::array();
  for (vtkIdType row = 0; row < classes->GetNumberOfRows(); ++row)
  {
    json["distribution"].push_back(
      { { "from", wholeCell(classes, row, "size_from") }, { "to", wholeCell(classes, row, "size_to") },
        { "count", wholeCell(classes, row, "pores") }, { "total", wholeCell(classes, row, "nodes") } });
  }
  json["ranks"] = report.ranks;
  json["seconds"] = report.seconds;
  json["files"] = report.written;
  addRecord(json, report.provenance);
  return dump(json);
}

std::string toTable(const PoreReport& report)
{
  auto* const image = vtkImageData::SafeDownCast(report.filter->GetOutputDataObject(0));
  const Lattice lattice = latticeOf(image);
  const Fields number{ image, lattice.dimension };
  vtkTable* const pores = report.filter->GetPores();
  const std::string unit = lattice.dimension == 3 ? "voxels" : "pixels";
  const std::string kind = lattice.dimension == 3 ? "volume" : "picture";
  const auto line = [](const std::string& name, const std::string& text)
  { return fmt::format("  {:<11}{}\n", name, text); };
  std::string text = fmt::format("{}: pores of {}, {} neighbours, {}\n\n", report.file, number.text("pore_phase"),
    number.whole("pore_connectivity"), sizeText(lattice.size, lattice.dimension));
  text += line("pores", grouped(number.whole("pore_count")));
  text += line("total",
    fmt::format(
      "{} {}; porosity {:.4f} of the {}", grouped(number.whole("pore_total")), unit, number("porosity"), kind));
  text += line("mean", fmt::format("{:.1f} {}", number("pore_mean"), unit));
  if (pores->GetNumberOfRows() > 0)
  {
    const vtkIdType row = largestOf(pores, number);
    std::string largest = fmt::format("{} {}", grouped(number.whole("pore_largest")), unit);
    if (report.metres)
    {
      largest += fmt::format(", {} of {:.4g} µm", lattice.dimension == 3 ? "a sphere" : "a circle",
        1e6 * cell(pores, row, "equivalent_diameter"));
    }
    text += line("largest", largest + ", window " + fmt::format("{}", fmt::join(window(pores, row, lattice), ",")));
  }
  if (number("pore_dropped") > 0)
  {
    text += line("left out",
      fmt::format("{} pores below {} {}, {} {} in all", grouped(number.whole("pore_dropped")),
        report.filter->GetMinimumSize(), unit, grouped(number.whole("pore_dropped", 1)), unit));
  }
  text += line("open",
    fmt::format("{} pores, {:.1f} % of the total; they touch a border", grouped(number.whole("pore_open_count")),
      100 * number("pore_open")));
  const std::vector<std::string> through = axesOf(number.numbers("pore_percolates"));
  text += line("percolates",
    through.empty() ? "no pore leads from side to side" : fmt::format("along {}", fmt::join(through, ", ")));
  if (const auto windows = windowFields(image); !windows.empty())
  {
    text += windowHeading;
    const std::string per = lattice.dimension == 3 ? "mm³" : "mm²";
    for (const statistics::WindowError& window : windows)
    {
      if (window.name == "pore_density")
        text += report.metres ? windowText("pores ", window, " per " + per, lattice.dimension == 3 ? 1e-9 : 1e-6) : "";
      else
        text += windowText(
          window.name == "pore_mean" ? "mean " : "porosity ", window, window.name == "pore_mean" ? " " + unit : "", 1);
    }
  }
  text += wroteText(report.written);
  return text;
}

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

ResultFiles openFiles(const PoreFloodFillOptions& options, vtkPoreFloodFill* filter)
{
  ResultFiles files;
  const bool overwrite = options.common.overwrite;
  for (const std::string& name : options.output)
  {
    const std::string ending = std::filesystem::path(name).extension().string();
    if (ending == ".vti")
    {
      files.addGrid("-o", name, ending, filter->GetOutputDataObject(0), overwrite);
    }
    else if (ending == ".csv")
    {
      files.addTable("-o", name, filter->GetPores(), overwrite);
    }
    else
    {
      throw ParameterError("-o '" + name + "': labels are written as .vti, the table of the pores as .csv",
        "end the name in one of these; -o can be given twice");
    }
  }
  files.addTable("--distribution", options.distribution, filter->GetSizeDistribution(), overwrite);
  return files;
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
  ResultFiles files;
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
      files = openFiles(options, filter);
      // compressed; the whole is nine bytes a node
      files.needGrids(static_cast<std::uint64_t>(sample.image.lattice.count()));
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
      (void)files.write(io::toJson(record), report.metres);
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
  addOption(*app, "Pores", "--fill", o->fill,
    "The phase that the pores are; the one called void, pore, lumen or air when not given", "PHASE");
  o->settings.declare(*app, "vtkPoreFloodFill", { "phase", "labels", "pore-size", "maximum-number-of-labels" });
  o->settings.formerly(*app, "order", "sort-by-size", "memory");
  addOption(*app, "Pores", "--threads", o->threads, "Threads of each process; 0: one for each core", "NUMBER")
    ->capture_default_str();
  addOption(*app, "Output", "-o,--output", o->output,
    "Write labels (.vti) or the table of the pores (.csv); twice for both", "FILE")
    ->allow_extra_args(false);
  addResultFile(*app, "--distribution", o->distribution, "Write how sizes are distributed");
  addResultOptions(*app, o->common);
  addExamples(*app,
    { "lamella pore-flood-fill tissue.png --phase 0=void --other solid --connectivity 4 --json",
      "lamella pore-flood-fill tissue.png --phase 0=lumen --other wall --minimum-size 10 -o pores.csv -o labels.vti",
      "lamella pore-flood-fill rock_200x200x200_u8.raw --phase 1=pore --other grain --connectivity 26",
      "mpirun -n 4 lamella pore-flood-fill rock_200x200x200_u8.raw --phase 1=pore --other grain --json",
      "lamella snapshot labels.vti --preset pores -o pores.png" });
  return jointCommand(app, o, poreFloodFill);
}

} // namespace lamella::cli
