#include "Commands.h"
#include "GridFile.h"
#include "MicrographDiffusion.h"
#include "MicrographInput.h"
#include "MicrographOverlay.h"
#include "MicrographReport.h"
#include "OutputFile.h"
#include "Record.h"
#include "SampleFile.h"
#include "Text.h"

#include "ContourData.h"
#include "io/Provenance.h"
#include "lattice/Error.h"
#include "lattice/Memory.h"
#include "micrograph/MiddleLamella.h"
#include "micrograph/PolygonFile.h"
#include "micrograph/WallDirection.h"
#include "micrograph/WallThickness.h"
#include "vtkLatticeConversion.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

struct MicrographCommandOptions
{
  CommonOptions common;
  MicrographOptions input;
  std::string spacing;
  std::string lamella = "growth";
  std::string thickness;
  std::string radius;
  std::string lamellaPhase;
  double horizon = 0;
  std::vector<std::string> conductivity;
  std::string direction = "all";
  int threads = 1;
  std::string output;
  std::string contours;
  std::string overlay;
  int overlayWidth = 0;
  CLI::Option* lamellaOption = nullptr;
};

const std::vector<std::string> lamellaWords{ "growth", "constant", "labels", "none" };
const std::vector<std::string> directionWords{ "x", "y", "all" };
constexpr const char* creator = "lamella micrograph";

/// What can be said without the file, in numbers.
struct Plan
{
  std::string lamella;
  micrograph::LamellaOptions how;
  std::optional<double> spacing;
  std::optional<Conductivities> conductivities;
  std::vector<int> axes;
};

Plan planOf(const MicrographCommandOptions& o)
{
  Plan plan;
  plan.lamella = lamellaWords[oneOf("--lamella", o.lamella, lamellaWords)];
  plan.how.method =
    plan.lamella == "constant" ? micrograph::LamellaMethod::Constant : micrograph::LamellaMethod::Growth;
  const bool made = plan.lamella == "growth" || plan.lamella == "constant";
  if (!o.thickness.empty())
  {
    plan.how.thickness = lengthInMetres("--lamella-thickness", o.thickness);
  }
  if (!o.radius.empty())
  {
    plan.how.radius = toNumber(o.radius) == 0.0 ? 0.0 : lengthInMetres("--lamella-radius", o.radius);
  }
  if ((plan.how.thickness && !made) || (plan.how.radius && plan.lamella != "growth"))
  {
    throw ParameterError(
      fmt::format("--lamella-{} with --lamella {}", plan.how.thickness && !made ? "thickness" : "radius", plan.lamella),
      plan.how.thickness && !made ? "it is for growth and constant" : "it is for growth");
  }
  if (!o.lamellaPhase.empty() && plan.lamella != "labels")
  {
    throw ParameterError("--lamella-phase with --lamella " + plan.lamella, "it is for --lamella labels");
  }
  if (!(o.horizon >= 0) || !std::isfinite(o.horizon))
  {
    throw ParameterError(fmt::format("--horizon {:g} is below 0", o.horizon), "give a number of nodes, such as 3");
  }
  plan.how.horizon = o.horizon;
  if (!o.spacing.empty())
  {
    plan.spacing = lengthInMetres("--spacing", o.spacing);
  }
  const std::size_t direction = oneOf("--direction", o.direction, directionWords);
  plan.axes = direction == 2 ? std::vector<int>{ 0, 1 } : std::vector<int>{ static_cast<int>(direction) };
  if (!o.conductivity.empty())
  {
    plan.conductivities = parseConductivities(o.conductivity, plan.lamella != "none");
  }
  if (o.threads < 1 || o.threads > 1024)
  {
    throw ParameterError(
      fmt::format("--threads {} is outside 1 to 1024", o.threads), "give the number of cores to use");
  }
  if (o.overlayWidth != 0 && (o.overlayWidth < 100 || o.overlayWidth > 20000))
  {
    throw ParameterError(
      fmt::format("--overlay-width {} is outside 100 to 20000", o.overlayWidth), "leave it out to have it chosen");
  }
  return plan;
}

