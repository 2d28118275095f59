#pragma once

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "lattice/Lattice.h"

#include "vtkSmartPointer.h"

#include <optional>
#include <string>

class vtkPolyData;
class vtkXMLImageDataReader;
class vtkXMLPolyDataReader;
class vtkXMLUnstructuredGridReader;

/// VTK's readers of .vti, .vtp and .vtu files, for files with "appended" data too, and for damaged ones: nothing of a
/// file reaches VTK before all of it was looked at (GridParser.h). Where something is wrong the reader has no output;
/// requireReadable() says why (GridChecks.h).
///
/// Expat 2.6, and Debian 12's 2.5.0-1+deb12u2, which has the same remedy for CVE-2023-52425, put off parsing until much
/// text has come in. VTK 9.2 does not expect that: it reads on into appended data, takes them for XML and fails.
/// These readers ask Expat not to wait; the text is the user's own file and read once, which is what the remedy is not
/// for. ParaView's own readers fail all the same, so files of ours are written with their data inline
/// (vtkXMLWriter::SetDataModeToBinary).
namespace lamella
{

[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkXMLImageDataReader> newImageReader();
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkXMLPolyDataReader> newPolyDataReader();
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkXMLUnstructuredGridReader> newUnstructuredGridReader();

/// The ending of a reader's file in small letters, with its dot. @throws InputError where no file is named
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::string endingOf(const char* fileName);

/// Reads a whole .vtp into `data`, its cells checked; every fault is told in our words.
/// @throws InputError, MemoryError (GridChecks.h)
VTKLAMELLASOLVERSVTK_EXPORT void readPolyData(const std::string& path, vtkPolyData* data);

/// The lattice of a file with values at points only, from its header; nothing for other files, and where the header
/// makes none.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::optional<Lattice> latticeInFile(vtkXMLImageDataReader* reader);

} // namespace lamella
