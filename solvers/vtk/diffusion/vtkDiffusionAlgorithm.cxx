#include "vtkDiffusionAlgorithm.h"

#include "Attempt.h"
#include "ThreadCount.h"
#include "vtkPieces.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"

#include <limits>

vtkCxxSetObjectMacro(vtkDiffusionAlgorithm, Controller, vtkMultiProcessController);

vtkDiffusionAlgorithm::vtkDiffusionAlgorithm()
{
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
  this->vtkDiffusionAlgorithm::SetController(vtkMultiProcessController::GetGlobalController());
}

vtkDiffusionAlgorithm::~vtkDiffusionAlgorithm()
{
  this->vtkDiffusionAlgorithm::SetController(nullptr);
}

int vtkDiffusionAlgorithm::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

int vtkDiffusionAlgorithm::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  lamella::requestInput(
    inputVector[0]->GetInformationObject(0), outputVector->GetInformationObject(0), this->Controller);
  return 1;
}

int vtkDiffusionAlgorithm::Attempt(const std::function<void()>& run, vtkInformationVector* outputs)
{
  lamella::Failure failure = lamella::Failure::None;
  const lamella::Outcome outcome = lamella::attempt(this, run, &failure);
  this->Failure = static_cast<int>(failure);
  return lamella::concluded(this, outcome, outputs);
}

void vtkDiffusionAlgorithm::SetPhaseValue(PhaseValues& table, const char* phase, double value)
{
  if (phase == nullptr || *phase == '\0')
    return;
  const auto [entry, added] = table.try_emplace(phase, value);
  if (added || entry->second != value)
  {
    entry->second = value;
    this->Modified();
  }
}

void vtkDiffusionAlgorithm::RemovePhaseValue(PhaseValues& table, const char* phase)
{
  if (phase != nullptr && table.erase(phase) > 0)
    this->Modified();
}

void vtkDiffusionAlgorithm::RemoveAllPhaseValues(PhaseValues& table)
{
  if (!table.empty())
  {
    table.clear();
    this->Modified();
  }
}

double vtkDiffusionAlgorithm::PhaseValue(const PhaseValues& table, const char* phase)
{
  const auto entry = table.find(phase != nullptr ? phase : "");
  return entry != table.end() ? entry->second : std::numeric_limits<double>::quiet_NaN();
}

void vtkDiffusionAlgorithm::PrintPhaseValues(ostream& os, vtkIndent indent, const char* what, const PhaseValues& table)
{
  for (const auto& [phase, value] : table)
    os << indent << what << " " << phase << ": " << value << "\n";
}

const char* vtkDiffusionAlgorithm::QuantityName() const
{
  return this->Quantity == CONCENTRATION ? "concentration" : "temperature";
}

const char* vtkDiffusionAlgorithm::SidesName() const
{
  return this->Sides == PERIODIC ? "periodic" : "insulated";
}

int vtkDiffusionAlgorithm::ThreadCount() const
{
  return lamella::threadCount(this->Threads);
}
