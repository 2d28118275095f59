#pragma once

#include "lattice/Lattice.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::micrograph
{

/// A point where an outline crosses the line between two neighbouring nodes, one lumen and one wall; or, on the
/// picture's border, between their projections onto it. Lengths in pixels, (0, 0) the picture's lower left corner.
struct Crossing
{
  double x = 0, y = 0; ///< half-way between the two nodes
  double t = 0;        ///< how far beyond, towards the wall's node; −½ … ½
  std::int8_t ex = 0;  ///< unit vector from the lumen's node to the wall's
  std::int8_t ey = 0;  ///< likewise

  [[nodiscard]] double px() const noexcept { return x + t * ex; }
  [[nodiscard]] double py() const noexcept { return y + t * ey; }
};

/// An outline as marching squares gives it, the lumen on its left.
struct Trace
{
  std::vector<Crossing> crossings;
  bool closed = true;
  double width = 0, height = 0; ///< of the picture [pixels]
  /// What the outline of the pixels themselves has more than the chain through the half-way points (t = 0) [pixels²]:
  /// an eighth for each corner that the chain cuts off, less for each it fills. Open chains: with the border as it is.
  double corners = 0;
};

/// All outlines of lumens that lie in no island of wall.
struct Traces
{
  std::vector<Trace> chains;     ///< open ones first, counter-clockwise along the border by their begin
  std::int64_t islands = 0;      ///< pieces of wall inside lumens, left out with all that is in them
  double islandArea = 0;         ///< of these, with all that is in them [pixels²]
  std::int64_t nestedLumens = 0; ///< lumens left out since they lie in islands
  bool borderIsLumen = false;    ///< all along
};

/// Marching squares between the centres of pixels. Lumens hang together through sides (4), walls through sides and
/// corners (8): where two lumen nodes and two wall nodes lie crosswise, the walls join and the lumens part.
///
/// Outside the outermost nodes the picture goes on for half a pixel as they are; chains therefore meet the border at a
/// right angle (with a level: by linear extrapolation of it).
/// @param lumen #nodes; not 0 where lumen is
/// @param level empty, or #nodes: a smooth field, above 0 in lumens, whose zero the crossings lie on; a node whose
///   level contradicts `lumen` is taken as one on the outline
/// @param margin how near to a node a crossing may come [pixels]
[[nodiscard]] Traces traceOutlines(
  const Lattice& lattice, std::span<const std::uint8_t> lumen, std::span<const float> level, double margin);

} // namespace lamella::micrograph
