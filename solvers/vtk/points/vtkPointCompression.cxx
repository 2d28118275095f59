#include "vtkPointCompression.h"

#include "FieldNumbers.h"
#include "LongRun.h"
#include "PointOutput.h"
#include "PointScene.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkProvenance.h"

#include "core/Clock.h"
#include "core/Communicator.h"
#include "core/Error.h"

#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

namespace mpm = lamella::mpm;

namespace
{

constexpr std::array<const char*, 4> sidesNames{ "straight", "open", "fixed", "periodic" };
constexpr std::array<const char*, 3> shapeNames{ "linear", "gimp", "spline" };
constexpr std::array<const char*, 4> transferNames{ "flip", "pic", "apic", "xpic" };
constexpr double sameStrain = 1e-9; // of the last one

} // namespace

struct vtkPointCompression::Internals
{
  vtkPointCompression* Self;
  std::vector<double> Strains;
  std::map<std::string, double> Frictions;
  lamella::Pace Told;

  // of the last run
  lamella::KeptStates<vtkPolyData> States;
  vtkNew<vtkTable> Curve;
  std::map<std::string, bool> Made; ///< fields of the states

  /// What is said of a run.
  struct Account
  {
    mpm::CompressionSummary Summary;
    std::vector<std::string> Warnings;
    double Points = 0;
    double BytesPerPoint = 0;
    double ContinuedAt = 0;
    double StatesBefore = 0;
    double SetupSeconds = 0;
    double RunSeconds = 0;
    int Axis = 0;
    std::array<std::array<double, 3>, 2> Box{};
    std::string Provenance; ///< of the input
  };

  template <int Dim>
  mpm::CompressionOptions<Dim> Options(const lamella::PointScene& scene, const Account& account) const;
  template <int Dim>
  void Solve(vtkImageData* input, const lamella::PointScene& scene, const lamella::Team& team);
  /// What is said of a run that has ended: warnings, curve, and of every state what was found. @param warning or empty
  template <int Dim>
  void Conclude(const mpm::PointCompression<Dim>& run, const lamella::PointScene& scene, const lamella::Team& team,
    const std::string& warning, Account& account);
  void Describe(vtkDataObject* output, const lamella::PointScene& scene, const Account& account) const;
};

vtkStandardNewMacro(vtkPointCompression);

vtkPointCompression::vtkPointCompression()
  : Kept(std::make_unique<Internals>())
{
  this->Kept->Self = this;
  this->SetNumberOfOutputPorts(2);
  this->Controller = vtkMultiProcessController::GetGlobalController();
}

vtkPointCompression::~vtkPointCompression() = default;

vtkOutputTypesMacro(vtkPointCompression, "vtkPolyData", "vtkTable");
vtkGetOutputMacro(vtkPointCompression, Points, vtkPolyData, 0);
vtkGetOutputMacro(vtkPointCompression, Curve, vtkTable, 1);
vtkGetStatesMacro(vtkPointCompression, Points, vtkPolyData, Kept->States);
vtkAddToListMacro(vtkPointCompression, StateAtStrain, StatesAtStrains, double, Kept->Strains);

void vtkPointCompression::SetFriction(const char* pair, double value)
{
  if (pair == nullptr || *pair == '\0')
    return;
  const auto entry = this->Kept->Frictions.find(pair);
  if (entry == this->Kept->Frictions.end() || entry->second != value)
  {
    this->Kept->Frictions[pair] = value;
    this->Modified();
  }
}

vtkRemoveAllMacro(vtkPointCompression, Frictions, Kept->Frictions);

