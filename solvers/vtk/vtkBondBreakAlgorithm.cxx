#include "vtkBondBreakAlgorithm.h"

#include "LongRun.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"

#include "io/RunCheckpoint.h"
#include "lattice/Error.h"
#include "peridynamics/fracture/FractureCheckpoint.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"

#include <algorithm>
#include <array>
#include <limits>

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

template <class Number, class Limit>
void setLimit(const char* name, Number value, Limit& limit)
{
  if (value < 0 || value != value)
  {
    throw lamella::ParameterError(
      std::string(name) + " is " + std::to_string(value), "give a number above 0, or 0 for no limit");
  }
  if (value > 0)
  {
    limit = static_cast<Limit>(value);
  }
}

} // namespace

struct vtkBondBreakAlgorithm::Internals
{
  std::vector<std::int64_t> Broken;
  lamella::Pace Told;
  bool Anew = false;

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

vtkBondBreakAlgorithm::vtkBondBreakAlgorithm()
  : PeakStress(unknown)
  , Kept(std::make_unique<Internals>())
{
  this->SetNumberOfOutputPorts(3);
}

vtkBondBreakAlgorithm::~vtkBondBreakAlgorithm() = default;

int vtkBondBreakAlgorithm::FillOutputPortInformation(int port, vtkInformation* info)
{
  constexpr std::array<const char*, 3> types{ "vtkImageData", "vtkPolyData", "vtkTable" };
  info->Set(vtkDataObject::DATA_TYPE_NAME(), types.at(static_cast<std::size_t>(port)));
  return 1;
}

vtkPolyData* vtkBondBreakAlgorithm::GetBrokenBonds()
{
  return vtkPolyData::SafeDownCast(this->GetOutputDataObject(1));
}

vtkTable* vtkBondBreakAlgorithm::GetCurve()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(2));
}

int vtkBondBreakAlgorithm::GetNumberOfStates()
{
  return static_cast<int>(this->Kept->States.size());
}

vtkImageData* vtkBondBreakAlgorithm::GetStateImage(int state)
{
  return state >= 0 && state < this->GetNumberOfStates() ? this->Kept->States[static_cast<std::size_t>(state)]
                                                         : nullptr;
}

void vtkBondBreakAlgorithm::AddStateAtBroken(vtkIdType broken)
{
  this->Kept->Broken.push_back(broken);
  this->Modified();
}

void vtkBondBreakAlgorithm::RemoveAllStatesAtBroken()
{
  if (!this->Kept->Broken.empty())
  {
    this->Kept->Broken.clear();
    this->Modified();
  }
}

std::vector<std::int64_t> vtkBondBreakAlgorithm::StatesAtBroken() const
{
  return this->Kept->Broken;
}

void vtkBondBreakAlgorithm::SetCheckpointFile(const std::string& path)
{
  if (this->CheckpointFile != path)
  {
    this->CheckpointFile = path;
    this->Modified();
  }
}

void vtkBondBreakAlgorithm::SetContinueFile(const std::string& path)
{
  if (this->ContinueFile != path)
  {
    this->ContinueFile = path;
    this->Modified();
  }
}

void vtkBondBreakAlgorithm::SetState(int state)
{
  const int clamped = std::max(state, -1);
  if (this->State != clamped)
  {
    this->State = clamped;
    this->StateTime.Modified(); // not Modified(): that would run all again
  }
}

vtkMTimeType vtkBondBreakAlgorithm::GetMTime()
{
  return std::max(this->Superclass::GetMTime(), this->StateTime.GetMTime());
}

void vtkBondBreakAlgorithm::Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
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
      this->Solve(input, team, kept.Bonds, kept.Curve);
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

vtkImageData* vtkBondBreakAlgorithm::NewState(vtkImageData* input)
{
  const auto image = vtkSmartPointer<vtkImageData>::New();
  image->ShallowCopy(input);
  this->Kept->States.push_back(image);
  return image;
}

std::vector<vtkImageData*> vtkBondBreakAlgorithm::KeptStates() const
{
  return { this->Kept->States.begin(), this->Kept->States.end() };
}

void vtkBondBreakAlgorithm::Finish(
  vtkPolyData* broken, vtkTable* curve, const std::vector<std::string>& warnings, const lamella::Team& team)
{
  if (team.rank() == 0)
  {
    for (const std::string& warning : warnings)
    {
      vtkWarningMacro(<< warning);
    }
  }
  for (vtkDataObject* const data : { static_cast<vtkDataObject*>(broken), static_cast<vtkDataObject*>(curve) })
  {
    data->GetFieldData()->ShallowCopy(this->Kept->States.back()->GetFieldData());
  }
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
  options.path = this->CheckpointFile;
  options.provenance = lamella::fieldText(input, "provenance").value_or("");
  this->LastCheckpoint = 0;
  this->Kept->Anew = lamella::beginsAnew(this->ContinueFile, this->CheckpointFile, team);
  return this->Kept->Anew ? std::string() : this->ContinueFile;
}

std::string vtkBondBreakAlgorithm::BeginsAnew() const
{
  return this->Kept->Anew ? lamella::anewWarning(this->ContinueFile, "the unbroken sample") : std::string();
}

void vtkBondBreakAlgorithm::TellNext()
{
  this->Kept->Told.next();
}

bool vtkBondBreakAlgorithm::Due()
{
  return this->Kept->Told.due();
}

void vtkBondBreakAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Compression: " << this->Compression << "\n"
     << indent << "StopShare: " << this->StopShare << "\n"
     << indent << "MaximumStrain: " << this->MaximumStrain << "\n"
     << indent << "MaximumBroken: " << this->MaximumBroken << "\n"
     << indent << "State: " << this->State << " of " << this->GetNumberOfStates() << "\n"
     << indent << "CheckpointFile: " << this->CheckpointFile << "\n"
     << indent << "CheckpointEvery: " << this->CheckpointEvery << "\n"
     << indent << "ContinueFile: " << this->ContinueFile << "\n"
     << indent << "LastCheckpoint: " << this->LastCheckpoint << "\n"
     << indent << "ComputeDisplacement: " << this->ComputeDisplacement << "\n"
     << indent << "PeakStress: " << this->PeakStress << "\n";
}
