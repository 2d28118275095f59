#include "vtkSteadyDiffusion.h"

#include "BondFields.h"
#include "DiffusionScene.h"
#include "WallConductivity.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "lattice/Error.h"
#include "lbm/Bounds.h"
#include "lbm/DiffusionStudy.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
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

/// The largest of those that are numbers, else NaN.
double worst(const std::array<double, 3>& errors)
{
  return *std::ranges::max_element(errors, [](double a, double b) { return std::isnan(a) || a < b; });
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
  std::map<std::string, double> Across; ///< of the phases whose conductivity differs across the wall

  /// By direction, NaN where not solved.
  using ByDirection = std::array<double, 3>;
  std::array<ByDirection, 3> Effective; ///< columns of the tensor
  ByDirection Balance;
  ByDirection Iterations;
  ByDirection Stored;
  ByDirection Skipped;
  ByDirection Error;
  ByDirection LatticeError;
  ByDirection PictureError;
  ByDirection Extrapolated;
  std::vector<double> PhaseConductivity; ///< by id
  std::vector<double> PhaseAcross;       ///< by id; empty: the same in every direction
  std::vector<double> PhaseFraction;     ///< by id
  std::vector<std::string> PhaseNames;   ///< by id
  std::string PhaseArray;
  std::string LatticeName;
  lbm::Bounds Bounds;

  void Forget()
  {
    for (ByDirection* const numbers :
      { &this->Effective[0], &this->Effective[1], &this->Effective[2], &this->Balance, &this->Iterations, &this->Stored,
        &this->Skipped, &this->Error, &this->LatticeError, &this->PictureError, &this->Extrapolated })
    {
      numbers->fill(notSolved);
    }
  }
  void Keep(int axis, const lbm::SteadyResult& result)
  {
    const auto place = static_cast<std::size_t>(axis);
    this->Effective[place] = result.effective;
    this->Balance[place] = result.balance;
    this->Iterations[place] = result.iterations;
    this->Stored[place] = static_cast<double>(result.stored);
    this->Skipped[place] = static_cast<double>(result.skipped);
  }
};

/// Puts the fields of a solve into the output, as asked for.
struct vtkSteadyDiffusion::FieldStore
{
  vtkSteadyDiffusion* Self;
  vtkImageData* Output;
  const lamella::DiffusionScene& Scene;

  void operator()(const lbm::SteadyDiffusion& solver, int axis) const
  {
    const bool all = this->Self->Direction == ALL;
    const std::string suffix = all ? std::string("_") + lamella::axisNames[static_cast<std::size_t>(axis)] : "";
    const std::string quantity = this->Self->QuantityName();
    // The solver has value 1 on the low face.
    const bool fromTop = this->Scene.fromTop(axis);
    vtkPointData* const points = this->Output->GetPointData();
    const bool first = !all || axis == X;
    if (this->Self->ComputeField)
    {
      const auto field = this->Scene.array(quantity + suffix, 1, [&](std::span<double> out) { solver.value(out); });
      if (fromTop)
      {
        change(field, [](double& value) { value = 1 - value; });
      }
      lamella::describe(field, "1", quantity + ", 1 at the inlet and 0 at the outlet", "vtkSteadyDiffusion");
      points->AddArray(field);
      if (first)
      {
        points->SetActiveScalars(field->GetName());
      }
    }
    if (this->Self->ComputeFlux)
    {
      const auto flux = this->Scene.array("flux" + suffix, 3, [&](std::span<double> out) { solver.flux(out); });
      if (fromTop)
      {
        change(flux, [](double& value) { value = value == 0 ? 0 : -value; });
      }
      lamella::describe(flux, "conductivity/m", "flux of " + quantity + ", -D grad u", "vtkSteadyDiffusion");
      points->AddArray(flux);
      if (first)
      {
        points->SetActiveVectors(flux->GetName());
      }
    }
  }
};

vtkStandardNewMacro(vtkSteadyDiffusion);

