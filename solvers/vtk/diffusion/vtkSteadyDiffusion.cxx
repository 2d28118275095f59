#include "vtkSteadyDiffusion.h"

#include "BondFields.h"
#include "BoxExchange.h"
#include "DiffusionScene.h"
#include "FieldLayers.h"
#include "MembranePairs.h"
#include "PhaseTensors.h"
#include "RefinedImage.h"
#include "SteadyFindings.h"
#include "SurfaceDoubt.h"
#include "WallConductivity.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"

#include "core/Communicator.h"
#include "core/Error.h"
#include "core/Parse.h"
#include "lattice/GreyTable.h"
#include "lbm/Bounds.h"
#include "lbm/DiffusionStudy.h"
#include "lbm/Shares.h"
#include "lbm/StudyChecks.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lbm = lamella::lbm;

namespace
{

constexpr double notSolved = std::numeric_limits<double>::quiet_NaN();

lbm::Method methodOf(int method)
{
  switch (method)
  {
    case vtkSteadyDiffusion::MULTIGRID:
      return lbm::Method::Multigrid;
    case vtkSteadyDiffusion::LEAN_MULTIGRID:
      return lbm::Method::LeanMultigrid;
    case vtkSteadyDiffusion::PIECE_MULTIGRID:
      return lbm::Method::PieceMultigrid;
    case vtkSteadyDiffusion::ALGEBRAIC_MULTIGRID:
      return lbm::Method::AlgebraicMultigrid;
    default:
      return lbm::Method::Auto;
  }
}

/// Makes sure that the output has the ids that the solver used: the input's own array where that holds them as they
/// are, else a new one. Returns its name.
std::string storePhases(vtkImageData* output, const lamella::PhaseIds& phases, const lamella::Team& team)
{
  std::array<std::int64_t, 1> converted{ phases.own.empty() ? 0 : 1 };
  team.maximum(converted);
  std::string name = phases.array;
  if (converted[0] != 0)
  {
    name = phases.array == "phase" || output->GetPointData()->HasArray("phase") ? phases.array + "_id" : "phase";
    name = team.share(name, output->GetNumberOfPoints() > 0);
    const auto ids = lamella::adopt(phases.own, name.c_str());
    lamella::describe(ids, "1", "phase of the node: position in phase_names", "vtkSteadyDiffusion");
    output->GetPointData()->AddArray(ids);
  }
  return name;
}

/// Derivatives of two phases as those of all ids, of which they are the a-th and the b-th.
void spread(lbm::DiffusionAnswer& answer, std::size_t ids, std::size_t a, std::size_t b)
{
  const auto pairs = [&](std::vector<double>& of)
  {
    if (of.empty())
      return;
    std::vector<double> all(ids * ids, 0.0);
    all[a * ids + b] = of[1];
    of = std::move(all);
  };
  pairs(answer.surfaces.shift);
  pairs(answer.surfaces.area);
  if (std::vector<double>& along = answer.derivatives.along; !along.empty())
  {
    std::vector<double> all(ids, 0.0);
    all[a] = along[0];
    all[b] = along[1];
    along = std::move(all);
  }
}

/// Applies f to each number.
template <class F>
void change(vtkDoubleArray* array, F&& f)
{
  std::for_each(array->GetPointer(0), array->GetPointer(0) + array->GetNumberOfValues(), f);
}

} // namespace

struct vtkSteadyDiffusion::Internals
{
  std::map<std::string, double> Conductivity;
  std::map<std::string, double> Across;      ///< of the phases whose conductivity differs across the wall
  std::map<std::string, std::string> Tensor; ///< numbers, of the phases that have one
  std::map<std::string, double> Uncertainty;
  std::map<std::string, double> AcrossUncertainty;
  std::map<std::string, double> Membrane;
  std::map<std::string, double> Permeance;

  // Of the update that is under way.
  std::vector<double> Values;        ///< by id: what is stored where it is above 0
  std::vector<double> Shares;        ///< by id: the part of a node in the phase `high`; empty: ids are phases
  std::vector<std::size_t> Smoothed; ///< ids of the two phases whose labels are smoothed; empty: they are not
  bool VoxelTensors = false;         ///< the image has an array of tensors
  lamella::PhaseTensors Tensors;
  std::shared_ptr<lbm::DirectedDiffusivity> Directed;
  std::vector<lbm::Membrane> Membranes; ///< of which the image has both phases
  lbm::SteadyOptions Steady;
  std::vector<int> Axes;

  lamella::FieldSink Sink;

  lamella::SteadyFindings Found;
};

/// Keeps the fields of solves, as asked for, until they are put into the output.
class vtkSteadyDiffusion::FieldStore
{
public:
  /// @param image with the phases
  FieldStore(
    vtkSteadyDiffusion* self, vtkImageData* image, const lamella::DiffusionScene& scene, const lamella::Team& team)
    : Self(self)
    , Image(image)
    , Scene(scene)
    , Team(team)
  {
  }

  [[nodiscard]] bool wanted() const { return this->Self->ComputeField || this->Self->ComputeFlux; }

