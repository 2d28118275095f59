#pragma once

#include "Canvas.h"
#include "Furniture.h"
#include "SnapshotOptions.h"

#include "vtkSmartPointer.h"

#include <array>
#include <optional>

class vtkActor;
class vtkImageData;
class vtkPolyData;

namespace lamella::rendering
{

struct Quantity;

/// A finished picture.
struct Drawing
{
  Canvas canvas;
  PixelRect data;                ///< where the data are
  std::array<double, 2> range{}; ///< values at the ends of the colour map
};

/// A picture of pixels: a vtkImageData one of whose dimensions is 1.
/// @throws InputError
[[nodiscard]] Drawing DrawPicture(vtkImageData* image, const SnapshotOptions& options);

/// A volume, in isometric view.
/// @throws InputError
[[nodiscard]] Drawing DrawVolume(vtkImageData* image, const SnapshotOptions& options);

/// Lines, points and surfaces; seen from above when they lie in a plane z = constant.
/// @throws InputError
[[nodiscard]] Drawing DrawGeometry(vtkPolyData* geometry, const SnapshotOptions& options);

/// Lines, points and surfaces to be lit and drawn in the colours of a field, or in one. Lines alone are tubes in space.
/// @param linePixels their thickness @param scale pixels a unit
[[nodiscard]] vtkSmartPointer<vtkActor> GeometryActor(vtkPolyData* geometry, const std::optional<Quantity>& field,
  bool isFlat, const Color& color, double linePixels, double scale);

/// What the three have in common: canvas, layout, ink.
/// @throws InputError when the size asked for leaves no room
[[nodiscard]] Layout ArrangeOrThrow(
  const Furniture& furniture, double unitsX, double unitsY, bool pixelated, const SnapshotOptions& options);
[[nodiscard]] Color BackgroundColor(const SnapshotOptions& options);
[[nodiscard]] Color InkOn(Color background);

} // namespace lamella::rendering
