#pragma once

#include "vtkDoubleArray.h"
#include "vtkSmartPointer.h"

#include <functional>
#include <vector>

class vtkImageData;

/// Helper of the diffusion solvers; not installed.
namespace lamella
{

/// The fields of a solve that are made a few layers at a time, so that a large volume's are never held.
struct FieldLayers
{
  int axis = 0;
  vtkImageData* image = nullptr; ///< what they belong to, whole: phases, no fields
  /// The arrays of layers `first` to `last` along z, counted from 0: field and flux, as asked for.
  std::function<std::vector<vtkSmartPointer<vtkDoubleArray>>(int first, int last)> read;
};

/// Called on the first rank after each solve, while the others make their part of what it reads.
using FieldSink = std::function<void(const FieldLayers& fields)>;

} // namespace lamella
