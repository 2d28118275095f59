#include "vtkBondBreakAlgorithm.h"

#include "BondFields.h"
#include "BondScene.h"
#include "FieldNumbers.h"
#include "FractureData.h"
#include "LongRun.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"

#include "core/Error.h"
#include "peridynamics/BondLattice.h"
#include "peridynamics/Loading.h"
#include "peridynamics/fracture/FractureCheckpoint.h"
#include "peridynamics/fracture/FractureStudy.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <algorithm>
#include <map>
#include <set>

namespace pd = lamella::peridynamics;

namespace
{

constexpr const char* stressName = "stress";
constexpr const char* energyName = "strain_energy";
using lamella::unknown;

template <class Number, class Limit>
void setLimit(const char* name, Number value, Limit& limit)
{
  if (value < 0 || value != value)
  {
    throw lamella::ParameterError(
      std::string(name) + " is " + std::to_string(value), "give a number above 0, or 0 for no limit");
  }
  if (value > 0)
    limit = static_cast<Limit>(value);
}

} // namespace

struct vtkBondBreakAlgorithm::Internals
{
  std::vector<std::int64_t> Broken;
  lamella::Pace Told;
  std::string Anew; ///< a warning, or empty

  // of the last run
  lamella::KeptStates<vtkImageData> States;
  vtkNew<vtkPolyData> Bonds;
  vtkNew<vtkTable> Curve;
  std::vector<pd::Bond> Order;                          ///< the broken bonds
  std::set<std::string> Made;                           ///< fields that all states were given
  std::map<vtkImageData*, std::set<std::string>> Found; ///< and those that were found for one since
};

vtkBondBreakAlgorithm::vtkBondBreakAlgorithm()
  : PeakStress(unknown)
  , Kept(std::make_unique<Internals>())
{
  this->SetNumberOfOutputPorts(3);
}

vtkBondBreakAlgorithm::~vtkBondBreakAlgorithm() = default;

vtkOutputTypesMacro(vtkBondBreakAlgorithm, "vtkImageData", "vtkPolyData", "vtkTable");
vtkGetOutputMacro(vtkBondBreakAlgorithm, BrokenBonds, vtkPolyData, 1);
vtkGetOutputMacro(vtkBondBreakAlgorithm, Curve, vtkTable, 2);
vtkGetStatesMacro(vtkBondBreakAlgorithm, Image, vtkImageData, Kept->States);
vtkAddToListMacro(vtkBondBreakAlgorithm, StateAtBroken, StatesAtBroken, vtkIdType, Kept->Broken);

std::vector<std::int64_t> vtkBondBreakAlgorithm::StatesAtBroken() const
{
  return this->Kept->Broken;
}

void vtkBondBreakAlgorithm::SetState(int state)
{
  this->Kept->States.choose(state);
}

vtkShownStateMacro(vtkBondBreakAlgorithm, Kept->States);

void vtkBondBreakAlgorithm::Show(bool& setting, bool on)
{
  this->Kept->States.toggle(setting, on);
}

void vtkBondBreakAlgorithm::SetComputeDisplacement(bool on)
{
  this->Show(this->ComputeDisplacement, on);
}

void vtkBondBreakAlgorithm::SetComputeStress(bool on)
{
  this->Show(this->ComputeStress, on);
}

void vtkBondBreakAlgorithm::SetComputeStrainEnergy(bool on)
{
  this->Show(this->ComputeStrainEnergy, on);
}

std::vector<std::pair<std::string, bool>> vtkBondBreakAlgorithm::MadeFields() const
{
  return { { "displacement", this->ComputeDisplacement } };
}

std::vector<std::pair<std::string, bool>> vtkBondBreakAlgorithm::ShownFields() const
{
  std::vector<std::pair<std::string, bool>> fields = this->MadeFields();
  fields.emplace_back(stressName, this->ComputeStress);
  fields.emplace_back(energyName, this->ComputeStrainEnergy);
  return fields;
}

bool vtkBondBreakAlgorithm::Lacks(const std::string& field) const
{
  const std::set<std::string>& made = this->Kept->Made;
  const bool follows = (field == stressName || field == energyName) && made.count("displacement") != 0;
  return made.count(field) == 0 && !follows;
}

void vtkBondBreakAlgorithm::Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  Internals& kept = *this->Kept;
  std::set<std::string> asked;
  for (const auto& [name, on] : this->ShownFields())
    if (on)
      asked.insert(name);
  const bool lacking =
    std::any_of(asked.begin(), asked.end(), [this](const std::string& field) { return this->Lacks(field); });
  kept.States.renew(
    input, this->Superclass::GetMTime(), team,
    [&]
    {
      this->Solve(input, team, kept.Bonds, kept.Curve);
      kept.Made = asked;
    },
    [&]
    {
      this->PeakStress = unknown;
      this->StateRange[1] = 0;
      kept.Bonds->Initialize();
      kept.Curve->Initialize();
      kept.Order.clear();
      kept.Made.clear();
      kept.Found.clear();
    },
    lacking);
  this->StateRange[1] = kept.States.count() - 1;
  this->Measure(input, team);
  kept.States.show(output);
  for (const auto& [name, on] : this->ShownFields())
    if (!on)
      lamella::leaveOut(output, input, name.c_str());
  this->GetBrokenBonds()->ShallowCopy(kept.Bonds);
  this->GetCurve()->ShallowCopy(kept.Curve);
}

