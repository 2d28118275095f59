#pragma once

#include "convert/Volume.h"
#include "session/OutputFile.h"

#include <vtkPointSet.h>
#include <vtkTable.h>

#include <memory>
#include <string>

/// VTK's own files: .vti slab by slab, VTKHDF, and grids of points and cells.
namespace lamella::cli
{

/// A step of a file: one of these.
struct Step
{
  std::unique_ptr<Volume> volume{};
  vtkSmartPointer<vtkPointSet> points{}; ///< poly data or an unstructured grid
  vtkSmartPointer<vtkTable> table{};     ///< numbers without a place, of a checkpoint
  int noted = 0; ///< type of the volume's values before they were put into 8 or 16 bits; 0: as they are
};

/// @throws InputError for a file that is not whole, MemoryError
[[nodiscard]] Step openXml(const std::string& path);

/// VTKHDF 1.0, with units, descriptions and creators where vtkVTKHDFWriter wrote them.
/// @throws InputError: no HDF5, no VTKHDF, a newer version, another type of data
[[nodiscard]] Step openHdf(const std::string& path);

/// Writes a .vti, in pieces of one slab each where it is larger than that. @throws OutputError; Cancelled
void writeXmlImage(Session& session, Volume& volume, const OutputFile& file);
/// @throws OutputError; InputError for what the format has no place for; Cancelled
void writeHdf(Session& session, Volume& volume, const OutputFile& file);
void writeHdf(Session& session, vtkPointSet* points, const OutputFile& file);

} // namespace lamella::cli