  /// Collective. Takes them of a solve on this lattice.
  void take(lbm::SteadyDiffusion const& solver, int axis, const lamella::Lattice& lattice, const lbm::Block& block)
  {
    if (this->Self->Internal->Sink)
    {
      this->stream(solver, axis, lattice, block);
      return;
    }
    this->Split = static_cast<int>(lattice.size[0] / this->Scene.lattice().size[0]);
    lbm::Block held = this->Scene.whole.held;
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimension); ++a)
    {
      held.start[a] *= this->Split;
      held.size[a] *= this->Split;
    }
    const Part part{ solver, axis, lattice, block, held, { 0, block.size[2] } };
    const auto [field, flux] = this->arrays(part);
    if (field)
      this->Fields.emplace_back(field);
    if (flux)
      this->Fluxes.emplace_back(flux);
  }

  /// An image with the phases becomes one with the fields, too, on the lattice that they were solved on.
  void put(vtkImageData* output) const
  {
    if (this->Split > 1)
      output->ShallowCopy(lamella::refinedImage(output, this->Scene.lattice().dimension, this->Split));
    vtkPointData* const points = output->GetPointData();
    for (std::size_t i = 0; i < std::max(this->Fields.size(), this->Fluxes.size()); ++i)
    {
      for (const auto* const kind : { &this->Fields, &this->Fluxes })
        if (i < kind->size())
          points->AddArray((*kind)[i]);
    }
    if (!this->Fields.empty())
      points->SetActiveScalars(this->Fields.front()->GetName());
    if (!this->Fluxes.empty())
      points->SetActiveVectors(this->Fluxes.front()->GetName());
  }

private:
  /// Of a solve, what a rank has solved and what it holds.
  struct Part
  {
    const lbm::SteadyDiffusion& solver;
    int axis;
    const lamella::Lattice& lattice;
    lbm::Block block; ///< the layers of it alone
    lbm::Block held;
    lbm::Layers layers; ///< of the rank's block
  };

  /// Field and flux of what is held, where they are asked for. Collective.
  [[nodiscard]] std::array<vtkSmartPointer<vtkDoubleArray>, 2> arrays(const Part& part) const
  {
    const lamella::BoxExchange outward(
      part.lattice, part.block, part.held, { false, false, false }, this->Team.comm(), this->Team.size());
    const int axis = part.axis;
    std::array<vtkSmartPointer<vtkDoubleArray>, 2> made;
    const bool all = this->Self->Direction == ALL;
    const std::string suffix = all ? std::string("_") + lamella::axisNames[static_cast<std::size_t>(axis)] : "";
    const std::string quantity = this->Self->QuantityName();
    // The solver has value 1 on the low face.
    const bool fromTop = this->Scene.fromTop(axis);
    if (this->Self->ComputeField)
    {
      const auto field = lamella::DiffusionScene::array(quantity + suffix, 1, outward, part.block, part.held,
        [&](std::span<double> out) { part.solver.value(out, part.layers); });
      if (fromTop)
        change(field, [](double& value) { value = 1 - value; });
      lamella::describe(field, "1", quantity + ", 1 at the inlet and 0 at the outlet", "vtkSteadyDiffusion");
      made[0] = field;
    }
    if (this->Self->ComputeFlux)
    {
      const auto flux = lamella::DiffusionScene::array("flux" + suffix, 3, outward, part.block, part.held,
        [&](std::span<double> out) { part.solver.flux(out, part.layers); });
      if (fromTop)
        change(flux, [](double& value) { value = value == 0 ? 0 : -value; });
      lamella::describe(flux, "conductivity/m", "flux of " + quantity + ", -D grad u", "vtkSteadyDiffusion");
      made[1] = flux;
    }
    return made;
  }

  /// Hands the fields to the sink, which reads them by layers on the first rank, who has the image. Collective.
  void stream(
    const lbm::SteadyDiffusion& solver, int axis, const lamella::Lattice& lattice, const lbm::Block& block) const
  {
    const lamella::Communicator comm(this->Team.comm());
    // what there is of some layers in a box
    const auto within = [](lbm::Block box, std::int64_t first, std::int64_t last)
    {
      const std::int64_t end = std::min(box.start[2] + box.size[2], last + 1);
      box.start[2] = std::max(box.start[2], first);
      box.size[2] = std::max<std::int64_t>(0, end - box.start[2]);
      return box;
    };
    const auto read = [&](std::int64_t first, std::int64_t last)
    {
      const lbm::Block mine = within(block, first, last);
      const std::int64_t begin = mine.size[2] > 0 ? mine.start[2] - block.start[2] : 0;
      return this->arrays(
        { solver, axis, lattice, mine, within(this->Scene.whole.held, first, last), { begin, begin + mine.size[2] } });
    };
    std::array<std::int64_t, 2> wanted{ 0, 0 };
    const auto tell = [&]
    {
      if (comm.parallel())
        MPI_Bcast(wanted.data(), 2, MPI_INT64_T, 0, comm.handle());
    };
    std::exception_ptr failure;
    if (comm.rank() > 0)
      for (tell(); wanted[0] >= 0; tell())
        (void)read(wanted[0], wanted[1]);
    else
    {
      lamella::FieldLayers fields;
      fields.axis = axis;
      fields.image = this->Image;
      fields.read = [&](int first, int last)
      {
        wanted = { first, last };
        tell();
        std::vector<vtkSmartPointer<vtkDoubleArray>> some;
        for (auto& array : read(first, last))
          if (array)
            some.push_back(array);
        return some;
      };
      try
      {
        this->Self->Internal->Sink(fields);
      }
      catch (...)
      {
        failure = std::current_exception();
      }
      wanted = { -1, -1 };
      tell();
    }
    this->Team.agree(
      [&]
      {
        if (failure)
          std::rethrow_exception(failure);
      });
  }

