#pragma once

#include "outlines/Contour.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

/// Outlines whose walls are known.
namespace lamella::testing
{

/// Counter-clockwise about its centre.
inline micrograph::Contour regularPolygon(
  const micrograph::Point& centre, double radius, int corners, std::int32_t lumen, double turn = 0)
{
  micrograph::Contour contour{ {}, true, lumen };
  for (int i = 0; i < corners; ++i)
  {
    const double angle = turn + 2 * std::numbers::pi * i / corners;
    contour.points.push_back({ centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle) });
  }
  return contour;
}

/// An arc from one angle to another, open.
inline micrograph::Contour arc(double radius, double from, double to, int pieces, std::int32_t lumen)
{
  micrograph::Contour contour{ {}, false, lumen };
  for (int i = 0; i <= pieces; ++i)
  {
    const double angle = from + (to - from) * i / pieces;
    contour.points.push_back({ radius * std::cos(angle), radius * std::sin(angle) });
  }
  return contour;
}

/// A quarter of a ring of wall about the lower left corner of a square, lumen 1 inside it and lumen 2 outside: two open
/// chains that the border closes.
inline micrograph::ContourSet quarterRing(double side, double inner, double outer, int pieces)
{
  micrograph::ContourSet set{ { side, side }, {} };
  set.contours = { arc(inner, 0, std::numbers::pi / 2, pieces, 1), arc(outer, std::numbers::pi / 2, 0, pieces, 2) };
  for (micrograph::Contour& contour : set.contours)
    for (micrograph::Point* end : { &contour.points.front(), &contour.points.back() })
      (*end)[(*end)[0] < (*end)[1] ? 0 : 1] = 0; // the cosine of a right angle is not quite 0
  return set;
}

/// Hexagonal lumens of a honeycomb with pointed tops, each given by its corners; those at the border reach out of it.
/// @param across distance of neighbouring centres  @param wall thickness
inline micrograph::ContourSet honeycomb(double width, double height, double across, double wall, int pointsPerSide = 1)
{
  micrograph::ContourSet set{ { width, height }, {} };
  const double rowHeight = across * std::sqrt(3) / 2;
  std::int32_t lumen = 0;
  for (int row = -1; row * rowHeight < height + across; ++row)
  {
    for (int column = -1; column * across < width + across; ++column)
    {
      const micrograph::Point centre{ (column + (row % 2 != 0 ? 0.5 : 0.0)) * across, row * rowHeight };
      const micrograph::Contour corners =
        regularPolygon(centre, (across - wall) / std::sqrt(3), 6, ++lumen, std::numbers::pi / 6);
      micrograph::Contour contour{ {}, true, lumen };
      for (std::size_t i = 0; i < 6; ++i)
      {
        const micrograph::Point& a = corners.points[i];
        const micrograph::Point& b = corners.points[(i + 1) % 6];
        for (int k = 0; k < pointsPerSide; ++k)
        {
          const double t = static_cast<double>(k) / pointsPerSide;
          contour.points.push_back({ a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) });
        }
      }
      set.contours.push_back(contour);
    }
  }
  return set;
}

/// Twice the signed area that a closed chain encloses, halved.
inline double areaOf(const micrograph::Contour& contour)
{
  double sum = 0;
  for (std::size_t i = 0; i < contour.points.size(); ++i)
  {
    const micrograph::Point& a = contour.points[i];
    const micrograph::Point& b = contour.points[(i + 1) % contour.points.size()];
    sum += a[0] * b[1] - b[0] * a[1];
  }
  return sum / 2;
}

} // namespace lamella::testing
