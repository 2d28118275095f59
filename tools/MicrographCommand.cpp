#include "Commands.h"
#include "FilterRun.h"
#include "GridFile.h"
#include "MicrographFiles.h"
#include "MicrographInput.h"
#include "MicrographLabels.h"
#include "MicrographOverlay.h"
#include "MicrographPlan.h"
#include "MicrographReport.h"
#include "Record.h"
#include "SampleFile.h"
#include "Text.h"

#include "io/Provenance.h"
#include "lattice/Clock.h"
#include "lattice/Error.h"
#include "lattice/Memory.h"
#include "micrograph/LabelledLamella.h"
#include "micrograph/MiddleLamella.h"
#include "micrograph/WallDirection.h"
#include "micrograph/WallThickness.h"
#include "vtkOutlineDiffusion.h"

#include <vtkCallbackCommand.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace lamella::cli
{

namespace
{

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
    prepareDiffusion();
    step(0.02, "outlines");
    source_ = loadMicrograph(session_, options_.input);
    for (const std::string& warning : source_.warnings)
    {
      warn(warning);
    }
    if (const std::string doubt = pixelSizeDoubt(options_.input.picture.pixelSize); !doubt.empty())
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
    report_.latticeSeconds = secondsSince(start);
    if (diffusion_ != nullptr)
    {
      solve();
    }
    step(0.9, "files");
    report_.provenance = recordRun(session_, line_, options_.input.picture.file, source_.provenance);
    write();
    session_.endProgress();
    outputs_.commit();
    report_.seconds = secondsSince(start);
    session_.print(options_.common.json ? toJson(report_) : options_.common.quiet ? "" : toTable(report_));
    if (const lbm::Shortfall& shortfall = report_.found.shortfall; !shortfall.message.empty())
    {
      session_.fallShort(shortfall.message, shortfall.hint);
    }
  }

private:
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
    report_.cells = lookLikeCells(source_, report_.measures);
    report_.wallFraction = micrograph::wallFraction(source_.contours);
    report_.thickness = micrograph::wallThickness(source_.contours);
  }

  micrograph::ContourLattice latticeOf(double spacing) const
  {
    micrograph::ContourLatticeOptions make;
    make.spacing = spacing;
    make.lines = 0;
    return micrograph::contourLattice(source_.contours, make);
  }

  void makeLattice()
  {
    const double spacing = spacingOf(plan_, source_, report_.thickness);
    requireMemory(source_.contours, spacing, !options_.output.empty());
    made_.lattice = latticeOf(spacing);
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
      made_.phases = micrograph::labelledLamella(made_.lattice, *source_.labels, labelled_);
      const auto across = micrograph::nodesAcross(made_.lattice, made_.directions, made_.phases.phase);
      told.mean = across.mean;
      told.low = across.low;
      told.wallShare = micrograph::lamellaShare(made_.phases);
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

  /// What can be said of the settings is said before the file is read.
  void prepareDiffusion()
  {
    if (!options_.diffusion.given("conductivity"))
    {
      return;
    }
    options_.diffusion.checkNames({ "lumen", "wall", "middle lamella" });
    diffusion_ = vtkSmartPointer<vtkOutlineDiffusion>::New();
    options_.diffusion.give(diffusion_);
    const std::vector<std::string> types{ "none", "growth", "constant", "labels" }; // as the class numbers them
    diffusion_->SetLamella(static_cast<int>(std::find(types.begin(), types.end(), plan_.lamella) - types.begin()));
    diffusion_->SetLamellaThickness(plan_.how.thickness.value_or(0));
    diffusion_->SetLamellaRadius(plan_.how.radius.value_or(-1));
    diffusion_->SetLamellaPhase(options_.lamellaPhase);
    diffusion_->RequireConductivities();
    plan_event_->SetClientData(&session_);
    plan_event_->SetCallback([](vtkObject*, unsigned long, void* to, void* words)
      { static_cast<Session*>(to)->note(static_cast<const char*>(words)); });
    diffusion_->AddObserver(vtkOutlineDiffusion::PLAN_EVENT, plan_event_);
  }

  void solve()
  {
    if (plan_.lamella == "none")
    {
      diffusion_->SetLamella(vtkOutlineDiffusion::NONE);
    }
    diffusion_->SetInputData(source_.outlines);
    if (source_.picture != nullptr)
    {
      diffusion_->SetPictureData(source_.picture);
    }
    diffusion_->SetSpacing(spacingOf(plan_, source_, report_.thickness));
    runFilter(session_, diffusion_, "diffusion");
    report_.found = diffusion_->GetFindings();
    (void)VtkMessages::takeWarnings(); // the same, and the shortfall
    for (const std::string& warning : report_.found.warnings)
    {
      warn(warning);
    }
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
      parts.cells = report_.cells;
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
  vtkSmartPointer<vtkOutlineDiffusion> diffusion_; ///< null: nothing is solved
  vtkNew<vtkCallbackCommand> plan_event_;
  MicrographReport report_;
};

void micrographRun(Session& session, const MicrographCommandOptions& options, const std::string& commandLine)
{
  Run(session, options, commandLine)();
}

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
  o->diffusion.declare(
    *app, "vtkOutlineDiffusion", { "spacing", "lamella", "lamella-thickness", "lamella-radius", "lamella-phase" });
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
  return aloneCommand(app, o, micrographRun);
}

} // namespace lamella::cli