private:
  vtkSteadyDiffusion* Self;
  vtkImageData* Image;
  const lamella::DiffusionScene& Scene;
  const lamella::Team& Team;
  int Split = 1;
  std::vector<vtkSmartPointer<vtkDoubleArray>> Fields;
  std::vector<vtkSmartPointer<vtkDoubleArray>> Fluxes;
};

vtkStandardNewMacro(vtkSteadyDiffusion);

vtkSteadyDiffusion::vtkSteadyDiffusion()
  : Internal(std::make_unique<Internals>())
{
  this->Direction = ALL;
  this->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "axis");
  this->SetInputArrayToProcess(2, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "tensor");
  std::fill_n(this->EffectiveConductivity, 9, notSolved);
  this->EstimatedError = notSolved;
}

vtkSteadyDiffusion::~vtkSteadyDiffusion() = default;

vtkSetNamedMacro(vtkSteadyDiffusion, Conductivity, Conductivities, Internal->Conductivity);

void vtkSteadyDiffusion::RemoveConductivity(const char* phase)
{
  if (phase != nullptr && this->Internal->Conductivity.erase(phase) > 0)
    this->Modified();
}

int vtkSteadyDiffusion::GetNumberOfConductivities()
{
  return static_cast<int>(this->Internal->Conductivity.size());
}

double vtkSteadyDiffusion::GetConductivity(const char* phase)
{
  return lamella::named(this->Internal->Conductivity, phase);
}

vtkSetNamedMacro(vtkSteadyDiffusion, ConductivityAcross, ConductivitiesAcross, Internal->Across);

double vtkSteadyDiffusion::GetConductivityAcross(const char* phase)
{
  return lamella::named(this->Internal->Across, phase);
}

void vtkSteadyDiffusion::SetConductivityTensor(const char* phase, const char* numbers)
{
  lamella::setNamed(this, this->Internal->Tensor, phase, std::string(numbers != nullptr ? numbers : ""));
}
vtkRemoveAllMacro(vtkSteadyDiffusion, ConductivityTensors, Internal->Tensor);

int vtkSteadyDiffusion::GetNumberOfConductivityTensors()
{
  return static_cast<int>(this->Internal->Tensor.size());
}

vtkSetNamedMacro(vtkSteadyDiffusion, ConductivityUncertainty, ConductivityUncertainties, Internal->Uncertainty);
vtkSetNamedMacro(
  vtkSteadyDiffusion, ConductivityAcrossUncertainty, ConductivityAcrossUncertainties, Internal->AcrossUncertainty);

double vtkSteadyDiffusion::GetConductivityUncertainty(const char* phase)
{
  return lamella::named(this->Internal->Uncertainty, phase);
}

double vtkSteadyDiffusion::GetConductivityAcrossUncertainty(const char* phase)
{
  return lamella::named(this->Internal->AcrossUncertainty, phase);
}

vtkSetNamedMacro(vtkSteadyDiffusion, Membrane, Membranes, Internal->Membrane);
vtkSetNamedMacro(vtkSteadyDiffusion, Permeance, Permeances, Internal->Permeance);

int vtkSteadyDiffusion::GetNumberOfMembranes()
{
  return static_cast<int>(this->Internal->Membrane.size());
}

double vtkSteadyDiffusion::GetMembrane(const char* pair)
{
  return lamella::named(this->Internal->Membrane, pair);
}

int vtkSteadyDiffusion::GetNumberOfPermeances()
{
  return static_cast<int>(this->Internal->Permeance.size());
}

double vtkSteadyDiffusion::GetPermeance(const char* pair)
{
  return lamella::named(this->Internal->Permeance, pair);
}

bool vtkSteadyDiffusion::TellsSensitivity() const
{
  return this->ComputeSensitivity || !this->Internal->Uncertainty.empty() || !this->Internal->AcrossUncertainty.empty();
}

bool vtkSteadyDiffusion::TellsSurfaces() const
{
  return this->EstimateSegmentationError || this->SurfaceDoubt > 0;
}

// The image's field data are on the ranks that hold it.
void vtkSteadyDiffusion::TakeDoubt(vtkImageData* input, const lamella::Team& team)
{
  this->Internal->Found.surfaceDoubt =
    lamella::surfaceDoubt(input, this->SurfaceDoubt, lamella::Communicator(team.comm()));
}

void vtkSteadyDiffusion::SetFieldSink(std::function<void(const lamella::FieldLayers&)> sink)
{
  this->Internal->Sink = std::move(sink);
  this->Modified();
}

const lamella::SteadyFindings& vtkSteadyDiffusion::GetFindings() const
{
  return this->Internal->Found;
}

int vtkSteadyDiffusion::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* const in = inputVector[0]->GetInformationObject(0);
  vtkInformation* const out = outputVector->GetInformationObject(0);
  if (this->Refinement > 1 && (this->ComputeField || this->ComputeFlux) &&
    in->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()) && in->Has(vtkDataObject::SPACING()) &&
    in->Has(vtkDataObject::ORIGIN()))
  {
    std::array<int, 6> extent{};
    std::array<double, 3> spacing{};
    std::array<double, 3> origin{};
    in->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data());
    in->Get(vtkDataObject::SPACING(), spacing.data());
    in->Get(vtkDataObject::ORIGIN(), origin.data());
    // What is too large to be counted is refused when it is asked for.
    const int most = *std::ranges::max_element(extent) + 1;
    if (most <= std::numeric_limits<int>::max() / this->Refinement)
    {
      lamella::refineGeometry(extent, spacing, origin, extent[4] == extent[5] ? 2 : 3, this->Refinement);
      out->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data(), 6);
      out->Set(vtkDataObject::SPACING(), spacing.data(), 3);
      out->Set(vtkDataObject::ORIGIN(), origin.data(), 3);
    }
  }
  return 1;
}