std::string endingOf(const std::string& path)
{
  const std::filesystem::path name(path);
  const std::string last = name.extension().string();
  return last == ".gz" ? name.stem().extension().string() + last : last;
}

/// The files, which are refused at once where they cannot be written.
struct Outputs
{
  std::optional<OutputFile> lattice, beside, contours, overlay;

  explicit Outputs(const MicrographCommandOptions& o)
  {
    if (!o.output.empty())
    {
      checkSampleEnding(o.output, 2);
    }
    if (!o.contours.empty())
    {
      const std::vector<std::string> known{ ".vtp", ".json", ".json.gz" };
      if (std::find(known.begin(), known.end(), endingOf(o.contours)) == known.end())
      {
        throw ParameterError("--contours '" + o.contours + "' has no ending that can be written",
          suggestion(endingOf(o.contours), known, "end it in .vtp, .json or .json.gz"));
      }
    }
    if (!o.overlay.empty() && endingOf(o.overlay) != ".png")
    {
      throw ParameterError("--overlay '" + o.overlay + "' has no ending that can be written", "end it in .png");
    }
    std::vector<std::string> names;
    for (const std::string& name : { o.output, o.contours, o.overlay })
    {
      if (!name.empty() && std::find(names.begin(), names.end(), name) != names.end())
      {
        throw ParameterError("'" + name + "' is to be written twice", "give every output a name of its own");
      }
      names.push_back(name);
    }
    const auto open = [&](std::optional<OutputFile>& file, const std::string& name)
    {
      if (!name.empty())
      {
        file.emplace(name, o.common.overwrite);
      }
    };
    open(lattice, o.output);
    if (lattice && lattice->path().extension() == ".raw")
    {
      beside.emplace(recordBeside(lattice->path()), o.common.overwrite);
    }
    open(contours, o.contours);
    open(overlay, o.overlay);
  }

  void commit()
  {
    for (auto* const file : { &lattice, &beside, &contours, &overlay })
    {
      if (*file)
      {
        (*file)->commit();
      }
    }
  }
};

/// All that lives on the lattice's nodes.
struct OnLattice
{
  micrograph::ContourLattice lattice;
  micrograph::WallDirections directions;
  PhaseImage phases; ///< void, secondary wall, middle lamella; or lumen and wall
};

void requireMemory(const micrograph::ContourSet& contours, double spacing, bool written)
{
  const Lattice lattice = micrograph::latticeOf(contours.size, spacing);
  const auto nodes = static_cast<double>(lattice.count());
  // Shares, grain and phases; directions; lamella; and what a .vti takes beside them.
  const double bytes = nodes * (17 + 28 + 20 + (written ? 42 : 0));
  if (const auto available = static_cast<double>(availableMemory()); bytes > available)
  {
    throw MemoryError(fmt::format("{} nodes of {:.4g} µm take about {}, and {} are free", sizeText(lattice.size, 2),
                        1e6 * lattice.spacing, bytesText(bytes), bytesText(available)),
      "take a larger --spacing or a part of the picture with --window");
  }
}

/// The lamella's phase among a picture's labels. @throws ParameterError, InputError
std::uint8_t labelledLamella(const MicrographCommandOptions& o, const PhaseTable& phases)
{
  if (!o.lamellaPhase.empty())
  {
    if (const auto id = phases.find(o.lamellaPhase))
    {
      return *id;
    }
    throw ParameterError("--lamella-phase '" + o.lamellaPhase + "' is no phase of this picture",
      suggestion(o.lamellaPhase, phases.names(), "its phases are " + quotedList(phases.names(), "and")));
  }
  for (const char* const name : { "middle lamella", "lamella" })
  {
    if (const auto id = phases.find(name))
    {
      return *id;
    }
  }
  throw InputError(
    "which phase is the middle lamella? '" + o.input.picture.file + "' has " + quotedList(phases.names(), "and"),
    "add --lamella-phase NAME, or choose --lamella growth");
}

