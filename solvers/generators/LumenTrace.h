#pragma once

#include "generators/CellGeometry.h"
#include "outlines/Contour.h"

#include <functional>
#include <span>
#include <vector>

/// Lumens as outlines: level sets of wallDepth() traced around a middle.
namespace lamella::generators
{

/// How far the outline is from the middle in a direction; 0 where there is no lumen.
using Radius = std::function<double(double directionX, double directionY)>;

/// Points of the closed outline around a middle, counter-clockwise, spread so that no chord is farther than about
/// `tolerance` from it. Empty where the lumen is closed.
[[nodiscard]] std::vector<micrograph::Point> trace(
  double middleX, double middleY, const Radius& radius, double tolerance);

/// The outline of the points of a convex cell that lie deeper than `depth`: Σ max(0, depth + r − dᵢ)² = r², solved
/// along each direction by Newton's method to 1e-12 of the fillet radius r.
[[nodiscard]] std::vector<micrograph::Point> traceConvex(
  std::span<const CellSide> sides, double fillet, double depth, double middleX, double middleY, double tolerance);

/// Adds what a picture shows of a closed outline: all of it as a closed chain, or the parts inside as open chains whose
/// ends lie on the border exactly.
/// @return whether there was anything
bool addShown(micrograph::ContourSet& set, std::span<const micrograph::Point> outline, std::int32_t lumen);

/// Area of a polygon, counter-clockwise positive.
[[nodiscard]] double areaOf(std::span<const micrograph::Point> polygon) noexcept;

/// The part of its area in the box from (0, 0) to `size`.
[[nodiscard]] double areaShown(std::span<const micrograph::Point> polygon, std::array<double, 2> size);

} // namespace lamella::generators