int vtkSteadyDiffusion::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* const input = vtkImageData::GetData(inputVector[0]);
  vtkImageData* const output = vtkImageData::GetData(outputVector);
  std::fill_n(this->EffectiveConductivity, 9, notSolved);
  this->EstimatedError = notSolved;
  this->Internal->Found = {};
  const int done = this->Attempt(
    [&]
    {
      const lamella::Team team(this->Controller, outputVector->GetInformationObject(0));
      this->Solve(input, output, team);
    },
    outputVector);
  this->Internal->Directed.reset();
  this->Internal->Tensors = {};
  this->Internal->Shares.clear();
  this->Internal->Smoothed.clear();
  this->Internal->Membranes.clear();
  this->Internal->Steady = {};
  return done;
}

void vtkSteadyDiffusion::Solve(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  if (this->TargetError > 0 && !this->EstimateError)
  {
    throw lamella::ParameterError(
      fmt::format("target error {:g} and no error estimate contradict each other", this->TargetError),
      "let the error be estimated, or leave the target out");
  }
  const bool shares = this->Shares[0] != 0 || this->Shares[1] != 0;
  if (shares && !(std::abs(this->Shares[1] - this->Shares[0]) > 0))
    throw lamella::ParameterError(
      fmt::format("greys of none and of all that are both {:g}", this->Shares[0]), "give the greys of the two phases");
  if (this->SmoothLabels && (shares || this->Interpolate))
    throw lamella::ParameterError("smoothed labels of an image that is grey", "take one of them");
  const bool parts = shares || this->SmoothLabels;
  const std::string what = shares ? "greys as shares of two phases" : "smoothed labels";
  const bool directions = !this->Internal->Across.empty() || !this->Internal->Tensor.empty();
  if (parts && (this->Refinement > 1 || this->TargetError > 0 || directions))
    throw lamella::ParameterError(what + ", with pixels that are split or conduct differently by direction",
      "leave out the refinement, the target error and all but one conductivity a phase: two spacings give the error");
  if (this->Interpolate && (shares || directions))
    throw lamella::ParameterError("interpolated conductivities with shares, or by direction", "take one of them");
  if (this->TellsSurfaces() && this->Interpolate)
    throw lamella::ParameterError(
      "a segmentation error of conductivities interpolated between greys, which have no surfaces",
      "leave it out, or give each phase one conductivity");
  const bool membranes = !this->Internal->Membrane.empty() || !this->Internal->Permeance.empty();
  if (membranes)
    this->RefuseMembranes(shares);
  std::optional<lamella::GreyTable> table;
  std::optional<lamella::GreyBins> bins;
  team.agree(
    [&]
    {
      if (this->Interpolate)
        bins = table.emplace(this->Internal->Conductivity, "conductivity").bins();
      else if (shares)
        bins = lamella::GreyBins::even(this->Shares[0], this->Shares[1]);
    });
  // whose voxels have tensors; of phases that have nothing else, which are not known yet
  vtkInformation* const choice = this->GetInputArrayInformation(2);
  const char* const tensors = choice->Has(vtkDataObject::FIELD_NAME()) ? choice->Get(vtkDataObject::FIELD_NAME()) : "";
  this->Internal->VoxelTensors = !parts && !this->Interpolate &&
    team.any(input->GetNumberOfPoints() > 0 && input->GetPointData()->HasArray(tensors) != 0);
  const bool gathered = this->EstimateError || this->EstimateWindowError || this->Refinement > 1 ||
    this->TargetError > 0 || directions || this->Internal->VoxelTensors || parts || membranes;
  const lamella::DiffusionScene scene(
    input, this->GetInputArrayInformation(0), this->Direction, team, gathered, lamella::Voxels::Any, bins);
  if (table)
    team.agree([&] { this->TakeGreys(scene, *table); });
  if (this->TellsSurfaces())
    team.agree([&] { this->TakeDoubt(input, team); });
  this->Prepare(input, scene, team);
  output->ShallowCopy(input);
  // Of a state in time, which this is none, and of a window error, which may not be asked for.
  for (const char* const name :
    { "time", "inlet_flux", "outlet_flux", "window_error", "window_error_by_direction", "window_low", "window_high",
      "window_deviation", "window_freedom", "window_bias", "window_gradient", "layered_conductivity", "layered_low",
      "layered_high", "surface_sensitivity", "segmentation_error_by_direction", "total_error_by_direction",
      "membrane_names", "membrane_resistance", "membrane_area", "membrane_sensitivity" })
    output->GetFieldData()->RemoveArray(name);
  this->Internal->Found.phaseArray = storePhases(output, scene.phases, team);
  FieldStore store(this, output, scene, team);
  gathered ? this->SolveGathered(scene, store, team) : this->SolveInBlocks(scene, store, team);
  this->Conclude();
  store.put(output);
  lamella::describe(output, this->Internal->Found);
}

