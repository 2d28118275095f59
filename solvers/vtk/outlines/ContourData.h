#pragma once

#include "outlines/Contour.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include "vtkSmartPointer.h"

#include <array>
#include <string>

class vtkPolyData;

/// Between outlines of lumens and VTK's poly-lines.
///
/// A chain is one poly-line with the lumen on its left; a closed one ends with the id of its first point. Cells carry
/// `lumen` (number from 1; chains of one lumen share it), `closed`, and of the whole lumen `area` [m²], `solidity` and
/// `equivalent_diameter` [m]. Field data: `size` (2) of the picture, `corner` (3) where its lower left corner lies, and
/// `wall_fraction`. docs/data-model.md says what each means.
namespace lamella
{

/// @param creator class that made them, for the arrays' descriptions
/// @param corner  position of the picture's lower left corner [m]; the contours' own (0, 0)
/// @throws InputError as micrograph::measureLumens()
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT vtkSmartPointer<vtkPolyData> toPolyData(
  const micrograph::ContourSet& contours, const std::string& creator, const std::array<double, 3>& corner = {});

/// The outlines of poly data: poly-lines, and polygons as closed chains. Poly-lines that end where they begin are
/// closed, whether by a point's id or by its coordinates. Clockwise closed chains are turned. Without `lumen` each
/// chain is a lumen; without `size` the picture is the box around all points.
/// @throws InputError: no lines, cells of another kind, points that do not lie in one plane of z, arrays of the wrong
///   kind, and whatever is wrong with the chains (micrograph::requireValid())
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT micrograph::ContourSet contoursFrom(vtkPolyData* outlines);

/// Position of the picture's lower left corner [m], the (0, 0) of contoursFrom(): the field data `corner`; else the
/// origin where there is a `size`, and the least coordinates of all points where there is none.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::array<double, 3> cornerOf(vtkPolyData* outlines);

} // namespace lamella