/// Wall nodes that lie in a pixel labelled lamella become that.
PhaseImage fromLabels(const micrograph::ContourLattice& lattice, const PhaseImage& labels, std::uint8_t lamella)
{
  PhaseImage image = lattice.image;
  image.phases = PhaseTable({ "void", "secondary wall", "middle lamella" });
  const Lattice& to = image.lattice;
  const Lattice& from = labels.lattice;
  const auto pixel = [&](std::int64_t i, int axis)
  {
    const double at = (static_cast<double>(i) + 0.5) * to.spacing / from.spacing;
    return std::min(static_cast<std::int64_t>(at), from.size[static_cast<std::size_t>(axis)] - 1);
  };
  for (std::int64_t y = 0; y < to.size[1]; ++y)
  {
    for (std::int64_t x = 0; x < to.size[0]; ++x)
    {
      auto& phase = image.phase[static_cast<std::size_t>(to.index(x, y))];
      if (phase != 0 && labels.phase[static_cast<std::size_t>(from.index(pixel(x, 0), pixel(y, 1)))] == lamella)
      {
        phase = 2;
      }
    }
  }
  return image;
}

double lamellaShare(const PhaseImage& image)
{
  const auto wall = std::count_if(image.phase.begin(), image.phase.end(), [](std::uint8_t p) { return p != 0; });
  const auto lamella = std::count(image.phase.begin(), image.phase.end(), std::uint8_t{ 2 });
  return wall > 0 ? static_cast<double>(lamella) / static_cast<double>(wall) : 0;
}

void writeLattice(const OnLattice& made, const Micrograph& source, Outputs& outputs, const io::Provenance& record)
{
  if (outputs.lattice->path().extension() != ".vti")
  {
    writeLabels(made.phases, *outputs.lattice, outputs.beside ? &*outputs.beside : nullptr, record);
    return;
  }
  const auto image = toImageData(made.phases);
  const auto count = static_cast<vtkIdType>(made.phases.phase.size());
  const auto grain = vtkSmartPointer<vtkIntArray>::New();
  grain->SetName("grain");
  grain->SetNumberOfTuples(count);
  std::copy(made.directions.grain.begin(), made.directions.grain.end(), grain->GetPointer(0));
  describe(grain, "1", "cell: number of the nearest lumen, from 1", creator);
  const auto share = vtkSmartPointer<vtkFloatArray>::New();
  share->SetName("lumen_share");
  share->SetNumberOfTuples(count);
  std::copy(made.lattice.lumenShare.begin(), made.lattice.lumenShare.end(), share->GetPointer(0));
  describe(share, "1", "share of the node's pixel that is lumen", creator);
  const auto axis = vtkSmartPointer<vtkFloatArray>::New();
  axis->SetName("axis");
  axis->SetNumberOfComponents(3);
  axis->SetNumberOfTuples(count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const auto& a = made.directions.axis[static_cast<std::size_t>(i)];
    const std::array<float, 3> v{ a[0], a[1], 0 };
    axis->SetTypedTuple(i, v.data());
  }
  describe(axis, "1", "unit vector along the wall, its sign means nothing; 0 in lumens", creator);
  vtkPointData* const data = image->GetPointData();
  data->AddArray(grain);
  data->AddArray(axis);
  data->AddArray(share);
  setFieldText(
    image, "pixel_size_source", source.kind == MicrographKind::Polygons ? "polygons" : source.pixelSizeSource);
  setProvenance(image, io::toJson(record));
  writeGrid(image, *outputs.lattice);
}

void writeContours(const micrograph::ContourSet& contours, const OutputFile& file, const io::Provenance& record)
{
  if (file.path().extension() == ".vtp")
  {
    const auto data = toPolyData(contours, creator);
    setProvenance(data, io::toJson(record));
    writeGrid(data, file);
    return;
  }
  try
  {
    micrograph::writePolygons(contours, file.temporary());
  }
  catch (const Error& error)
  {
    file.rethrow(error);
    throw;
  }
}

