#include "vtkBondEquilibrium.h"

#include "BondFields.h"
#include "BreakData.h"
#include "FieldNumbers.h"
#include "LongRun.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "core/Plausible.h"
#include "peridynamics/BondLattice.h"
#include "peridynamics/ElasticStudy.h"

#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"

#include <fmt/format.h>

#include <cmath>

namespace pd = lamella::peridynamics;

namespace
{

using lamella::unknown;
constexpr std::array<const char*, 4> solverName{ "multigrid", "jacobi", "direct", "dynamic-relaxation" };

/// What was found, as field data.
void setNumbers(vtkImageData* output, const pd::ElasticResult& r, const std::vector<std::string>& phases)
{
  const auto set = [output](const char* name, double value) { lamella::setFieldNumber(output, name, value); };
  const auto whole = [&](const char* name, std::int64_t value) { set(name, static_cast<double>(value)); };
  lamella::setPlatens(output, r);
  lamella::setWork(output, r);
  set("effective_modulus", r.effectiveModulus);
  set("effective_stress", r.effectiveStress);
  set("strain", r.strain);
  lamella::setFieldNumbers(output, "mean_stress", r.meanStress);
  lamella::setFieldNumbers(output, "reaction_low", r.reactions.low);
  lamella::setFieldNumbers(output, "reaction_high", r.reactions.high);
  set("elastic_energy", r.elasticEnergy);
  const pd::FirstBreak first =
    r.firstBreak.value_or(pd::FirstBreak{ 0, unknown, unknown, {}, { unknown, unknown, unknown } });
  set("first_break_strain", first.strain);
  set("first_break_stress", first.stress);
  lamella::setFieldNumbers(output, "first_break_position", first.position);
  std::vector<std::string> names;
  if (r.firstBreak)
    names = { phases.at(first.phases[0]), phases.at(first.phases[1]) };
  lamella::setFieldTexts(output, "first_break_phases", names);
  set("largest_stretch_ratio", r.largestRatio);
  lamella::setPores(output, r);
  whole("hinges", r.solve.hinges);
  whole("iterations", r.solve.iterations);
  whole("newton_steps", r.solve.newtonSteps);
  set("residual", r.solve.residual);
  whole("products", r.solve.products);
  whole("levels", r.solve.levels);
  lamella::setFieldNumbers(output, "seconds",
    std::array{ r.bondSeconds, r.loadSeconds, r.solve.setupSeconds, r.solve.solveSeconds, r.measureSeconds,
      r.sensitivitySeconds });
}

} // namespace

vtkStandardNewMacro(vtkBondEquilibrium);

struct vtkBondEquilibrium::Internals
{
  lamella::KeptStates<vtkImageData> Solved; ///< one
  // which of its fields are there
  bool Stress = false;
  bool Energy = false;
};

vtkBondEquilibrium::vtkBondEquilibrium()
  : Kept(std::make_unique<Internals>())
  , EffectiveModulus(unknown)
  , FirstBreakStrain(unknown)
{
}

vtkBondEquilibrium::~vtkBondEquilibrium() = default;

void vtkBondEquilibrium::SetComputeStress(bool on)
{
  this->Kept->Solved.toggle(this->ComputeStress, on);
}

void vtkBondEquilibrium::SetComputeStrainEnergy(bool on)
{
  this->Kept->Solved.toggle(this->ComputeStrainEnergy, on);
}

vtkMTimeType vtkBondEquilibrium::GetMTime()
{
  return this->Kept->Solved.changed(this->Superclass::GetMTime());
}

void vtkBondEquilibrium::Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  Internals& kept = *this->Kept;
  kept.Solved.renew(
    input, this->Superclass::GetMTime(), team,
    [&]
    {
      this->Solve(input, kept.Solved.add(true), team);
      kept.Stress = this->ComputeStress;
      kept.Energy = this->ComputeStrainEnergy;
    },
    [&]
    {
      this->EffectiveModulus = unknown;
      this->FirstBreakStrain = unknown;
    });
  const bool stress = this->ComputeStress && !kept.Stress;
  const bool energy = this->ComputeStrainEnergy && !kept.Energy;
  if (stress || energy)
  {
    const lamella::BondSettings settings = this->Settings();
    const lamella::BondScene scene(
      input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), settings, team);
    const pd::ThreadScope threads(this->ThreadCount());
    const lamella::Communicator comm(team.comm());
    const pd::BondLattice bonds(scene.model(), scene.lattice(), scene.phase(), scene.grain(), comm);
    lamella::addMeasures(
      kept.Solved.shown(), scene, bonds, { stress, energy, settings.largeStrains }, this->GetClassName(), team);
    kept.Stress = kept.Stress || stress;
    kept.Energy = kept.Energy || energy;
  }
  kept.Solved.show(output);
  if (!this->ComputeStress)
    lamella::leaveOut(output, input, "stress");
  if (!this->ComputeStrainEnergy)
    lamella::leaveOut(output, input, "strain_energy");
}

