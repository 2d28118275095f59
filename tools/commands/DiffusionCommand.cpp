#include "commands/DiffusionConductivity.h"
#include "commands/DiffusionReport.h"
#include "commands/FilterRun.h"
#include "commands/SampleRun.h"
#include "convert/VtkFiles.h"
#include "files/GridFile.h"
#include "files/Record.h"
#include "program/Commands.h"
#include "program/SettingOptions.h"
#include "session/OutputFile.h"
#include "session/Text.h"

#include "FieldLayers.h"
#include "core/Clock.h"
#include "lattice/GreyTable.h"
#include "lattice/Phases.h"
#include "lbm/StudyChecks.h"
#include "vtkLatticeConversion.h"
#include "vtkSteadyDiffusion.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

namespace
{

struct DiffusionOptions
{
  CommonOptions common;
  PictureOptions picture;
  SettingOptions settings;
  std::vector<std::string> conductivity;
  std::string output;
};

bool isHdf(const std::string& path)
{
  const std::string ending = std::filesystem::path(path).extension().string();
  return ending == ".vtkhdf" || ending == ".hdf";
}

void requireImage(const std::string& output)
{
  if (!output.empty() && !isVtkImage(output) && !isHdf(output))
  {
    throw ParameterError("-o '" + output + "': the fields are written as .vti or .vtkhdf",
      "end the name in .vti or .vtkhdf; numbers go to standard output, as JSON with --json");
  }
}

/// Phases, which are in memory, and the fields of a solve, of which a slab is.
class FieldVolume : public Volume
{
public:
  /// @param image the phases, with field data
  FieldVolume(vtkSmartPointer<vtkImageData> image, const FieldLayers& fields)
    : fields_(fields)
  {
    image->GetExtent(extent_.data());
    phases_ = wholeVolume(std::move(image));
  }

  vtkSmartPointer<vtkImageData> read(int first, int last) override
  {
    auto slab = vtkSmartPointer<vtkImageData>::New();
    slab->ShallowCopy(phases_->read(first, last));
    vtkPointData* const points = slab->GetPointData();
    for (const auto& array : fields_.read(first - extent_[4], last - extent_[4]))
    {
      points->AddArray(array);
      array->GetNumberOfComponents() == 1 ? points->SetActiveScalars(array->GetName())
                                          : points->SetActiveVectors(array->GetName());
    }
    return slab;
  }

private:
  std::unique_ptr<Volume> phases_;
  const FieldLayers& fields_;
};

/// What is given of the phases goes to the filter; the image gets the directions that it may want.
void giveConductivities(const DiffusionOptions& options, bool greys, const Sample& sample, vtkImageData* image)
{
  const auto given = parseConductivities(options.conductivity);
  if (greys)
    return; // the filter knows what it may be told of
  requireNames("--conductivity", given, sample.image.phases.names());
  options.settings.checkNames(sample.image.phases.names());
  if (std::ranges::any_of(given, [](const GivenConductivity& one) { return one.along != one.across; }))
    requireAxes(options.picture, image);
}

/// Conductivities of greys.
GreyTable tableOf(const DiffusionOptions& options)
{
  std::map<std::string, double> given;
  for (const GivenConductivity& one : parseConductivities(options.conductivity))
    given.emplace(one.phase, one.along);
  return { given, "conductivity" };
}

/// One run of `lamella diffusion`: its filter, its sample, its files.
class DiffusionRun
{
public:
  DiffusionRun(Session& session, const DiffusionOptions& options, const std::string& commandLine)
    : session_(session)
    , options_(options)
    , commandLine_(commandLine)
  {
    options.settings.give(filter_);
    for (const GivenConductivity& one : parseConductivities(options.conductivity))
    {
      filter_->SetConductivity(one.phase.c_str(), one.along);
      if (one.alongUncertainty > 0)
        filter_->SetConductivityUncertainty(one.phase.c_str(), one.alongUncertainty);
      if (one.across == one.along)
        continue;
      filter_->SetConductivityAcross(one.phase.c_str(), one.across);
      if (one.acrossUncertainty > 0)
        filter_->SetConductivityAcrossUncertainty(one.phase.c_str(), one.acrossUncertainty);
    }
    if (options.conductivity.empty() && filter_->GetNumberOfConductivityTensors() == 0 &&
      !isVtkImage(options.picture.file)) // which may have tensors of its voxels
      throw ParameterError("--conductivity is missing",
        "add --conductivity NAME=VALUE of every phase; lamella diffusion --help tells more");
    fields_ = !options.output.empty();
    requireImage(options.output);
    report_.file = options.picture.file;
    report_.sample = &sample_;
    report_.ranks = session.ranks();
    report_.threads = filter_->GetThreads();
    report_.estimated = filter_->GetEstimateError();
  }

  void run()
  {
    load();
    if (!fields_ || fieldsApart())
    {
      filter_->SetComputeField(false);
      filter_->SetComputeFlux(false);
      solve();
      report_.found = filter_->GetFindings();
    }
    if (fields_)
      solveFields();
    conclude();
  }

private:
  /// Are fields solved for by themselves, when all numbers are known?
  [[nodiscard]] bool fieldsApart() const { return streams_ || filter_->GetTargetError() > 0; }

