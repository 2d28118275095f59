#pragma once

#include "vtkLatticeConversion.h"

#include "core/Communicator.h"
#include "core/Error.h"
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

/// The same of the whole image, or what is given instead, above 0. Collective. @throws ParameterError where nothing
/// tells it
[[nodiscard]] inline double surfaceDoubt(vtkDataObject* image, double given, const Communicator& ranks)
{
  const double known = ranks.max(surfaceDoubtOf(image));
  const double doubt = given > 0 ? given : known;
  if (!(doubt > 0))
    throw ParameterError("nothing tells how far surfaces may lie from where the picture has them",
      "give the doubt in pixels, or read the grey picture and let it be segmented");
  return doubt;
}

} // namespace lamella
