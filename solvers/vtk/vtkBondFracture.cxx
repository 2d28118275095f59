#include "vtkBondFracture.h"

#include "BondScene.h"
#include "FieldNumbers.h"
#include "FractureData.h"
#include "vtkProvenance.h"

#include "io/Checkpoint.h"
#include "lattice/Error.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <system_error>
#include <vector>

namespace pd = lamella::peridynamics;

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Of a limit: 0 stands for none.
template <class Number>
void setLimit(const char* name, Number value, Number& limit)
{
  if (value < 0 || value != value)
  {
    throw lamella::ParameterError(
      std::string(name) + " is " + std::to_string(value), "give a number above 0, or 0 for no limit");
  }
  if (value > 0)
  {
    limit = value;
  }
}

/// The observers of progress are told some twenty times a second, however many events there are.
class Rarely
{
public:
  [[nodiscard]] bool due()
  {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(50))
    {
      return false;
    }
    last_ = now;
    return true;
  }

private:
  std::chrono::steady_clock::time_point last_{};
};

} // namespace

struct vtkBondFracture::Internals
{
  std::vector<double> Strains;
  std::vector<std::int64_t> Broken;

  // of the last run
  std::vector<vtkSmartPointer<vtkImageData>> States;
  vtkNew<vtkPolyData> Bonds;
  vtkNew<vtkTable> Curve;
  vtkMTimeType Input = 0;
  vtkMTimeType Settings = 0;
  int Ranks = 0;

  void Forget()
  {
    this->States.clear();
    this->Bonds->Initialize();
    this->Curve->Initialize();
  }
};

vtkStandardNewMacro(vtkBondFracture);

vtkBondFracture::vtkBondFracture()
  : Kept(std::make_unique<Internals>())
  , PeakStress(unknown)
{
  this->SetNumberOfOutputPorts(3);
}

vtkBondFracture::~vtkBondFracture() = default;

int vtkBondFracture::FillOutputPortInformation(int port, vtkInformation* info)
{
  constexpr std::array<const char*, 3> types{ "vtkImageData", "vtkPolyData", "vtkTable" };
  info->Set(vtkDataObject::DATA_TYPE_NAME(), types.at(static_cast<std::size_t>(port)));
  return 1;
}

vtkPolyData* vtkBondFracture::GetBrokenBonds()
{
  return vtkPolyData::SafeDownCast(this->GetOutputDataObject(1));
}

vtkTable* vtkBondFracture::GetCurve()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(2));
}

int vtkBondFracture::GetNumberOfStates()
{
  return static_cast<int>(this->Kept->States.size());
}

vtkImageData* vtkBondFracture::GetStateImage(int state)
{
  return state >= 0 && state < this->GetNumberOfStates() ? this->Kept->States[static_cast<std::size_t>(state)]
                                                         : nullptr;
}

void vtkBondFracture::AddStateAtStrain(double strain)
{
  this->Kept->Strains.push_back(strain);
  this->Modified();
}

void vtkBondFracture::RemoveAllStatesAtStrains()
{
  if (!this->Kept->Strains.empty())
  {
    this->Kept->Strains.clear();
    this->Modified();
  }
}

void vtkBondFracture::AddStateAtBroken(vtkIdType broken)
{
  this->Kept->Broken.push_back(broken);
  this->Modified();
}

void vtkBondFracture::RemoveAllStatesAtBroken()
{
  if (!this->Kept->Broken.empty())
  {
    this->Kept->Broken.clear();
    this->Modified();
  }
}

void vtkBondFracture::SetCheckpointFile(const std::string& path)
{
  if (this->CheckpointFile != path)
  {
    this->CheckpointFile = path;
    this->Modified();
  }
}

void vtkBondFracture::SetContinueFile(const std::string& path)
{
  if (this->ContinueFile != path)
  {
    this->ContinueFile = path;
    this->Modified();
  }
}

void vtkBondFracture::SetState(int state)
{
  const int clamped = std::max(state, -1);
  if (this->State != clamped)
  {
    this->State = clamped;
    this->StateTime.Modified(); // not Modified(): that would run all again
  }
}

vtkMTimeType vtkBondFracture::GetMTime()
{
  return std::max(this->Superclass::GetMTime(), this->StateTime.GetMTime());
}

