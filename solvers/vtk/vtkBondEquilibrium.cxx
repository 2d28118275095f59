#include "vtkBondEquilibrium.h"

#include "BondScene.h"
#include "vtkProvenance.h"

#include "lattice/Error.h"
#include "peridynamics/ElasticStudy.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pd = lamella::peridynamics;

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<const char*, 4> loadName{ "stretch", "shear", "biaxial", "traction" };
constexpr std::array<const char*, 4> solverName{ "multigrid", "jacobi", "direct", "dynamic-relaxation" };
constexpr std::array<const char*, 3> axisName{ "x", "y", "z" };

/// What was found, as field data.
class Numbers
{
public:
  explicit Numbers(vtkImageData* output)
    : output_(output)
  {
  }

  void set(const char* name, double value) const { lamella::setFieldNumbers(output_, name, std::span(&value, 1)); }
  void set(const char* name, std::int64_t value) const { this->set(name, static_cast<double>(value)); }
  template <std::size_t N>
  void set(const char* name, const std::array<double, N>& values) const
  {
    lamella::setFieldNumbers(output_, name, values);
  }

  void result(const pd::ElasticResult& r, const std::vector<std::string>& phases) const
  {
    this->set("effective_modulus", r.effectiveModulus);
    this->set("effective_stress", r.effectiveStress);
    this->set("strain", r.strain);
    this->set("mean_stress", r.meanStress);
    this->set("reaction_low", r.reactions.low);
    this->set("reaction_high", r.reactions.high);
    this->set("elastic_energy", r.elasticEnergy);
    this->set("section_area", r.area);
    this->set("gauge_length", r.length);
    const pd::FirstBreak first =
      r.firstBreak.value_or(pd::FirstBreak{ 0, unknown, unknown, {}, { unknown, unknown, unknown } });
    this->set("first_break_strain", first.strain);
    this->set("first_break_stress", first.stress);
    this->set("first_break_position", first.position);
    std::vector<std::string> names;
    if (r.firstBreak)
    {
      names = { phases.at(first.phases[0]), phases.at(first.phases[1]) };
    }
    lamella::setFieldTexts(output_, "first_break_phases", names);
    this->set("largest_stretch_ratio", r.largestRatio);
    const auto layer = [](std::int64_t n) { return static_cast<double>(n); };
    this->set("platen_layers",
      std::array<double, 4>{
        layer(r.lowPlaten[0]), layer(r.lowPlaten[1] - 1), layer(r.highPlaten[0]), layer(r.highPlaten[1] - 1) });
    lamella::setFieldText(output_, "load_axis", axisName[static_cast<std::size_t>(r.axis)]);
    this->set("loose_pieces", r.loosePieces);
    this->set("loose_nodes", r.looseNodes);
    this->set("hinges", r.solve.hinges);
    this->set("iterations", r.solve.iterations);
    this->set("newton_steps", std::int64_t{ r.solve.newtonSteps });
    this->set("residual", r.solve.residual);
    this->set("products", r.solve.products);
    this->set("levels", std::int64_t{ r.solve.levels });
    this->set("solid_nodes", r.solidNodes);
    this->set("skipped_nodes", r.nodes - r.solidNodes);
    this->set("bonds", r.bonds);
    this->set("visited_strips", std::array<double, 2>{ layer(r.strips.uniform), layer(r.strips.mixed) });
    this->set("skipped_strips", r.strips.empty);
    this->set("bytes", r.bytes);
    this->set("seconds",
      std::array<double, 5>{
        r.bondSeconds, r.loadSeconds, r.solve.setupSeconds, r.solve.solveSeconds, r.measureSeconds });
    lamella::setFieldTexts(output_, "warnings", r.warnings);
  }

private:
  vtkImageData* output_;
};

} // namespace

vtkStandardNewMacro(vtkBondEquilibrium);

vtkBondEquilibrium::vtkBondEquilibrium()
  : EffectiveModulus(unknown)
  , FirstBreakStrain(unknown)
{
}

