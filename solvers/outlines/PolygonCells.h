#pragma once

#include "outlines/Contour.h"

#include <cstdint>
#include <functional>
#include <vector>

/// Internal: outlines of cells, which may touch and cross each other, so that each is worked on by itself.
namespace lamella::micrograph
{

/// Told the number of a cell that is left out, since it crosses or touches itself or is no outline.
using LeaveOut = std::function<void(std::size_t cell)>;

/// What of closed polygons lies in a window; numbered from 1. @param numbers of the polygons, for `leaveOut`
[[nodiscard]] ContourSet clipCells(const std::vector<std::vector<Point>>& outers,
  const std::vector<std::size_t>& numbers, const Point& low, const Point& high, const LeaveOut& leaveOut);

/// Those that are sound by themselves.
[[nodiscard]] ContourSet soundCells(const ContourSet& cells, const LeaveOut& leaveOut);

/// What of sound cells lies in a window of their picture; numbered anew.
[[nodiscard]] ContourSet cropCells(const ContourSet& cells, const Point& low, const Point& high);

} // namespace lamella::micrograph
