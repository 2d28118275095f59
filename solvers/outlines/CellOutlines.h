#pragma once

#include "outlines/NearestContours.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// Internal: lines of value 0 between the nodes of a lattice.
namespace lamella::micrograph
{

/// Values at the four corners of a square of nodes: (x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1).
using Corners = std::array<double, 4>;

/// Appends the straight pieces in which the value is 0 between four nodes, the positive side on their left, values
/// taken as linear along the square's edges; a saddle is split by the mean. @param low the first node's position
/// @param chain number for the pieces; their label is 1
void zeroLines(
  const Corners& values, const Point& low, double spacing, std::int32_t chain, std::vector<Segment>& lines);

} // namespace lamella::micrograph
