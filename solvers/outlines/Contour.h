#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lamella::micrograph
{

/// A point of a picture [m]: x to the right, y up, (0, 0) the picture's lower left corner, so that the first node of
/// a lattice made from it lies half a spacing inside, as makeLattice() has it.
using Point = std::array<double, 2>;

/// The outline of a lumen: a chain of straight segments with the lumen on its left.
///
/// A closed chain's last point is joined to its first, which is not repeated; its area is positive. An open chain
/// belongs to a lumen that the picture's border cuts; its first and last point lie on the border, and the lumen goes
/// on from its end along the border, counter-clockwise, to the next chain's begin.
struct Contour
{
  std::vector<Point> points;
  bool closed = true;
  /// Which lumen, from 1; chains of one lumen (a border may cut it into several) share it.
  std::int32_t lumen = 0;
};

/// All lumens of a picture. Chains do not cross each other or themselves; a lumen has no wall inside it.
struct ContourSet
{
  std::array<double, 2> size{ 0, 0 }; ///< of the picture [m]
  std::vector<Contour> contours;
};

} // namespace lamella::micrograph
