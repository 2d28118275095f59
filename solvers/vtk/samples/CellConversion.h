#pragma once

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "vtkSmartPointer.h"

class vtkPolyData;
class vtkUnstructuredGrid;

/// Between VTK's two grids of cells. Points, point data and field data are shared, not copied.
namespace lamella
{

/// Vertices, lines, polygons and strips, in this order, as their cell data are.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkUnstructuredGrid> toUnstructuredGrid(vtkPolyData* poly);

/// The way back. Cells are put in poly data's order (vertices, lines, polygons, strips), and their data with them.
/// @throws InputError for cells that are no such (solids, curved cells): says how many and of which type
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkPolyData> toPolyData(vtkUnstructuredGrid* grid);

} // namespace lamella
