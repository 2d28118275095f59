#include "vtkLatticeBoltzmann.h"

#include "Columns.h"
#include "DiffusionScene.h"
#include "FieldNumbers.h"
#include "LongRun.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "lbm/stepping/LatticeBoltzmann.h"

#include "vtkDataSetAttributes.h"
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

const char* wordOf(lbm::Collision collision)
{
  return collision == lbm::Collision::BGK ? "bgk" : "trt";
}

double timeOf(vtkImageData* state)
{
  return state->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP());
}

/// A row a record; in a picture y begins at the high face.
void fillCurve(vtkTable* table, std::span<const lbm::SteppingRecord> records, bool fromTop, const char* creator)
{
  using Record = lbm::SteppingRecord;
  const lamella::Columns columns{ table->GetRowData(), records, creator };
  columns.numbers("time", "s", "since the start", &Record::time);
  columns.numbers(
    "inlet_flux", "m/s",
    "mean over the face where the direction begins, times the unit of the values; NaN where it goes less than a node "
    "deep",
    [&](const Record& r) { return fromTop ? -r.faceFlux[1] : r.faceFlux[0]; });
  columns.numbers("outlet_flux", "m/s",
    "mean over the face where it ends, times the unit of the values; NaN where it goes less than a node deep",
    [&](const Record& r) { return fromTop ? -r.faceFlux[0] : r.faceFlux[1]; });
  columns.numbers("mean_value", "1", "over the box, 0 where nothing conducts", &Record::mean);
  columns.numbers("steps", "1", "since the start", &Record::steps);
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

  struct Running;

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

vtkSetNamedMacro(vtkLatticeBoltzmann, Diffusivity, Diffusivities, Internal->Diffusivity);
vtkAddToListMacro(vtkLatticeBoltzmann, StateAtTime, StatesAtTimes, double, Internal->Times);
vtkAddToListMacro(vtkLatticeBoltzmann, StateAtStep, StatesAtSteps, vtkIdType, Internal->Steps);
vtkGetStatesMacro(vtkLatticeBoltzmann, Image, vtkImageData, Internal->States);

vtkTable* vtkLatticeBoltzmann::GetCurve()
{
  return this->Internal->Curve;
}

int vtkLatticeBoltzmann::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (this->Superclass::RequestInformation(request, inputVector, outputVector) == 0)
    return 0;
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  const Internals& internal = *this->Internal;
  std::vector<double> times = internal.Times;
  for (int k = 0; internal.Evenly() && k <= this->NumberOfSteps; ++k)
    times.push_back(this->EndTime * k / this->NumberOfSteps);
  for (const vtkIdType step : internal.Steps)
    times.push_back(static_cast<double>(step) * this->TimeStep);
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
    largest = scene.nodes[id] > 0 ? std::max(largest, diffusivity[id]) : largest;
  const double to = this->Evenly() ? self.EndTime / self.NumberOfSteps
    : this->Times.empty()          ? 0.0
                                   : *std::max_element(this->Times.begin(), this->Times.end());
  if (self.TimeStep != 0 || largest == 0 || !(to > 0 && std::isfinite(to)))
    return self.TimeStep; // 0: the solver's own
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
      throw lamella::ParameterError(
        fmt::format(
          "the time {:.4g} s lies before the end of the first two steps of {:.4g} s", time, solver.timeStep()),
        fmt::format("steps come in pairs: take a step of {:.3g} s or less, or a later time", time / 2));
  };
  for (int k = 0; this->Evenly() && k <= self.NumberOfSteps; ++k)
    add(self.EndTime / self.NumberOfSteps * k);
  for (const double time : this->Times)
    add(time);
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