// What membranes do not go with.
void vtkSteadyDiffusion::RefuseMembranes(bool shares) const
{
  if (shares || this->Interpolate)
    throw lamella::ParameterError("membranes between greys, which have no surfaces",
      "give the image of phases: greys that are told apart by a threshold");
  if (this->SmoothLabels)
    throw lamella::ParameterError(
      "membranes between smoothed labels, whose voxels hold both phases", "leave one of them out");
  if (!this->Internal->Across.empty() || !this->Internal->Tensor.empty())
    throw lamella::ParameterError("membranes between phases that conduct differently by direction",
      "give each phase one conductivity, or leave the membranes out");
  if (this->Lattice == D2Q9 || this->Lattice == D3Q19 || this->Lattice == Q1)
    throw lamella::ParameterError(std::string("membranes on ") +
        lbm::name(this->Lattice == D2Q9 ? lbm::Stencil::D2Q9
            : this->Lattice == D3Q19    ? lbm::Stencil::D3Q19
                                        : lbm::Stencil::Q1),
      "they lie across straight links: take d2q5, of volumes d3q7, or leave the choice of the lattice");
  if (this->TellsSurfaces())
    throw lamella::ParameterError("a segmentation error where surfaces have membranes", "leave one of them out");
}

void vtkSteadyDiffusion::TakeMembranes(const lamella::DiffusionScene& scene)
{
  auto& internal = *this->Internal;
  const lamella::Lattice& lattice = scene.lattice();
  const std::vector<lamella::NamedMembrane> named =
    lamella::namedMembranes(scene.phases, internal.Membrane, internal.Permeance);
  for (const lamella::NamedMembrane& one : named)
    if (one.there)
      internal.Membranes.push_back(one.membrane);
  const bool wraps = this->Sides != INSULATED;
  const lbm::MembraneIds ids = lbm::membraneIds(scene.image, 1, internal.Membranes, { wraps, wraps, wraps });
  std::array<double, 3> across{ 0, 0, 0 }; // resistance of all that a straight line meets, over its length
  std::size_t at = 0;
  for (const lamella::NamedMembrane& one : named)
  {
    lamella::FoundMembrane found{ one.name, one.membrane.resistance };
    if (one.there)
    {
      found.area = ids.area[at] / lattice.spacing;
      found.place = at;
      for (std::size_t a = 0; a < 3; ++a)
        across[a] += one.membrane.resistance * ids.across[at][a] / lattice.spacing;
      ++at;
    }
    if (!(found.area > 0))
      vtkWarningMacro(<< "there is no surface between the phases of the membrane " << one.name
                      << ": it changes nothing");
    internal.Found.membranes.push_back(found);
  }
  internal.Found.membraneSeries = *std::ranges::max_element(across);
}

