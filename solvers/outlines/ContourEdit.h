#pragma once

#include "outlines/Contour.h"

#include <array>
#include <cstdint>
#include <numbers>
#include <vector>

namespace lamella::micrograph
{

struct SimplifyReport
{
  std::int64_t before = 0; ///< points
  std::int64_t after = 0;  ///< points
  std::int64_t kept = 0;   ///< chains left as they were, since they would cross others or themselves
};

/// Leaves out points that lie within a tolerance of the line through their neighbours (Ramer, Computer Graphics and
/// Image Processing 1, 1972, 244–256; Douglas and Peucker, Cartographica 10, 1973, 112–122), then moves those that are
/// left along their normals until each chain has its area again, to round-off. Ends of open chains stay. Chains that
/// would cross afterwards are left as they were.
/// @param tolerance [m]; 0 or less leaves everything
[[nodiscard]] ContourSet simplify(const ContourSet& set, double tolerance, SimplifyReport* report = nullptr);

/// [m²] @param diameter [m]
[[nodiscard]] inline double areaOfCircle(double diameter)
{
  return std::numbers::pi / 4 * diameter * diameter;
}

struct LumenFilter
{
  double smallestArea = 0;  ///< lumens below become wall [m²]
  double leastSolidity = 0; ///< lumens below become wall, 0 … 1; those that the border cuts are kept
};

struct FilterReport
{
  std::int64_t small = 0;  ///< lumens below the smallest area
  double smallArea = 0;    ///< of these [m²]
  std::int64_t ragged = 0; ///< lumens below the least solidity
  double raggedArea = 0;   ///< of these [m²]
};

/// Takes lumens out; those that are left are numbered anew from 1.
/// @throws ParameterError for an area below 0 or a solidity outside 0 … 1; InputError as outlines()
[[nodiscard]] ContourSet filterLumens(const ContourSet& set, const LumenFilter& filter, FilterReport* report = nullptr);

/// What becomes of a polygon that covers a whole window.
enum class Covering
{
  Refused,
  NoContour ///< it has none in the window
};

/// What of closed polygons lies in a window, as contours whose picture it is: polygons that its border cuts become open
/// chains that end exactly on it.
/// @param polygons counter-clockwise, not crossing
/// @param low, high the window's corners [m]; low becomes (0, 0)
/// @throws InputError when one polygon covers the whole window and that is refused
[[nodiscard]] ContourSet clipToWindow(const std::vector<std::vector<Point>>& polygons, const Point& low,
  const Point& high, Covering covering = Covering::Refused);

/// A part of a picture with its outlines: what of them lies in a window becomes the picture, lumens numbered anew.
/// @param low, high the window's corners in the picture [m]; low becomes (0, 0)
/// @throws ParameterError for a window that is empty or reaches out of the picture; InputError where no outline, or one
///   lumen alone, lies in it, and as outlines()
[[nodiscard]] ContourSet cropContours(const ContourSet& set, const Point& low, const Point& high);

} // namespace lamella::micrograph
