#pragma once

#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

/// Small data whose picture is known beforehand.
namespace samples
{

inline void addStrings(vtkDataObject* data, const char* name, std::initializer_list<const char*> values)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  for (const char* value : values)
    array->InsertNextValue(value);
  data->GetFieldData()->AddArray(array);
}

inline vtkSmartPointer<vtkImageData> lattice(int nx, int ny, int nz, double spacing)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(nx, ny, nz);
  image->SetSpacing(spacing, spacing, spacing);
  image->SetOrigin(spacing / 2, spacing / 2, nz > 1 ? spacing / 2 : 0);
  addStrings(image, "pixel_size_source", { "option" });
  return image;
}

using Value = std::function<double(int i, int j, int k)>;

template <class Array = vtkDoubleArray>
void addField(vtkImageData* image, const char* name, const std::vector<Value>& components)
{
  const int* n = image->GetDimensions();
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(static_cast<int>(components.size()));
  array->SetNumberOfTuples(image->GetNumberOfPoints());
  vtkIdType index = 0;
  for (int k = 0; k < n[2]; ++k)
  {
    for (int j = 0; j < n[1]; ++j)
    {
      for (int i = 0; i < n[0]; ++i, ++index)
        for (std::size_t c = 0; c < components.size(); ++c)
          array->SetComponent(index, static_cast<int>(c), components[c](i, j, k));
    }
  }
  image->GetPointData()->AddArray(array);
}

/// Cells of 20 × 16 pixels in brick-like rows, with walls of 4 pixels and a middle lamella of one.
inline int tissuePhase(int i, int j)
{
  const int row = j / 16;
  const int x = (i + 10 * (row % 2)) % 20;
  const int y = j % 16;
  if (x == 0 || y == 0)
    return 2;
  return x > 4 && x < 17 && y > 3 && y < 14 ? 0 : 1;
}

/// Layers of conductivity 1 and 4 (each 8 pixels) side by side: parallel to the flow, the flux is that of each layer.
inline double layerFlux(int i)
{
  return i / 8 % 2 == 0 ? 1 : 4;
}

/// 120 × 96 pixels of half a micrometre with every field of a result: the temperature falls from the top to the bottom.
inline vtkSmartPointer<vtkImageData> tissue()
{
  auto image = lattice(120, 96, 1, 0.5e-6);
  addStrings(image, "phase_names", { "lumen", "cell wall", "middle lamella" });
  addField<vtkUnsignedCharArray>(
    image, "phase", { [](int i, int j, int) { return static_cast<double>(tissuePhase(i, j)); } });
  addField(image, "temperature",
    { [](int i, int j, int) { return tissuePhase(i, j) == 0 && i < 20 ? std::nan("") : (j + 0.5) / 96; } });
  addField(image, "flux",
    { [](int, int, int) { return 0.0; }, [](int i, int, int) { return -layerFlux(i); },
      [](int, int, int) { return 0.0; } });
  addField(image, "grain", { [](int i, int j, int) { return 1.0 + i / 30 + 4 * (j / 24); } });
  addField(image, "stress", { [](int i, int, int) { return 2e6 * ((i + 0.5) / 120 - 0.5); } });
  return image;
}

/// A box with a hole along x and one along z, 24 × 20 × 16 voxels.
inline vtkSmartPointer<vtkImageData> volume()
{
  auto image = lattice(24, 20, 16, 1e-6);
  addStrings(image, "phase_names", { "pore", "grain" });
  addField<vtkUnsignedCharArray>(image, "phase",
    { [](int i, int j, int k)
      {
        const bool along = j > 6 && j < 13 && k > 5 && k < 11;
        const bool up = i > 5 && i < 12 && j > 6 && j < 13;
        return along || up ? 0.0 : 1.0;
      } });
  addField(image, "concentration", { [](int, int, int k) { return (k + 0.5) / 16; } });
  return image;
}

} // namespace samples