#define LAMELLA_SHOW(name)                                                                                             \
  void vtkPointCompression::SetCompute##name(bool on)                                                                  \
  {                                                                                                                    \
    this->Kept->States.toggle(this->Compute##name, on);                                                                \
  }
LAMELLA_SHOW(Displacement)
LAMELLA_SHOW(Velocity)
LAMELLA_SHOW(Stress)
LAMELLA_SHOW(DeformationGradient)
LAMELLA_SHOW(EnergyDensity)
LAMELLA_SHOW(PlasticStrain)
#undef LAMELLA_SHOW

void vtkPointCompression::SetState(int state)
{
  this->Kept->States.choose(state);
}

vtkShownStateMacro(vtkPointCompression, Kept->States);

void vtkPointCompression::Run(vtkImageData* input, vtkInformationVector* outputs, const lamella::Team& team)
{
  Internals& kept = *this->Kept;
  const std::map<std::string, bool> fields{ { "displacement", this->ComputeDisplacement },
    { "velocity", this->ComputeVelocity }, { "stress", this->ComputeStress },
    { "deformation_gradient", this->ComputeDeformationGradient }, { "energy_density", this->ComputeEnergyDensity },
    { "plastic_strain", this->ComputePlasticStrain } };
  const bool lacking = std::any_of(
    fields.begin(), fields.end(), [&](const auto& field) { return field.second && kept.Made[field.first] == false; });
  kept.States.renew(
    input, this->Superclass::GetMTime(), team,
    [&]
    {
      kept.Made = fields;
      this->LastCheckpoint = 0;
      this->SetProgressText("setting up");
      this->LetStop(team);
      const lamella::PointScene scene(
        input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), this->Settings(), team);
      this->LetStop(team);
      if (scene.lattice().dimension == 3)
      {
        kept.Solve<3>(input, scene, team);
      }
      else
      {
        kept.Solve<2>(input, scene, team);
      }
    },
    [&]
    {
      kept.Curve->Initialize();
      kept.Made.clear();
      this->StateRange[1] = 0;
    },
    lacking);
  this->StateRange[1] = kept.States.count() - 1;
  vtkPolyData* const output = vtkPolyData::GetData(outputs, 0);
  kept.States.show(output);
  for (const auto& [name, on] : fields)
    if (!on)
      output->GetPointData()->RemoveArray(name.c_str());
  vtkDataObject::GetData(outputs, 1)->ShallowCopy(kept.Curve);
}

template <int Dim>
mpm::CompressionOptions<Dim> vtkPointCompression::Internals::Options(
  const lamella::PointScene& scene, const Account& account) const
{
  const vtkPointCompression& s = *this->Self;
  mpm::CompressionOptions<Dim> o;
  o.axis = account.Axis;
  std::copy_n(account.Box[0].begin(), Dim, o.lower.begin());
  std::copy_n(account.Box[1].begin(), Dim, o.upper.begin());
  o.strain = s.Strain;
  o.sides = static_cast<mpm::LateralSides>(s.Sides);
  o.grip = s.Grip;
  if (s.Grip && s.PlatenFriction > 0)
  {
    throw lamella::ParameterError(
      fmt::format("platens that grip, and have a friction of {}", s.PlatenFriction), "give one of the two");
  }
  o.platenFriction = s.PlatenFriction;
  o.energyRatio = s.EnergyRatio;
  o.calmFrom = s.CalmFrom;
  o.firstSpeed = s.FirstSpeed;
  o.leastSpeed = s.LeastSpeed;
  o.mostSpeed = s.MostSpeed;
  o.damping = s.Damping;
  o.rows = s.Rows;
  o.atStrains = this->Strains;
  o.checkpoint.every = s.CheckpointEvery;
  o.checkpoint.seconds = s.CheckpointSeconds;
  o.motion.spacing = scene.gridSpacing();
  o.motion.bodies = scene.bodies(this->Frictions);
  o.motion.shape = static_cast<mpm::Shape>(s.Shape);
  o.motion.transfer = static_cast<mpm::Transfer>(s.Transfer);
  o.motion.mass = s.ConsistentMass ? mpm::MassMatrix::Consistent : mpm::MassMatrix::Lumped;
  o.motion.update = s.ModifiedUpdate ? mpm::StressUpdate::ModifiedLast : mpm::StressUpdate::Last;
  if (s.TimeStep != 0)
    o.motion.step = s.TimeStep;
  return o;
}