void vtkBondBreakAlgorithm::Measure(vtkImageData* input, const lamella::Team& team)
{
  vtkImageData* const state = this->Kept->States.shown();
  std::set<std::string>& found = this->Kept->Found[state];
  const auto missing = [&](const char* name) { return this->Kept->Made.count(name) + found.count(name) == 0; };
  const bool stress = this->ComputeStress && missing(stressName);
  const bool energy = this->ComputeStrainEnergy && missing(energyName);
  if (!stress && !energy)
    return;
  this->SetProgressText("stress of the state");
  lamella::BondSettings settings = this->Settings();
  settings.largeStrains = this->Moves();
  const lamella::BondScene scene(
    input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), settings, team);
  const std::vector<double> count = lamella::fieldNumbers(state, "broken_bonds");
  const std::size_t broken = std::min(static_cast<std::size_t>(count.at(0)), this->Kept->Order.size());
  const pd::Loading loading = this->Platens(scene);
  const pd::ThreadScope threads(this->ThreadCount());
  const lamella::Communicator comm(team.comm());
  const auto displacements = [&](pd::NodeField<double>& u) { lamella::displacementsOf(state, scene, u, team); };
  const pd::BondLattice bonds = pd::remainingBonds(scene.model(), scene.lattice(), scene.phase(), scene.grain(),
    std::span(this->Kept->Order).first(broken), this->Moves() ? nullptr : &loading,
    this->CracksClose() ? displacements : std::function<void(pd::NodeField<double>&)>(), comm);
  lamella::addMeasures(state, scene, bonds, { stress, energy, this->Moves() }, this->GetClassName(), team);
  if (stress)
    found.insert(stressName);
  if (energy)
    found.insert(energyName);
}

vtkImageData* vtkBondBreakAlgorithm::NewState(vtkImageData* input)
{
  vtkImageData* const image = this->Kept->States.add(this->KeepStates);
  image->ShallowCopy(input);
  return image;
}

void vtkBondBreakAlgorithm::EmitState(vtkImageData* state)
{
  lamella::tellStep(this, state);
}

std::vector<vtkImageData*> vtkBondBreakAlgorithm::KeptStates() const
{
  return { this->Kept->States.all().begin(), this->Kept->States.all().end() };
}

void vtkBondBreakAlgorithm::AddWarnings(const lamella::BondSettings& settings, std::vector<std::string>& warnings) const
{
  const std::vector<std::string> doubts = lamella::unitDoubts(settings.materials);
  warnings.insert(warnings.end(), doubts.begin(), doubts.end());
  if (!this->Kept->Anew.empty())
    warnings.insert(warnings.begin(), this->Kept->Anew);
}

void vtkBondBreakAlgorithm::Finish(vtkPolyData* broken, vtkTable* curve, std::vector<pd::Bond> order,
  const lamella::BondScene& scene, const std::vector<std::string>& warnings, const lamella::Team& team)
{
  this->Kept->Order = std::move(order);
  if (team.rank() == 0)
    for (const std::string& warning : warnings)
      vtkWarningMacro(<< warning);
  for (vtkDataObject* const data : { static_cast<vtkDataObject*>(broken), static_cast<vtkDataObject*>(curve) })
    data->GetFieldData()->ShallowCopy(this->Kept->States.all().back()->GetFieldData());
  lamella::setLatticeNumbers(broken, scene.lattice());
}

void vtkBondBreakAlgorithm::SetLimit(const char* name, double value, double& limit)
{
  setLimit(name, value, limit);
}

void vtkBondBreakAlgorithm::SetLimit(const char* name, vtkIdType value, std::int64_t& limit)
{
  setLimit(name, value, limit);
}

std::string vtkBondBreakAlgorithm::PrepareCheckpoints(
  vtkImageData* input, const lamella::Team& team, lamella::io::CheckpointOptions& options)
{
  this->LastCheckpoint = 0;
  options.seconds = this->CheckpointSeconds;
  const lamella::RunStart start =
    lamella::startOf(this->ContinueFile, this->CheckpointFile, "the unbroken sample", input, team, options);
  this->Kept->Anew = start.warning;
  return start.from;
}

void vtkBondBreakAlgorithm::TellNext()
{
  this->Kept->Told.next();
}

bool vtkBondBreakAlgorithm::Due()
{
  return this->Kept->Told.due();
}
