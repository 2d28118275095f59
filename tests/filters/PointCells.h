#pragma once

#include "VtkTesting.h"

#include "vtkFloatArray.h"
#include "vtkPointCompression.h"

#include <string>
#include <vector>

/// Small tissues that are pressed, and how.
namespace lamella::vtktest
{

constexpr double pointSpacing = 1e-6;

/// Of lumen (0) and wall.
inline vtkSmartPointer<vtkImageData> wallsOf(int nx, int ny, int nz, const std::function<int(int, int, int)>& rule)
{
  const auto image = picture(nx, ny, nz, rule, pointSpacing);
  setFieldTexts(image, "phase_names", std::vector<std::string>{ "lumen", "wall" });
  return image;
}

/// Walls round a lumen, each three nodes thick, of a picture or a volume.
inline vtkSmartPointer<vtkImageData> cellOf(int nz = 1)
{
  return wallsOf(
    12, 14, nz,
    [](int x, int y, int z) { return x > 2 && x < 9 && y > 2 && y < 11 && (z == 0 || (z > 2 && z < 5)) ? 0 : 1; });
}

/// A picture of walls two nodes thick around lumens of 5 × 4.
inline vtkSmartPointer<vtkImageData> tissueOf(int nx, int ny)
{
  return wallsOf(
    nx, ny, 1, [](int x, int y, int) { return x % 7 < 2 || y % 6 < 2 ? 1 : 0; });
}

/// Directions along x + y.
inline void addAxis(vtkImageData* image)
{
  vtkNew<vtkFloatArray> axis;
  axis->SetName("axis");
  axis->SetNumberOfComponents(3);
  axis->SetNumberOfTuples(image->GetNumberOfPoints());
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    axis->SetTuple3(i, 1, 1, 0);
  image->GetPointData()->AddArray(axis);
}

/// Short: to 4 %, of few rows, not so calm.
inline void quick(vtkPointCompression* filter)
{
  filter->SetStrain(0.04);
  filter->SetRows(8);
  filter->SetFirstSpeed(0.01);
}

} // namespace lamella::vtktest
