#pragma once

#include "lattice/Phases.h"

#include <string>
#include <vector>

#include "vtkLamellaSolversVTKModule.h" // for the export macro

class vtkImageData;

/// Helper of vtkMicrographContours and the program; not installed.
namespace lamella
{

/// A picture of numbers as extractContours() takes it.
struct ContourField
{
  PhaseImage image;         ///< phases "lumen" and "wall"
  std::vector<float> level; ///< #nodes, above 0 in lumens
  std::string array;        ///< its name
};

/// @param array its name, `lumen_share` if empty: at points, one component, finite; unsigned whole numbers of 8 or 16
///   bits count as parts of the largest one
/// @param shares values are lumen's (or, `below`, the wall's) shares of the pixels, from 0 to 1; else lumens are where
///   they are above (below) the level
/// @throws InputError, ParameterError
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT ContourField contourField(
  vtkImageData* image, const std::string& array, bool shares, double level, bool below);

} // namespace lamella