void vtkBondFracture::Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  Internals& kept = *this->Kept;
  const vtkMTimeType settings = this->Superclass::GetMTime();
  if (team.any(kept.States.empty() || kept.Input != input->GetMTime() || kept.Settings != settings ||
        kept.Ranks != team.size()))
  {
    this->PeakStress = unknown;
    kept.Forget();
    try
    {
      this->Solve(input, team);
    }
    catch (...)
    {
      kept.Forget();
      throw;
    }
    kept.Input = input->GetMTime();
    kept.Settings = settings;
    kept.Ranks = team.size();
  }
  const int last = this->GetNumberOfStates() - 1;
  vtkImageData* const state = this->GetStateImage(this->State < 0 ? last : std::min(this->State, last));
  output->ShallowCopy(state);
  output->GetInformation()->Set(
    vtkDataObject::DATA_TIME_STEP(), state->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()));
  this->GetBrokenBonds()->ShallowCopy(kept.Bonds);
  this->GetCurve()->ShallowCopy(kept.Curve);
}

void vtkBondFracture::Solve(vtkImageData* input, const lamella::Team& team)
{
  Internals& kept = *this->Kept;
  const lamella::BondSettings settings = this->Settings();
  if (settings.largeStrains)
  {
    throw lamella::ParameterError("fracture in large strains", "leave them out: quasi-static fracture is linear");
  }
  const lamella::BondScene scene(
    input, this->GetInputArrayInformation(0), this->GetInputArrayInformation(1), settings, team);
  pd::FractureStudyOptions options;
  options.loading = this->Platens();
  options.loading.strain = this->Compression ? -1e-3 : 1e-3;
  options.loading.lateralStrain = this->LateralRatio * options.loading.strain;
  options.fracture.breaking = static_cast<pd::Breaking>(this->Breaking);
  options.fracture.stopShare = this->StopShare;
  setLimit("the largest strain", this->MaximumStrain, options.fracture.maxStrain);
  options.fracture.strainStep = this->StrainStep;
  std::int64_t most = 0;
  setLimit("the largest number of broken bonds", std::int64_t{ this->MaximumBroken }, most);
  options.fracture.maxBroken = most > 0 ? most : options.fracture.maxBroken;
  options.fracture.tolerance = this->Tolerance;
  if (!this->Rivals)
  {
    options.fracture.events.rivals = 0;
  }
  if (this->Method != AUTO)
  {
    options.method = this->Method == EVENTS ? pd::FractureMethod::Events : pd::FractureMethod::Accurate;
  }
  options.fracture.renewEvery = this->CheckpointEvery;
  options.fracture.checkpoint.path = this->CheckpointFile;
  options.fracture.checkpoint.provenance = lamella::fieldText(input, "provenance").value_or("");
  std::error_code ignored;
  const bool anew = !this->ContinueFile.empty() && lamella::io::sameFile(this->ContinueFile, this->CheckpointFile) &&
    team.any(team.rank() == 0 && !std::filesystem::exists(this->ContinueFile, ignored));
  if (!anew)
  {
    options.fracture.continueFrom = this->ContinueFile;
  }
  this->LastCheckpoint = 0;
  bool unwritten = false; // the last checkpoint
  options.fracture.checkpoint.warn = [&unwritten](const std::string&) { unwritten = true; };
  options.atStrains = kept.Strains;
  options.atBroken = kept.Broken;
  options.displacement = this->ComputeDisplacement;
  options.stress = this->ComputeStress;
  options.energyDensity = this->ComputeStrainEnergy;
  options.threads = this->ThreadCount();
  this->SetProgressText("fracture");
  Rarely before; // the first break
  Rarely after;
  options.fracture.progress = [&](const pd::FractureProgress& p)
  {
    unwritten = unwritten && this->LastCheckpoint == p.checkpoint;
    this->LastCheckpoint = p.checkpoint;
    const bool first = p.equilibrium < 1;
    if ((first ? before : after).due())
    {
      std::array<char, 128> text{};
      if (first)
      {
        std::snprintf(text.data(), text.size(), "first equilibrium, %.0f %%", 100 * p.equilibrium);
      }
      else
      {
        std::snprintf(text.data(), text.size(), "%lld bonds broken, peak %.3g Pa%s", static_cast<long long>(p.broken),
          p.peakStress, unwritten ? ", checkpoint not written" : "");
      }
      this->SetProgressText(text.data());
      this->UpdateProgress(p.share);
    }
    return static_cast<bool>(this->CheckAbort());
  };
  options.keep = [&](const pd::FractureState& state)
  {
    const auto image = vtkSmartPointer<vtkImageData>::New();
    image->ShallowCopy(input);
    lamella::setFractureState(image, state, scene, this->GetClassName());
    kept.States.push_back(image);
  };
  if (this->CheckAbort())
  {
    throw lamella::Cancelled();
  }
  const lamella::Communicator comm(team.comm());
  pd::FractureResult result =
    pd::studyFracture(scene.model(), scene.lattice(), scene.phase(), scene.grain(), options, comm);
  this->PeakStress = result.peak.stress;
  if (anew)
  {
    result.warnings.insert(result.warnings.begin(),
      "there was no checkpoint '" + this->ContinueFile + "' yet: the run began with the unbroken sample");
  }

  for (vtkImageData* const image : kept.States)
  {
    lamella::setFractureNumbers(image, result);
    lamella::describeThickness(image, scene, result.thickness);
    const nlohmann::json model = lamella::describeModel(image, scene, settings);
    lamella::setFieldText(image, "load", this->LoadName());
    lamella::setFieldNumber(image, "compression", this->Compression ? 1.0 : 0.0);
    lamella::setFieldText(image, "breaking", lamella::wordOf(options.fracture.breaking));

    lamella::continueProvenance(image, "fracture",
      { { "model", model }, { "load", this->LoadName() }, { "axis", std::string(1, "xyz"[result.axis]) },
        { "compression", this->Compression }, { "lateral_ratio", this->LateralRatio },
        { "smooth_platens", this->SmoothPlatens }, { "rigid_platens", this->RigidPlatens },
        { "platen_layers", this->PlatenLayers }, { "method", lamella::wordOf(result.method) },
        { "breaking", lamella::wordOf(options.fracture.breaking) }, { "rivals", this->Rivals },
        { "stop_share", this->StopShare }, { "maximum_strain", this->MaximumStrain },
        { "strain_step", this->StrainStep }, { "maximum_broken", this->MaximumBroken },
        { "tolerance", this->Tolerance }, { "checkpoint_every", this->CheckpointEvery } });
  }
  vtkImageData* const end = kept.States.back();
  if (team.rank() == 0)
  {
    lamella::setBrokenBonds(kept.Bonds, result, scene, this->GetClassName());
    lamella::setFractureCurve(kept.Curve, result, this->GetClassName());
    for (const std::string& warning : result.warnings)
    {
      vtkWarningMacro(<< warning);
    }
  }
  for (vtkDataObject* const data : { static_cast<vtkDataObject*>(kept.Bonds), static_cast<vtkDataObject*>(kept.Curve) })
  {
    data->GetFieldData()->ShallowCopy(end->GetFieldData());
  }
  lamella::setLatticeNumbers(kept.Bonds, scene.lattice());
}

void vtkBondFracture::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Compression: " << this->Compression << "\n"
     << indent << "LateralRatio: " << this->LateralRatio << "\n"
     << indent << "Method: " << this->Method << "\n"
     << indent << "Breaking: " << this->Breaking << "\n"
     << indent << "Rivals: " << this->Rivals << "\n"
     << indent << "StopShare: " << this->StopShare << "\n"
     << indent << "MaximumStrain: " << this->MaximumStrain << "\n"
     << indent << "StrainStep: " << this->StrainStep << "\n"
     << indent << "MaximumBroken: " << this->MaximumBroken << "\n"
     << indent << "State: " << this->State << " of " << this->GetNumberOfStates() << "\n"
     << indent << "CheckpointFile: " << this->CheckpointFile << "\n"
     << indent << "CheckpointEvery: " << this->CheckpointEvery << "\n"
     << indent << "ContinueFile: " << this->ContinueFile << "\n"
     << indent << "LastCheckpoint: " << this->LastCheckpoint << "\n"
     << indent << "ComputeDisplacement: " << this->ComputeDisplacement << "\n"
     << indent << "PeakStress: " << this->PeakStress << "\n";
}
