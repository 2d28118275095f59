#pragma once

#include "outlines/ContourLattice.h"
#include "outlines/WallDirection.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lamella::micrograph
{

enum class LamellaMethod
{
  Growth,  ///< what lumens that grow leave between them: thicker where three cells meet
  Constant ///< of one thickness, about the line as far from two lumens
};

struct LamellaOptions
{
  LamellaMethod method = LamellaMethod::Growth;
  /// Gap that growing outlines keep between them, or the constant thickness [m]; not given: half a micrometre, as in
  /// spruce, but not more than an eighth of the walls' median thickness.
  std::optional<double> thickness;
  /// Growth: outlines stop where their radius of curvature has fallen to this [m]; 0: never; not given: a quarter
  /// of the walls' median thickness.
  std::optional<double> radius;
  double horizon = 0; ///< nodes that a solver wants across the lamella; 0: none in particular
};

/// The thickness that is taken where none is given [m]. @param median of the walls [m]
[[nodiscard]] double usualLamella(double median);

/// How many nodes lie across the lamella, measured along the wall's normal through each link between two cells.
struct NodesAcross
{
  double mean = 0;
  double low = 0;         ///< 5 % have fewer
  std::vector<float> all; ///< #links between two cells, in no order [nodes]
};

struct MiddleLamella
{
  PhaseImage image;     ///< phases "lumen" 0, "wall" 1, "middle lamella" 2
  double thickness = 0; ///< as used [m]
  double radius = 0;    ///< as used [m]
  NodesAcross across;
  double wallShare = 0;      ///< of the wall's nodes that are lamella
  std::int64_t joined = 0;   ///< nodes that are lamella only so that it does not tear where it is thinner than a node
  std::int64_t networks = 0; ///< parts that do not hang together in the picture, not even over corners of nodes
  double largestNetwork = 0; ///< share of the lamella's nodes in the largest
  std::int64_t cells = 0;    ///< lumens on the lattice
  std::int64_t cellsTouched = 0; ///< of these, bordered by the network: the largest part, and what the border cuts off
  std::int64_t cellsCutOff = 0;  ///< of these, bordered by nothing but parts that the border cuts off from the largest
  std::vector<std::string> warnings;
};

/// Finds the middle lamella in walls between lumens.
///
/// *Growth* is the first paper's way (section 2, figure 4): all outlines advance along their normals in small steps, "a
/// minimum gap between two neighbouring internal contours" stays, and an outline "locally stops when a maximum
/// curvature is attained"; what none of them reached is lamella. Here the end of that motion is computed without steps:
/// - Outlines that advance at one speed have come a distance τ when what they enclose is {d_i ≤ τ}. Two that face each
///   other stop at a gap g, when d_i = τ and d_j = τ + g: lumen i's outline ends on d_j − d_i = g, wherever the walls
///   run and whatever their thickness. The cell that has grown is G_i = {d_j − d_i ≥ g for all j}.
/// - An outline that grows freely becomes flatter (its radius of curvature rises by τ). It sharpens only where its
///   sides have stopped and it runs on into the corner between three cells. Stopped at the radius r it is the curve of
///   radius r that touches both sides: the part of G_i that disks of radius r within G_i cover (its opening). Free
///   growth until walls of median thickness have met, d_i ≤ (median − g)/2, is never undone, however sharp a lumen's
///   corners.
///
/// Both boundaries are drawn as lines between nodes (one set a cell, so that even a gap much smaller than a node is
/// found), and distances to them are exact: a straight lamella is as thick as it should be at any spacing. Within r of
/// the box's sides corners are not rounded, for the disks' centres may lie outside.
///
/// Where it is thinner than a node it would tear on the lattice; so of two neighbouring wall nodes of two cells the one
/// nearer to the middle always is lamella. Lines between cells are then covered without a gap, and the lamella hangs
/// together over the 8 neighbours of a node (sides and corners) wherever the cells' walls do; over the 4 at its sides
/// alone it does so only where it is two nodes thick or more. It still tears where the lattice lost a wall, that is
/// where two lumens' nodes are neighbours.
///
/// A cell in a corner of the picture may border on one other cell alone, along a line that begins and ends on the
/// border: there the lamella goes on outside. Such parts count with the largest network if that leaves the picture too.
///
/// Time: about 0.5 µs a wall node (growth), 0.1 µs (constant). Memory beside `directions`: about 10 bytes a node.
/// @param directions as wallDirections() found them on the same lattice
/// @throws ParameterError for a thickness that is not positive, a radius or horizon below 0; InputError with fewer than
/// two lumens
[[nodiscard]] MiddleLamella middleLamella(
  const ContourLattice& lattice, const WallDirections& directions, const LamellaOptions& options = {});

/// Counts the nodes of "middle lamella" (2) along the wall's normals. @param phase #nodes
[[nodiscard]] NodesAcross nodesAcross(
  const ContourLattice& lattice, const WallDirections& directions, std::span<const std::uint8_t> phase);

/// A picture of three classes, 0 lumen, 128 middle lamella and 255 wall, with the phases of MiddleLamella.
/// @throws InputError for another grey
[[nodiscard]] PhaseImage lamellaFromLabels(const Lattice& lattice, std::span<const std::uint16_t> grey);

/// Twice the nodes that are of a phase in both, over the nodes of it in each (Dice); 1 if neither has any.
[[nodiscard]] double overlap(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, std::uint8_t phase);

} // namespace lamella::micrograph
