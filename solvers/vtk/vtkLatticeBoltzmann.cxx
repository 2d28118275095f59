#include "vtkLatticeBoltzmann.h"

#include "DiffusionScene.h"
#include "FieldNumbers.h"
#include "LongRun.h"
#include "Settings.h"
#include "vtkLatticeConversion.h"
#include "vtkProvenance.h"

#include "lattice/Error.h"
#include "lattice/Memory.h"
#include "lbm/stepping/LatticeBoltzmann.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace lbm = lamella::lbm;

namespace
{

constexpr double usualRelaxation = 0.5;

double timeOf(vtkImageData* state)
{
  return state->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP());
}

/// A row a record; in a picture y begins at the high face.
void fillCurve(vtkTable* table, std::span<const lbm::SteppingRecord> records, bool fromTop, const char* creator)
{
  const auto column = [&](const char* name, const char* unit, const char* what, auto&& value)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    for (const lbm::SteppingRecord& r : records)
    {
      array->InsertNextValue(value(r));
    }
    lamella::describe(array, unit, what, creator);
    table->AddColumn(array);
  };
  using Record = lbm::SteppingRecord;
  column("time", "s", "since the start", [](const Record& r) { return r.time; });
  column("inlet_flux", "m/s",
    "mean over the face where the direction begins, times the unit of the values; NaN where it goes less than a node "
    "deep",
    [&](const Record& r) { return fromTop ? -r.faceFlux[1] : r.faceFlux[0]; });
  column("outlet_flux", "m/s",
    "mean over the face where it ends, times the unit of the values; NaN where it goes less than a node deep",
    [&](const Record& r) { return fromTop ? -r.faceFlux[0] : r.faceFlux[1]; });
  column("mean_value", "1", "over the box, 0 where nothing conducts", [](const Record& r) { return r.mean; });
  column("steps", "1", "since the start", [](const Record& r) { return static_cast<double>(r.steps); });
}

} // namespace

struct vtkLatticeBoltzmann::Internals
{
  PhaseValues Diffusivity;
  std::vector<double> Times;
  std::vector<vtkIdType> Steps;
  lamella::KeptStates<vtkImageData> States;
  vtkNew<vtkTable> Curve;
  lamella::Pace Told;

  bool Evenly() const { return this->Times.empty() && this->Steps.empty(); }
  /// The time step to take; 0: the solver's own.
  double StepFor(
    const vtkLatticeBoltzmann& self, const lamella::DiffusionScene& scene, std::span<const double> diffusivity) const;
  /// After how many steps to stop, rising. @throws lamella::ParameterError
  std::vector<std::int64_t> Stops(const vtkLatticeBoltzmann& self, const lbm::LatticeBoltzmann& solver) const;
};

vtkStandardNewMacro(vtkLatticeBoltzmann);

vtkLatticeBoltzmann::vtkLatticeBoltzmann()
  : Internal(std::make_unique<Internals>())
{
  this->ComputeFlux = false;
}

vtkLatticeBoltzmann::~vtkLatticeBoltzmann() = default;

void vtkLatticeBoltzmann::SetDiffusivity(const char* phase, double value)
{
  this->SetPhaseValue(this->Internal->Diffusivity, phase, value);
}

void vtkLatticeBoltzmann::RemoveAllDiffusivities()
{
  this->RemoveAllPhaseValues(this->Internal->Diffusivity);
}

void vtkLatticeBoltzmann::AddStateAtTime(double time)
{
  this->Internal->Times.push_back(time);
  this->Modified();
}

void vtkLatticeBoltzmann::RemoveAllStatesAtTimes()
{
  if (!this->Internal->Times.empty())
  {
    this->Internal->Times.clear();
    this->Modified();
  }
}

void vtkLatticeBoltzmann::AddStateAtStep(vtkIdType step)
{
  this->Internal->Steps.push_back(step);
  this->Modified();
}

