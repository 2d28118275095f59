#pragma once

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <string>

class vtkPolyData;
class vtkUnstructuredGrid;
class vtkXMLReader;

/// What VTK's readers take on trust. They take memory for as many points as a file says it has, and end the program
/// where there is not so much; and they hand on cells of points that are not there, which whoever draws them does not
/// survive.
namespace lamella
{

/// Reads what the file says of itself, and refuses sizes that its bytes cannot hold, an image without points, and a
/// spacing or an origin that is no length. Cheap: no values are read. A file that cannot be understood at all is left
/// to the reader, whose Update() fails.
/// @param reader knows its file's name
/// @throws InputError, MemoryError
VTKLAMELLASOLVERSVTK_EXPORT void requireReadable(vtkXMLReader* reader, const std::string& path);

/// Refuses cells of points that are not there. @throws InputError
VTKLAMELLASOLVERSVTK_EXPORT void requireSoundCells(vtkPolyData* data, const std::string& path);
VTKLAMELLASOLVERSVTK_EXPORT void requireSoundCells(vtkUnstructuredGrid* data, const std::string& path);

} // namespace lamella