vtkSteadyDiffusion::vtkSteadyDiffusion()
  : Internal(std::make_unique<Internals>())
{
  this->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "axis");
  std::fill_n(this->EffectiveConductivity, 9, notSolved);
  this->EstimatedError = notSolved;
  this->Internal->Forget();
}

vtkSteadyDiffusion::~vtkSteadyDiffusion() = default;

void vtkSteadyDiffusion::SetConductivity(const char* phase, double value)
{
  this->SetPhaseValue(this->Internal->Conductivity, phase, value);
}

void vtkSteadyDiffusion::RemoveConductivity(const char* phase)
{
  this->RemovePhaseValue(this->Internal->Conductivity, phase);
}

void vtkSteadyDiffusion::RemoveAllConductivities()
{
  this->RemoveAllPhaseValues(this->Internal->Conductivity);
}

int vtkSteadyDiffusion::GetNumberOfConductivities()
{
  return static_cast<int>(this->Internal->Conductivity.size());
}

double vtkSteadyDiffusion::GetConductivity(const char* phase)
{
  return PhaseValue(this->Internal->Conductivity, phase);
}

void vtkSteadyDiffusion::SetConductivityAcross(const char* phase, double value)
{
  this->SetPhaseValue(this->Internal->Across, phase, value);
}

void vtkSteadyDiffusion::RemoveAllConductivitiesAcross()
{
  this->RemoveAllPhaseValues(this->Internal->Across);
}

double vtkSteadyDiffusion::GetConductivityAcross(const char* phase)
{
  return PhaseValue(this->Internal->Across, phase);
}

int vtkSteadyDiffusion::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* const input = vtkImageData::GetData(inputVector[0]);
  vtkImageData* const output = vtkImageData::GetData(outputVector);
  std::fill_n(this->EffectiveConductivity, 9, notSolved);
  this->EstimatedError = notSolved;
  this->Internal->Forget();
  return this->Attempt(
    [&]
    {
      const lamella::Team team(this->Controller, outputVector->GetInformationObject(0));
      this->Solve(input, output, team);
    },
    outputVector);
}

