#pragma once

#include "vtkSmartPointer.h"

#include <array>

class vtkImageData;

/// Images whose pixels are split; not installed.
namespace lamella
{

/// The same image, or piece of one, with every pixel split into n × n (× n in three dimensions): the new points carry
/// what theirs did.
[[nodiscard]] vtkSmartPointer<vtkImageData> refinedImage(vtkImageData* image, int dimension, int n);

/// Extent, spacing and origin of that, in place.
void refineGeometry(
  std::array<int, 6>& extent, std::array<double, 3>& spacing, std::array<double, 3>& origin, int dimension, int n);

} // namespace lamella
