#include "vtkBondDynamics.h"

#include "BondFields.h"
#include "BondScene.h"
#include "DynamicsData.h"
#include "FractureData.h"
#include "vtkClassMacros.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "lattice/PhaseNames.h"
#include "peridynamics/fracture/DynamicsStudy.h"

#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pd = lamella::peridynamics;

namespace
{

/// What is told of sides: by side and component.
using SideTable = std::map<std::string, std::map<std::string, double>>;

struct BoxVelocity
{
  std::array<double, 3> Low;
  std::array<double, 3> High;
  std::string Component;
  double Speed;
};

void setSide(vtkObject* object, SideTable& table, const char* side, const char* component, double value)
{
  if (side != nullptr && *side != '\0' && component != nullptr && *component != '\0')
    lamella::setNamed(object, table[side], component, value);
}

int componentOf(const std::string& name, int dimension)
{
  const std::size_t c = std::string("xyz").find(name);
  if (name.size() != 1 || c >= static_cast<std::size_t>(dimension))
  {
    throw lamella::ParameterError(
      "there is no component '" + name + "' in " + std::to_string(dimension) + " dimensions",
      dimension == 3 ? "it is x, y or z" : "of a picture it is x or y; y points up");
  }
  return static_cast<int>(c);
}

struct Side
{
  int Axis;
  bool High;
};

Side sideOf(const std::string& name, const lamella::BondScene& scene)
{
  const int dimension = scene.lattice().dimension;
  if (name.size() != 2 || (name[1] != '-' && name[1] != '+') ||
    std::string("xyz").find(name[0]) >= static_cast<std::size_t>(dimension))
  {
    throw lamella::ParameterError("there is no side '" + name + "' in " + std::to_string(dimension) + " dimensions",
      dimension == 3 ? "it is x-, x+, y-, y+, z- or z+"
                     : "of a picture it is x- (left), x+ (right), y- (bottom) or y+ (top)");
  }
  const Side side{ name[0] - 'x', name[1] == '+' };
  if (scene.model().periodic[static_cast<std::size_t>(side.Axis)])
  {
    throw lamella::ParameterError("side '" + name + "' of a sample that is periodic along " + name[0],
      "make that direction not periodic, or choose another side");
  }
  return side;
}

} // namespace

struct vtkBondDynamics::Internals
{
  std::map<std::string, double> Densities;
  SideTable Velocities;
  SideTable Tractions;
  std::vector<BoxVelocity> Boxes;
  std::vector<double> Times;
};

vtkStandardNewMacro(vtkBondDynamics);

vtkBondDynamics::vtkBondDynamics()
  : Internal(std::make_unique<Internals>())
{
  this->SetInputArrayToProcess(2, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "velocity");
  this->CheckpointEvery = 1000;
}

vtkBondDynamics::~vtkBondDynamics() = default;

vtkSetNamedMacro(vtkBondDynamics, PhaseDensity, PhaseDensities, Internal->Densities);

void vtkBondDynamics::SetSideVelocity(const char* side, const char* component, double speed)
{
  setSide(this, this->Internal->Velocities, side, component, speed);
}

void vtkBondDynamics::SetSideTraction(const char* side, const char* component, double traction)
{
  setSide(this, this->Internal->Tractions, side, component, traction);
}

void vtkBondDynamics::AddBoxVelocity(
  double x1, double y1, double z1, double x2, double y2, double z2, const char* component, double speed)
{
  this->Internal->Boxes.push_back(
    { { x1, y1, z1 }, { x2, y2, z2 }, component != nullptr ? component : std::string(), speed });
  this->Modified();
}

vtkAddToListMacro(vtkBondDynamics, StateAtTime, StatesAtTimes, double, Internal->Times);
vtkRemoveAllMacro(vtkBondDynamics, SideVelocities, Internal->Velocities);
vtkRemoveAllMacro(vtkBondDynamics, SideTractions, Internal->Tractions);
vtkRemoveAllMacro(vtkBondDynamics, BoxVelocities, Internal->Boxes);