void vtkSteadyDiffusion::Solve(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  const lamella::DiffusionScene scene(input, this->GetInputArrayInformation(0), this->Direction, team);
  const lamella::Lattice& lattice = scene.lattice();
  const lamella::PhaseIds& phases = scene.phases;
  const bool periodic = this->Sides == PERIODIC;
  std::vector<double> conductivity;
  std::vector<double> across;
  team.agree(
    [&]
    {
      conductivity = lamella::conductivityById(phases, this->Internal->Conductivity, scene.nodes);
      across = lamella::acrossById(phases, this->Internal->Conductivity, this->Internal->Across, scene.nodes);
      if (!across.empty() && this->Lattice != AUTO_LATTICE && this->Lattice != D2Q9)
      {
        throw lamella::ParameterError(
          std::string("conductivities along and across walls on ") + lbm::name(scene.stencil(this->Lattice)),
          "they want the diagonal links of d2q9: choose it, or leave the choice");
      }
      if (!across.empty() && lattice.dimension != 2)
      {
        throw lamella::ParameterError("conductivities along and across walls in a volume",
          "they go with pictures; give each phase of a volume one value");
      }
    });
  auto& internal = *this->Internal;
  internal.PhaseConductivity = conductivity;
  internal.PhaseAcross = across;

  lbm::SteadyOptions options;
  options.stencil = across.empty() ? scene.stencil(this->Lattice) : lbm::Stencil::D2Q9;
  options.sides = periodic ? lbm::Sides::Periodic : lbm::Sides::Insulated;
  options.method = methodOf(this->Method);
  options.tolerance = this->Tolerance;
  options.maxIterations = this->MaximumIterations;
  options.threads = this->ThreadCount();
  std::vector<int> axes{ this->Direction };
  if (this->Direction == ALL)
  {
    axes = lattice.dimension == 3 ? std::vector<int>{ X, Y, Z } : std::vector<int>{ X, Y };
  }
  // Without an estimate each solve counts from 0 again: the next one has begun when the share falls. A study tells the
  // share of the whole.
  const double solves = this->EstimateError ? 1.0 : static_cast<double>(axes.size());
  double done = 0;
  double last = 0;
  options.progress = [this, solves, &done, &last](double share, const char* what)
  {
    done += share < last && solves > 1 ? 1 : 0;
    last = share;
    this->SetProgressText(what);
    this->UpdateProgress(std::min((done + share) / solves, 1.0));
    return !this->CheckAbort();
  };

  output->ShallowCopy(input);
  for (const char* const name : { "time", "inlet_flux", "outlet_flux" }) // of a state in time: this is none
  {
    output->GetFieldData()->RemoveArray(name);
  }
  const FieldStore store{ this, output, scene };
  std::shared_ptr<lbm::DirectedDiffusivity> directed;
  lamella::PhaseImage image;
  if (!across.empty() || this->EstimateError)
  {
    image = lamella::gatherPhases(lattice, scene.whole.held, phases, team);
  }
  if (!across.empty())
  {
    const lamella::NodeVectors axis = lamella::vectorsOf(input, this->GetInputArrayInformation(1), "axis",
      "give the directions along the walls, as MicrographLattice does, take one conductivity a phase", 2, team);
    directed = std::make_shared<lbm::DirectedDiffusivity>(lbm::DirectedDiffusivity{
      conductivity, across, lamella::gatherAxes(lattice, scene.whole.held, axis.array, team) });
    conductivity = directed->larger(); // what conducts at all
  }
  if (!this->EstimateError)
  {
    if (directed)
    {
      options.links =
        std::make_shared<lbm::LinkTable>(lbm::directedLinks(lattice, image.phase, *directed, options.sides));
    }
    lbm::SteadyDiffusion solver(lattice, scene.block, scene.ids, conductivity, options, team.comm());
    for (const int axis : axes)
    {
      const lbm::SteadyResult result = solver.solve(axis);
      internal.Keep(axis, result);
      store(solver, axis);
    }
  }
  else
  {
    lbm::StudyOptions study;
    study.steady = options;
    study.axes = axes;
    study.directed = directed;
    for (const lbm::DiffusionAnswer& answer : lbm::studyDiffusion(image, conductivity, study, team.comm(),
           [&](const lbm::SteadyDiffusion&solver, const lbm::DiffusionAnswer&sofar, const lamella::Lattice&,
             const lbm::Block&) { store(solver, sofar.axis); }))
    {
      internal.Keep(answer.axis, answer.result);
      internal.Error[static_cast<std::size_t>(answer.axis)] = answer.error.relative;
      internal.LatticeError[static_cast<std::size_t>(answer.axis)] = answer.error.lattice;
      internal.PictureError[static_cast<std::size_t>(answer.axis)] = answer.error.picture;
      internal.Extrapolated[static_cast<std::size_t>(answer.axis)] = answer.error.extrapolated;
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto& column = internal.Effective[static_cast<std::size_t>(axis)];
    for (int row = 0; row < 3; ++row)
    {
      this->EffectiveConductivity[3 * row + axis] =
        row < lattice.dimension ? column[static_cast<std::size_t>(row)] : notSolved;
    }
  }
  this->EstimatedError = worst(internal.Error);
  internal.PhaseFraction.assign(scene.nodes.begin(), scene.nodes.end());
  for (double& fraction : internal.PhaseFraction)
  {
    fraction /= static_cast<double>(lattice.count());
  }
  internal.Bounds = lbm::bounds(internal.PhaseFraction, conductivity, lattice.dimension);
  if (directed) // more of a conductor conducts no less
  {
    const lbm::Bounds least = lbm::bounds(internal.PhaseFraction, directed->smaller(), lattice.dimension);
    internal.Bounds.series = least.series;
    internal.Bounds.hashinShtrikmanLower = least.hashinShtrikmanLower;
  }
  internal.PhaseNames = phases.names;
  internal.PhaseArray = storePhases(output, phases, team);
  internal.LatticeName = lbm::name(options.stencil);
  this->Describe(output);
}

void vtkSteadyDiffusion::Describe(vtkImageData* output)
{
  const auto& internal = *this->Internal;
  const std::string direction =
    this->Direction == ALL ? "all" : lamella::axisNames[static_cast<std::size_t>(this->Direction)];
  const std::string sides = this->SidesName();
  const std::string quantity = this->QuantityName();
  lamella::setFieldNumbers(output, "effective_conductivity", this->EffectiveConductivity);
  lamella::setFieldNumbers(output, "estimated_error", std::span(&this->EstimatedError, 1));
  lamella::setFieldNumbers(output, "estimated_error_by_direction", internal.Error);
  for (const auto& [name, errors] :
    { std::pair{ "lattice_error", &internal.LatticeError }, std::pair{ "picture_error", &internal.PictureError } })
  {
    const double largest = worst(*errors);
    lamella::setFieldNumbers(output, name, std::span(&largest, 1));
    lamella::setFieldNumbers(output, (std::string(name) + "_by_direction").c_str(), *errors);
  }
  lamella::setFieldNumbers(output, "extrapolated_conductivity", internal.Extrapolated);
  const lbm::Bounds& bounds = internal.Bounds;
  const std::array<double, 4> limits{ bounds.series, bounds.hashinShtrikmanLower, bounds.hashinShtrikmanUpper,
    bounds.parallel };
  lamella::setFieldNumbers(output, "bounds", limits);
  lamella::setFieldNumbers(output, "balance", internal.Balance);
  lamella::setFieldNumbers(output, "iterations", internal.Iterations);
  lamella::setFieldNumbers(output, "stored_nodes", internal.Stored);
  lamella::setFieldNumbers(output, "skipped_nodes", internal.Skipped);
  const int phases = static_cast<int>(internal.PhaseConductivity.size());
  lamella::setFieldNumbers(output, "phase_conductivity", internal.PhaseConductivity);
  if (!internal.PhaseAcross.empty())
  {
    lamella::setFieldNumbers(output, "phase_conductivity_across", internal.PhaseAcross);
  }
  lamella::setFieldNumbers(output, "phase_fraction", internal.PhaseFraction);
  lamella::setFieldTexts(output, "phase_names", internal.PhaseNames);
  lamella::setFieldText(output, "phase_array", internal.PhaseArray);
  lamella::setFieldText(output, "direction", direction);
  lamella::setFieldText(output, "sides", sides);
  lamella::setFieldText(output, "lattice", internal.LatticeName);
  lamella::setFieldText(output, "quantity", quantity);

  nlohmann::json conductivity;
  for (int id = 0; id < phases; ++id)
  {
    const auto place = static_cast<std::size_t>(id);
    if (internal.PhaseFraction[place] > 0)
    {
      auto& entry = conductivity[internal.PhaseNames[place]];
      entry = internal.PhaseConductivity[place];
      if (!internal.PhaseAcross.empty() && internal.PhaseAcross[place] != internal.PhaseConductivity[place])
      {
        entry = { internal.PhaseConductivity[place], internal.PhaseAcross[place] }; // along, across
      }
    }
  }
  lamella::continueProvenance(output, "steady_diffusion",
    { { "conductivity", conductivity }, { "direction", direction }, { "quantity", quantity }, { "sides", sides },
      { "lattice", internal.LatticeName }, { "tolerance", this->Tolerance } });
}

void vtkSteadyDiffusion::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Method: " << this->Method << "\n"
     << indent << "Tolerance: " << this->Tolerance << "\n"
     << indent << "MaximumIterations: " << this->MaximumIterations << "\n"
     << indent << "ComputeField: " << this->ComputeField << "\n"
     << indent << "EstimateError: " << this->EstimateError << "\n";
  PrintPhaseValues(os, indent, "Conductivity of", this->Internal->Conductivity);
  PrintPhaseValues(os, indent, "Conductivity across", this->Internal->Across);
}