void vtkSteadyDiffusion::Prepare(vtkImageData* input, const lamella::DiffusionScene& scene, const lamella::Team& team)
{
  auto& internal = *this->Internal;
  lamella::SteadyFindings& found = internal.Found;
  const lamella::Lattice& lattice = scene.lattice();
  team.agree(
    [&]
    {
      if (this->Shares[0] != 0 || this->Shares[1] != 0)
      {
        this->TakeShares(scene);
        return;
      }
      if (found.rounding)
      {
        if (!internal.Uncertainty.empty())
          throw lamella::ParameterError("uncertainties of conductivities that are interpolated between greys",
            "leave them out: sensitivities tell what each grey counts for");
        return;
      }
      internal.Tensors = lamella::phaseTensors(
        scene.phases, internal.Conductivity, internal.Tensor, scene.nodes, internal.VoxelTensors, lattice.dimension);
      const auto& given = internal.Tensors.conductivity;
      found.conductivity = lamella::conductivityById(scene.phases, given, scene.nodes);
      found.across = lamella::acrossById(scene.phases, given, internal.Across, scene.nodes);
      found.uncertainty =
        lamella::uncertaintyById(scene.phases, internal.Conductivity, nullptr, internal.Uncertainty, scene.nodes);
      found.acrossUncertainty = lamella::uncertaintyById(
        scene.phases, internal.Conductivity, &internal.Across, internal.AcrossUncertainty, scene.nodes);
      if (this->SmoothLabels)
        this->TakeLabels(scene);
      const bool tensors = !internal.Tensors.source.empty();
      if (tensors && this->Lattice != AUTO_LATTICE && this->Lattice != Q1)
        throw lamella::ParameterError(
          std::string("conductivities that are tensors on ") + lbm::name(scene.stencil(this->Lattice)),
          "elements carry them: take q1, or leave the choice of the lattice");
      if (tensors && (!internal.Membrane.empty() || !internal.Permeance.empty()))
        throw lamella::ParameterError("membranes between phases that conduct differently by direction",
          "give each phase one conductivity, or leave the membranes out");
      if (!found.across.empty() && this->Lattice == D2Q9 && (this->TellsSensitivity() || this->TellsSurfaces()))
        throw lamella::ParameterError(
          std::string(this->TellsSensitivity() ? "sensitivities to" : "a segmentation error of") +
            " conductivities along and across walls on d2q9",
          "take q1, or leave the choice of the lattice");
      if (!found.across.empty() && this->Lattice != AUTO_LATTICE && this->Lattice != D2Q9 && this->Lattice != Q1)
        throw lamella::ParameterError(
          std::string("conductivities along and across walls on ") + lbm::name(scene.stencil(this->Lattice)),
          "they want the diagonal links of d2q9, or elements, q1: choose one, or leave the choice");
      if (!found.across.empty() && this->Lattice == D2Q9 && this->Sides == MIXED)
        throw lamella::ParameterError(
          "conductivities along and across walls with mixed sides on d2q9", "take q1, or insulated or periodic sides");
      if (!internal.Membrane.empty() || !internal.Permeance.empty())
        this->TakeMembranes(scene);
    });
  internal.Axes = { this->Direction };
  if (this->Direction == ALL)
    internal.Axes = lattice.dimension == 3 ? std::vector<int>{ X, Y, Z } : std::vector<int>{ X, Y };
  for (const int axis : internal.Axes)
  {
    if (lattice.size[static_cast<std::size_t>(axis)] < 2)
    {
      const bool volume = lattice.dimension == 3;
      throw lamella::InputError(fmt::format("the {} is {} × {}{} {}: one node along {} has no conductivity of its own",
                                  volume ? "volume" : "picture", lattice.size[0], lattice.size[1],
                                  volume ? fmt::format(" × {}", lattice.size[2]) : "", volume ? "voxels" : "pixels",
                                  lamella::axisNames[static_cast<std::size_t>(axis)]),
        "give a larger picture, or solve along another direction only");
    }
  }
  found.dimension = lattice.dimension;
  found.stencil = scene.stencil(this->Lattice);
  if ((!found.across.empty() || !internal.Tensors.source.empty()) && this->Lattice == AUTO_LATTICE)
  {
    const bool links = internal.Tensors.source.empty() && lattice.dimension == 2 && lattice.cubes() &&
      this->Sides != MIXED && !this->TellsSensitivity() && !this->TellsSurfaces() &&
      lbm::linksCarry(found.conductivity, found.across);
    found.stencil = links ? lbm::Stencil::D2Q9 : lbm::Stencil::Q1;
  }
  if (!found.shares)
    found.phases = scene.phases.names;
  found.targetError = this->TargetError;
  found.direction = this->Direction == ALL ? "all" : lamella::axisNames[static_cast<std::size_t>(this->Direction)];
  found.sides = this->SidesName();
  found.quantity = this->QuantityName();
  found.tolerance = this->Tolerance;
  if (!found.shares)
  {
    found.fractions.assign(scene.nodes.begin(), scene.nodes.end());
    for (double& fraction : found.fractions)
      fraction /= static_cast<double>(lattice.count());
    internal.Values = found.conductivity;
  }
  if (!found.across.empty() || !internal.Tensors.source.empty())
    this->TakeDirections(input, scene, team);
  lbm::SteadyOptions& options = internal.Steady;
  options.stencil = found.stencil;
  options.sides = this->Sides == PERIODIC ? lbm::Sides::Periodic
    : this->Sides == MIXED                ? lbm::Sides::Mixed
                                          : lbm::Sides::Insulated;
  options.method = methodOf(this->Method);
  options.tolerance = this->Tolerance;
  options.maxIterations = this->MaximumIterations;
  options.threads = this->ThreadCount();
  const bool fields = this->ComputeField || this->ComputeFlux;
  if (!fields)
    options.fieldTolerance = std::numeric_limits<double>::infinity(); // nobody sees the field
  lbm::StudySize size{ lattice, 0, found.stencil, this->Refinement, fields && !internal.Sink };
  for (std::size_t id = 0; id < scene.nodes.size(); ++id)
    size.conducting += internal.Values[id] > 0 ? scene.nodes[id] : 0;
  size.membranes = !internal.Membranes.empty();
  const lamella::Communicator comm(team.comm());
  size.ranks = comm.size();
  size.ranksOnMachine = comm.sizeOnMachine();
  team.agree([&] { lbm::requireMemory(size); });
  if (std::string words = lbm::plan(size, static_cast<int>(internal.Axes.size()), options.threads); !words.empty())
    this->InvokeEvent(PLAN_EVENT, words.data());
}

// What phases conduct that conduct differently by direction.
void vtkSteadyDiffusion::TakeDirections(
  vtkImageData* input, const lamella::DiffusionScene& scene, const lamella::Team& team)
{
  using Source = lbm::DirectedDiffusivity::Source;
  auto& internal = *this->Internal;
  lamella::SteadyFindings& found = internal.Found;
  const lamella::Lattice& lattice = scene.lattice();
  auto directed = std::make_shared<lbm::DirectedDiffusivity>();
  directed->along = found.conductivity;
  directed->across = found.across.empty() ? found.conductivity : found.across;
  if (!found.across.empty())
  {
    const lamella::NodeVectors axis = lamella::vectorsOf(input, this->GetInputArrayInformation(1), "axis",
      "give the directions along the walls, as MicrographLattice does, take one conductivity a phase",
      lattice.dimension, team);
    directed->axis = lamella::gatherAxes(lattice, scene.whole.held, axis.array, team);
  }
  if (!internal.Tensors.source.empty())
  {
    directed->source = internal.Tensors.source;
    directed->ofPhase = internal.Tensors.ofPhase;
    if (std::ranges::find(directed->source, Source::Node) != directed->source.end())
      directed->ofNode = lamella::gatherTensors(lattice, scene.whole.held,
        input->GetNumberOfPoints() > 0
          ? input->GetPointData()->GetArray(this->GetInputArrayInformation(2)->Get(vtkDataObject::FIELD_NAME()))
          : nullptr,
        team);
    directed->takeTensors(lattice, scene.image.phase);
    found.tensors = directed->means(scene.image.phase);
    found.conductivity = directed->along;
    if (!found.across.empty())
      found.across = directed->across;
  }
  internal.Values = directed->larger(); // what conducts at all
  internal.Directed = std::move(directed);
}

