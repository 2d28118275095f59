#pragma once

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstddef>

/// Helper of the sources and filters; not installed.
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

} // namespace lamella
