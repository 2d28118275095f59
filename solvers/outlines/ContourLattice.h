#pragma once

#include "lattice/Phases.h"
#include "outlines/Contour.h"
#include "outlines/WallThickness.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lamella::micrograph
{

struct ContourLatticeOptions
{
  double spacing = 0;  ///< asked for [m]; see latticeOf()
  int lines = 4;       ///< Gauss points across a link's face, and across the link if `across`; 0 (no links) to 16
  bool across = false; ///< shares on lines across the links too
  bool grain = true;
};

/// What outlines do to the links along one axis between neighbouring nodes.
///
/// Link i along x of row j has the index i + (nx + 1) j and joins the nodes i − 1 and i; links 0 and nx lead from the
/// first and the last node to the box's faces and are half as long. Along y link j of column i has the index i + nx j.
/// A link's cell is as long as the link and one spacing wide. Links that no outline passes are not listed: their cell
/// is of the phase of their nodes.
struct LinkCuts
{
  std::vector<double> place;      ///< #lines: Gauss points, 0 to 1, across the cell (in `across`: along it)
  std::vector<double> weight;     ///< #lines: they sum to 1
  std::vector<std::int64_t> link; ///< #cut, rising
  std::vector<float> share;       ///< #cut by #lines: lumen's share of the lines along the link, each exact
  std::vector<float> across;      ///< #cut by #lines or none: the same of the lines across it
  std::vector<float> area;        ///< #cut: lumen's exact share of the cell
  /// #cut: the outline's normal from lumen to wall, integrated along the outline in the cell and divided by its length:
  /// of length 1 where it is straight, shorter where it bends or where there are two.
  std::vector<std::array<float, 2>> normal;

  /// Mean over the face of the harmonic mean along the link, Σ w / (s/lumen + (1 − s)/wall).
  /// @param cut position in `link`  @param lumen, wall conductivities, > 0
  [[nodiscard]] double harmonicAlong(std::size_t cut, double lumen, double wall) const;
  /// Harmonic mean along the link of the mean across it, 1/Σ w / (s lumen + (1 − s) wall); needs `across`.
  /// Where an outline runs along these lines the share jumps from one to the next, which costs up to a line's weight.
  [[nodiscard]] double harmonicAcross(std::size_t cut, double lumen, double wall) const;
};

struct ContourLattice
{
  PhaseImage image;                ///< phases "lumen" 0 and "wall" 1, at the nodes
  double cropped = 0;              ///< strip at the top of the picture that no node stands for [m]
  std::vector<std::int32_t> grain; ///< #nodes or none: the lumen's number, 0 in the wall
  std::vector<float> lumenShare;   ///< #nodes: lumen's exact share of the node's pixel
  double lumenFraction = 0;        ///< the same of the box, from sums in double precision
  std::array<LinkCuts, 2> links;   ///< along x, along y
  WallThickness thickness;
  std::vector<std::string> warnings;
};

/// The lattice of a picture: as many nodes as come nearest to the spacing asked for fit its width exactly, so that the
/// spacing changes a little (by spacing/2 over the width at most); along y there are as many as fit, and what is left
/// of the height, less than a spacing, is cropped at the top. Nothing is stretched.
/// @throws ParameterError for a spacing that is no positive number or larger than the picture
[[nodiscard]] Lattice latticeOf(const std::array<double, 2>& size, double spacing);

/// A picture for a lattice that covers all of it, whatever its size: the lattice's cells are a little longer or shorter
/// along y than along x, and the outlines are stretched along y so that they are squares.
struct FittedContours
{
  ContourSet contours; ///< of `lattice`'s size exactly
  Lattice lattice;     ///< its spacing is the cells' true one along x
  double stretch = 1;  ///< of lengths along y, within multiple / (2 · rows + multiple) of 1
};

/// @param spacing  asked for [m]; that along x fits the width as latticeOf() has it, that along y the height
/// @param multiple nodes along both axes are multiples of this: with 2^n, n more lattices, each twice as coarse as the
/// one before, cover the picture as exactly
/// @throws ParameterError, MemoryError as latticeOf(), and for a multiple below 1
[[nodiscard]] FittedContours fitContours(const ContourSet& contours, double spacing, int multiple = 1);

/// Puts the outlines of lumens on a lattice of any spacing: what lies at each node, the exact share of each pixel, and
/// exactly where outlines cut the lines along which nodes are linked.
///
/// Pixels and link cells are clipped by following each edge from cell to cell and summing the area to its right within
/// the row (as scan converters of fonts do), so that areas are exact to round-off and cost nothing where no outline
/// passes. A node on an outline belongs to the side to its right. Closed chains may reach out of the box and are
/// clipped.
///
/// Time: about 25 ns a node and 0.3 µs a cut link. Memory: 9 bytes a node, 8 while at work, and about 100 a cut link.
/// @throws ParameterError, InputError (see closedEdges()); MemoryError (how much it takes) before anything is allocated
[[nodiscard]] ContourLattice contourLattice(const ContourSet& contours, const ContourLatticeOptions& options);

/// Gauss–Legendre points and weights on 0 … 1. @param count 1 to 16
struct LineRule
{
  std::vector<double> place;
  std::vector<double> weight;
};
[[nodiscard]] LineRule gaussRule(int count);

} // namespace lamella::micrograph