void vtkBondDynamics::SetMovement(const lamella::BondScene& scene, pd::DynamicsStudyOptions& options) const
{
  const lamella::Lattice& lattice = scene.lattice();
  const int d = lattice.dimension;
  const int layers = this->PlatenLayers > 0 ? this->PlatenLayers : pd::Stencil(d, scene.model().horizon).layers();
  for (const auto& [name, components] : this->Internal->Velocities)
  {
    const Side side = sideOf(name, scene);
    pd::MovedNodes moved{ pd::sideLayers(lattice, side.Axis, side.High, layers), {} };
    for (const auto& [component, speed] : components)
      moved.velocity[static_cast<std::size_t>(componentOf(component, d))] = speed;
    options.moved.push_back(moved);
  }
  for (const BoxVelocity& box : this->Internal->Boxes)
  {
    pd::MovedNodes moved{ pd::nodesBetween(lattice, box.Low, box.High), {} };
    moved.velocity[static_cast<std::size_t>(componentOf(box.Component, d))] = box.Speed;
    options.moved.push_back(moved);
  }
  for (const auto& [name, components] : this->Internal->Tractions)
  {
    const Side side = sideOf(name, scene);
    pd::SideTraction traction{ side.Axis, side.High, { 0, 0, 0 }, layers };
    for (const auto& [component, value] : components)
      traction.traction[static_cast<std::size_t>(componentOf(component, d))] = value;
    options.tractions.push_back(traction);
  }
  for (std::size_t c = 0; c < 3; ++c)
    options.velocity[c] = c < static_cast<std::size_t>(d) ? this->InitialVelocity[c] : 0;
  if (this->Pull)
  {
    pd::PullOptions pull;
    pull.loading = this->Platens(scene);
    pull.loading.strain = this->Compression ? -1 : 1;
    pull.strainRate = this->StrainRate;
    pull.transits = this->TravelTimes;
    pull.startShare = this->StartShare;
    options.pull = pull;
  }
}

void vtkBondDynamics::CheckRate() const
{
  const char* const without = this->ReferenceEnergy != 0 ? "omega0"
    : this->ReferenceCrack != 0                          ? "delta l"
    : this->StartRate != 1                               ? "start rate"
                                                         : nullptr;
  if (this->Relaxation == 0 && without != nullptr)
    throw lamella::ParameterError(std::string(without) + " counts only with tau", "give tau, or leave it out");
  if (this->ReferenceEnergy != 0 && this->ReferenceCrack != 0)
    throw lamella::ParameterError("omega0 and delta l", "each says what the other one does: leave one out");
}

void vtkBondDynamics::SetDensities(const lamella::BondScene& scene, pd::DynamicsStudyOptions& options) const
{
  options.motion.density = this->Density;
  const std::vector<std::string>& names = scene.phases().names;
  options.densities.assign(names.size(), 0);
  for (std::size_t id = 0; id < names.size(); ++id)
  {
    if (const auto own = lamella::entryOf(this->Internal->Densities, names, id); own != this->Internal->Densities.end())
    {
      if (!(own->second > 0) || !std::isfinite(own->second))
      {
        throw lamella::ParameterError(
          "the density of " + names[id] + " is " + std::to_string(own->second), "give a number above 0 [kg/m³]");
      }
      const auto& voids = scene.model().voids;
      if (std::find(voids.begin(), voids.end(), id) != voids.end())
      {
        throw lamella::ParameterError(
          "a density is given for " + names[id] + ", but " + names[id] + " carries no bonds",
          "take the density out, or the phase from the voids");
      }
      options.densities[id] = own->second;
    }
  }
}

void vtkBondDynamics::SetOptions(const lamella::BondScene& scene, pd::DynamicsStudyOptions& options) const
{
  this->SetMovement(scene, options);
  this->SetDensities(scene, options);
  pd::DynamicsOptions& motion = options.motion;
  motion.damping = this->Damping;
  motion.safety = this->StepShare;
  if (this->TimeStep != 0)
    motion.step = this->TimeStep;
  motion.checkpoint.every = this->CheckpointEvery;
  options.axis = this->LoadAxis;
  options.regulation = { this->Relaxation, this->ReferenceEnergy, this->ReferenceCrack, this->StartRate };
  SetLimit("the time of the end", this->EndTime, options.ends.time);
  SetLimit("the largest strain", this->MaximumStrain, options.ends.strain);
  SetLimit("the largest number of broken bonds", this->MaximumBroken, options.ends.broken);
  options.ends.stopShare = this->StopShare;
  options.every = this->HistoryEvery;
  options.atTimes = this->Internal->Times;
  options.atBroken = this->StatesAtBroken();
  options.displacement = this->ComputeDisplacement;
  options.velocities = this->ComputeVelocity;
  options.stress = this->ComputeStress;
  options.energyDensity = this->ComputeStrainEnergy;
  options.threads = this->ThreadCount();
}

