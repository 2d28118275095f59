#pragma once

#include "outlines/Contour.h"

#include <vector>

namespace lamella::micrograph
{

/// Of one lumen; exact for its polygon. What the picture's border cuts off is not counted, what it adds to the outline
/// is.
struct LumenMeasures
{
  std::int32_t lumen = 0;
  bool open = false;             ///< cut by the border
  double area = 0;               ///< [m²]
  double perimeter = 0;          ///< of the whole outline [m]
  double wallLength = 0;         ///< of the outline without the border [m]
  Point centroid{ 0, 0 };        ///< [m]
  double equivalentDiameter = 0; ///< of the circle of the same area [m]
  double solidity = 0;           ///< area over that of the convex hull, 0 … 1
  double major = 0, minor = 0;   ///< axes (diameters) of the ellipse of the same second moments [m]
  double angle = 0;              ///< of the major axis from x, counter-clockwise, −π/2 … π/2
};

/// Measures of each lumen, in the order of their first chains.
/// @throws InputError as outlines()
[[nodiscard]] std::vector<LumenMeasures> measureLumens(const ContourSet& set);

/// Share of the picture that is no lumen, from the polygons' areas.
/// @throws InputError as outlines()
[[nodiscard]] double wallFraction(const ContourSet& set);

/// Twice the area of the lumens, or of the walls where that is less, over the length of all outlines without the
/// border: the thickness of plates, the radius of disks [m].
/// @throws InputError as outlines()
[[nodiscard]] double leastWidth(const ContourSet& set);

/// The convex hull, counter-clockwise (Andrew's monotone chain). Of fewer than three points: these.
[[nodiscard]] std::vector<Point> convexHull(std::vector<Point> points);

} // namespace lamella::micrograph
