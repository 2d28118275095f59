#include "Commands.h"
#include "DiffusionConductivity.h"
#include "DiffusionFields.h"
#include "DiffusionReport.h"
#include "DiffusionRun.h"
#include "Input.h"
#include "OutputFile.h"
#include "Record.h"
#include "Text.h"

#include "lattice/Clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace lamella::cli
{

namespace
{

struct DiffusionOptions
{
  CommonOptions common;
  PictureOptions picture;
  std::vector<std::string> conductivity;
  std::string direction = "all";
  std::string sides = "insulated";
  std::string lattice;
  std::string method = "auto";
  std::string quantity = "temperature";
  std::string output;
  int refine = 1;
  double tolerance = 1e-8;
  int maxIterations = 500;
  int threads = 1;
  std::string targetError;
  bool noErrorEstimate = false;
};

const std::vector<std::string> directions{ "x", "y", "z", "all" };
const std::vector<std::string> sidesWords{ "insulated", "periodic" };
const std::vector<std::string> lattices{ "d2q5", "d2q9", "d3q7", "d3q19" };
const std::vector<std::string> methods{ "auto", "multigrid", "algebraic-multigrid" };
const std::vector<std::string> quantities{ "temperature", "concentration" };

/// What can be said without the picture. @throws ParameterError
lbm::StudyOptions parseStudy(const DiffusionOptions& options)
{
  lbm::StudyOptions study;
  study.steady.sides = static_cast<lbm::Sides>(oneOf("--sides", options.sides, sidesWords));
  study.steady.method = static_cast<lbm::Method>(oneOf("--method", options.method, methods));
  if (!options.lattice.empty())
  {
    study.steady.stencil = static_cast<lbm::Stencil>(oneOf("--lattice", options.lattice, lattices));
  }
  (void)oneOf("--direction", options.direction, directions);
  (void)oneOf("--quantity", options.quantity, quantities);
  if (!(options.tolerance > 0 && options.tolerance < 1))
  {
    throw ParameterError(fmt::format("--tolerance {:g} is not between 0 and 1", options.tolerance),
      "it is the largest relative error of the flux through either face, such as 1e-8");
  }
  study.steady.tolerance = options.tolerance;
  if (options.maxIterations < 1)
  {
    throw ParameterError(fmt::format("--max-iterations {} is below 1", options.maxIterations), "allow at least 1");
  }
  study.steady.maxIterations = options.maxIterations;
  checkThreads(options.threads);
  study.steady.threads = options.threads;
  if (options.refine < 1)
  {
    throw ParameterError(fmt::format("--refine {} is below 1", options.refine),
      "give a whole number from 1 up: every pixel becomes N × N");
  }
  study.refinement = options.refine;
  study.estimateError = !options.noErrorEstimate;
  if (!options.targetError.empty())
  {
    if (options.noErrorEstimate)
    {
      throw ParameterError("--target-error and --no-error-estimate contradict each other", "leave one of them out");
    }
    const double target = share("--target-error", options.targetError);
    if (!(target > 0 && target < 1))
    {
      throw ParameterError(
        "--target-error '" + options.targetError + "' is not between 0 and 1", "write it as 1% or 0.01");
    }
    study.targetError = target;
  }
  return study;
}

lbm::Stencil stencilFor(const DiffusionOptions& options, const Lattice& lattice, lbm::Stencil chosen)
{
  if (options.lattice.empty())
  {
    return lattice.dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5;
  }
  if ((options.lattice[1] == '3') != (lattice.dimension == 3))
  {
    throw ParameterError(fmt::format("--lattice {} does not fit {} in {} dimensions", options.lattice,
                           lattice.dimension == 3 ? "a volume" : "a picture", lattice.dimension),
      lattice.dimension == 3 ? "use d3q7 or d3q19" : "use d2q5 or d2q9");
  }
  return chosen;
}

/// That of conductivities along and across the walls.
lbm::Stencil directedStencil(const DiffusionOptions& options, const Lattice& lattice)
{
  if (lattice.dimension != 2)
  {
    throw ParameterError(
      "--conductivity NAME=ALONG:ACROSS of a volume", "two values go with pictures; give each phase of a volume one");
  }
  if (!options.lattice.empty() && options.lattice != "d2q9")
  {
    throw ParameterError("--conductivity NAME=ALONG:ACROSS on --lattice " + options.lattice,
      "it wants the diagonal links of d2q9, which it takes by itself: leave --lattice out");
  }
  return lbm::Stencil::D2Q9;
}

/// The axes asked for. One node along an axis is no sample of anything: refused, where it is asked for.
std::vector<int> parseAxes(const std::string& direction, const Lattice& lattice)
{
  std::vector<int> axes;
  for (int axis = 0; axis < lattice.dimension; ++axis)
  {
    if (direction == "all" || direction == axisNames[axis])
    {
      axes.push_back(axis);
    }
  }
  if (axes.empty())
  {
    throw ParameterError("--direction z of a picture, which has x and y only", "choose x, y or all");
  }
  std::string open;
  for (int axis = 0; axis < lattice.dimension; ++axis)
  {
    if (lattice.size[static_cast<std::size_t>(axis)] > 1)
    {
      open = open.empty() ? axisNames[axis] : open;
    }
  }
  for (const int axis : axes)
  {
    if (lattice.size[static_cast<std::size_t>(axis)] < 2)
    {
      throw InputError(fmt::format("the {} is {} {}: one node along {} has no conductivity of its own",
                         lattice.dimension == 3 ? "volume" : "picture", sizeText(lattice.size, lattice.dimension),
                         lattice.dimension == 3 ? "voxels" : "pixels", axisNames[axis]),
        open.empty() ? "give a larger picture or --window"
                     : "give a larger picture or --window, or solve along it only: --direction " + open);
    }
  }
  return axes;
}

std::vector<std::string> outputNames(const std::string& output, const std::vector<int>& axes)
{
  if (output.empty())
  {
    return {};
  }
  if (!isVtkImage(output))
  {
    throw ParameterError("-o '" + output + "': the fields are written as .vti",
      "end the name in .vti; numbers go to standard output, as JSON with --json");
  }
  std::vector<std::string> names;
  for (const int axis : axes)
  {
    names.push_back(axes.size() == 1 ? output : withSuffix(output, std::string("_") + axisNames[axis]).string());
  }
  return names;
}

void diffusion(Session& session, const DiffusionOptions& options, const std::string& commandLine)
{
  const auto start = Clock::now();
  lbm::StudyOptions study = parseStudy(options);
  const auto given = parseConductivities(options.conductivity);

  Sample sample;
  DiffusionReport report;
  std::array<std::optional<OutputFile>, 3> files; // rank 0
  std::shared_ptr<lbm::DirectedDiffusivity> directed;
  report.file = options.picture.file;
  report.sample = &sample;
  report.ranks = session.ranks();

  DiffusionSize size;
  size.refinement = study.refinement;
  size.fields = !options.output.empty();
  size.ranks = session.ranks();
  size.ranksOnMachine = session.ranksOnMachine();
  const bool allConduct =
    std::all_of(given.begin(), given.end(), [](const auto& v) { return v.along > 0 || v.across > 0; });
  const auto check = [&](const Lattice& lattice)
  {
    study.axes = parseAxes(options.direction, lattice);
    size.lattice = lattice;
    size.stencil = stencilFor(options, lattice, study.steady.stencil);
    size.conducting = allConduct ? lattice.count() : 0;
    requireMemory(size);
  };

  // All that can go wrong with what the user gave goes wrong here, before anything is computed.
  session.onRoot(
    [&]
    {
      sample = loadSample(options.picture, check);
      Session::checkInterrupt();
      for (const std::string& warning : sample.warnings)
      {
        session.warn(warning);
      }
      const Lattice& lattice = sample.image.lattice;
      study.axes = parseAxes(options.direction, lattice);
      study.steady.stencil = stencilFor(options, lattice, study.steady.stencil);
      report.fractions = sample.image.fractions();
      Conductivities found = conductivities(given, sample.image.phases, report.fractions);
      if (found.directed(report.fractions))
      {
        study.steady.stencil = directedStencil(options, lattice);
        directed = std::make_shared<lbm::DirectedDiffusivity>();
        directed->axis = readAxes(options.picture, sample);
        report.across = found.across;
      }
      report.conductivity = std::move(found.along);
      const std::vector<std::string> names = outputNames(options.output, study.axes);
      for (std::size_t i = 0; i < names.size(); ++i)
      {
        files[static_cast<std::size_t>(study.axes[i])].emplace(names[i], options.common.overwrite);
        report.written.push_back(names[i]);
      }
    });

  // What every rank needs to know.
  std::array<int, 3> axes{ -1, -1, -1 };
  std::copy(study.axes.begin(), study.axes.end(), axes.begin());
  session.broadcast(axes);
  study.axes.assign(axes.begin(), std::find(axes.begin(), axes.end(), -1));
  session.broadcast(study.steady.stencil);
  std::array<double, 256> values{};
  const auto spread = [&](const std::vector<double>& byId)
  {
    std::array<double, 256> all{};
    std::transform(byId.begin(), byId.end(), all.begin(), [](double v) { return std::isnan(v) ? 0 : v; });
    session.broadcast(all);
    return all;
  };
  values = spread(report.conductivity);
  share(session, sample.image);
  std::array<int, 1> twoValues{ directed ? 1 : 0 };
  session.broadcast(twoValues);
  std::array<double, 256> least = values;
  if (twoValues[0] != 0)
  {
    const std::array<double, 256> across = spread(report.across);
    if (!directed)
    {
      directed = std::make_shared<lbm::DirectedDiffusivity>();
    }
    share(session, directed->axis, sample.image.phase.size());
    directed->along.assign(values.begin(), values.end());
    directed->across.assign(across.begin(), across.end());
    std::ranges::copy(directed->larger(), values.begin()); // what conducts at all
    std::ranges::copy(directed->smaller(), least.begin());
    study.directed = directed;
  }
  if (session.root())
  {
    const auto bounds = [&](const std::array<double, 256>& k) {
      return lbm::bounds(report.fractions, std::span(k).first(report.fractions.size()), sample.image.lattice.dimension);
    };
    report.bounds = bounds(values);
    report.bounds.series = bounds(least).series; // more of a conductor conducts no less
    report.bounds.hashinShtrikmanLower = bounds(least).hashinShtrikmanLower;
  }
  size.lattice = sample.image.lattice;
  size.stencil = study.steady.stencil;
  size.conducting = std::count_if(
    sample.image.phase.begin(), sample.image.phase.end(), [&](std::uint8_t id) { return values[id] > 0; });
  requireMemory(size);
  session.onRoot(
    [&]
    {
      const double nodes =
        static_cast<double>(sample.image.lattice.count()) * std::pow(study.refinement, sample.image.lattice.dimension);
      for (const auto& file : files)
      {
        if (file)
        {
          file->needs(static_cast<std::uint64_t>(nodes * (8 + 24 + 1)));
        }
      }
    });
  session.onRoot([&] { requirePaths(sample.image, values, study); });

  study.steady.progress = [&session](double part, const char* what) { return session.progress(part, what); };
  study.announce = [&session](const lbm::TargetPlan& plan)
  {
    session.onRoot([&] { session.note(planText(plan)); });
    return !Session::interrupted();
  };
  Fields taken;
  const lbm::FieldSink take = [&](const lbm::SteadyDiffusion& solver, const lbm::DiffusionAnswer& answer,
                                const Lattice& lattice, const Block& block)
  { taken = takeFields(session, solver, answer.axis, lattice, block, options.quantity); };
  const auto run = [&](const lbm::StudyOptions& part, bool fields)
  { return lbm::studyDiffusion(sample.image, values, part, session.communicator(), fields ? take : lbm::FieldSink()); };
  const bool fields = !options.output.empty();
  if (!fields || study.targetError)
  {
    report.answers = run(study, false);
  }
  if (fields)
  {
    // One direction at a time, so that only one direction's fields are held.
    if (session.root())
    {
      report.provenance = recordRun(commandLine, options.picture.file, sample.provenance);
    }
    for (std::size_t i = 0; i < study.axes.size(); ++i)
    {
      lbm::StudyOptions one = study;
      one.axes = { study.axes[i] };
      if (study.targetError) // the refinement is known by now; solved again, for its fields
      {
        one.targetError.reset();
        one.estimateError = false;
        one.refinement = report.answers[i].refinement;
        (void)run(one, true);
      }
      else
      {
        report.answers.push_back(run(one, true).front());
      }
      report.options = study;
      session.onRoot(
        [&]
        {
          writeFields(
            report, report.answers[i], std::exchange(taken, {}), *files[static_cast<std::size_t>(study.axes[i])]);
          Session::checkInterrupt();
        });
    }
  }
  session.endProgress();

  report.options = study;
  report.peakMemory = peakMemoryBytes();
  if (session.ranks() > 1)
  {
    MPI_Allreduce(MPI_IN_PLACE, &report.peakMemory, 1, MPI_UINT64_T, MPI_MAX, session.communicator());
  }
  session.onRoot(
    [&]
    {
      Session::checkInterrupt();
      for (auto& file : files)
      {
        if (file)
        {
          file->commit();
        }
      }
      if (report.provenance.version.empty())
      {
        report.provenance = recordRun(commandLine, options.common.json ? options.picture.file : "", sample.provenance);
      }
      report.seconds = secondsSince(start);
      if (study.estimateError || study.targetError)
      {
        for (const auto& answer : report.answers)
        {
          if (!std::isfinite(answer.error.relative))
          {
            session.warn(fmt::format("the error along {} could not be estimated: the middle of the sample, which is "
                                     "solved for it, has no conducting path",
              axisNames[answer.axis]));
          }
        }
      }
      session.print(options.common.json ? toJson(report) : options.common.quiet ? "" : toTable(report));
    });
  const lbm::Target how = report.answers.front().target;
  if (how == lbm::Target::PictureTooCoarse || how == lbm::Target::MemoryShort)
  {
    const Shortfall shortfall = shortfallOf(report);
    session.fallShort(shortfall.message, shortfall.hint);
  }
}

} // namespace

Command diffusionCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "diffusion", "Effective conductivity of a picture or volume: heat, vapour, anything that diffuses");
  auto o = std::make_shared<DiffusionOptions>();
  addPictureOptions(*app, o->picture);
  const auto physics = [](CLI::Option* option) { option->group("Physics"); };
  physics(app
            ->add_option("--conductivity", o->conductivity,
              "Conductivity of a phase, in any unit; 0: it does not conduct. ALONG:ACROSS where it differs along the "
              "walls of a "
              "lattice from outlines")
            ->type_name("NAME=VALUE|NAME=ALONG:ACROSS")
            ->allow_extra_args(false)
            ->required());
  physics(app->add_option("--direction", o->direction, "x across the picture, y down it, z through a volume")
            ->type_name("x|y|z|all")
            ->capture_default_str());
  physics(app->add_option("--sides", o->sides, "What bounds the sample across the flux")
            ->type_name("insulated|periodic")
            ->capture_default_str());
  physics(app->add_option("--quantity", o->quantity, "What diffuses: names the field that is written")
            ->type_name("temperature|concentration")
            ->capture_default_str());
  const auto numerics = [](CLI::Option* option) { option->group("Accuracy and cost"); };
  numerics(app->add_option("--refine", o->refine, "Split every pixel into N × N (× N)")
             ->type_name("N")
             ->capture_default_str());
  numerics(app
             ->add_option("--target-error", o->targetError,
               "Refine until the estimated error is below this, as 1%, as far as the picture's own pixels allow")
             ->type_name("SHARE"));
  numerics(app->add_flag("--no-error-estimate", o->noErrorEstimate,
    "Leave out the solves that the error is estimated from: every second pixel, and every pixel split"));
  numerics(app->add_option("--lattice", o->lattice, "Links of the lattice; d2q5 or d3q7 when not given")
             ->type_name("d2q5|d2q9|d3q7|d3q19"));
  numerics(app->add_option("--method", o->method, "How the system is solved")
             ->type_name("auto|multigrid|algebraic-multigrid")
             ->capture_default_str());
  numerics(app->add_option("--tolerance", o->tolerance, "Largest relative error of the flux through either face")
             ->type_name("SHARE")
             ->capture_default_str());
  numerics(app->add_option("--max-iterations", o->maxIterations, "Give up after this many")
             ->type_name("NUMBER")
             ->capture_default_str());
  numerics(
    app->add_option("--threads", o->threads, "Threads of each process")->type_name("NUMBER")->capture_default_str());
  addOutputOptions(*app, o->output, o->common,
    "Write phases, field and flux as .vti, for ParaView; several directions: FILE_x.vti, FILE_y.vti");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella diffusion tissue.png --phase 0=lumen --phase 255=wall --conductivity lumen=0.023 --conductivity wall=1",
      "lamella diffusion tissue.png --conductivity lumen=1 --conductivity wall=0.004 --target-error 1% --json",
      "lamella diffusion rock_200x200x200_u8.raw --phase 1=pore --other grain --conductivity pore=1 --conductivity "
      "grain=0",
      "lamella diffusion tissue.vti --conductivity lumen=0.023 --conductivity wall=1.2:0.8 --conductivity "
      "'middle lamella=1'",
      "mpirun -n 4 lamella diffusion tissue.vti --conductivity lumen=0 --conductivity wall=1 --direction z -o "
      "heat.vti" });
  return { app,
    [o](Session& session, const std::string& line)
    {
      session.setQuiet(o->common.quiet);
      diffusion(session, *o, line);
    } };
}

} // namespace lamella::cli