  /// All that can go wrong with what the user gave goes wrong here, before anything is computed.
  void load()
  {
    lbm::StudySize size;
    size.refinement = filter_->GetRefinement();
    size.ranks = session_.ranks();
    size.ranksOnMachine = session_.ranksOnMachine();
    const auto check = [&](const Lattice& lattice)
    {
      size.lattice = lattice;
      size.stencil = lattice.dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5;
      // of volumes slab by slab: their fields need not be held
      streams_ = fields_ && lattice.dimension == 3 && size.refinement == 1 && !(filter_->GetTargetError() > 0);
      size.fields = fields_ && !streams_;
      lbm::requireMemory(size); // of a sample that hardly conducts: the least that it may be
    };
    std::array<int, 4> axes{ 0, 0, 0, 0 }; // how many, and which
    session_.onRoot(
      [&]
      {
        const double* const greys = filter_->GetShares();
        const bool shares = greys[0] != 0 || greys[1] != 0;
        std::optional<GreyBins> bins;
        if (filter_->GetInterpolate())
          bins = tableOf(options_).bins();
        else if (shares)
          bins = GreyBins::even(greys[0], greys[1]);
        sample_ = loadSample(options_.picture, check, bins);
        Session::checkInterrupt();
        tellDoubts(session_, sample_);
        const Lattice& lattice = sample_.image.lattice;
        image_ = imageOf(sample_);
        giveConductivities(options_, bins.has_value(), sample_, image_);
        if (filter_->GetNumberOfMembranes() + filter_->GetNumberOfPermeances() > 0 && sample_.pixelSizeSource == "none")
          throw ParameterError(
            "'" + options_.picture.file + "' does not say its pixel size, and membranes have a resistance by area",
            "give it with --pixel-size, in the length that the resistance has: 1um where that is in m² K/W");
        image_->GetExtent(extent_.data());
        const int direction = filter_->GetDirection();
        for (int axis = 0; axis < 3; ++axis)
          if (direction == axis || (direction == vtkSteadyDiffusion::ALL && axis < lattice.dimension))
            axes[static_cast<std::size_t>(++axes[0])] = axis;
        for (int i = 1; fields_ && i <= axes[0]; ++i)
        {
          const std::string name = axes[0] == 1
            ? options_.output
            : withSuffix(options_.output, std::string("_") + axisNames[axes[static_cast<std::size_t>(i)]]).string();
          files_.emplace_back(name, options_.common.overwrite);
          report_.written.push_back(name);
          const double nodes = static_cast<double>(lattice.count()) * std::pow(size.refinement, lattice.dimension);
          files_.back().needs(static_cast<std::uint64_t>(nodes * (8 + 24 + 1)));
          streams_ = streams_ && !files_.back().inMemory();
        }
      });
    session_.broadcast(extent_);
    session_.broadcast(axes);
    session_.broadcast(streams_);
    axes_.assign(axes.begin() + 1, axes.begin() + 1 + axes[0]);
  }

  void solve()
  {
    runFilterOnRanks(session_, filter_.Get(), image_, extent_, "diffusion");
    session_.onRoot(
      [&]
      {
        const std::string& told = filter_->GetFindings().shortfall.message; // at the end, as what the run comes to
        tellWarnings(session_, [&](const std::string& warning) { return told.empty() || !warning.starts_with(told); });
      });
  }

  /// One direction at a time, so that only one direction's fields are held.
  void solveFields()
  {
    filter_->SetComputeField(true);
    filter_->SetComputeFlux(true);
    const bool apart = fieldsApart();
    if (apart) // the refinement is known by now
    {
      filter_->SetTargetError(0);
      filter_->SetEstimateError(false);
      filter_->SetEstimateWindowError(false);
      filter_->SetRefinement(report_.found.answers.front().refinement);
    }
    for (std::size_t i = 0; i < axes_.size(); ++i)
    {
      filter_->SetDirection(axes_[i]);
      if (streams_)
        filter_->SetFieldSink([this, i](const FieldLayers& fields) { write(fields, i); });
      solve();
      if (streams_)
        continue;
      const SteadyFindings& found = filter_->GetFindings();
      if (!apart)
      {
        std::vector<lbm::DiffusionAnswer> answers = std::move(report_.found.answers);
        report_.found = found;
        answers.insert(answers.end(), found.answers.begin(), found.answers.end());
        report_.found.answers = std::move(answers);
      }
      session_.onRoot(
        [&]
        {
          vtkImageData* const output = filter_->GetOutput();
          if (apart)
            describe(output, report_.found.along(axes_[i]));
          for (const char* const given : { "axis", "tensor" })
            output->GetPointData()->RemoveArray(given);
          write(output, files_[i]);
          Session::checkInterrupt();
        });
    }
  }