/// The spacing of the lattice: that asked for, else the pixel, else a quarter of the walls.
double spacingOf(const Plan& plan, const Micrograph& source, const micrograph::WallThickness& thickness)
{
  if (plan.spacing)
  {
    return *plan.spacing;
  }
  if (source.pixel > 0)
  {
    return source.pixel;
  }
  if (!(thickness.median > 0))
  {
    throw ParameterError("there is one lumen only, whose walls have no thickness to choose a spacing by",
      "give the spacing of the lattice: --spacing 0.5um");
  }
  return thickness.median / 4;
}

class Run
{
public:
  Run(Session& session, const MicrographCommandOptions& options, std::string line)
    : session_(session)
    , options_(options)
    , line_(std::move(line))
    , plan_(planOf(options))
    , outputs_(options)
  {
  }

  void operator()()
  {
    const auto start = Clock::now();
    step(0.02, "outlines");
    source_ = loadMicrograph(options_.input);
    for (const std::string& warning : source_.warnings)
    {
      warn(warning);
    }
    const bool given = source_.pixelSizeSource == "option";
    if (const std::string doubt = given ? pixelSizeDoubt("--pixel-size", source_.pixel) : ""; !doubt.empty())
    {
      warn(doubt);
    }
    if (plan_.lamella == "labels")
    {
      if (!source_.labels)
      {
        throw ParameterError("--lamella labels needs labels, and '" + options_.input.picture.file + "' has none",
          "choose --lamella growth");
      }
      labelled_ = labelledLamella(options_, source_.labels->phases);
    }
    measure();
    step(0.3, "lattice");
    makeLattice();
    report_.latticeSeconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (plan_.conductivities)
    {
      solve();
    }
    step(0.9, "files");
    report_.provenance = recordRun(line_, options_.input.picture.file, source_.provenance);
    write();
    session_.endProgress();
    outputs_.commit();
    report_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    session_.print(options_.common.json ? toJson(report_) : options_.common.quiet ? "" : toTable(report_));
  }

private:
  using Clock = std::chrono::steady_clock;

  void step(double share, const char* what)
  {
    (void)session_.progress(share, what);
    Session::checkInterrupt();
  }

  void warn(const std::string& text)
  {
    report_.warnings.push_back(text);
    session_.warn(text);
  }

  void measure()
  {
    report_.file = options_.input.picture.file;
    report_.micrograph = &source_;
    report_.measures = micrograph::measureLumens(source_.contours);
    report_.classes = classify(report_.measures);
    report_.wallFraction = micrograph::wallFraction(source_.contours);
    report_.thickness = micrograph::wallThickness(source_.contours);
  }

  micrograph::ContourLattice latticeOf(double spacing, int multiple) const
  {
    micrograph::ContourLatticeOptions make;
    make.spacing = spacing;
    make.multiple = multiple;
    make.lines = 0;
    return micrograph::contourLattice(source_.contours, make);
  }

  void makeLattice()
  {
    const double spacing = spacingOf(plan_, source_, report_.thickness);
    requireMemory(source_.contours, spacing, !options_.output.empty());
    made_.lattice = latticeOf(spacing, 1);
    for (const std::string& warning : made_.lattice.warnings)
    {
      warn(warning);
    }
    Session::checkInterrupt();
    made_.directions = micrograph::wallDirections(source_.contours, made_.lattice);
    Session::checkInterrupt();
    const Lattice& lattice = made_.lattice.image.lattice;
    report_.spacing = lattice.spacing;
    report_.size = lattice.size;
    report_.cropped = made_.lattice.cropped;
    report_.wallFractionOnLattice = 1 - made_.lattice.lumenFraction;
    const auto& phase = made_.lattice.image.phase;
    report_.wallNodes = std::count_if(phase.begin(), phase.end(), [](std::uint8_t p) { return p != 0; });
    makeLamella();
    report_.phases = made_.phases.phases.names();
    report_.fractions = made_.phases.fractions();
    Session::checkInterrupt();
  }

