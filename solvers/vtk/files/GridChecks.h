#pragma once

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <array>
#include <optional>
#include <string>

class vtkPointSet;
class vtkXMLReader;

/// Every .vti, .vtp and .vtu that is read goes through these two. What VTK does with a file that is damaged: see
/// XmlArrays.h.
namespace lamella
{

/// Reads what the file says of itself, and refuses one in which something is wrong: sizes that its bytes cannot hold,
/// an image without points, a spacing or an origin that is no length, arrays that have not what they are said to have
/// (XmlChecks.h).
/// @param reader of GridReaders.h; knows its file's name
/// @throws InputError, MemoryError
VTKLAMELLASOLVERSVTK_EXPORT void requireReadable(vtkXMLReader* reader, const std::string& path);

/// Reads all of it, or of an image this extent, after requireReadable(). Refuses what could not be read whole, and what
/// requireSound() refuses. Nothing is printed. @throws InputError
VTKLAMELLASOLVERSVTK_EXPORT void update(
  vtkXMLReader* reader, const std::string& path, const std::optional<std::array<int, 6>>& extent = {});

/// Refuses cells of points that are not there or of other numbers of points than their type has, and points that are
/// nowhere. @throws InputError
VTKLAMELLASOLVERSVTK_EXPORT void requireSound(vtkPointSet* data, const std::string& path);

} // namespace lamella
