#pragma once

#include "convert/VtkFiles.h"
#include "session/OutputFile.h"

#include <span>
#include <string>

/// Points, and the nodes of images, as comma-separated values: x, y, z and the arrays, a line each.
namespace lamella::cli
{

/// Reads columns x, y (and z), or Points:0, Points:1, Points:2 as ParaView writes them; columns NAME:0, NAME:1 … make
/// one array. Commas, semicolons, tabs or blanks separate. Becomes points with a vertex each, or the image that the
/// notes beside the table say it was.
/// @param arrays only these are read; empty: all
/// @throws InputError
[[nodiscard]] Step openTable(const std::string& path, std::span<const std::string> arrays);

/// The image whose nodes these points are: they fill a grid of even spacing along x, y and z, in any order.
/// @throws InputError: says what is missing
[[nodiscard]] vtkSmartPointer<vtkImageData> gridOf(vtkPointSet* points);

/// Would a table keep all that these are? No, where there are cells other than a vertex for each point in their order,
/// or arrays in cells.
[[nodiscard]] bool onlyPoints(vtkPointSet* points);

/// Numbers with all the digits that they need. @throws OutputError; Cancelled; InputError for whole numbers above 2^53
void writeTable(Session& session, Volume& volume, const OutputFile& file);
void writeTable(Session& session, vtkPointSet* points, const OutputFile& file);

} // namespace lamella::cli
