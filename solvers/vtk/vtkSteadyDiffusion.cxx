#include "vtkSteadyDiffusion.h"

#include "Attempt.h"
#include "BondFields.h"
#include "BoxExchange.h"
#include "PhaseIds.h"
#include "ThreadCount.h"
#include "WallConductivity.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "lattice/Error.h"
#include "lbm/Bounds.h"
#include "lbm/DiffusionStudy.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
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
constexpr std::array<const char*, 3> axisName{ "x", "y", "z" };
constexpr std::array<const char*, 2> quantityName{ "temperature", "concentration" };

lbm::Stencil stencilOf(int lattice, int dimension)
{
  switch (lattice)
  {
    case vtkSteadyDiffusion::D2Q5:
      return lbm::Stencil::D2Q5;
    case vtkSteadyDiffusion::D2Q9:
      return lbm::Stencil::D2Q9;
    case vtkSteadyDiffusion::D3Q7:
      return lbm::Stencil::D3Q7;
    case vtkSteadyDiffusion::D3Q19:
      return lbm::Stencil::D3Q19;
    default:
      return dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5;
  }
}

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

std::span<double> values(vtkDoubleArray* array)
{
  return { array->GetPointer(0), static_cast<std::size_t>(array->GetNumberOfValues()) };
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
    for (ByDirection* const numbers : { &this->Effective[0], &this->Effective[1], &this->Effective[2], &this->Balance,
           &this->Iterations, &this->Stored, &this->Skipped, &this->Error, &this->Extrapolated })
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
  const lamella::Lattice& Lattice;
  const lbm::Block& Block;
  const lamella::BoxExchange& Outward; ///< from the solver's block to the piece

  void operator()(const lbm::SteadyDiffusion& solver, int axis) const
  {
    const bool all = this->Self->Direction == ALL;
    const std::string suffix = all ? std::string("_") + axisName[static_cast<std::size_t>(axis)] : "";
    const std::string quantity = quantityName[static_cast<std::size_t>(this->Self->Quantity)];
    // The solver has value 1 on the low face; in a picture y starts at the top, which is the high face.
    const bool fromTop = this->Lattice.dimension == 2 && axis == Y;
    vtkPointData* const points = this->Output->GetPointData();
    const bool first = !all || axis == X;
    if (this->Self->ComputeField)
    {
      vtkDoubleArray* const field = this->Add(quantity + suffix, 1, [&](std::span<double> out) { solver.value(out); });
      if (fromTop)
      {
        std::ranges::for_each(values(field), [](double& value) { value = 1 - value; });
      }
      lamella::describe(field, "1", quantity + ", 1 at the inlet and 0 at the outlet", "vtkSteadyDiffusion");
      if (first)
      {
        points->SetActiveScalars(field->GetName());
      }
    }
    if (this->Self->ComputeFlux)
    {
      vtkDoubleArray* const flux = this->Add("flux" + suffix, 3, [&](std::span<double> out) { solver.flux(out); });
      if (fromTop)
      {
        std::ranges::for_each(values(flux), [](double& value) { value = value == 0 ? 0 : -value; });
      }
      lamella::describe(flux, "conductivity/m", "flux of " + quantity + ", -D grad u", "vtkSteadyDiffusion");
      if (first)
      {
        points->SetActiveVectors(flux->GetName());
      }
    }
  }

  template <typename Read>
  vtkDoubleArray* Add(const std::string& name, int components, const Read& read) const
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name.c_str());
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(this->Output->GetNumberOfPoints());
    if (this->Outward.identity())
    {
      read(values(array));
    }
    else
    {
      std::vector<double> own(static_cast<std::size_t>(this->Block.count() * components));
      read(std::span<double>(own));
      this->Outward.run<double>(own, values(array), components);
    }
    this->Output->GetPointData()->AddArray(array); // the image keeps it
    return array;
  }
};

vtkStandardNewMacro(vtkSteadyDiffusion);

vtkSteadyDiffusion::vtkSteadyDiffusion()
  : Internal(std::make_unique<Internals>())
{
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
  this->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "axis");
  std::fill_n(this->EffectiveConductivity, 9, notSolved);
  this->EstimatedError = notSolved;
  this->Internal->Forget();
  this->SetController(vtkMultiProcessController::GetGlobalController());
}

vtkSteadyDiffusion::~vtkSteadyDiffusion()
{
  this->SetController(nullptr);
}

vtkCxxSetObjectMacro(vtkSteadyDiffusion, Controller, vtkMultiProcessController);