  void makeLamella()
  {
    const bool alone = report_.measures.size() < 2;
    if (alone && plan_.lamella != "none" && options_.lamellaOption->count() == 0)
    {
      warn("there is one lumen only, and so no middle lamella");
      plan_.lamella = "none";
    }
    LamellaReport told;
    told.method = plan_.lamella;
    told.horizon = plan_.how.horizon;
    if (plan_.lamella == "none")
    {
      made_.phases = made_.lattice.image;
      return;
    }
    if (plan_.lamella == "labels")
    {
      made_.phases = fromLabels(made_.lattice, *source_.labels, labelled_);
      const auto across = micrograph::nodesAcross(made_.lattice, made_.directions, made_.phases.phase);
      told.mean = across.mean;
      told.low = across.low;
      told.wallShare = lamellaShare(made_.phases);
      if (plan_.how.horizon > 0 && across.mean < plan_.how.horizon)
      {
        warn(fmt::format("the middle lamella is {:.2g} nodes thick, thinner than the horizon of {:g}", across.mean,
          plan_.how.horizon));
      }
    }
    else
    {
      micrograph::MiddleLamella found = micrograph::middleLamella(made_.lattice, made_.directions, plan_.how);
      for (const std::string& warning : found.warnings)
      {
        warn(warning);
      }
      told.thickness = found.thickness;
      told.radius = found.radius;
      told.mean = found.across.mean;
      told.low = found.across.low;
      told.wallShare = found.wallShare;
      told.networks = found.networks;
      told.largestNetwork = found.largestNetwork;
      told.cells = found.cells;
      told.cellsTouched = found.cellsTouched;
      told.cellsCutOff = found.cellsCutOff;
      made_.phases = std::move(found.image);
    }
    report_.lamella = told;
  }

  /// The lamella on one of the solver's lattices.
  void givePhases(micrograph::ContourLattice& lattice) const
  {
    const std::int64_t nx = lattice.image.lattice.size[0];
    micrograph::ContourLattice own = latticeOf(lattice.image.lattice.spacing, nx % 2 == 0 ? 2 : 1);
    if (own.image.lattice.size != lattice.image.lattice.size)
    {
      own = latticeOf(lattice.image.lattice.spacing, 1);
    }
    if (plan_.lamella == "labels")
    {
      lattice.image = fromLabels(own, *source_.labels, labelled_);
      return;
    }
    micrograph::LamellaOptions how = plan_.how;
    how.thickness = report_.lamella->thickness;
    how.radius = report_.lamella->radius;
    const auto directions = micrograph::wallDirections(source_.contours, own);
    lattice.image = micrograph::middleLamella(own, directions, how).image;
    Session::checkInterrupt();
  }

  void solve()
  {
    if (plan_.lamella == "none" && plan_.conductivities->values.size() > 2)
    {
      throw ParameterError("--conductivity of a lamella, and this picture has none", "leave it out");
    }
    report_.conductivity = plan_.conductivities->named;
    report_.answers = solveMicrograph(session_, source_.contours, *plan_.conductivities, *report_.spacing, plan_.axes,
      options_.threads, [this](micrograph::ContourLattice& lattice) { givePhases(lattice); });
  }

  void write()
  {
    if (outputs_.lattice)
    {
      writeLattice(made_, source_, outputs_, report_.provenance);
      report_.written.push_back(options_.output);
      Session::checkInterrupt();
    }
    if (outputs_.contours)
    {
      writeContours(source_.contours, *outputs_.contours, report_.provenance);
      report_.written.push_back(options_.contours);
      Session::checkInterrupt();
    }
    if (outputs_.overlay)
    {
      OverlayParts parts;
      parts.contours = &source_.contours;
      parts.scan = source_.scan ? &*source_.scan : nullptr;
      parts.lattice = &made_.lattice;
      parts.directions = &made_.directions;
      parts.phase = report_.lamella ? &made_.phases.phase : nullptr;
      std::int32_t most = 0;
      for (const auto& m : report_.measures)
      {
        most = std::max(most, m.lumen);
      }
      parts.vessel.assign(static_cast<std::size_t>(most), false);
      for (std::size_t i = 0; i < report_.measures.size(); ++i)
      {
        parts.vessel[static_cast<std::size_t>(report_.measures[i].lumen - 1)] = report_.classes.vessel[i];
      }
      parts.marks = source_.marks;
      parts.pixel = source_.pixel;
      parts.width = options_.overlayWidth;
      writeScan(drawOverlay(parts), *outputs_.overlay, report_.provenance);
      report_.written.push_back(options_.overlay);
      Session::checkInterrupt();
    }
  }

