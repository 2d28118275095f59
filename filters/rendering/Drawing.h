#pragma once

#include "Canvas.h"
#include "Furniture.h"
#include "SnapshotOptions.h"

#include <array>

class vtkImageData;
class vtkPolyData;

namespace lamella::rendering
{

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

/// What the three have in common: canvas, layout, ink.
/// @throws InputError when the size asked for leaves no room
[[nodiscard]] Layout ArrangeOrThrow(
  const Furniture& furniture, double unitsX, double unitsY, bool pixelated, const SnapshotOptions& options);
[[nodiscard]] Color BackgroundColor(const SnapshotOptions& options);
[[nodiscard]] Color InkOn(Color background);

} // namespace lamella::rendering