void vtkSteadyDiffusion::SetConductivity(const char* phase, double value)
{
  if (phase == nullptr || *phase == '\0')
  {
    return; // an empty row in a panel
  }
  const auto entry = this->Internal->Conductivity.find(phase);
  if (entry != this->Internal->Conductivity.end() && entry->second == value)
  {
    return;
  }
  this->Internal->Conductivity[phase] = value;
  this->Modified();
}

void vtkSteadyDiffusion::RemoveConductivity(const char* phase)
{
  if (phase != nullptr && this->Internal->Conductivity.erase(phase) > 0)
  {
    this->Modified();
  }
}

void vtkSteadyDiffusion::RemoveAllConductivities()
{
  if (!this->Internal->Conductivity.empty())
  {
    this->Internal->Conductivity.clear();
    this->Modified();
  }
}

int vtkSteadyDiffusion::GetNumberOfConductivities()
{
  return static_cast<int>(this->Internal->Conductivity.size());
}

double vtkSteadyDiffusion::GetConductivity(const char* phase)
{
  const auto entry = this->Internal->Conductivity.find(phase != nullptr ? phase : "");
  return entry != this->Internal->Conductivity.end() ? entry->second : notSolved;
}

void vtkSteadyDiffusion::SetConductivityAcross(const char* phase, double value)
{
  if (phase == nullptr || *phase == '\0')
  {
    return; // an empty row in a panel
  }
  const auto [entry, added] = this->Internal->Across.try_emplace(phase, value);
  if (added || entry->second != value)
  {
    entry->second = value;
    this->Modified();
  }
}

void vtkSteadyDiffusion::RemoveAllConductivitiesAcross()
{
  if (!this->Internal->Across.empty())
  {
    this->Internal->Across.clear();
    this->Modified();
  }
}

double vtkSteadyDiffusion::GetConductivityAcross(const char* phase)
{
  const auto entry = this->Internal->Across.find(phase != nullptr ? phase : "");
  return entry != this->Internal->Across.end() ? entry->second : notSolved;
}

int vtkSteadyDiffusion::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

int vtkSteadyDiffusion::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  lamella::requestInput(
    inputVector[0]->GetInformationObject(0), outputVector->GetInformationObject(0), this->Controller);
  return 1;
}

int vtkSteadyDiffusion::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* const input = vtkImageData::GetData(inputVector[0]);
  vtkImageData* const output = vtkImageData::GetData(outputVector);
  std::fill_n(this->EffectiveConductivity, 9, notSolved);
  this->EstimatedError = notSolved;
  this->Internal->Forget();
  const lamella::Outcome outcome = lamella::attempt(this,
    [&]
    {
      const lamella::Team team(this->Controller, outputVector->GetInformationObject(0));
      this->Solve(input, output, team);
    });
  return lamella::concluded(this, outcome, outputVector);
}