  Session& session_;
  const MicrographCommandOptions& options_;
  std::string line_;
  Plan plan_;
  Outputs outputs_;
  Micrograph source_;
  OnLattice made_;
  std::uint8_t labelled_ = 0;
  MicrographReport report_;
};

} // namespace

Command micrographCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "micrograph", "From a scan, labels or polygons to outlines, a lattice with wall directions, cells, middle lamella");
  auto o = std::make_shared<MicrographCommandOptions>();
  addMicrographInput(*app, o->input);
  const auto in = [](const char* group, const char* type, CLI::Option* option)
  { return option->type_name(type)->group(group); };
  in("Lattice", "LENGTH",
    app->add_option(
      "--spacing", o->spacing, "Distance of nodes, as 0.25um; the pixel, of polygons a quarter of a wall"));
  o->lamellaOption = in("Lattice", "growth|constant|labels|none",
    app->add_option("--lamella", o->lamella, "How the middle lamella is found")->capture_default_str());
  in("Lattice", "LENGTH",
    app->add_option("--lamella-thickness", o->thickness,
      "Gap that growing outlines keep, or the constant thickness; 0.5um, or an eighth of a wall where that is less"));
  in("Lattice", "LENGTH",
    app->add_option(
      "--lamella-radius", o->radius, "Growth stops where outlines bend that sharply; a quarter of a wall"));
  in("Lattice", "NAME",
    app->add_option(
      "--lamella-phase", o->lamellaPhase, "With labels: the lamella's; else 'middle lamella', 'lamella'"));
  in("Lattice", "NODES",
    app->add_option("--horizon", o->horizon, "Nodes that a solver wants across the lamella; fewer are warned of"));
  in("Diffusion", "NAME=VALUE",
    app
      ->add_option(
        "--conductivity", o->conductivity, "Of lumen, wall and lamella: solves, at the spacing and at twice it")
      ->allow_extra_args(false));
  in("Diffusion", "x|y|all",
    app->add_option("--direction", o->direction, "Across the picture, down it, or both")->capture_default_str());
  in("Diffusion", "NUMBER", app->add_option("--threads", o->threads, "Threads of the solver")->capture_default_str());
  addOutputOptions(*app, o->output, o->common,
    "Write the lattice: .vti (phase, grain, axis, lumen_share), or its phases: .png, .tif, .raw");
  in("Output", "FILE", app->add_option("--contours", o->contours, "Write the outlines: .vtp, .json or .json.gz"));
  in("Output", "FILE",
    app->add_option("--overlay", o->overlay, "Draw outlines, wall directions and lamella over the picture: .png"));
  in("Output", "PIXELS", app->add_option("--overlay-width", o->overlayWidth, "Width of that drawing; chosen to fit"));
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella micrograph scan.jpg --pixel-size 0.44um -o tissue.vti --overlay look.png",
      "lamella micrograph labels.png --phase 0=lumen --other wall --spacing 0.25um --contours outlines.json.gz",
      "lamella micrograph spruce.json.gz --conductivity lumen=0.05 --conductivity wall=1 --json",
      "lamella micrograph scan.png --window 0,0,800,600 --lamella growth --lamella-thickness 1um --horizon 3 -o "
      "part.vti" });
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      session.onRoot([&] { Run(session, *o, line)(); });
    } };
}

} // namespace lamella::cli