  /// A volume's, slab by slab.
  void write(const FieldLayers& fields, std::size_t i)
  {
    vtkNew<vtkImageData> image;
    image->ShallowCopy(fields.image);
    for (const char* const given : { "axis", "tensor" })
      image->GetPointData()->RemoveArray(given);
    describe(image, report_.found.along(axes_[i]));
    note(image);
    FieldVolume volume(image.Get(), fields);
    isHdf(files_[i].path()) ? writeHdf(session_, volume, files_[i]) : writeXmlImage(session_, volume, files_[i]);
  }

  void write(vtkImageData* output, const OutputFile& file)
  {
    note(output);
    if (isHdf(file.path()))
      writeHdf(session_, *wholeVolume(output), file);
    else
      writeGrid(output, file);
  }

  void note(vtkImageData* output)
  {
    if (report_.provenance.version.empty())
      report_.provenance = recordRun(session_, commandLine_, options_.picture.file, sample_.provenance);
    setProvenance(output, io::toJson(report_.provenance));
  }

  void conclude()
  {
    report_.peakMemory = peakMemoryBytes();
    if (session_.ranks() > 1)
      MPI_Allreduce(MPI_IN_PLACE, &report_.peakMemory, 1, MPI_UINT64_T, MPI_MAX, session_.communicator());
    session_.onRoot(
      [&]
      {
        Session::checkInterrupt();
        for (OutputFile& file : files_)
          file.commit();
        if (report_.provenance.version.empty())
          report_.provenance =
            recordRun(session_, commandLine_, options_.common.json ? options_.picture.file : "", sample_.provenance);
        report_.seconds = secondsSince(start_);
        session_.print(options_.common.json ? toJson(report_) : options_.common.quiet ? "" : toTable(report_));
      });
    const lbm::Shortfall& shortfall = report_.found.shortfall;
    if (!shortfall.message.empty())
      session_.fallShort(shortfall.message, shortfall.hint);
  }

  Session& session_;
  const DiffusionOptions& options_;
  const std::string& commandLine_;
  Clock::time_point start_ = Clock::now();
  vtkNew<vtkSteadyDiffusion> filter_;
  Observer plan_{ filter_, vtkSteadyDiffusion::PLAN_EVENT,
    [this](void* words) { session_.note(static_cast<const char*>(words)); } };
  bool fields_ = false;
  bool streams_ = false; ///< they are written slab by slab
  Sample sample_;        // its phases are in the image
  vtkSmartPointer<vtkImageData> image_ = vtkSmartPointer<vtkImageData>::New();
  std::array<int, 6> extent_{ 0, -1, 0, -1, 0, -1 };
  std::vector<int> axes_;
  std::vector<OutputFile> files_; // rank 0
  DiffusionReport report_;
};

} // namespace

Command diffusionCommand(CLI::App& root)
{
  CLI::App* app = root.add_subcommand(
    "diffusion", "Effective conductivity of a picture or volume: heat, vapour, anything that diffuses");
  auto o = std::make_shared<DiffusionOptions>();
  addPictureOptions(*app, o->picture);
  addSliceDistance(*app, o->picture);
  addOption(*app, "Materials", "--conductivity", o->conductivity,
    "Conductivity of a phase, in any unit; 0: it does not conduct. ALONG:ACROSS where it differs along the walls of a "
    "lattice from outlines. With ± (or +-) how far it may be off: what that leaves of the value is told",
    "NAME=VALUE[±HALF]|NAME=ALONG:ACROSS")
    ->allow_extra_args(false);
  o->settings.declare(*app, "vtkSteadyDiffusion",
    { "conductivity", "conductivity-across", "conductivity-uncertainty", "conductivity-across-uncertainty", "field",
      "flux" });
  addOutputOptions(*app, o->output, o->common,
    "Write phases, field and flux as .vti or .vtkhdf, for ParaView; several directions: FILE_x.vti, FILE_y.vti. Of "
    "volumes slab by slab, so that fields that are larger than memory can be written");
  addReportOptions(*app, o->common);
  addExamples(*app,
    { "lamella diffusion tissue.png --phase 0=lumen --phase 255=wall --conductivity lumen=0.023 --conductivity wall=1",
      "lamella diffusion tissue.png --conductivity lumen=1 --conductivity wall=0.004 --target-error 1% --json",
      "lamella diffusion tissue.png --conductivity lumen=0.026 --conductivity wall=0.41±0.02",
      "lamella diffusion rock_200x200x200_u8.raw --phase 1=pore --other grain --conductivity pore=1 --conductivity "
      "grain=0",
      "lamella diffusion grains.png --pixel-size 1um --conductivity grain=40,matrix=0.3 --membrane grain-matrix=1e-7",
      "lamella diffusion tissue.vti --conductivity lumen=0.023 --conductivity wall=1.2:0.8 --conductivity "
      "'middle lamella=1'",
      "mpirun -n 4 lamella diffusion tissue.vti --conductivity lumen=0 --conductivity wall=1 --direction z -o "
      "heat.vti" });
  return jointCommand(app, o,
    [](Session& session, const DiffusionOptions& options, const std::string& line)
    { DiffusionRun(session, options, line).run(); });
}

} // namespace lamella::cli
