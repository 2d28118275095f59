#include "vtkDiffusionAlgorithm.h"

#include "Attempt.h"
#include "ThreadCount.h"
#include "vtkClassMacros.h"
#include "vtkPieces.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"

vtkPrintSettingsMacro(vtkDiffusionAlgorithm);

vtkDiffusionAlgorithm::vtkDiffusionAlgorithm()
{
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
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

const char* vtkDiffusionAlgorithm::QuantityName() const
{
  return this->Quantity == CONCENTRATION ? "concentration" : "temperature";
}

const char* vtkDiffusionAlgorithm::SidesName() const
{
  return this->Sides == PERIODIC ? "periodic" : this->Sides == MIXED ? "mixed" : "insulated";
}

int vtkDiffusionAlgorithm::ThreadCount() const
{
  return lamella::threadCount(this->Threads);
}