/// One run, from its input to states and curve.
struct vtkLatticeBoltzmann::Internals::Running
{
  vtkLatticeBoltzmann& Self;
  vtkImageData* Input;
  const lamella::Team& Team;
  const lamella::DiffusionScene Scene;
  const std::size_t Axis;
  const bool FromTop;
  const char* const Creator;
  std::vector<double> Diffusivity; ///< by id
  lamella::RunStart Begin;
  lbm::SteppingOptions Options;
  std::vector<std::string> Unwritten; ///< checkpoints: why not
  std::string Warning;                ///< of the solver
  std::int64_t Continued = 0;         ///< steps in the checkpoint that the run goes on from
  double Before = 0;                  ///< states asked for that lie before it
  bool Ended = false;                 ///< where the checkpoint stands, which is then shown itself
  double Done = 0;                    ///< stops
  double All = 1;
  double Made = 0;

  Running(vtkLatticeBoltzmann& self, vtkImageData* input, const lamella::Team& team)
    : Self(self)
    , Input(input)
    , Team(team)
    , Scene(input, self.GetInputArrayInformation(0), self.Direction, team)
    , Axis(static_cast<std::size_t>(self.Direction))
    , FromTop(this->Scene.fromTop(self.Direction))
    , Creator(self.GetClassName())
  {
  }

  void Go();
  void CheckInput() const;
  void SetOptions();
  void CheckMemory(std::size_t stops) const;
  /// Goes to the checkpoint. @return the stops from there on, at least one
  std::vector<std::int64_t> GoOn(lbm::LatticeBoltzmann& solver, std::vector<std::int64_t> stops);
  void Warn(const std::string& text) const;
  void WarnOfStart(const lbm::LatticeBoltzmann& solver, std::int64_t lastStop) const;
  void Keep(const lbm::LatticeBoltzmann& solver);
  void AddFields(vtkImageData* state, const lbm::LatticeBoltzmann& solver) const;
  void Describe(const lbm::LatticeBoltzmann& solver) const;
};

void vtkLatticeBoltzmann::Run(vtkImageData* input, const lamella::Team& team)
{
  Internals::Running(*this, input, team).Go();
}

void vtkLatticeBoltzmann::Internals::Running::Go()
{
  Internals& internal = *this->Self.Internal;
  this->Self.LastCheckpoint = 0;
  this->CheckInput();
  this->Team.agree(
    [&]
    {
      this->Diffusivity =
        lamella::conductivityById(this->Scene.phases, internal.Diffusivity, this->Scene.nodes, "diffusivity");
    });
  this->SetOptions();
  lbm::LatticeBoltzmann solver(
    this->Scene.lattice(), this->Scene.block, this->Scene.ids, this->Diffusivity, this->Options, this->Team.comm());
  solver.start(this->Self.InitialValue);
  std::vector<std::int64_t> stops = internal.Stops(this->Self, solver);
  this->CheckMemory(stops.size());
  stops = this->GoOn(solver, std::move(stops));
  this->All = static_cast<double>(stops.size());
  this->Warning = solver.warning();
  this->WarnOfStart(solver, stops.back());
  try
  {
    solver.run(
      stops, [&](const lbm::LatticeBoltzmann&) { this->Keep(solver); });
  }
  catch (const lamella::Error&)
  {
    this->Self.LastCheckpoint = solver.lastCheckpoint();
    throw;
  }
  this->Self.LastCheckpoint = solver.lastCheckpoint();
  fillCurve(internal.Curve, solver.records(), this->FromTop, this->Creator);
  if (!this->Unwritten.empty())
  {
    this->Warn(
      fmt::format("{} of the checkpoints could not be written: {}", this->Unwritten.size(), this->Unwritten.front()));
  }
  this->Describe(solver);
}

void vtkLatticeBoltzmann::Internals::Running::CheckInput() const
{
  if (this->Self.Internal->Evenly() && !(std::isfinite(this->Self.EndTime) && this->Self.EndTime > 0))
    throw lamella::ParameterError("no end time was given", "give the last time in seconds, or times to keep states at");
  if (lamella::fieldText(this->Input, "pixel_size_source") == "none")
  {
    throw lamella::ParameterError(
      "a run in time needs the size of a pixel, which is not known", "give it where the picture is read: pixel size");
  }
}

