#pragma once

#include "outlines/Contour.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace lamella::micrograph
{

/// Where on the picture's border a point lies: the way from its lower left corner, counter-clockwise [m]. Nothing for
/// a point that is farther from it than 1e-9 of the picture's size.
[[nodiscard]] std::optional<double> borderPosition(const std::array<double, 2>& size, const Point& point);

/// The whole outline of a lumen, the border's part of it included.
struct Outline
{
  std::int32_t lumen = 0;
  bool open = false;
  std::vector<std::size_t> chains; ///< of the set, in the order in which they follow each other
  std::vector<Point> points;       ///< a closed polygon, counter-clockwise; the first point is not repeated
};

/// Outlines of all lumens: closed chains as they are, open ones joined along the border. The lumen's number is that of
/// the first chain.
/// @throws InputError for an open chain with an end off the border, or ends that do not alternate with begins along it
[[nodiscard]] std::vector<Outline> outlines(const ContourSet& set);

/// Numbers lumens from 1: by the outlines, in the order of their first chains.
void numberLumens(ContourSet& set);

/// Area to the left of a closed polygon [m²]; negative when it is clockwise.
[[nodiscard]] double polygonArea(const std::vector<Point>& points);

/// Does a polygon hold a point? Points on its sides: either answer.
[[nodiscard]] bool holds(const std::vector<Point>& polygon, const Point& point);

} // namespace lamella::micrograph
