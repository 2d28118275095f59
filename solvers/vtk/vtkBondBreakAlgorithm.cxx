#include "vtkBondBreakAlgorithm.h"

#include "LongRun.h"
#include "vtkPieces.h"

#include "lattice/Error.h"
#include "peridynamics/fracture/FractureCheckpoint.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

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
  std::string Anew; ///< a warning, or empty

  // of the last run
  lamella::KeptStates<vtkImageData> States;
  vtkNew<vtkPolyData> Bonds;
  vtkNew<vtkTable> Curve;
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
  return this->Kept->States.count();
}

vtkImageData* vtkBondBreakAlgorithm::GetStateImage(int state)
{
  return this->Kept->States.at(state);
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

void vtkBondBreakAlgorithm::SetState(int state)
{
  this->Kept->States.choose(state);
}

int vtkBondBreakAlgorithm::GetState()
{
  return this->Kept->States.chosen();
}

vtkMTimeType vtkBondBreakAlgorithm::GetMTime()
{
  return this->Kept->States.changed(this->Superclass::GetMTime());
}

void vtkBondBreakAlgorithm::Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  Internals& kept = *this->Kept;
  kept.States.renew(
    input, this->Superclass::GetMTime(), team, [&] { this->Solve(input, team, kept.Bonds, kept.Curve); },
    [&]
    {
      this->PeakStress = unknown;
      kept.Bonds->Initialize();
      kept.Curve->Initialize();
    });
  kept.States.show(output);
  this->GetBrokenBonds()->ShallowCopy(kept.Bonds);
  this->GetCurve()->ShallowCopy(kept.Curve);
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
    data->GetFieldData()->ShallowCopy(this->Kept->States.all().back()->GetFieldData());
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
  this->LastCheckpoint = 0;
  const lamella::RunStart start =
    lamella::startOf(this->ContinueFile, this->CheckpointFile, "the unbroken sample", input, team, options);
  this->Kept->Anew = start.warning;
  return start.from;
}

std::string vtkBondBreakAlgorithm::BeginsAnew() const
{
  return this->Kept->Anew;
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
     << indent << "KeepStates: " << this->KeepStates << "\n"
     << indent << "StopShare: " << this->StopShare << "\n"
     << indent << "MaximumStrain: " << this->MaximumStrain << "\n"
     << indent << "MaximumBroken: " << this->MaximumBroken << "\n"
     << indent << "State: " << this->GetState() << " of " << this->GetNumberOfStates() << "\n"
     << indent << "CheckpointFile: " << this->CheckpointFile << "\n"
     << indent << "CheckpointEvery: " << this->CheckpointEvery << "\n"
     << indent << "ContinueFile: " << this->ContinueFile << "\n"
     << indent << "LastCheckpoint: " << this->LastCheckpoint << "\n"
     << indent << "ComputeDisplacement: " << this->ComputeDisplacement << "\n"
     << indent << "PeakStress: " << this->PeakStress << "\n";
}