void vtkSteadyDiffusion::Solve(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  const lamella::WholeImage whole = lamella::wholeImage(input, team);
  const lamella::Lattice& lattice = whole.lattice;
  const lamella::PhaseIds phases = lamella::phaseIds(input, this->GetInputArrayInformation(0), team);
  const bool periodic = this->Sides == PERIODIC;
  if (this->Direction == Z && lattice.dimension == 2)
  {
    throw lamella::ParameterError("direction z of a two-dimensional image", "solve along x or y");
  }

  // The solver's block of whole rows, whatever pieces the pipeline made.
  lbm::Block block{ { 0, 0, 0 }, lattice.size };
  if (team.size() > 1)
  {
    team.agree([&] { block = lbm::decompose(lattice, team.comm()); });
  }
  const lamella::BoxExchange inward(lattice, whole.held, block, { false, false, false }, team.comm(), team.size());
  const lamella::BoxExchange outward(lattice, block, whole.held, { false, false, false }, team.comm(), team.size());
  std::vector<std::uint8_t> moved;
  std::span<const std::uint8_t> ids = phases.ids;
  if (!inward.identity())
  {
    moved.resize(static_cast<std::size_t>(block.count()));
    inward.run<std::uint8_t>(phases.ids, moved);
    ids = moved;
  }

  std::vector<std::int64_t> nodes(phases.values.size(), 0);
  for (const std::uint8_t id : ids)
  {
    ++nodes[id];
  }
  team.sum(nodes);
  std::vector<double> conductivity;
  std::vector<double> across;
  team.agree(
    [&]
    {
      conductivity = lamella::conductivityById(phases, this->Internal->Conductivity, nodes);
      across = lamella::acrossById(phases, this->Internal->Conductivity, this->Internal->Across, nodes);
      if (!across.empty() && this->Lattice != AUTO_LATTICE && this->Lattice != D2Q9)
      {
        throw lamella::ParameterError(std::string("conductivities along and across walls on ") +
            lbm::name(stencilOf(this->Lattice, lattice.dimension)),
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
  options.stencil = across.empty() ? stencilOf(this->Lattice, lattice.dimension) : lbm::Stencil::D2Q9;
  options.sides = periodic ? lbm::Sides::Periodic : lbm::Sides::Insulated;
  options.method = methodOf(this->Method);
  options.tolerance = this->Tolerance;
  options.maxIterations = this->MaximumIterations;
  options.threads = lamella::threadCount(this->Threads);
  std::vector<int> axes{ this->Direction };
  if (this->Direction == ALL)
  {
    axes = lattice.dimension == 3 ? std::vector<int>{ X, Y, Z } : std::vector<int>{ X, Y };
  }
  // Each solve counts from 0 again: the next one has begun when the share falls.
  const double solves = static_cast<double>(axes.size()) * (this->EstimateError ? 2 : 1);
  double done = 0;
  double last = 0;
  options.progress = [this, solves, &done, &last](double share, const char* what)
  {
    done += share < last ? 1 : 0;
    last = share;
    this->SetProgressText(what);
    this->UpdateProgress(std::min((done + share) / solves, 1.0));
    return !this->CheckAbort();
  };

  output->ShallowCopy(input);
  const FieldStore store{ this, output, lattice, block, outward };
  std::shared_ptr<lbm::DirectedDiffusivity> directed;
  lamella::PhaseImage image;
  if (!across.empty() || this->EstimateError)
  {
    image = lamella::gatherPhases(lattice, whole.held, phases, team);
  }
  if (!across.empty())
  {
    const lamella::NodeVectors axis = lamella::vectorsOf(input, this->GetInputArrayInformation(1), "axis",
      "give the directions along the walls, as MicrographLattice does, take one conductivity a phase", 2, team);
    directed = std::make_shared<lbm::DirectedDiffusivity>(
      lbm::DirectedDiffusivity{ conductivity, across, lamella::gatherAxes(lattice, whole.held, axis.array, team) });
    conductivity = directed->larger(); // what conducts at all
  }
  if (!this->EstimateError)
  {
    if (directed)
    {
      options.links =
        std::make_shared<lbm::LinkTable>(lbm::directedLinks(lattice, image.phase, *directed, options.sides));
    }
    lbm::SteadyDiffusion solver(lattice, block, ids, conductivity, options, team.comm());
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
  this->EstimatedError = *std::max_element(
    internal.Error.begin(), internal.Error.end(), [](double a, double b) { return std::isnan(a) || a < b; });
  internal.PhaseFraction.assign(nodes.begin(), nodes.end());
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
  const std::string direction = this->Direction == ALL ? "all" : axisName[static_cast<std::size_t>(this->Direction)];
  const std::string sides = this->Sides == PERIODIC ? "periodic" : "insulated";
  const std::string quantity = quantityName[static_cast<std::size_t>(this->Quantity)];
  lamella::setFieldNumbers(output, "effective_conductivity", this->EffectiveConductivity);
  lamella::setFieldNumbers(output, "estimated_error", std::span(&this->EstimatedError, 1));
  lamella::setFieldNumbers(output, "estimated_error_by_direction", internal.Error);
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
  os << indent << "Direction: " << this->Direction << "\n"
     << indent << "Quantity: " << this->Quantity << "\n"
     << indent << "Lattice: " << this->Lattice << "\n"
     << indent << "Sides: " << this->Sides << "\n"
     << indent << "Method: " << this->Method << "\n"
     << indent << "Tolerance: " << this->Tolerance << "\n"
     << indent << "MaximumIterations: " << this->MaximumIterations << "\n"
     << indent << "Threads: " << this->Threads << "\n"
     << indent << "ComputeField: " << this->ComputeField << "\n"
     << indent << "ComputeFlux: " << this->ComputeFlux << "\n"
     << indent << "EstimateError: " << this->EstimateError << "\n";
  for (const auto& [phase, value] : this->Internal->Conductivity)
  {
    os << indent << "Conductivity of " << phase << ": " << value << "\n";
  }
  for (const auto& [phase, value] : this->Internal->Across)
  {
    os << indent << "Conductivity across " << phase << ": " << value << "\n";
  }
}
