#include "files/StateFiles.h"

#include "files/GridFile.h"

#include "Attempt.h"
#include "FieldNumbers.h"
#include "core/Error.h"
#include "vtkLatticeConversion.h"

#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkPolyData.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace lamella::cli
{

using Pipeline = vtkStreamingDemandDrivenPipeline;

vtkStandardNewMacro(StateFiles);

StateFiles::StateFiles()
{
  this->SetNumberOfInputPorts(0);
}

void StateFiles::SetFiles(std::vector<std::string> names, std::vector<double> strains)
{
  this->Names = std::move(names);
  this->Strains = std::move(strains);
  this->Modified();
}

int StateFiles::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  std::vector<double> steps(this->Names.size());
  std::iota(steps.begin(), steps.end(), 0.0);
  const std::array<double, 2> range{ steps.front(), steps.back() };
  vtkInformation* const output = outputVector->GetInformationObject(0);
  output->Set(Pipeline::TIME_STEPS(), steps.data(), static_cast<int>(steps.size()));
  output->Set(Pipeline::TIME_RANGE(), range.data(), 2);
  return 1;
}

int StateFiles::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkInformation* const wanted = outputVector->GetInformationObject(0);
  const double time = wanted->Has(Pipeline::UPDATE_TIME_STEP()) ? wanted->Get(Pipeline::UPDATE_TIME_STEP()) : 0;
  const auto step = static_cast<std::size_t>(std::clamp(time, 0.0, static_cast<double>(this->Names.size()) - 1) + 0.5);
  vtkPolyData* const output = vtkPolyData::GetData(outputVector);
  const Outcome outcome = attempt(this,
    [&]
    {
      const std::string& name = this->Names[step];
      output->ShallowCopy(readAs<vtkPolyData>(name, "material points", "give the points of a state (.vtp)"));
      if (!this->Strains.empty())
        setFieldNumber(output, "strain", this->Strains[step]);
      else if (fieldNumbers(output, "strain").empty())
        throw InputError("'" + name + "' does not tell its strain", "give the strains of all states with --strains");
      output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    });
  return outcome == Outcome::Done ? 1 : 0;
}

} // namespace lamella::cli
