#pragma once

#include "convert/Formats.h"

#include <string>
#include <vector>

class vtkPolyData;

/// Closed surfaces of phases, and the files of other programs that hold such surfaces.
namespace lamella::cli
{

/// The surface of phases of a volume, their union: triangles whose normals point out, two at every edge. It passes
/// half-way between nodes of these phases and others, and half a spacing outside of the volume's border nodes; edges
/// and corners of voxels are cut off by that.
/// @param volume of one array @param phases names, or the array's values where its phases have none
/// @param smoothing iterations of a windowed sinc filter; 0: none
/// @throws ParameterError for other phases; InputError for a picture, or where none of its nodes are of these phases;
///         MemoryError; Cancelled
[[nodiscard]] vtkSmartPointer<vtkPolyData> surfaceOf(
  Session& session, Volume& volume, const std::vector<std::string>& phases, int smoothing);

/// Only polygons, and no arrays: would STL and PLY keep all that these are?
[[nodiscard]] bool onlySurface(vtkPointSet* points);

/// Triangles as binary STL or PLY, told by the ending. @throws OutputError; InputError where there are none
void writeSurface(vtkPointSet* points, const OutputFile& file);

} // namespace lamella::cli