void vtkLatticeBoltzmann::Internals::Running::SetOptions()
{
  vtkLatticeBoltzmann& self = this->Self;
  lbm::SteppingOptions& options = this->Options;
  if (self.Lattice == Q1)
    throw lamella::ParameterError(
      "lattice Boltzmann on elements, which have no links", "choose d2q5, d2q9, d3q7 or d3q19, or leave the choice");
  options.stencil = this->Scene.stencil(self.Lattice);
  options.collision = static_cast<lbm::Collision>(self.Collision);
  options.sides.fill(self.Sides == INSULATED ? lbm::Boundary::Insulated : lbm::Boundary::Periodic);
  options.sides[this->Axis] = lbm::Boundary::Fixed;
  options.faceValues[this->Axis] = { self.InletValue, self.OutletValue };
  if (this->FromTop)
    std::swap(options.faceValues[this->Axis][0], options.faceValues[this->Axis][1]);
  options.axis = self.Direction;
  options.threads = self.ThreadCount();
  options.timeStep = self.Internal->StepFor(self, this->Scene, this->Diffusivity);
  options.checkpoint.every = self.CheckpointEvery;
  options.checkpoint.seconds = self.CheckpointSeconds;
  this->Begin = lamella::startOf(
    self.ContinueFile, self.CheckpointFile, "the initial value", this->Input, this->Team, options.checkpoint);
  options.checkpoint.warn = [this](const std::string& why) { this->Unwritten.push_back(why); };
  options.progress = [this](double share, const char* what)
  {
    if (this->Self.Internal->Told.due())
    {
      this->Self.SetProgressText(what);
      this->Self.UpdateProgress(std::min((this->Done + share) / this->All, 1.0));
    }
    return !this->Self.CheckAbort();
  };
}

void vtkLatticeBoltzmann::Internals::Running::CheckMemory(std::size_t stops) const
{
  const std::size_t kept = this->Self.KeepStates ? stops : 1;
  const double needed =
    static_cast<double>(kept) * static_cast<double>(this->Scene.whole.held.count()) * (this->Self.ComputeFlux ? 32 : 8);
  this->Team.agree(
    [&]
    {
      if (const auto available = static_cast<double>(lamella::availableMemory()); needed > available)
      {
        throw lamella::MemoryError(
          fmt::format("keeping {} states of {} nodes needs about {}, and {} are available", stops,
            this->Scene.lattice().count(), lamella::bytesText(needed), lamella::bytesText(available)),
          "keep fewer states, or take a smaller window");
      }
    });
}

std::vector<std::int64_t> vtkLatticeBoltzmann::Internals::Running::GoOn(
  lbm::LatticeBoltzmann& solver, std::vector<std::int64_t> stops)
{
  if (!this->Begin.from.empty())
  {
    solver.restore(this->Begin.from);
    this->Continued = solver.steps();
  }
  const auto first = std::lower_bound(stops.begin(), stops.end(), this->Continued);
  this->Before = static_cast<double>(first - stops.begin());
  stops.erase(stops.begin(), first);
  this->Ended = stops.empty();
  if (this->Ended)
    stops.push_back(this->Continued);
  return stops;
}

void vtkLatticeBoltzmann::Internals::Running::Warn(const std::string& text) const
{
  if (!text.empty() && this->Team.rank() == 0)
    vtkWarningWithObjectMacro(&this->Self, << text);
}

void vtkLatticeBoltzmann::Internals::Running::WarnOfStart(
  const lbm::LatticeBoltzmann& solver, std::int64_t lastStop) const
{
  this->Warn(this->Begin.warning);
  this->Warn(this->Warning);
  this->Warn(solver.shortRunWarning(lastStop));
  if (this->Ended)
  {
    this->Warn(fmt::format(
      "the run had ended where the checkpoint stands, after {} steps: that state is kept", this->Continued));
  }
  else if (this->Before > 0)
  {
    this->Warn(fmt::format("{} of the states asked for lie before the checkpoint, which stands after {} steps: they "
                           "are not made, the curve has them",
      this->Before, this->Continued));
  }
}

