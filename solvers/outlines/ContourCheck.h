#pragma once

#include "outlines/Contour.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// What can be wrong with contours.
enum class ContourFault
{
  NotFinite,   ///< a coordinate is NaN or infinite
  FewPoints,   ///< fewer than 3 points, 2 if open
  Repeated,    ///< a point that is the one before it
  Outside,     ///< a point outside the picture
  EndInside,   ///< an open chain that does not begin and end on the border
  Clockwise,   ///< a closed chain with the lumen on its right
  BorderOrder, ///< along the border, ends and begins of open chains do not alternate
  LumenNumber, ///< chains of one lumen with different numbers, or different lumens with one
  Crossing,    ///< chains, or parts of one, cross or touch
  Nested       ///< a lumen inside another
};

struct ContourFinding
{
  ContourFault fault{};
  std::size_t contour = 0; ///< from 0
  std::size_t other = 0;   ///< of Crossing, Nested (the outer one), LumenNumber; else as `contour`
  Point at{ 0, 0 };        ///< [m]

  /// "contours 3 and 7 cross at (…) m"
  [[nodiscard]] std::string text() const;
};

/// Everything that is wrong with contours, by kind; of a pair of contours one crossing is told. What follows from a
/// fault is not told again: without finite points nothing more is looked for, and lumens are only looked at where no
/// chain crosses.
///
/// Segments are sorted into a grid of cells about as large as they are long: time and memory grow with their number.
[[nodiscard]] std::vector<ContourFinding> validate(const ContourSet& set);

/// Pairs of contours (or a contour and itself) that cross or touch, each once.
[[nodiscard]] std::vector<ContourFinding> findCrossings(const ContourSet& set);

/// @param what the contours' source, for the message: "'cells.json'"
/// @throws InputError that tells the first finding and how many more there are
void requireValid(const ContourSet& set, const std::string& what);

} // namespace lamella::micrograph
