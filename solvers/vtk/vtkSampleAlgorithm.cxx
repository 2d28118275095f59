#include "vtkSampleAlgorithm.h"

#include "Attempt.h"
#include "ThreadCount.h"
#include "vtkPieces.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"

#include <algorithm>

vtkSampleAlgorithm::vtkSampleAlgorithm()
{
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "phase");
}

void vtkSampleAlgorithm::AddVoid(const char* phase)
{
  if (phase != nullptr && *phase != '\0' &&
    std::find(this->Voids.begin(), this->Voids.end(), phase) == this->Voids.end())
  {
    this->Voids.emplace_back(phase);
    this->Modified();
  }
}

void vtkSampleAlgorithm::RemoveAllVoids()
{
  if (!this->Voids.empty())
  {
    this->Voids.clear();
    this->Modified();
  }
}

int vtkSampleAlgorithm::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

int vtkSampleAlgorithm::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  lamella::requestInput(
    inputVector[0]->GetInformationObject(0), lamella::requestedOutput(request, outputVector), this->Controller);
  return 1;
}

int vtkSampleAlgorithm::Attempt(const std::function<void()>& run, vtkInformationVector* outputs)
{
  lamella::Failure failure = lamella::Failure::None;
  const lamella::Outcome outcome = lamella::attempt(this, run, &failure);
  this->Failure = static_cast<int>(failure);
  return lamella::concluded(this, outcome, outputs);
}

int vtkSampleAlgorithm::ThreadCount() const
{
  return lamella::threadCount(this->Threads);
}

void vtkSampleAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Voids:";
  for (const std::string& phase : this->Voids)
  {
    os << " " << phase;
  }
  os << "\n" << indent << "Threads: " << this->Threads << "\n";
}