void vtkLatticeBoltzmann::Internals::Running::Keep(const lbm::LatticeBoltzmann& solver)
{
  vtkImageData* const state = this->Self.Internal->States.add(this->Self.KeepStates);
  state->ShallowCopy(this->Input);
  this->AddFields(state, solver);
  const lbm::SteppingRecord& now = solver.records().back();
  const lbm::SteppingStatistics s = solver.statistics();
  const auto set = [state](const char* name, double value) { lamella::setFieldNumber(state, name, value); };
  set("time", now.time);
  set(lamella::stateNumber, (this->Ended ? 0 : this->Before) + this->Made++);
  set("inlet_flux", this->FromTop ? -now.faceFlux[1] : now.faceFlux[0]);
  set("outlet_flux", this->FromTop ? -now.faceFlux[0] : now.faceFlux[1]);
  set("mean_value", now.mean);
  set("time_step", solver.timeStep());
  set("steps", static_cast<double>(now.steps));
  set("relaxation", solver.relaxation());
  set("stored_nodes", static_cast<double>(s.stored));
  set("skipped_nodes", static_cast<double>(s.skipped));
  set("updates_per_second", s.seconds > 0 ? static_cast<double>(s.updates) / s.seconds : 0.0);
  set("bytes", static_cast<double>(s.bytes));
  state->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), now.time);
  lamella::setFieldText(state, "collision", wordOf(this->Options.collision));
  lamella::setFieldText(state, "lattice", lbm::name(this->Options.stencil));
  lamella::setFieldText(state, "direction", lamella::axisNames.at(this->Axis));
  lamella::setFieldText(state, "sides", this->Self.SidesName());
  lamella::setFieldText(state, "quantity", this->Self.QuantityName());
  lamella::setFieldText(state, "warning", this->Warning);
  this->Done += 1;
  lamella::tellStep(&this->Self, state);
}

void vtkLatticeBoltzmann::Internals::Running::AddFields(vtkImageData* state, const lbm::LatticeBoltzmann& solver) const
{
  const std::string quantity = this->Self.QuantityName();
  const auto field = this->Scene.array(quantity, 1, [&](std::span<double> out) { solver.value(out); });
  lamella::describe(field, "1", quantity + ", NaN where nothing conducts", this->Creator);
  state->GetPointData()->AddArray(field);
  state->GetPointData()->SetActiveScalars(field->GetName());
  if (this->Self.ComputeFlux)
  {
    const auto flux = this->Scene.array("flux", 3, [&](std::span<double> out) { solver.flux(out); });
    lamella::describe(flux, "m/s", "flux of " + quantity + ", -D grad u", this->Creator);
    state->GetPointData()->AddArray(flux);
    state->GetPointData()->SetActiveVectors(flux->GetName());
  }
}

void vtkLatticeBoltzmann::Internals::Running::Describe(const lbm::LatticeBoltzmann& solver) const
{
  const vtkLatticeBoltzmann& self = this->Self;
  nlohmann::json values;
  for (std::size_t id = 0; id < this->Diffusivity.size(); ++id)
    if (this->Scene.nodes[id] > 0)
      values[this->Scene.phases.names[id]] = this->Diffusivity[id];
  for (const auto& state : self.Internal->States.all())
  {
    lamella::setFieldNumber(state, "continued_at", static_cast<double>(this->Continued));
    lamella::setFieldNumber(state, "states_before", this->Ended ? 0 : this->Before);
    lamella::setFieldNumber(state, "checkpoints", static_cast<double>(solver.checkpoints()));
    lamella::setFieldNumber(state, "last_checkpoint", static_cast<double>(solver.lastCheckpoint()));
    lamella::continueProvenance(state, "lattice_boltzmann",
      { { "diffusivity", values }, { "direction", lamella::axisNames.at(this->Axis) },
        { "quantity", self.QuantityName() }, { "sides", self.SidesName() },
        { "lattice", lbm::name(this->Options.stencil) }, { "collision", wordOf(this->Options.collision) },
        { "inlet_value", self.InletValue }, { "outlet_value", self.OutletValue },
        { "initial_value", self.InitialValue }, { "end_time", solver.time() }, { "time_step", solver.timeStep() } });
  }
}
