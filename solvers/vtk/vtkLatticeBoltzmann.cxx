#include "vtkLatticeBoltzmann.h"

#include "Attempt.h"
#include "BoxExchange.h"
#include "LongRun.h"
#include "PhaseIds.h"
#include "ThreadCount.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "lattice/Error.h"
#include "lbm/stepping/LatticeBoltzmann.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace lbm = lamella::lbm;

namespace
{

constexpr std::array<const char*, 3> axisName{ "x", "y", "z" };
constexpr std::array<const char*, 2> quantityName{ "temperature", "concentration" };
constexpr double usualRelaxation = 0.5;

lbm::Stencil stencilOf(int lattice, int dimension)
{
  return lattice == vtkLatticeBoltzmann::AUTO_LATTICE ? (dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5)
                                                      : static_cast<lbm::Stencil>(lattice - vtkLatticeBoltzmann::D2Q5);
}

std::span<double> values(vtkDoubleArray* array)
{
  return { array->GetPointer(0), static_cast<std::size_t>(array->GetNumberOfValues()) };
}

/// An array of the piece from one that the solver fills for its block.
template <class Read>
vtkSmartPointer<vtkDoubleArray> arrayOf(const char* name, int components, vtkIdType points,
  const lamella::BoxExchange& outward, std::int64_t own, Read&& read)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(points);
  if (outward.identity())
  {
    read(values(array));
  }
  else
  {
    std::vector<double> block(static_cast<std::size_t>(own * components));
    read(std::span<double>(block));
    outward.run<double>(block, values(array), components);
  }
  return array;
}

} // namespace

struct vtkLatticeBoltzmann::Internals
{
  std::map<std::string, double> Diffusivity;
  lamella::KeptStates<vtkImageData> States;
  lamella::Pace Told;
};

vtkStandardNewMacro(vtkLatticeBoltzmann);

vtkLatticeBoltzmann::vtkLatticeBoltzmann()
  : Internal(std::make_unique<Internals>())
{
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
  this->SetController(vtkMultiProcessController::GetGlobalController());
}

vtkLatticeBoltzmann::~vtkLatticeBoltzmann()
{
  this->SetController(nullptr);
}

vtkCxxSetObjectMacro(vtkLatticeBoltzmann, Controller, vtkMultiProcessController);

void vtkLatticeBoltzmann::SetDiffusivity(const char* phase, double value)
{
  if (phase == nullptr || *phase == '\0')
  {
    return; // an empty row in a panel
  }
  const auto entry = this->Internal->Diffusivity.find(phase);
  if (entry == this->Internal->Diffusivity.end() || entry->second != value)
  {
    this->Internal->Diffusivity[phase] = value;
    this->Modified();
  }
}

void vtkLatticeBoltzmann::RemoveAllDiffusivities()
{
  if (!this->Internal->Diffusivity.empty())
  {
    this->Internal->Diffusivity.clear();
    this->Modified();
  }
}

int vtkLatticeBoltzmann::GetNumberOfStates()
{
  return this->Internal->States.count();
}

vtkImageData* vtkLatticeBoltzmann::GetStateImage(int state)
{
  return this->Internal->States.at(state);
}

int vtkLatticeBoltzmann::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

int vtkLatticeBoltzmann::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (this->Superclass::RequestInformation(request, inputVector, outputVector) == 0)
  {
    return 0;
  }
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  std::vector<double> times;
  for (int k = 0; k <= this->NumberOfSteps; ++k)
  {
    times.push_back(this->EndTime * k / this->NumberOfSteps);
  }
  vtkInformation* const output = outputVector->GetInformationObject(0);
  output->Set(Pipeline::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
  const std::array<double, 2> range{ times.front(), times.back() };
  output->Set(Pipeline::TIME_RANGE(), range.data(), 2);
  return 1;
}

int vtkLatticeBoltzmann::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  lamella::requestInput(
    inputVector[0]->GetInformationObject(0), outputVector->GetInformationObject(0), this->Controller);
  return 1;
}