template <int Dim>
void vtkPointCompression::Internals::Solve(
  vtkImageData* input, const lamella::PointScene& scene, const lamella::Team& team)
{
  const auto start = lamella::Clock::now();
  vtkPointCompression& self = *this->Self;
  const char* const creator = self.GetClassName();
  const lamella::Communicator comm(team.comm());
  Account account;
  account.Provenance = team.share(lamella::provenance(input), input->GetNumberOfPoints() > 0);
  account.Axis = scene.axis(self.LoadAxis);
  std::array<bool, 3> fitted{};
  fitted[static_cast<std::size_t>(account.Axis)] = self.FitPlatens;
  account.Box = scene.box(fitted);
  mpm::CompressionOptions<Dim> options = this->Options<Dim>(scene, account);
  const lamella::RunStart begin = lamella::startOf(
    self.ContinueFile, self.CheckpointFile, "the undeformed specimen", input, team, options.checkpoint);
  options.checkpoint.provenance = account.Provenance;
  options.continueFrom = begin.from;
  options.motion.comm = comm;

  const auto law = scene.law<Dim>();
  mpm::MaterialPoints<Dim> points = scene.points<Dim>();
  account.Points = static_cast<double>(scene.pointCount());
  const lamella::PointShare<Dim> share = lamella::shareAtStart(points, scene.shares(), comm);
  self.LetStop(team);
  const lamella::PointArrays arrays{ self.ComputeDisplacement, self.ComputeVelocity, self.ComputeStress,
    self.ComputeDeformationGradient, self.ComputeEnergyDensity, self.ComputePlasticStrain };
  const double depth = scene.lattice().origin[2];

  mpm::PointCompression<Dim>* running = nullptr;
  double made = 0;
  const auto keep = [&](double)
  {
    vtkPolyData* const state = this->States.add(self.KeepStates);
    lamella::setPointState(state, *running, *law, share, arrays, depth, creator);
    lamella::setFieldNumber(state, lamella::stateNumber, account.StatesBefore + made++);
    lamella::tellStep(this->Self, state);
  };
  const auto look = [&] { self.LastCheckpoint = running->summary().lastCheckpoint; };
  options.state = keep;
  options.progress = [&](double done)
  {
    if (running != nullptr)
      look();
    if (done == 0 || this->Told.due()) // setting up asks some thirty times
    {
      if (running != nullptr)
      {
        const double stress = running->rows().empty() ? 0 : running->rows().back().stress;
        self.SetProgressText(fmt::format("strain {:.3f}, stress {:.3g} Pa", running->strain(), stress).c_str());
      }
      self.UpdateProgress(done);
    }
    return static_cast<bool>(self.CheckAbort());
  };
  mpm::PointCompression<Dim> run(std::move(points), law, options);
  running = &run;
  const std::int64_t before = run.body().steps();
  account.ContinuedAt = static_cast<double>(before);
  account.StatesBefore = static_cast<double>(std::count_if(this->Strains.begin(), this->Strains.end(),
    [&](double e) { return before > 0 && e < run.strain() - sameStrain * self.Strain; }));
  account.SetupSeconds = comm.max(lamella::secondsSince(start));
  const auto moved = lamella::Clock::now();
  const bool finished = run.run();
  account.BytesPerPoint = comm.sum(static_cast<double>(run.body().points().bytes())) / account.Points;
  account.RunSeconds = comm.max(lamella::secondsSince(moved));
  look(); // also where it was stopped
  if (!finished)
    throw lamella::Cancelled();
  const bool ended = this->States.count() > 0 &&
    this->States.all().back()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()) >=
      run.strain() - sameStrain * self.Strain;
  if (!ended)
    keep(run.strain());

  this->Conclude(run, scene, team, begin.warning, account);
}

