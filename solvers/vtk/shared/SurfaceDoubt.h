#pragma once

#include "vtkLatticeConversion.h"

#include "segmentation/SegmentTypes.h"

#include <limits>
#include <vector>

/// Not installed.
namespace lamella
{

/// How far surfaces between phases may lie from where an image has them [pixels]: what its segmentation told of itself;
/// where greys were parted otherwise, that of edges whose blur is not known. 0: it says nothing of greys.
[[nodiscard]] inline double surfaceDoubtOf(vtkDataObject* image)
{
  if (const std::vector<double> told = fieldNumbers(image, "surface_doubt"); told.size() == 1)
    return told.front();
  return fieldText(image, "segmentation") ? micrograph::surfaceDoubt(0, std::numeric_limits<double>::infinity()) : 0;
}

} // namespace lamella
