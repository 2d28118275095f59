#pragma once

#include "lattice/Phases.h"

#include <cstdint>

/// Seeded samples whose geometry is known. The same options and seed give the same bytes on every machine and at
/// every number of threads. Lengths are in metres. All return phases "lumen" and "wall" (tissue, honeycomb) or
/// "matrix" and "inclusion" (arrays), in that order, as ids 0 and 1.
namespace lamella::generators
{

/// Softwood cross-section: radial files of tracheids (radial direction = x), from earlywood (wide lumens) to latewood
/// (flattened radially, thick walls), with rays (files of narrow ray cells along the radial direction), brick-like
/// offset between neighbouring files and natural scatter of sizes.
struct SoftwoodOptions
{
  int dimension = 2;
  std::array<std::int64_t, 3> size{ 200, 200, 1 };
  double spacing = 1e-6;               ///< [m]
  double solidFraction = 0.40;         ///< reached to within half a node in total
  double tangentialDiameter = 30e-6;   ///< mean tracheid diameter across the files [m]
  double radialDiameterEarly = 36e-6;  ///< mean tracheid diameter along the files at the start of the ring [m]
  double radialDiameterLate = 12e-6;   ///< the same at its end [m]
  double ringPosition0 = 0.0;          ///< position in the ring of the left edge: 0 earlywood … 1 latewood
  double ringPosition1 = 0.0;          ///< of the right edge; both 0: pure earlywood, both 1: pure latewood
  double rayEvery = 240e-6;            ///< mean tangential distance between rays [m]; 0: none
  double tracheidLength = 200e-6;      ///< 3D: mean length along z, closed at both ends (real ones are 3 mm) [m]
  double scatter = 0.12;               ///< relative standard deviation of the diameters
  std::uint64_t seed = 1;
};
[[nodiscard]] PhaseImage softwood(const SoftwoodOptions& options);

/// Regular honeycomb of straight walls at a solid fraction; whole cells fit the box periodically.
struct HoneycombOptions
{
  std::array<std::int64_t, 3> size{ 200, 200, 1 };
  double spacing = 1e-6;
  double solidFraction = 0.40;
  int cellsAcross = 4; ///< cells along x
};
[[nodiscard]] PhaseImage honeycomb(const HoneycombOptions& options);

/// Checkerboard (2D) or 3D chequered box of `cells` fields along each axis.
[[nodiscard]] PhaseImage checkerboard(int dimension, std::array<std::int64_t, 3> size, double spacing, int cells);

/// Square array of disks, or simple cubic array of spheres, centred in `cells` × `cells` (× `cells`) unit cells, of
/// area (volume) fraction `fraction`; a node is inclusion when its centre is inside.
[[nodiscard]] PhaseImage inclusionArray(
  int dimension, std::array<std::int64_t, 3> size, double spacing, double fraction, int cells);

/// Layers perpendicular to `axis`; `periods` pairs of layers of which `fraction` is "inclusion".
[[nodiscard]] PhaseImage laminate(
  int dimension, std::array<std::int64_t, 3> size, double spacing, int axis, double fraction, int periods);

} // namespace lamella::generators
