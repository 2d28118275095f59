#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// What the layouts of all tissues are made of: convex polygons cut out of a power diagram, and how deep a point lies
/// in one. Only +, −, ×, / and √ are used, which IEEE arithmetic rounds alike everywhere.
namespace lamella::generators
{

/// a where t is 0, b where it is 1.
inline double mix(double a, double b, double t)
{
  return a + (b - a) * t;
}

enum class CellKind : std::uint8_t
{
  Tracheid,
  Fibre,
  Vessel,
  Ray
};

/// A corner of a polygon and the side that leads from it to the next corner.
struct Corner
{
  double x = 0;
  double y = 0;
  int side = -1; ///< the caller's mark
};

/// A straight side of a cell: the middle of the wall that it shares with its neighbour.
/// nx x + ny y + c is the distance from it, positive inside the cell.
struct CellSide
{
  double nx = 0;
  double ny = 0;
  double c = 0;
  int ray = -1;          ///< the ray whose centre line this side lies on; -1: another cell is beyond
  bool rayBelow = false; ///< the ray lies at smaller y than the cell

  [[nodiscard]] double distance(double x, double y) const noexcept { return nx * x + ny * y + c; }
};

/// The side from one corner of a counter-clockwise polygon to the next.
[[nodiscard]] CellSide sideBetween(const Corner& from, const Corner& to) noexcept;

/// Where a counter-clockwise polygon lies.
struct PolygonPlace
{
  double xMin = 0, xMax = 0, yMin = 0, yMax = 0;
  double centreX = 0, centreY = 0; ///< of its area
};
[[nodiscard]] PolygonPlace placeOf(std::span<const Corner> corners) noexcept;

/// What is left of a convex polygon on the side a x + b y + c ≥ 0; the new side gets the mark `side`.
void clip(std::vector<Corner>& polygon, std::vector<Corner>& spare, double a, double b, double c, int side);

/// Leaves out the sides shorter than `least`, which have no sure direction, but three.
void dropShortSides(std::vector<Corner>& polygon, double least);

/// How deep a point lies inside a wall-bounded cell, its corners rounded: the wall thickness t at which the point would
/// lie on the lumen's surface, that is Σ max(0, t + r − dᵢ)² = r², with distances dᵢ to the sides and fillet radius r.
/// Equals the smallest dᵢ where one side alone is near. For each t the lumen is convex.
[[nodiscard]] double wallDepth(std::span<const double> distances, double fillet) noexcept;

/// A function of the depth in a cell that rises from 0 like the depth itself and without limit towards the middle, so
/// that a lumen shrinks ever more slowly and does not close before all the others.
/// @param cellDepth the depth at the cell's middle
[[nodiscard]] double widened(double depth, double cellDepth) noexcept;

/// The depth whose widened() is `value`.
[[nodiscard]] double depthOfWidened(double value, double cellDepth) noexcept;

/// (cos, sin) of an angle in turns, from a series: the same bits on every machine, to 1e-12.
[[nodiscard]] std::array<double, 2> onCircle(double turns) noexcept;

} // namespace lamella::generators
