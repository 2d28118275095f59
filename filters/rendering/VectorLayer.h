#pragma once

#include "Canvas.h"
#include "PlaneField.h"

#include <string>
#include <vector>

namespace lamella::rendering
{

/// Lines, arrows and other shapes of one colour. Positions are in pixels of the canvas. Shapes that overlap do not
/// darken each other.
class VectorLayer
{
public:
  explicit VectorLayer(Color color)
    : Paint(color)
  {
  }
  void Line(const Polyline& line, double width);
  void Triangle(const Point2& a, const Point2& b, const Point2& c);
  /// An arrow head with its tip at `tip`, pointing along `direction` (any length), `size` pixels long.
  void Head(const Point2& tip, const Point2& direction, double size);

  [[nodiscard]] Color GetColor() const { return this->Paint; }
  [[nodiscard]] const std::vector<Point2>& Corners() const { return this->Points; }

private:
  Color Paint;
  std::vector<Point2> Points; ///< three a triangle
};

/// Draws up to three layers with OpenGL, later ones over earlier ones, with smooth edges. One pass for all, since on a
/// software renderer every pass over a large picture costs half a second.
/// @param inside what may be drawn on
/// @returns false, and why, when nothing can draw
[[nodiscard]] bool DrawLayers(
  const std::vector<VectorLayer>& layers, Canvas& canvas, const PixelRect& inside, std::string& whyNot);

} // namespace lamella::rendering
