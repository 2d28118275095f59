#include "vtkOutlineAlgorithm.h"

#include "vtkClassMacros.h"
#include "vtkPieces.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkPrintSettingsMacro(vtkOutlineAlgorithm);

vtkOutlineAlgorithm::vtkOutlineAlgorithm()
{
  this->SetNumberOfInputPorts(2);
}

void vtkOutlineAlgorithm::SetPictureData(vtkImageData* picture)
{
  this->SetInputDataInternal(1, picture);
}

int vtkOutlineAlgorithm::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkPolyData" : "vtkImageData");
  if (port == 1)
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

int vtkOutlineAlgorithm::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  lamella::requestWhole(inputs[0]->GetInformationObject(0));
  vtkInformation* const picture = inputs[1]->GetInformationObject(0);
  if (picture != nullptr && picture->Has(Pipeline::WHOLE_EXTENT()))
    picture->Set(Pipeline::UPDATE_EXTENT(), picture->Get(Pipeline::WHOLE_EXTENT()), 6);
  return 1;
}
