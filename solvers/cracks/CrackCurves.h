#pragma once

#include "cracks/CrackGraph.h"
#include "cracks/CrackSmoothing.h"

namespace lamella::cracks
{

/// A chain as a line: points[0] is where it begins, points[1 + k] where it crosses the pair of its edge k, the last one
/// where it ends. Closed: the last one is the first.
struct CrackCurve
{
  std::vector<Place> points;
};

/// One a chain. Chains that meet share a point; a chain that ends at a side of the picture ends on it.
[[nodiscard]] std::vector<CrackCurve> crackCurves(
  const Lattice& lattice, std::span<const CrackEdge> edges, const CrackGraph& graph);

} // namespace lamella::cracks
