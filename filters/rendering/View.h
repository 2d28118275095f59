#pragma once

#include "Furniture.h"
#include "SnapshotOptions.h"

#include <array>

class vtkRenderer;

namespace lamella::rendering
{

using Point3 = std::array<double, 3>;

/// A parallel view of a box in space.
class View
{
public:
  /// @param bounds xmin, xmax, ymin, ymax, zmin, zmax
  View(const std::array<double, 6>& bounds, double azimuth, double elevation);

  [[nodiscard]] const Point3& Towards() const { return this->Back; }               ///< from the data to the viewer
  [[nodiscard]] double Width() const { return this->Extent[1] - this->Extent[0]; } ///< of the box as it is seen
  [[nodiscard]] double Height() const { return this->Extent[3] - this->Extent[2]; }

  /// Points the camera so that the box fills a picture of its aspect.
  void Aim(vtkRenderer* renderer) const;

  /// Where a point is seen, in pixels, when the box as seen fills `rect`.
  [[nodiscard]] PixelPoint Project(const Point3& point, const PixelRect& rect) const;

  /// Draws a scale bar along one of the box's two lowest edges (the one seen in more of its length), just outside the
  /// box.
  void DrawScaleBar(Canvas& canvas, const Layout& layout, const Scale& scale, Color ink) const;

private:
  [[nodiscard]] std::array<double, 2> OnScreen(const Point3& point) const;

  std::array<double, 6> Bounds;
  Point3 Right{};
  Point3 Up{};
  Point3 Back{};
  std::array<double, 4> Extent{}; ///< of the box as it is seen: right and up, least and most
};

} // namespace lamella::rendering