int vtkLatticeBoltzmann::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* const input = vtkImageData::GetData(inputVector[0]);
  vtkImageData* const output = vtkImageData::GetData(outputVector);
  vtkInformation* const asked = outputVector->GetInformationObject(0);
  lamella::Failure failure = lamella::Failure::None;
  const lamella::Outcome outcome = lamella::attempt(
    this,
    [&]
    {
      const lamella::Team team(this->Controller, asked);
      auto& states = this->Internal->States;
      states.renew(
        input, this->GetMTime(), team, [&] { this->Run(input, team); }, [] {});
      // the time step that is nearest to what is asked for; without a time the last one
      using Pipeline = vtkStreamingDemandDrivenPipeline;
      int chosen = this->NumberOfSteps;
      if (asked->Has(Pipeline::UPDATE_TIME_STEP()))
      {
        const double at = asked->Get(Pipeline::UPDATE_TIME_STEP()) / this->EndTime * this->NumberOfSteps;
        chosen = static_cast<int>(std::lround(std::clamp(at, 0.0, static_cast<double>(this->NumberOfSteps))));
      }
      states.choose(chosen);
      states.show(output);
    },
    &failure);
  this->Failure = static_cast<int>(failure);
  return lamella::concluded(this, outcome, outputVector);
}

void vtkLatticeBoltzmann::Run(vtkImageData* input, const lamella::Team& team)
{
  const lamella::WholeImage whole = lamella::wholeImage(input, team);
  const lamella::Lattice& lattice = whole.lattice;
  const lamella::PhaseIds phases = lamella::phaseIds(input, this->GetInputArrayInformation(0), team);
  if (this->Direction == Z && lattice.dimension == 2)
  {
    throw lamella::ParameterError("direction z of a two-dimensional image", "choose x or y");
  }
  if (!(std::isfinite(this->EndTime) && this->EndTime > 0))
  {
    throw lamella::ParameterError(
      fmt::format("an end time of {} s is not above 0", this->EndTime), "give the last time in seconds");
  }

  // the solver's block of whole rows, whatever pieces the pipeline made
  lamella::Block block{ { 0, 0, 0 }, lattice.size };
  if (team.size() > 1)
  {
    team.agree([&] { block = lamella::decompose(lattice, team.comm()); });
  }
  const lamella::BoxExchange inward(lattice, whole.held, block, { false, false, false }, team.comm(), team.size());
  const lamella::BoxExchange outward(lattice, block, whole.held, { false, false, false }, team.comm(), team.size());
  std::vector<std::uint8_t> ids(static_cast<std::size_t>(block.count()));
  inward.run<std::uint8_t>(phases.ids, ids);
  std::vector<std::int64_t> nodes(phases.values.size(), 0);
  for (const std::uint8_t id : ids)
  {
    ++nodes[id];
  }
  team.sum(nodes);
  std::vector<double> diffusivity;
  team.agree(
    [&] { diffusivity = lamella::conductivityById(phases, this->Internal->Diffusivity, nodes, "diffusivity"); });

  const auto axis = static_cast<std::size_t>(this->Direction);
  const bool fromTop = lattice.dimension == 2 && this->Direction == Y;
  lbm::SteppingOptions options;
  options.stencil = stencilOf(this->Lattice, lattice.dimension);
  options.collision = static_cast<lbm::Collision>(this->Collision);
  options.sides.fill(this->Sides == PERIODIC ? lbm::Boundary::Periodic : lbm::Boundary::Insulated);
  options.sides[axis] = lbm::Boundary::Fixed;
  options.faceValues[axis] = { this->InletValue, this->OutletValue };
  if (fromTop)
  {
    std::swap(options.faceValues[axis][0], options.faceValues[axis][1]);
  }
  options.axis = this->Direction;
  options.threads = lamella::threadCount(this->Threads);
  options.timeStep = this->TimeStep;
  const double interval = this->EndTime / this->NumberOfSteps;
  double largest = 0;
  for (std::size_t id = 0; id < diffusivity.size(); ++id)
  {
    largest = nodes[id] > 0 ? std::max(largest, diffusivity[id]) : largest;
  }
  if (this->TimeStep == 0 && largest > 0)
  {
    // a pair of steps divides the interval
    const double most = usualRelaxation * lattice.spacing * lattice.spacing / (3 * largest);
    options.timeStep = interval / (2 * std::ceil(interval / (2 * most)));
  }
  double done = 0;
  options.progress = [this, &done](double share, const char* what)
  {
    if (this->Internal->Told.due())
    {
      this->SetProgressText(what);
      this->UpdateProgress(std::min((done + share) / (this->NumberOfSteps + 1), 1.0));
    }
    return !this->CheckAbort();
  };

  lbm::LatticeBoltzmann solver(lattice, block, ids, diffusivity, options, team.comm());
  solver.start(this->InitialValue);
  const std::string warning = solver.warning();
  if (!warning.empty())
  {
    vtkWarningMacro(<< warning);
  }
  std::vector<double> times;
  for (int k = 0; k <= this->NumberOfSteps; ++k)
  {
    times.push_back(interval * k);
  }
  const std::string quantity = quantityName[static_cast<std::size_t>(this->Quantity)];
  const std::string collision = options.collision == lbm::Collision::BGK ? "bgk" : "trt";
  const std::string sides = this->Sides == PERIODIC ? "periodic" : "insulated";
  const char* const creator = this->GetClassName();
  const auto keep = [&](const lbm::LatticeBoltzmann&)
  {
    vtkImageData* const state = this->Internal->States.add(this->KeepStates);
    state->ShallowCopy(input);
    const vtkIdType points = input->GetNumberOfPoints();
    const auto field =
      arrayOf(quantity.c_str(), 1, points, outward, block.count(), [&](std::span<double> out) { solver.value(out); });
    lamella::describe(field, "1", quantity + ", NaN where nothing conducts", creator);
    state->GetPointData()->AddArray(field);
    state->GetPointData()->SetActiveScalars(field->GetName());
    if (this->ComputeFlux)
    {
      const auto flux =
        arrayOf("flux", 3, points, outward, block.count(), [&](std::span<double> out) { solver.flux(out); });
      lamella::describe(flux, "m/s", "flux of " + quantity + ", -D grad u", creator);
      state->GetPointData()->AddArray(flux);
      state->GetPointData()->SetActiveVectors(flux->GetName());
    }
    const std::array<double, 2> through = solver.faceFlux();
    const lbm::SteppingStatistics s = solver.statistics();
    const auto set = [state](const char* name, double value)
    { lamella::setFieldNumbers(state, name, std::span(&value, 1)); };
    set("time", solver.time());
    set("inlet_flux", fromTop ? -through[1] : through[0]);
    set("outlet_flux", fromTop ? -through[0] : through[1]);
    set("mean_value", solver.mean());
    set("time_step", solver.timeStep());
    set("steps", static_cast<double>(solver.steps()));
    set("relaxation", solver.relaxation());
    set("stored_nodes", static_cast<double>(s.stored));
    set("skipped_nodes", static_cast<double>(s.skipped));
    set("updates_per_second", s.seconds > 0 ? static_cast<double>(s.updates) / s.seconds : 0.0);
    set("bytes", static_cast<double>(s.bytes));
    state->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), solver.time());
    lamella::setFieldText(state, "collision", collision);
    lamella::setFieldText(state, "lattice", lbm::name(options.stencil));
    lamella::setFieldText(state, "direction", axisName[axis]);
    lamella::setFieldText(state, "sides", sides);
    lamella::setFieldText(state, "quantity", quantity);
    lamella::setFieldText(state, "warning", warning);
    done += 1;
    lamella::tellStep(this, state);
  };
  solver.run(times, keep);

  nlohmann::json values;
  for (std::size_t id = 0; id < diffusivity.size(); ++id)
  {
    if (nodes[id] > 0)
    {
      values[phases.names[id]] = diffusivity[id];
    }
  }
  for (const auto& state : this->Internal->States.all())
  {
    lamella::continueProvenance(state, "lattice_boltzmann",
      { { "diffusivity", values }, { "direction", axisName[axis] }, { "quantity", quantity }, { "sides", sides },
        { "lattice", lbm::name(options.stencil) }, { "collision", collision }, { "inlet_value", this->InletValue },
        { "outlet_value", this->OutletValue }, { "initial_value", this->InitialValue }, { "end_time", this->EndTime },
        { "time_step", solver.timeStep() } });
  }
}

void vtkLatticeBoltzmann::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Direction: " << this->Direction << "\n"
     << indent << "InletValue: " << this->InletValue << "\n"
     << indent << "OutletValue: " << this->OutletValue << "\n"
     << indent << "InitialValue: " << this->InitialValue << "\n"
     << indent << "Quantity: " << this->Quantity << "\n"
     << indent << "Sides: " << this->Sides << "\n"
     << indent << "Collision: " << this->Collision << "\n"
     << indent << "Lattice: " << this->Lattice << "\n"
     << indent << "EndTime: " << this->EndTime << "\n"
     << indent << "NumberOfSteps: " << this->NumberOfSteps << "\n"
     << indent << "TimeStep: " << this->TimeStep << "\n"
     << indent << "ComputeFlux: " << this->ComputeFlux << "\n"
     << indent << "Threads: " << this->Threads << "\n";
  for (const auto& [phase, value] : this->Internal->Diffusivity)
  {
    os << indent << "Diffusivity of " << phase << ": " << value << "\n";
  }
}