// What each grey conducts.
void vtkSteadyDiffusion::TakeGreys(const lamella::DiffusionScene& scene, const lamella::GreyTable& table)
{
  lamella::SteadyFindings& found = this->Internal->Found;
  const lamella::GreyBins bins = table.bins();
  bool binned = scene.phases.names.size() == bins.count();
  for (std::size_t bin = 0; binned && bin < bins.count(); ++bin)
    binned = scene.phases.names[bin] == bins.name(bin);
  found.rounding = binned ? table.rounding() : 0.0;
  bool below = true; // all that there are
  bool above = true;
  for (std::size_t id = 0; id < scene.phases.names.size(); ++id)
  {
    const std::string& name = scene.phases.names[id];
    const std::optional<double> grey = lamella::toNumber(name);
    if (!grey)
      throw lamella::ParameterError(
        "conductivities interpolated between greys for an image whose phases have names, as '" + name + "'",
        "give the grey image itself, and no names of phases");
    found.conductivity.push_back(table.value(*grey));
    if (scene.nodes[id] > 0)
    {
      below = below && *grey <= table.lowest();
      above = above && *grey >= table.highest();
    }
  }
  if (below || above)
    throw lamella::InputError(fmt::format("no grey lies between {:g} and {:g}: all are {}", table.lowest(),
                                table.highest(), below ? "below" : "above"),
      "give the conductivities of greys that the image has; lamella info tells them");
}

// What the greys say of the two phases.
void vtkSteadyDiffusion::TakeShares(const lamella::DiffusionScene& scene)
{
  auto& internal = *this->Internal;
  lamella::SteadyFindings& found = internal.Found;
  const std::string remedy = "give conductivities of low and high, the phases of the low and of the high greys";
  for (const auto& [name, value] : internal.Conductivity)
    if (name != "low" && name != "high")
      throw lamella::ParameterError("a conductivity of '" + name + "' where greys are shares of two phases", remedy);
  for (const char* const name : { "low", "high" })
  {
    const auto given = internal.Conductivity.find(name);
    if (given == internal.Conductivity.end())
      throw lamella::ParameterError(std::string("no conductivity of '") + name + "'", remedy);
    if (!std::isfinite(given->second) || given->second < 0)
      throw lamella::ParameterError(fmt::format("the conductivity of {} is {}", name, given->second),
        "give a positive value, or 0 for a phase that does not conduct");
    found.conductivity.push_back(given->second);
    const auto doubt = internal.Uncertainty.find(name);
    if (!internal.Uncertainty.empty())
      found.uncertainty.push_back(doubt == internal.Uncertainty.end() ? 0.0 : doubt->second);
  }
  for (const auto& [name, value] : internal.Uncertainty)
    if ((name != "low" && name != "high") || !std::isfinite(value) || value < 0)
      throw lamella::ParameterError(fmt::format("an uncertainty of {} of '{}'", value, name), remedy);
  double sum = 0;
  for (std::size_t id = 0; id < scene.nodes.size(); ++id)
  {
    const std::string& text = scene.phases.names[id]; // of what nobody named: the grey
    const std::optional<double> grey = lamella::toNumber(text);
    if (!grey)
      throw lamella::ParameterError(
        "shares of greys were given for an image whose phases have names, as '" + text + "'",
        "give the grey image itself, and no names of phases");
    internal.Shares.push_back(std::clamp((*grey - this->Shares[0]) / (this->Shares[1] - this->Shares[0]), 0.0, 1.0));
    sum += internal.Shares.back() * static_cast<double>(scene.nodes[id]);
  }
  const double high = sum / static_cast<double>(scene.lattice().count());
  const auto crosses = [&](auto&& side)
  {
    for (std::size_t id = 0; id < scene.nodes.size(); ++id)
      if (scene.nodes[id] > 0 && side(internal.Shares[id]))
        return true;
    return false;
  };
  const bool someHigh = crosses([](double share) { return share > 0.5; });
  if (!someHigh || !crosses([](double share) { return share < 0.5; }))
    throw lamella::InputError(fmt::format("no node crosses from {:g} to {:g}: {}", this->Shares[0], this->Shares[1],
                                someHigh ? "all are more high than low" : "none is more high than low"),
      "give the greys of the two phases, as the peaks of the histogram show them");
  found.shares = true;
  found.phases = { "low", "high" };
  found.fractions = { 1 - high, high };
  for (const double share : internal.Shares)
    internal.Values.push_back(share * found.conductivity[1] + (1 - share) * found.conductivity[0]);
}

// Which two phases there are.
void vtkSteadyDiffusion::TakeLabels(const lamella::DiffusionScene& scene)
{
  std::vector<std::size_t>& two = this->Internal->Smoothed;
  std::string names;
  for (std::size_t id = 0; id < scene.nodes.size(); ++id)
    if (scene.nodes[id] > 0)
    {
      two.push_back(id);
      names += (names.empty() ? "" : ", ") + scene.phases.names[id];
    }
  if (two.size() != 2)
    throw lamella::InputError(
      fmt::format("smoothed labels of {} phase{}: {}", two.size(), two.size() == 1 ? "" : "s", names),
      "give an image of two phases, or take its voxels as they are");
}

