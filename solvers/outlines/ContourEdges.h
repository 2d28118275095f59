#pragma once

#include "outlines/Contour.h"

#include <cstdint>
#include <vector>

/// Internal: the outlines of lumens as one bag of directed edges.
namespace lamella::micrograph
{

struct ContourEdge
{
  Point from;
  Point to;
  std::int32_t lumen = 0;
  bool border = false; ///< runs along the picture's border and only closes an open chain
};

/// All edges of a set, lumen on the left, and those along the border that close its open chains, so that the edges
/// form loops. Points are multiplied by `scale`. Edges without length are left out.
/// @throws ParameterError for a size that is none; InputError (names the contour, from 1): fewer than three points in a
///   closed chain or two in an open one, coordinates that are no numbers, a lumen number below 1, an open chain whose
///   ends are not on the border (to 1e-6 of the picture's longer side), open chains that do not follow each other along
///   the border as ContourSet has it
[[nodiscard]] std::vector<ContourEdge> closedEdges(const ContourSet& set, double scale = 1);

/// The checks of closedEdges() alone.
void checkContours(const ContourSet& set);

} // namespace lamella::micrograph
