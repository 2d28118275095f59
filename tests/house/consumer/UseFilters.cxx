// Another project's use of Lamella::Filters: the layers of UseSolvers.cpp through VTK's pipeline, and where the flux
// goes.
#include <vtkFluxMap.h>
#include <vtkSteadyDiffusion.h>

#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include <cmath>
#include <cstdio>

int main()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(32, 32, 1);
  image->SetSpacing(1e-6, 1e-6, 1e-6);
  vtkNew<vtkUnsignedCharArray> phase;
  phase->SetName("phase");
  phase->SetNumberOfTuples(image->GetNumberOfPoints());
  for (vtkIdType i = 0; i < phase->GetNumberOfTuples(); ++i)
    phase->SetValue(i, static_cast<unsigned char>(i % 32 / 8 % 2));
  image->GetPointData()->SetScalars(phase);

  vtkNew<vtkSteadyDiffusion> diffusion;
  diffusion->SetInputData(image);
  diffusion->SetConductivity("0", 1.0);
  diffusion->SetConductivity("1", 3.0);
  diffusion->SetDirection(vtkSteadyDiffusion::Y);
  vtkNew<vtkFluxMap> map;
  map->SetInputConnection(diffusion->GetOutputPort());
  map->SetNumberOfStreamlines(10);
  map->Update();

  // Along the layers: the mean of the two conductivities; straight lines, as many as were asked for.
  vtkDataArray* effective = map->GetOutput()->GetFieldData()->GetArray("effective_conductivity");
  const double along = effective != nullptr ? effective->GetTuple1(4) : std::nan("");
  const auto lines = map->GetStreamlines()->GetNumberOfLines();
  std::printf("along the layers %.6f, %d streamlines\n", along, static_cast<int>(lines));
  return std::abs(along - 2.0) < 1e-6 && lines == 10 ? 0 : 1;
}