void vtkSteadyDiffusion::SolveInBlocks(
  const lamella::DiffusionScene& scene, FieldStore& store, const lamella::Team& team)
{
  auto& internal = *this->Internal;
  // Each solve counts from 0 again: the next one has begun when the share falls.
  const auto solves = static_cast<double>(internal.Axes.size());
  double done = 0;
  double last = 0;
  internal.Steady.progress = [this, solves, &done, &last](double share, const char* what)
  {
    done += share < last ? 1 : 0;
    last = share;
    this->SetProgressText(what);
    this->UpdateProgress(std::min((done + share) / solves, 1.0));
    return !this->CheckAbort();
  };
  lbm::SteadyDiffusion solver(scene.lattice(), scene.block, scene.ids, internal.Values, internal.Steady, team.comm());
  lbm::requirePaths(solver, internal.Axes, scene.lattice().dimension);
  for (const int axis : internal.Axes)
  {
    lbm::DiffusionAnswer answer;
    answer.axis = axis;
    answer.result = solver.solve(axis);
    if (this->TellsSensitivity())
      answer.derivatives = solver.derivatives();
    if (this->TellsSurfaces())
      answer.surfaces = solver.surfaceDerivatives();
    lbm::RefinementStep step;
    step.value = answer.result.effective[static_cast<std::size_t>(axis)];
    step.nodes = answer.result.nodes;
    step.iterations = answer.result.iterations;
    step.seconds = lamella::Communicator(team.comm()).max(answer.result.setupSeconds + answer.result.solveSeconds);
    answer.steps.push_back(step);
    internal.Found.answers.push_back(answer);
    if (store.wanted())
      store.take(solver, axis, scene.lattice(), scene.block);
  }
}

void vtkSteadyDiffusion::SolveGathered(
  const lamella::DiffusionScene& scene, FieldStore& store, const lamella::Team& team)
{
  auto& internal = *this->Internal;
  lbm::StudyOptions study;
  study.steady = internal.Steady;
  study.steady.progress = [this](double share, const char* what) // of the whole study
  {
    this->SetProgressText(what);
    this->UpdateProgress(std::min(share, 1.0));
    return !this->CheckAbort();
  };
  study.axes = internal.Axes;
  study.refinement = this->Refinement;
  study.estimateError = this->EstimateError;
  study.derivatives = this->TellsSensitivity();
  study.surfaces = this->TellsSurfaces();
  study.windowError = this->EstimateWindowError;
  study.directed = internal.Directed;
  study.membranes = internal.Membranes;
  if (this->TargetError > 0)
  {
    study.targetError = this->TargetError;
    study.announce = [this](const lbm::TargetPlan& plan)
    {
      std::string words = lbm::text(plan);
      this->InvokeEvent(PLAN_EVENT, words.data());
      return !this->CheckAbort();
    };
  }
  lbm::FieldSink take;
  if (store.wanted())
  {
    take = [&store](const lbm::SteadyDiffusion& solver, const lbm::DiffusionAnswer& answer,
             const lamella::Lattice& lattice, const lbm::Block& block)
    { store.take(solver, answer.axis, lattice, block); };
  }
  const std::vector<double>& k = internal.Found.conductivity;
  if (!internal.Smoothed.empty())
  {
    const std::size_t a = internal.Smoothed[0];
    const std::size_t b = internal.Smoothed[1];
    lbm::LabelAnswers found =
      lbm::studyLabels(scene.image, static_cast<std::uint8_t>(b), { k[a], k[b] }, study, team.comm(), take);
    for (lbm::DiffusionAnswer& answer : found.answers)
      spread(answer, k.size(), a, b);
    internal.Found.answers = std::move(found.answers);
    internal.Found.fractions[a] = 1 - found.second;
    internal.Found.fractions[b] = found.second;
    return;
  }
  internal.Found.answers = internal.Shares.empty()
    ? lbm::studyDiffusion(scene.image, internal.Values, study, team.comm(), take)
    : lbm::studyShares(scene.image, internal.Shares, k[0], k[1], study, team.comm(), take);
}

void vtkSteadyDiffusion::Conclude()
{
  const auto& internal = *this->Internal;
  lamella::SteadyFindings& found = this->Internal->Found;
  found.bounds = lbm::bounds(found.fractions, found.shares ? found.conductivity : internal.Values, found.dimension);
  if (internal.Directed) // more of a conductor conducts no less
  {
    const lbm::Bounds least = lbm::bounds(found.fractions, internal.Directed->smaller(), found.dimension);
    found.bounds.series = least.series;
    found.bounds.hashinShtrikmanLower = least.hashinShtrikmanLower;
  }
  if (!found.membranes.empty()) // one flux throughout; Hashin and Shtrikman's lower one knows of no membranes
  {
    found.bounds.series = found.bounds.series > 0 ? 1 / (1 / found.bounds.series + found.membraneSeries) : 0;
    found.bounds.hashinShtrikmanLower = found.bounds.series;
  }
  std::ranges::copy(found.tensor(), this->EffectiveConductivity);
  this->EstimatedError = found.error();
  if (this->EstimateError)
  {
    for (const lbm::DiffusionAnswer& answer : found.answers)
    {
      if (!std::isfinite(answer.error.relative))
      {
        vtkWarningMacro("the error along "
          << lamella::axisNames[static_cast<std::size_t>(answer.axis)] << " could not be estimated: "
          << (found.shares || this->SmoothLabels
                 ? "voxels of twice the size would be too few"
                 : "the middle of the sample, which is solved for it, has no conducting path"));
      }
    }
  }
  found.windows = this->EstimateWindowError;
  if (this->EstimateWindowError &&
    std::ranges::any_of(found.answers, [](const lbm::DiffusionAnswer& answer) { return !answer.window; }))
    vtkWarningMacro("the window error could not be told: the sample is too small to be cut into windows");
  if (this->TargetError > 0)
  {
    found.shortfall = lbm::shortfall(found.answers, this->TargetError, found.outlinesServe());
    if (!found.shortfall.message.empty())
      vtkWarningMacro(<< found.shortfall.message << "\nhint: " << found.shortfall.hint);
  }
}