void vtkBondEquilibrium::Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  this->EffectiveModulus = unknown;
  this->FirstBreakStrain = unknown;
  const lamella::BondSettings settings = this->Settings();
  const lamella::BondScene scene(
    input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), settings, team);
  pd::ElasticOptions options;
  options.loading.load = static_cast<pd::LoadCase>(this->Load);
  options.loading.axis = this->LoadAxis;
  options.loading.strain = this->Strain;
  options.loading.lateralStrain = this->LateralStrain;
  options.loading.traction = this->Traction;
  options.loading.smooth = this->SmoothPlatens;
  options.loading.rigid = this->RigidPlatens;
  options.loading.layers = this->PlatenLayers;
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
  if (this->CheckAbort())
  {
    throw lamella::Cancelled();
  }
  const lamella::Communicator comm(team.comm());
  const pd::ElasticResult result =
    pd::studyElastic(scene.model(), scene.lattice(), scene.phase(), scene.grain(), options, comm);
  this->EffectiveModulus = result.effectiveModulus;
  this->FirstBreakStrain = result.firstBreak ? result.firstBreak->strain : unknown;

  output->ShallowCopy(input);
  vtkPointData* const points = output->GetPointData();
  const std::array<int, 3> from{ 0, 1, scene.lattice().dimension == 3 ? 2 : -1 };
  const auto displacement = scene.toPiece(result.displacement, from, "displacement");
  lamella::describe(displacement, "m", "displacement at equilibrium; 0 in voids", this->GetClassName());
  points->AddArray(displacement);
  points->SetActiveVectors("displacement");
  if (result.stress)
  {
    points->AddArray(lamella::stressArray(scene, *result.stress, this->GetClassName()));
  }
  if (result.energyDensity)
  {
    const auto energy = scene.toPiece(*result.energyDensity, std::array<int, 1>{ 0 }, "strain_energy");
    lamella::describe(
      energy, "J/m^3", "elastic energy of half of the node's bonds over its volume", this->GetClassName());
    points->AddArray(energy);
  }

  const Numbers numbers(output);
  numbers.result(result, scene.phases().names);
  lamella::describeThickness(output, scene, result.thickness);
  const nlohmann::json model = lamella::describeModel(output, scene, settings);
  lamella::setFieldText(output, "load", loadName[static_cast<std::size_t>(this->Load)]);
  lamella::setFieldText(output, "solver", solverName[static_cast<std::size_t>(this->Solver)]);
  lamella::continueProvenance(output, "equilibrium",
    { { "model", model }, { "load", loadName[static_cast<std::size_t>(this->Load)] },
      { "axis", axisName[static_cast<std::size_t>(result.axis)] }, { "strain", this->Strain },
      { "lateral_strain", this->LateralStrain }, { "traction", this->Traction },
      { "smooth_platens", this->SmoothPlatens }, { "rigid_platens", this->RigidPlatens },
      { "platen_layers", this->PlatenLayers }, { "solver", solverName[static_cast<std::size_t>(this->Solver)] },
      { "tolerance", this->Tolerance } });
  if (team.rank() == 0)
  {
    for (const std::string& warning : result.warnings)
    {
      vtkWarningMacro(<< warning);
    }
  }
}

void vtkBondEquilibrium::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Load: " << this->Load << "\n"
     << indent << "LoadAxis: " << this->LoadAxis << "\n"
     << indent << "Strain: " << this->Strain << "\n"
     << indent << "LateralStrain: " << this->LateralStrain << "\n"
     << indent << "Traction: " << this->Traction << "\n"
     << indent << "SmoothPlatens: " << this->SmoothPlatens << "\n"
     << indent << "RigidPlatens: " << this->RigidPlatens << "\n"
     << indent << "PlatenLayers: " << this->PlatenLayers << "\n"
     << indent << "Solver: " << this->Solver << "\n"
     << indent << "Tolerance: " << this->Tolerance << "\n"
     << indent << "MaximumIterations: " << this->MaximumIterations << "\n"
     << indent << "ComputeStress: " << this->ComputeStress << "\n"
     << indent << "ComputeStrainEnergy: " << this->ComputeStrainEnergy << "\n"
     << indent << "EffectiveModulus: " << this->EffectiveModulus << "\n"
     << indent << "FirstBreakStrain: " << this->FirstBreakStrain << "\n";
}
