#include "Settings.h"
#include "commands/FilterRun.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "files/SampleFile.h"
#include "micrograph/MicrographFiles.h"
#include "micrograph/MicrographInput.h"
#include "micrograph/MicrographOverlay.h"
#include "micrograph/MicrographReport.h"
#include "program/Commands.h"
#include "session/Text.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "io/Provenance.h"
#include "vtkLatticeConversion.h"
#include "vtkMicrographLattice.h"
#include "vtkOutlineDiffusion.h"

#include <vtkNew.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace lamella::cli
{

namespace
{

class MicrographRun
{
public:
  MicrographRun(Session& session, const MicrographCommandOptions& options, std::string line)
    : session_(session)
    , options_(options)
    , line_(std::move(line))
    , outputs_(options)
  {
  }

  void operator()()
  {
    const auto start = Clock::now();
    prepare();
    step(0.02, "outlines");
    source_ = loadMicrograph(session_, options_.input);
    for (const std::string& warning : source_.warnings)
      warn(warning);
    if (const std::string doubt = pixelSizeDoubt(options_.input.settings().text("pixel-size")); !doubt.empty())
      warn(doubt);
    measure();
    step(0.3, "lattice");
    makeLattice();
    report_.latticeSeconds = secondsSince(start);
    if (solves())
      solve();
    step(0.9, "files");
    report_.provenance = recordRun(session_, line_, options_.input.picture.file, source_.provenance);
    write();
    session_.endProgress();
    outputs_.commit();
    report_.seconds = secondsSince(start);
    session_.print(options_.common.json ? toJson(report_) : options_.common.quiet ? "" : toTable(report_));
    if (const lbm::Shortfall& shortfall = report_.found.shortfall; !shortfall.message.empty())
      session_.fallShort(shortfall.message, shortfall.hint);
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
    report_.wallFraction = fieldNumbers(source_.outlines, "wall_fraction").at(0);
  }

  void makeLattice()
  {
    if (report_.measures.size() < 2 && !options_.settings.given("lamella"))
    {
      warn("there is one lumen only, and so no middle lamella");
      lattice_->SetLamella(vtkMicrographLattice::NONE);
      diffusion_->SetLamella(vtkOutlineDiffusion::NONE);
    }
    lattice_->SetInputData(source_.outlines);
    diffusion_->SetInputData(source_.outlines);
    if (source_.picture != nullptr)
    {
      lattice_->SetPictureData(source_.picture);
      diffusion_->SetPictureData(source_.picture);
    }
    runFilter(session_, lattice_, "lattice");
    for (const std::string& warning : VtkMessages::takeWarnings())
      warn(warning);
    vtkImageData* const image = lattice_->GetOutput();
    const auto number = [image](const char* name, std::size_t index = 0)
    { return fieldNumbers(image, name).at(index); };
    const PhaseView phases = viewPhases(image);
    report_.spacing = phases.lattice.spacing;
    report_.size = phases.lattice.size;
    report_.cropped = number("cropped");
    report_.wallFractionOnLattice = number("wall_fraction");
    report_.wallNodes = std::ranges::count_if(phases.phase, [](std::uint8_t p) { return p != 0; });
    report_.phases = phases.phases.names();
    report_.fractions = toPhaseImage(image).fractions();
    report_.thickness = { number("wall_thickness"), number("wall_thickness", 1) };
    if (lattice_->GetLamella() == vtkMicrographLattice::NONE)
      return;
    LamellaReport told;
    told.method = settingsAsJson(lattice_).at("lamella").get<std::string>();
    told.horizon = lattice_->GetHorizon();
    told.mean = number("lamella_nodes_across");
    told.low = number("lamella_nodes_across", 1);
    told.wallShare = number("lamella_share");
    if (lattice_->GetLamella() != vtkMicrographLattice::LABELS)
    {
      told.thickness = number("lamella_thickness");
      told.radius = number("lamella_radius");
      told.networks = std::llround(number("lamella_networks"));
      told.largestNetwork = number("lamella_largest_network");
      told.cells = std::llround(number("cells"));
      told.cellsTouched = std::llround(number("cells_touched"));
      told.cellsCutOff = std::llround(number("cells_cut_off"));
    }
    report_.lamella = told;
  }

  /// What can be said of the settings is said before the file is read.
  void prepare()
  {
    options_.settings.give(lattice_);
    options_.settings.give(diffusion_);
    if (!solves())
    {
      if (options_.settings.given("target-error"))
        throw ParameterError("--target-error without --conductivity", "say what lumen and wall conduct");
      return;
    }
    options_.settings.checkNames({ "lumen", "wall", "middle lamella" });
    diffusion_->RequireConductivities();
  }

  [[nodiscard]] bool solves() const { return options_.settings.given("conductivity"); }

  void solve()
  {
    runFilter(session_, diffusion_, "diffusion");
    report_.found = diffusion_->GetFindings();
    (void)VtkMessages::takeWarnings(); // the same, and the shortfall
    for (const std::string& warning : report_.found.warnings)
      warn(warning);
  }

  void write()
  {
    if (outputs_.lattice)
    {
      outputs_.lattice->write(lattice_->GetOutput(), report_.provenance);
      report_.written.push_back(options_.output);
      Session::checkInterrupt();
    }
    if (outputs_.contours)
    {
      writeContours(source_, *outputs_.contours, report_.provenance);
      report_.written.push_back(options_.contours);
      Session::checkInterrupt();
    }
    if (outputs_.overlay)
    {
      OverlayParts parts;
      parts.contours = &source_.contours;
      parts.scan = source_.scan ? &*source_.scan : nullptr;
      parts.lattice = lattice_->GetOutput();
      parts.lamella = report_.lamella.has_value();
      parts.wall = report_.thickness.median;
      std::int32_t most = 0;
      for (const auto& m : report_.measures)
        most = std::max(most, m.lumen);
      parts.vessel.assign(static_cast<std::size_t>(most), false);
      for (std::size_t i = 0; i < report_.measures.size(); ++i)
        parts.vessel[static_cast<std::size_t>(report_.measures[i].lumen - 1)] = report_.classes.vessel[i];
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
  Outputs outputs_;
  Micrograph source_;
  vtkNew<vtkMicrographLattice> lattice_;
  vtkNew<vtkOutlineDiffusion> diffusion_;
  Observer plan_{ diffusion_, vtkOutlineDiffusion::PLAN_EVENT,
    [this](void* words) { session_.note(static_cast<const char*>(words)); } };
  MicrographReport report_;
};

} // namespace

Command micrographCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "micrograph", "From a scan, labels or polygons to outlines, a lattice with wall directions, cells, middle lamella");
  auto o = std::make_shared<MicrographCommandOptions>();
  addMicrographInput(*app, o->input);
  o->settings.declare(*app, "vtkMicrographLattice", {}, { { "lamella", "growth" } });
  o->settings.declare(*app, "vtkOutlineDiffusion");
  addOutputOptions(*app, o->output, o->common,
    "Write the lattice: .vti (phase, grain, axis, lumen_share), or its phases: .png, .tif, .raw");
  addResultFile(*app, "--contours", o->contours, "Write the outlines: .vtp, .json or .json.gz", "FILE");
  addResultFile(
    *app, "--overlay", o->overlay, "Draw outlines, wall directions and lamella over the picture: .png", "FILE");
  addOption(*app, "Output", "--overlay-width", o->overlayWidth, "Width of that drawing; chosen to fit", "PIXELS");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella micrograph scan.jpg --pixel-size 0.44um -o tissue.vti --overlay look.png",
      "lamella micrograph labels.png --phase 0=lumen --other wall --spacing 0.25um --contours outlines.json.gz",
      "lamella micrograph spruce.json.gz --conductivity lumen=0.05 --conductivity wall=1 --json",
      "lamella micrograph scan.png --window 0,0,800,600 --lamella growth --lamella-thickness 1um --horizon 3 -o "
      "part.vti" });
  return aloneCommand(app, o,
    [](Session& session, const MicrographCommandOptions& options, const std::string& line)
    { MicrographRun(session, options, line)(); });
}

} // namespace lamella::cli
