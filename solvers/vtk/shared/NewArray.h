#pragma once

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstddef>
#include <initializer_list>

/// Helpers of the sources and filters; not installed.
namespace lamella
{

/// An array of so many tuples, its values not set.
template <typename Array>
[[nodiscard]] vtkSmartPointer<Array> newArray(const char* name, int components, std::size_t tuples)
{
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(tuples));
  return array;
}

inline void addArrays(vtkFieldData* data, std::initializer_list<vtkDataArray*> arrays)
{
  for (vtkDataArray* const array : arrays)
    data->AddArray(array);
}

/// So many points in double precision, their places not set.
[[nodiscard]] inline vtkSmartPointer<vtkPoints> newPoints(std::size_t count)
{
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(count));
  return points;
}

/// Drops what there is, and takes these points, each with a vertex.
inline void setVertices(vtkPolyData* data, vtkPoints* points)
{
  vtkNew<vtkCellArray> vertices;
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
    vertices->InsertNextCell({ i });
  data->Initialize();
  data->SetPoints(points);
  data->SetVerts(vertices);
}

} // namespace lamella