void vtkBondDynamics::Solve(vtkImageData* input, const lamella::Team& team, vtkPolyData* broken, vtkTable* curve)
{
  lamella::BondSettings settings = this->Settings();
  settings.largeStrains = true; // as the forces are, for filters on the result
  const lamella::BondScene scene(
    input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), settings, team);
  this->CheckRate();
  if (lamella::fieldText(input, "pixel_size_source") == "none")
  {
    throw lamella::ParameterError(
      "motion needs the size of a pixel, which is not known", "give it where the picture is read: pixel size");
  }
  pd::DynamicsStudyOptions options;
  this->SetOptions(scene, options);
  options.motion.continueFrom = this->PrepareCheckpoints(input, team, options.motion.checkpoint);
  lamella::NodeVectors velocity;
  if (this->UseInputVelocity)
  {
    velocity = lamella::vectorsOf(input, this->GetInputArrayInformation(2), "velocity",
      "make it, for instance with a calculator", scene.lattice().dimension, team);
    options.startVelocity = [&](pd::NodeField<double>& field) { scene.toSlab(velocity.array, velocity.name, field); };
  }
  this->SetProgressText("motion");
  options.progress = [this](const pd::DynamicsProgress& p, double share)
  {
    this->LastCheckpoint = p.checkpoint;
    this->Tell(share,
      [&]
      {
        std::array<char, 96> text{};
        std::snprintf(text.data(), text.size(), "%.3g s, %lld bonds broken", p.time, static_cast<long long>(p.broken));
        return std::string(text.data());
      });
    return static_cast<bool>(this->CheckAbort());
  };
  options.keep = [&](const pd::MotionState& state)
  {
    vtkImageData* const image = this->NewState(input);
    lamella::setMotionState(image, state, scene, this->GetClassName());
    this->EmitState(image);
  };
  if (this->CheckAbort())
    throw lamella::Cancelled();
  pd::DynamicsResult result = pd::studyDynamics(
    scene.model(), scene.lattice(), scene.phase(), scene.grain(), options, lamella::Communicator(team.comm()));
  this->PeakStress = result.peak.stress;
  this->LastCheckpoint = result.checkpointAt;
  this->AddWarnings(settings, result.warnings);
  for (vtkImageData* const image : this->KeptStates())
    this->Describe(image, scene, settings, result, options.velocity, velocity.name);
  if (team.rank() == 0)
  {
    lamella::setBrokenBonds(broken, result, scene, this->GetClassName());
    lamella::setHistory(curve, result, scene.lattice().dimension, this->GetClassName());
  }
  std::vector<pd::Bond> order;
  for (const auto& b : result.broken)
    order.push_back(b.bond);
  this->Finish(broken, curve, std::move(order), scene, result.warnings, team);
}

void vtkBondDynamics::Describe(vtkImageData* image, const lamella::BondScene& scene,
  const lamella::BondSettings& settings, const pd::DynamicsResult& result, const std::array<double, 3>& velocity,
  const std::string& inputVelocity) const
{
  const char* const load = this->Pull ? this->LoadName() : "sides";
  lamella::setDynamicsNumbers(image, result);
  lamella::describeThickness(image, scene, result.thickness);
  const nlohmann::json model = lamella::describeModel(image, scene, settings);
  lamella::setFieldText(image, "load", load);
  lamella::setFieldNumber(image, "compression", this->Compression ? 1.0 : 0.0);
  nlohmann::json boxes = nlohmann::json::array();
  for (const BoxVelocity& box : this->Internal->Boxes)
    boxes.push_back({ box.Low, box.High, box.Component, box.Speed });
  lamella::continueProvenance(image, "dynamics",
    { { "model", model }, { "density", this->Density }, { "densities", this->Internal->Densities }, { "load", load },
      { "axis", std::string(1, "xyz"[result.axis]) }, { "compression", this->Compression },
      { "smooth_platens", this->SmoothPlatens }, { "rigid_platens", this->RigidPlatens },
      { "platen_layers", this->PlatenLayers }, { "strain_rate", this->StrainRate },
      { "travel_times", this->TravelTimes }, { "start_share", this->StartShare },
      { "side_velocities", this->Internal->Velocities }, { "side_tractions", this->Internal->Tractions },
      { "box_velocities", boxes }, { "initial_velocity", velocity }, { "input_velocity", inputVelocity },
      { "relaxation", this->Relaxation }, { "reference_energy", this->ReferenceEnergy },
      { "reference_crack", this->ReferenceCrack }, { "start_rate", this->StartRate }, { "damping", this->Damping },
      { "time_step", result.step }, { "end_time", this->EndTime }, { "stop_share", this->StopShare },
      { "maximum_strain", this->MaximumStrain }, { "maximum_broken", this->MaximumBroken } });
}

void vtkBondDynamics::SetComputeVelocity(bool on)
{
  this->Show(this->ComputeVelocity, on);
}

std::vector<std::pair<std::string, bool>> vtkBondDynamics::MadeFields() const
{
  std::vector<std::pair<std::string, bool>> fields = this->Superclass::MadeFields();
  fields.emplace_back("velocity", this->ComputeVelocity);
  return fields;
}