template <int Dim>
void vtkPointCompression::Internals::Conclude(const mpm::PointCompression<Dim>& run, const lamella::PointScene& scene,
  const lamella::Team& team, const std::string& warning, Account& account)
{
  vtkPointCompression& self = *this->Self;
  account.Summary = run.summary();
  if (!warning.empty())
    account.Warnings.push_back(warning);
  for (const std::vector<std::string>& some : { scene.warnings(), account.Summary.warnings })
    account.Warnings.insert(account.Warnings.end(), some.begin(), some.end());
  for (const std::string& said : account.Warnings)
    if (team.rank() == 0)
      vtkWarningWithObjectMacro(&self, << said);
  for (const auto& state : this->States.all())
  {
    lamella::setFieldNumber(
      state, "stress", lamella::stressAt(run.rows(), lamella::fieldNumbers(state, "strain").at(0)));
    this->Describe(state, scene, account);
  }
  if (team.rank() == 0)
    lamella::setCompressionCurve(this->Curve, run.rows(), self.GetClassName());
  this->Curve->GetFieldData()->ShallowCopy(this->States.all().back()->GetFieldData());
}

void vtkPointCompression::Internals::Describe(
  vtkDataObject* output, const lamella::PointScene& scene, const Account& account) const
{
  const vtkPointCompression& self = *this->Self;
  const mpm::CompressionSummary& s = account.Summary;
  const auto number = [output](const char* name, double value) { lamella::setFieldNumber(output, name, value); };
  const auto whole = [&](const char* name, std::int64_t value) { number(name, static_cast<double>(value)); };
  number("worst_energy_ratio", s.worstRatio);
  number("worst_energy_ratio_strain", s.worstRatioAt);
  number("early_energy_ratio", s.earlyRatio);
  number("early_energy_ratio_strain", s.earlyRatioAt);
  number("calm_from", s.calmFrom);
  number("worst_lateral", s.worstLateral);
  number("worst_imbalance", s.worstImbalance);
  number("wave_speed", s.waveSpeed);
  number("first_touch_strain", s.firstTouch);
  whole("slowdowns", s.slowdowns);
  whole("steps", s.steps);
  number("points", account.Points);
  number("bytes_per_point", account.BytesPerPoint);
  number(
    "updates_per_second", account.Points * (static_cast<double>(s.steps) - account.ContinuedAt) / account.RunSeconds);
  lamella::setFieldNumbers(output, "seconds", std::array{ account.SetupSeconds, account.RunSeconds });
  number("continued_at", account.ContinuedAt);
  number("states_before", account.StatesBefore);
  whole("checkpoints", s.checkpoints);
  whole("last_checkpoint", self.LastCheckpoint);
  lamella::setFieldNumbers(output, "box",
    std::array{ account.Box[0][0], account.Box[0][1], account.Box[0][2], account.Box[1][0], account.Box[1][1],
      account.Box[1][2] });
  const std::string axis(1, "xyz"[account.Axis]);
  lamella::setFieldText(output, "load_axis", axis);
  lamella::setFieldText(output, "sides", sidesNames.at(static_cast<std::size_t>(self.Sides)));
  lamella::setFieldTexts(output, "warnings", account.Warnings);
  const nlohmann::json model = scene.describe(output);
  lamella::setProvenance(output, account.Provenance);
  lamella::continueProvenance(output, "compression",
    { { "model", model }, { "axis", axis }, { "strain", self.Strain },
      { "sides", sidesNames.at(static_cast<std::size_t>(self.Sides)) }, { "grip", self.Grip },
      { "platen_friction", self.PlatenFriction }, { "friction", this->Frictions }, { "fit_platens", self.FitPlatens },
      { "energy_ratio", self.EnergyRatio }, { "calm_from", self.CalmFrom },
      { "speeds", { self.FirstSpeed, self.LeastSpeed, self.MostSpeed } }, { "damping", self.Damping },
      { "rows", self.Rows }, { "shape", shapeNames.at(static_cast<std::size_t>(self.Shape)) },
      { "transfer", transferNames.at(static_cast<std::size_t>(self.Transfer)) },
      { "mass", self.ConsistentMass ? "consistent" : "lumped" }, { "update", self.ModifiedUpdate ? "musl" : "usl" },
      { "time_step", self.TimeStep }, { "checkpoint_every", self.CheckpointEvery } });
}
