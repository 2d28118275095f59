#pragma once

#include "outlines/ContourTracing.h"

namespace lamella::micrograph
{

/// How the steps of pixels are smoothed away.
struct SmoothingScale
{
  double wavelength = 20; ///< waves shorter than this are damped [pixels]
  double margin = 0.02;   ///< how near to a node a chain may come [pixels]
  int rounds = 8;
};

/// Leaves out crossings through which a chain passes anyhow, whatever their `t`: in flat parts those on lines along x,
/// in steep parts those along y. What is left lies about a pixel apart.
void thinOut(Trace& trace);

/// Moves each crossing of a chain along the line between its two nodes to where the chain varies its curvature least
/// and is nearest to half-way: ∫ (dκ/ds)² + (2π/wavelength)⁶ d² ds is least, d the distance from half-way, with no node
/// on the wrong side. Where a corner forbids that, d is weighted more, eight times at a time. Straight lines and
/// circles of any size are not bent. Since crossings stay between their nodes, chains cross neither themselves nor each
/// other.
void smooth(Trace& trace, const SmoothingScale& scale);

/// Moves a chain along its normals, every crossing between its nodes, until its area is that of its pixels.
/// @returns what is missing [pixels²]: 0 to round-off unless the nodes leave no room
double restoreArea(Trace& trace, double target, double margin);

/// The area to the left of a chain through its crossings [pixels²]; of an open one, up to whole pictures, with the
/// border from its end to its begin.
/// @param halfWay as if all `t` were 0
[[nodiscard]] double signedArea(const Trace& trace, bool halfWay = false);

/// What a smooth curve through the crossings of a closed or open chain encloses more than the chain: over each segment
/// a cap of a twelfth of its length squared times the turn at its ends [pixels²].
[[nodiscard]] double capArea(const Trace& trace);

} // namespace lamella::micrograph
