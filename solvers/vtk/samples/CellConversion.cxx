#include "CellConversion.h"

#include "core/Error.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#if __has_include("vtkCellTypeUtilities.h")
#include "vtkCellTypeUtilities.h"
#else
#include "vtkCellTypes.h"
#endif
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace lamella
{
namespace
{

#if __has_include("vtkCellTypeUtilities.h") // VTK 9.6 has their names there
using CellTypes = vtkCellTypeUtilities;
#else
using CellTypes = vtkCellTypes;
#endif

enum Kind
{
  Vertices,
  Lines,
  Polygons,
  Strips
};

/// The type of a cell of so many points in one of poly data's four lists.
int typeOf(int kind, vtkIdType points)
{
  switch (kind)
  {
    case Vertices:
      return points == 1 ? VTK_VERTEX : VTK_POLY_VERTEX;
    case Lines:
      return points == 2 ? VTK_LINE : VTK_POLY_LINE;
    case Polygons:
      return points == 3 ? VTK_TRIANGLE : points == 4 ? VTK_QUAD : VTK_POLYGON;
    default:
      return VTK_TRIANGLE_STRIP;
  }
}

std::optional<Kind> kindOf(int type)
{
  switch (type)
  {
    case VTK_VERTEX:
    case VTK_POLY_VERTEX:
      return Vertices;
    case VTK_LINE:
    case VTK_POLY_LINE:
      return Lines;
    case VTK_TRIANGLE:
    case VTK_QUAD:
    case VTK_PIXEL:
    case VTK_POLYGON:
      return Polygons;
    case VTK_TRIANGLE_STRIP:
      return Strips;
    default:
      return std::nullopt;
  }
}

void requireFlatCells(vtkUnstructuredGrid* grid)
{
  vtkIdType others = 0;
  int type = 0;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    if (!kindOf(grid->GetCellType(cell)))
    {
      type = grid->GetCellType(cell);
      ++others;
    }
  }
  if (others > 0)
  {
    throw InputError(fmt::format("{} of {} cells are no vertices, lines or polygons ({})", others,
                       grid->GetNumberOfCells(), CellTypes::GetClassNameFromTypeId(type)),
      "keep them in an unstructured grid (.vtu, .hdf)");
  }
}

} // namespace

vtkSmartPointer<vtkUnstructuredGrid> toUnstructuredGrid(vtkPolyData* poly)
{
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> types;
  const std::array<vtkCellArray*, 4> lists{ poly->GetVerts(), poly->GetLines(), poly->GetPolys(), poly->GetStrips() };
  for (int kind = 0; kind < 4; ++kind)
  {
    vtkCellArray* const list = lists[static_cast<std::size_t>(kind)];
    for (vtkIdType cell = 0; cell < list->GetNumberOfCells(); ++cell)
      types->InsertNextValue(static_cast<unsigned char>(typeOf(kind, list->GetCellSize(cell))));
    cells->Append(list);
  }
  if (poly->GetPoints() != nullptr)
    grid->SetPoints(poly->GetPoints());
  grid->SetCells(types, cells);
  grid->GetPointData()->ShallowCopy(poly->GetPointData());
  grid->GetCellData()->ShallowCopy(poly->GetCellData());
  grid->GetFieldData()->ShallowCopy(poly->GetFieldData());
  return grid;
}

vtkSmartPointer<vtkPolyData> toPolyData(vtkUnstructuredGrid* grid)
{
  requireFlatCells(grid);
  auto poly = vtkSmartPointer<vtkPolyData>::New();
  std::array<vtkNew<vtkCellArray>, 4> lists;
  vtkNew<vtkIdList> points;
  vtkNew<vtkIdList> order;
  for (std::size_t kind = 0; kind < lists.size(); ++kind)
  {
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
    {
      if (static_cast<std::size_t>(*kindOf(grid->GetCellType(cell))) != kind)
        continue;
      grid->GetCellPoints(cell, points);
      if (grid->GetCellType(cell) == VTK_PIXEL) // its rows run the same way, a polygon runs round
        std::swap(*points->GetPointer(2), *points->GetPointer(3));
      lists[kind]->InsertNextCell(points);
      order->InsertNextId(cell);
    }
  }
  if (grid->GetPoints() != nullptr)
    poly->SetPoints(grid->GetPoints());
  poly->SetVerts(lists[Vertices]);
  poly->SetLines(lists[Lines]);
  poly->SetPolys(lists[Polygons]);
  poly->SetStrips(lists[Strips]);
  poly->GetPointData()->ShallowCopy(grid->GetPointData());
  if (std::is_sorted(order->begin(), order->end()))
  {
    poly->GetCellData()->ShallowCopy(grid->GetCellData());
  }
  else
  {
    poly->GetCellData()->CopyAllOn();
    poly->GetCellData()->CopyAllocate(grid->GetCellData(), grid->GetNumberOfCells());
    for (vtkIdType cell = 0; cell < order->GetNumberOfIds(); ++cell)
      poly->GetCellData()->CopyData(grid->GetCellData(), order->GetId(cell), cell);
  }
  poly->GetFieldData()->ShallowCopy(grid->GetFieldData());
  return poly;
}

} // namespace lamella