void vtkBondEquilibrium::Solve(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  const lamella::BondSettings settings = this->Settings();
  const lamella::BondScene scene(
    input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), settings, team);
  pd::ElasticOptions options;
  options.loading = this->Platens(scene);
  this->CheckLoad();
  options.loading.strain = this->Strain;
  options.loading.lateralStrain = this->LateralStrain;
  options.loading.traction = this->Traction;
  options.loading.pressure = this->Pressure;
  options.equilibrium.solver = static_cast<pd::EquilibriumSolver>(this->Solver);
  options.equilibrium.strains = settings.largeStrains ? pd::Strains::Large : pd::Strains::Small;
  options.equilibrium.tolerance = this->Tolerance;
  options.equilibrium.maxIterations = this->MaximumIterations;
  this->SetProgressText("equilibrium");
  options.equilibrium.progress = [this](double share)
  {
    this->UpdateProgress(share);
    return this->CheckAbort();
  };
  options.stress = this->ComputeStress;
  options.energyDensity = this->ComputeStrainEnergy;
  options.threads = this->ThreadCount();
  const lamella::BondUncertainties& uncertainties = this->Uncertainties();
  options.sensitivity = this->WantsSensitivity();
  if (this->CheckAbort())
    throw lamella::Cancelled();
  const lamella::Communicator comm(team.comm());
  pd::ElasticResult result =
    pd::studyElastic(options.sensitivity ? lamella::sensitivityModel(scene, settings) : scene.model(), scene.lattice(),
      scene.phase(), scene.grain(), options, comm);
  for (const std::string& doubt : lamella::unitDoubts(settings.materials))
    result.warnings.push_back(doubt);
  this->EffectiveModulus = result.effectiveModulus;
  this->FirstBreakStrain = result.firstBreak ? result.firstBreak->strain : unknown;

  output->ShallowCopy(input);
  lamella::addDisplacement(output, scene, result.displacement, this->GetClassName());
  if (result.stress)
    output->GetPointData()->AddArray(lamella::stressArray(scene, *result.stress, this->GetClassName()));
  if (result.energyDensity)
    lamella::addStrainEnergy(output, scene, *result.energyDensity, this->GetClassName());

  setNumbers(output, result, scene.phases().names);
  lamella::setBreakSensitivity(output, scene, settings, uncertainties,
    result.firstBreak ? result.firstBreak->stress : unknown, result.sensitivity);
  lamella::describeThickness(output, scene, result.thickness);
  const nlohmann::json model = lamella::describeModel(output, scene, settings);
  lamella::setFieldText(output, "load", this->LoadName());
  lamella::setFieldText(output, "solver", solverName[static_cast<std::size_t>(this->Solver)]);
  lamella::continueProvenance(output, "equilibrium",
    { { "model", model }, { "load", this->LoadName() }, { "axis", std::string(1, "xyz"[result.axis]) },
      { "strain", this->Strain }, { "lateral_strain", this->LateralStrain }, { "traction", this->Traction },
      { "pressure", this->Pressure }, { "pressure_in", this->PressurePhases() },
      { "straight_sides", this->StraightSides }, { "smooth_platens", this->SmoothPlatens },
      { "rigid_platens", this->RigidPlatens }, { "platen_layers", this->PlatenLayers },
      { "solver", solverName[static_cast<std::size_t>(this->Solver)] }, { "sensitivity", options.sensitivity },
      { "tolerance", this->Tolerance } });
  if (team.rank() == 0)
    for (const std::string& warning : result.warnings)
      vtkWarningMacro(<< warning);
}

void vtkBondEquilibrium::CheckLoad() const
{
  if (this->Load == PRESSURE)
    return; // the solver looks at it
  const bool traction = this->Load == TRACTION;
  const double load = traction ? this->Traction : this->Strain;
  if (load != 0 && !lamella::plausible(std::fabs(load)))
  {
    throw lamella::ParameterError(
      fmt::format("{} {:g} is not between 1e-30 and 1e30", traction ? "traction" : "strain", load),
      traction ? "give pascals, such as 1e6" : "give a number such as 1e-3");
  }
}