void vtkLatticeBoltzmann::RemoveAllStatesAtSteps()
{
  if (!this->Internal->Steps.empty())
  {
    this->Internal->Steps.clear();
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

vtkTable* vtkLatticeBoltzmann::GetCurve()
{
  return this->Internal->Curve;
}

int vtkLatticeBoltzmann::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (this->Superclass::RequestInformation(request, inputVector, outputVector) == 0)
  {
    return 0;
  }
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  const Internals& internal = *this->Internal;
  std::vector<double> times = internal.Times;
  for (int k = 0; internal.Evenly() && k <= this->NumberOfSteps; ++k)
  {
    times.push_back(this->EndTime * k / this->NumberOfSteps);
  }
  for (const vtkIdType step : internal.Steps)
  {
    times.push_back(static_cast<double>(step) * this->TimeStep);
  }
  std::erase_if(times, [](double time) { return !std::isfinite(time); }); // refused later, in words
  vtkInformation* const output = outputVector->GetInformationObject(0);
  if (times.empty() || (!internal.Steps.empty() && !(this->TimeStep > 0))) // not known before the run
  {
    output->Remove(Pipeline::TIME_STEPS());
    output->Remove(Pipeline::TIME_RANGE());
    return 1;
  }
  std::sort(times.begin(), times.end());
  output->Set(Pipeline::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
  const std::array<double, 2> range{ times.front(), times.back() };
  output->Set(Pipeline::TIME_RANGE(), range.data(), 2);
  return 1;
}

int vtkLatticeBoltzmann::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkImageData* const input = vtkImageData::GetData(inputVector[0]);
  vtkImageData* const output = vtkImageData::GetData(outputVector);
  vtkInformation* const asked = outputVector->GetInformationObject(0);
  return this->Attempt(
    [&]
    {
      const lamella::Team team(this->Controller, asked);
      Internals& internal = *this->Internal;
      auto& states = internal.States;
      states.renew(
        input, this->GetMTime(), team, [&] { this->Run(input, team); }, [&] { internal.Curve->Initialize(); });
      // the state that is nearest to the time asked for; without a time the last one
      using Pipeline = vtkStreamingDemandDrivenPipeline;
      int chosen = states.count() - 1;
      if (asked->Has(Pipeline::UPDATE_TIME_STEP()))
      {
        const double time = asked->Get(Pipeline::UPDATE_TIME_STEP());
        const auto& all = states.all();
        const auto nearest = std::min_element(all.begin(), all.end(),
          [&](const auto& a, const auto& b) { return std::fabs(timeOf(a) - time) < std::fabs(timeOf(b) - time); });
        chosen = static_cast<int>(nearest - all.begin());
      }
      states.choose(chosen);
      states.show(output);
    },
    outputVector);
}

double vtkLatticeBoltzmann::Internals::StepFor(
  const vtkLatticeBoltzmann& self, const lamella::DiffusionScene& scene, std::span<const double> diffusivity) const
{
  double largest = 0;
  for (std::size_t id = 0; id < diffusivity.size(); ++id)
  {
    largest = scene.nodes[id] > 0 ? std::max(largest, diffusivity[id]) : largest;
  }
  const double to = this->Evenly() ? self.EndTime / self.NumberOfSteps
    : this->Times.empty()          ? 0.0
                                   : *std::max_element(this->Times.begin(), this->Times.end());
  if (self.TimeStep != 0 || largest == 0 || !(to > 0 && std::isfinite(to)))
  {
    return self.TimeStep; // 0: the solver's own
  }
  // a whole number of pairs of steps
  const double most = usualRelaxation * scene.lattice().spacing * scene.lattice().spacing / (3 * largest);
  return to / (2 * std::ceil(to / (2 * most)));
}

std::vector<std::int64_t> vtkLatticeBoltzmann::Internals::Stops(
  const vtkLatticeBoltzmann& self, const lbm::LatticeBoltzmann& solver) const
{
  std::vector<std::int64_t> stops;
  const auto add = [&](double time)
  {
    stops.push_back(solver.stepsAt(time));
    if (time > 0 && stops.back() == 0)
    {
      throw lamella::ParameterError(
        fmt::format(
          "the time {:.4g} s lies before the end of the first two steps of {:.4g} s", time, solver.timeStep()),
        fmt::format("steps come in pairs: take a step of {:.3g} s or less, or a later time", time / 2));
    }
  };
  for (int k = 0; this->Evenly() && k <= self.NumberOfSteps; ++k)
  {
    add(self.EndTime / self.NumberOfSteps * k);
  }
  for (const double time : this->Times)
  {
    add(time);
  }
  for (const vtkIdType step : this->Steps)
  {
    if (step < 0 || step % 2 != 0)
    {
      throw lamella::ParameterError(
        fmt::format("a state after {} steps cannot be kept", step), "steps come in pairs: give even numbers from 0 on");
    }
    stops.push_back(step);
  }
  std::sort(stops.begin(), stops.end());
  stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
  return stops;
}

void vtkLatticeBoltzmann::Run(vtkImageData* input, const lamella::Team& team)
{
  const Internals& internal = *this->Internal;
  const lamella::DiffusionScene scene(input, this->GetInputArrayInformation(0), this->Direction, team);
  this->LastCheckpoint = 0;
  if (internal.Evenly() && !(std::isfinite(this->EndTime) && this->EndTime > 0))
  {
    throw lamella::ParameterError("no end time was given", "give the last time in seconds, or times to keep states at");
  }
  if (lamella::fieldText(input, "pixel_size_source") == "none")
  {
    throw lamella::ParameterError(
      "a run in time needs the size of a pixel, which is not known", "give it where the picture is read: pixel size");
  }
  std::vector<double> diffusivity;
  team.agree(
    [&] { diffusivity = lamella::conductivityById(scene.phases, internal.Diffusivity, scene.nodes, "diffusivity"); });

  const auto axis = static_cast<std::size_t>(this->Direction);
  const bool fromTop = scene.fromTop(this->Direction);
  lbm::SteppingOptions options;
  options.stencil = scene.stencil(this->Lattice);
  options.collision = static_cast<lbm::Collision>(this->Collision);
  options.sides.fill(this->Sides == PERIODIC ? lbm::Boundary::Periodic : lbm::Boundary::Insulated);
  options.sides[axis] = lbm::Boundary::Fixed;
  options.faceValues[axis] = { this->InletValue, this->OutletValue };
  if (fromTop)
  {
    std::swap(options.faceValues[axis][0], options.faceValues[axis][1]);
  }
  options.axis = this->Direction;
  options.threads = this->ThreadCount();
  options.timeStep = internal.StepFor(*this, scene, diffusivity);
  options.checkpoint.every = this->CheckpointEvery;
  options.checkpoint.seconds = this->CheckpointSeconds;
  const lamella::RunStart begin =
    lamella::startOf(this->ContinueFile, this->CheckpointFile, "the initial value", input, team, options.checkpoint);
  std::vector<std::string> unwritten;
  options.checkpoint.warn = [&](const std::string& why) { unwritten.push_back(why); };
  double done = 0; // stops
  double all = 1;
  options.progress = [&](double share, const char* what)
  {
    if (this->Internal->Told.due())
    {
      this->SetProgressText(what);
      this->UpdateProgress(std::min((done + share) / all, 1.0));
    }
    return !this->CheckAbort();
  };

  lbm::LatticeBoltzmann solver(scene.lattice(), scene.block, scene.ids, diffusivity, options, team.comm());
  solver.start(this->InitialValue);
  std::vector<std::int64_t> stops = internal.Stops(*this, solver);
  const std::size_t kept = this->KeepStates ? stops.size() : 1;
  const double needed =
    static_cast<double>(kept) * static_cast<double>(scene.whole.held.count()) * (this->ComputeFlux ? 32 : 8);
  team.agree(
    [&]
    {
      if (const auto available = static_cast<double>(lamella::availableMemory()); needed > available)
      {
        throw lamella::MemoryError(
          fmt::format("keeping {} states of {} nodes needs about {}, and {} are available", stops.size(),
            scene.lattice().count(), lamella::bytesText(needed), lamella::bytesText(available)),
          "keep fewer states, or take a smaller window");
      }
    });
  if (!begin.from.empty())
  {
    solver.restore(begin.from);
  }
  const std::int64_t continued = begin.from.empty() ? 0 : solver.steps();
  const auto first = std::lower_bound(stops.begin(), stops.end(), continued);
  const auto before = static_cast<double>(first - stops.begin());
  stops.erase(stops.begin(), first);
  const bool ended = stops.empty();
  if (ended) // the checkpoint itself is shown
  {
    stops.push_back(continued);
  }
  all = static_cast<double>(stops.size());
  const auto warn = [&](const std::string& text)
  {
    if (!text.empty() && team.rank() == 0)
    {
      vtkWarningMacro(<< text);
    }
  };
  const std::string warning = solver.warning();
  warn(begin.warning);
  warn(warning);
  warn(solver.shortRunWarning(stops.back()));
  if (ended)
  {
    warn(fmt::format("the run had ended where the checkpoint stands, after {} steps: that state is kept", continued));
  }
  else if (before > 0)
  {
    warn(fmt::format("{} of the states asked for lie before the checkpoint, which stands after {} steps: they are not "
                     "made, the curve has them",
      before, continued));
  }

  const std::string quantity = this->QuantityName();
  const std::string collision = options.collision == lbm::Collision::BGK ? "bgk" : "trt";
  const std::string sides = this->SidesName();
  const char* const direction = lamella::axisNames.at(axis);
  const char* const creator = this->GetClassName();
  double made = 0;
  const auto keep = [&](const lbm::LatticeBoltzmann&)
  {
    vtkImageData* const state = this->Internal->States.add(this->KeepStates);
    state->ShallowCopy(input);
    const auto field = scene.array(quantity, 1, [&](std::span<double> out) { solver.value(out); });
    lamella::describe(field, "1", quantity + ", NaN where nothing conducts", creator);
    state->GetPointData()->AddArray(field);
    state->GetPointData()->SetActiveScalars(field->GetName());
    if (this->ComputeFlux)
    {
      const auto flux = scene.array("flux", 3, [&](std::span<double> out) { solver.flux(out); });
      lamella::describe(flux, "m/s", "flux of " + quantity + ", -D grad u", creator);
      state->GetPointData()->AddArray(flux);
      state->GetPointData()->SetActiveVectors(flux->GetName());
    }
    const lbm::SteppingRecord& now = solver.records().back();
    const lbm::SteppingStatistics s = solver.statistics();
    const auto set = [state](const char* name, double value) { lamella::setFieldNumber(state, name, value); };
    set("time", now.time);
    set(lamella::stateNumber, (ended ? 0 : static_cast<double>(before)) + made++);
    set("inlet_flux", fromTop ? -now.faceFlux[1] : now.faceFlux[0]);
    set("outlet_flux", fromTop ? -now.faceFlux[0] : now.faceFlux[1]);
    set("mean_value", now.mean);
    set("time_step", solver.timeStep());
    set("steps", static_cast<double>(now.steps));
    set("relaxation", solver.relaxation());
    set("stored_nodes", static_cast<double>(s.stored));
    set("skipped_nodes", static_cast<double>(s.skipped));
    set("updates_per_second", s.seconds > 0 ? static_cast<double>(s.updates) / s.seconds : 0.0);
    set("bytes", static_cast<double>(s.bytes));
    state->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), now.time);
    lamella::setFieldText(state, "collision", collision);
    lamella::setFieldText(state, "lattice", lbm::name(options.stencil));
    lamella::setFieldText(state, "direction", direction);
    lamella::setFieldText(state, "sides", sides);
    lamella::setFieldText(state, "quantity", quantity);
    lamella::setFieldText(state, "warning", warning);
    done += 1;
    lamella::tellStep(this, state);
  };
  try
  {
    solver.run(stops, keep);
  }
  catch (const lamella::Error&)
  {
    this->LastCheckpoint = solver.lastCheckpoint();
    throw;
  }
  this->LastCheckpoint = solver.lastCheckpoint();
  fillCurve(this->Internal->Curve, solver.records(), fromTop, creator);

  if (!unwritten.empty())
  {
    warn(fmt::format("{} of the checkpoints could not be written: {}", unwritten.size(), unwritten.front()));
  }

  nlohmann::json values;
  for (std::size_t id = 0; id < diffusivity.size(); ++id)
  {
    if (scene.nodes[id] > 0)
    {
      values[scene.phases.names[id]] = diffusivity[id];
    }
  }
  for (const auto& state : this->Internal->States.all())
  {
    lamella::setFieldNumber(state, "continued_at", static_cast<double>(continued));
    lamella::setFieldNumber(state, "states_before", ended ? 0 : before);
    lamella::setFieldNumber(state, "checkpoints", static_cast<double>(solver.checkpoints()));
    lamella::setFieldNumber(state, "last_checkpoint", static_cast<double>(solver.lastCheckpoint()));
    lamella::continueProvenance(state, "lattice_boltzmann",
      { { "diffusivity", values }, { "direction", direction }, { "quantity", quantity }, { "sides", sides },
        { "lattice", lbm::name(options.stencil) }, { "collision", collision }, { "inlet_value", this->InletValue },
        { "outlet_value", this->OutletValue }, { "initial_value", this->InitialValue }, { "end_time", solver.time() },
        { "time_step", solver.timeStep() } });
  }
}

void vtkLatticeBoltzmann::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  lamella::printSettings(this, os, indent);
}
