#pragma once

#include "lattice/Phases.h"

#include <cstdint>

/// Seeded samples whose geometry is known. The same options and seed give the same bytes on every machine and at
/// every number of threads. Lengths are in metres. All return phases "lumen" and "wall" (tissue, honeycomb) or
/// "matrix" and "inclusion" (arrays), in that order, as ids 0 and 1.
namespace lamella::generators
{

/// Softwood: radial files of tracheids (radial direction = x, tangential = y), from earlywood (wide lumens) to latewood
/// (flattened radially, thick walls), with rays (files of narrow ray cells along the radial direction), brick-like
/// offset between neighbouring files, a few tips of tracheids between the others, and natural scatter of sizes.
///
/// The cells are the polygons of a power diagram whose sites stand in files, bent slowly; each lumen is its polygon
/// less a wall of one thickness, with round corners. One factor scales all walls so that the solid fraction is met.
/// In 3D tracheids run along z; each is closed at both ends by walls that slope like a chisel's edge, at nearly the
/// same height in a file and staggered between files; rays are stacks of ray cells, some eight high, that close above
/// and below.
///
/// The walls are connected through faces but for pieces that an edge of the box cuts off, and no lumen opens into
/// another, not even at a corner: where walls would be thinner than that the sample is refused.
struct SoftwoodOptions
{
  int dimension = 2;
  std::array<std::int64_t, 3> size{ 200, 200, 1 };
  double spacing = 1e-6;              ///< [m]
  double solidFraction = 0.40;        ///< reached to within half a node in total
  double tangentialDiameter = 30e-6;  ///< mean tracheid diameter across the files [m]
  double radialDiameterEarly = 36e-6; ///< mean tracheid diameter along the files at the start of the ring [m]
  double radialDiameterLate = 15e-6;  ///< the same at its end [m]
  double ringPosition0 = 0.0;         ///< position in the ring of the left edge: 0 earlywood … 1 latewood
  double ringPosition1 = 0.0;         ///< of the right edge; both 0: pure earlywood, both 1: pure latewood
  double rayEvery = 240e-6;           ///< mean tangential distance between rays [m]; 0: none
  double tracheidLength = 200e-6;     ///< 3D: mean length along z, closed at both ends (real ones are 3 mm) [m]
  double scatter = 0.12;              ///< relative standard deviation of the diameters
  std::uint64_t seed = 1;
};
/// @throws ParameterError for values outside their range, cells of fewer than 6 nodes, and a solid fraction too small
/// for
///         closed walls at this spacing (says which spacing would do); MemoryError
/// Time and memory are proportional to the nodes: about 0.15 µs a node in 2D, 0.08 µs in 3D; 17 and 5 bytes a node
/// (and 350 bytes a node of one cross-section in 3D).
[[nodiscard]] PhaseImage softwood(const SoftwoodOptions& options);

/// Hardwood in cross-section (radial direction = x, tangential = y): vessels, alone or in radial files of two to four
/// that share a flat wall, among fibres, between rays one cell wide. Diffuse-porous as poplar by default; large vessels
/// that end early in the ring make it ring-porous.
///
/// All cells are convex polygons of one power diagram, in which vessels are heavy points and each is ringed by fibres;
/// the fibres are moved towards their middles a few times, and a share of them is narrow, cut near its tips. Each lumen
/// is its polygon less a wall, with round corners; one factor scales all walls so that the solid fraction is met. The
/// tissue does not depend on the spacing: a box of the same size in metres holds the same cells.
struct HardwoodOptions
{
  int dimension = 2; ///< 2 alone: a cross-section
  std::array<std::int64_t, 3> size{ 400, 400, 1 };
  double spacing = 1e-6;              ///< [m]
  double solidFraction = 0.38;        ///< reached to within half a node in total
  double fibreDiameter = 16e-6;       ///< mean diameter of a fibre, between the middles of its walls [m]
  double vesselDiameterEarly = 64e-6; ///< mean tangential diameter of the vessels at the start of the ring [m]
  double vesselDiameterLate = 40e-6;  ///< the same at its end [m]
  /// Share of the picture that is in vessels, out to the middle of their walls, at the start of the ring. In pictures
  /// of few vessels their diameters give way by up to a tenth to come near it.
  double vesselShareEarly = 0.32;
  double vesselShareLate = 0.15; ///< the same at its end
  double earlyEnd = 0.6;   ///< position in the ring around which early vessels give way to late ones; ring-porous: 0.25
  double multiples = 0.45; ///< share of the groups of vessels that are radial files of two to four
  double ringPosition0 = 0.0; ///< position in the ring of the left edge: 0 its start … 1 its end
  double ringPosition1 = 0.0; ///< of the right edge
  double rayEvery = 95e-6;    ///< mean tangential distance between rays [m]; 0: none
  double scatter = 0.12;      ///< relative standard deviation of the fibres' diameters
  std::uint64_t seed = 1;
};
/// Phases "lumen" and "wall". The walls are connected through faces but for pieces that an edge of the box cuts off,
/// and no lumen opens into another, not even at a corner.
/// @throws ParameterError for values outside their range, a third dimension, fibres of fewer than 6 nodes, vessels too
///         wide for the rays' distance, and a solid fraction too small for closed walls at this spacing (says which
///         spacing would do); MemoryError
/// Time and memory are proportional to the nodes: about 0.4 µs and 14 bytes a node.
[[nodiscard]] PhaseImage hardwood(const HardwoodOptions& options);

/// Honeycomb of straight walls at a solid fraction, met to within half a node; whole cells fit the box periodically.
/// The cells are regular in a box whose height is a whole even number of rows, 0.866 of a cell's width each (four cells
/// across 400 × 346 nodes); in any other box they are stretched a little along y. In 3D the walls run along z.
struct HoneycombOptions
{
  std::array<std::int64_t, 3> size{ 200, 200, 1 };
  double spacing = 1e-6;
  double solidFraction = 0.40;
  int cellsAcross = 4; ///< cells along x
};
/// @throws ParameterError, MemoryError
[[nodiscard]] PhaseImage honeycomb(const HoneycombOptions& options);

/// Checkerboard (2D) or 3D chequered box of `cells` fields along each axis, which must divide the nodes; matrix is at
/// the origin. An even number of fields is half matrix, half inclusion and closes periodically.
/// @throws ParameterError, MemoryError
[[nodiscard]] PhaseImage checkerboard(int dimension, std::array<std::int64_t, 3> size, double spacing, int cells);

/// Square array of disks, or simple cubic array of spheres, centred in `cells` × `cells` (× `cells`) unit cells, of
/// area (volume) fraction `fraction` of the exact geometry; a node is inclusion when its centre is inside.
/// @throws ParameterError for a box that is not square (a cube), or a fraction above that of touching inclusions;
/// MemoryError
[[nodiscard]] PhaseImage inclusionArray(
  int dimension, std::array<std::int64_t, 3> size, double spacing, double fraction, int cells);

/// Layers perpendicular to `axis`: `periods` times matrix then inclusion; layers are whole numbers of nodes, and all of
/// them together hold `fraction` to within half a layer of nodes.
/// @throws ParameterError, MemoryError
[[nodiscard]] PhaseImage laminate(
  int dimension, std::array<std::int64_t, 3> size, double spacing, int axis, double fraction, int periods);

} // namespace lamella::generators
