#pragma once

#include "lattice/Phases.h"
#include "packing/Packing.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The binding matrix of cemented grains, as Frank, Radjai, Nezamabadi and Delenne, Phys. Rev. E 102 (2020) 022906,
/// section III and figure 7: a bridge between the centres of each pair of grains that touch or nearly do, a trapezoid
/// whose width at each end is a share of that grain's diameter; in 3D, which the paper has not, a truncated cone.
/// Where grain and bridge overlap there is grain.
namespace lamella::packing
{

struct BridgeOptions
{
  /// Width of a bridge at a grain's centre over the grain's diameter, α; from 0 (none) to 2.
  double width = 0.5;
  /// Pairs whose centres are nearer than this times the sum of their radii get a bridge, β; from 1 to 2.
  double reach = 1.1;
  /// All of the space between the grains is matrix, whatever the width.
  bool filled = false;
  /// Grains are bridged to the two walls along the last axis too, as to their mirror images beyond them.
  bool walls = false;
  /// Share of the space between the grains, over the whole box, that is matrix: the width is solved for.
  std::optional<double> saturation{};
};

/// A pair of grains with a bridge; `shift` is added to the second's centre (periodic boxes, mirror images) [m].
struct Bridge
{
  std::int32_t first = 0;
  std::int32_t second = 0;
  std::array<double, 3> shift{ 0, 0, 0 };
};

struct MatrixFractions
{
  double grains = 0;     ///< share of the box
  double matrix = 0;     ///< share of the box
  double voids = 0;      ///< share of the box
  double saturation = 0; ///< matrix/(matrix + voids)
};

/// Pairs nearer than `reach`, by rising first and second. In periodic boxes a grain's images count as others.
/// @param walls as BridgeOptions::walls: first and second are then one grain
/// @throws ParameterError for a reach outside 1 … 2; for walls where the last axis is periodic; for a periodic box
/// narrower than bridges are long
[[nodiscard]] std::vector<Bridge> findBridges(const Packing& packing, double reach, bool walls = false);

/// Shares of the box, exact but for the quadrature: lines along x meet disks, spheres, trapezoids and cones in
/// intervals, whose union is exact, and are summed across with `lines` of them along each other axis (0: so many that
/// the error is about 1e-5 in 2D, 1e-3 in 3D; more where grains are a hundred times smaller than the box).
[[nodiscard]] MatrixFractions matrixFractions(
  const Packing& packing, std::span<const Bridge> bridges, double width, bool filled = false, int lines = 0);

/// The width that gives a saturation, to 1e-6 of it; where a few bridges lie along x, as the lines do by which shares
/// are measured, as near as these lines resolve, about 1e-2.
/// @throws ParameterError when no width from 0 to 2 does (says the range that can be reached)
[[nodiscard]] double widthForSaturation(
  const Packing& packing, std::span<const Bridge> bridges, double saturation, int lines = 0);

struct RasterOptions
{
  std::int64_t nodesAcross = 400; ///< nodes along x; the spacing is the box's first edge over this
  double platen = 0;              ///< thickness of a plate of grain material below and above, along the last axis [m]
  bool shares = false;            ///< also how much of each voxel is grain, and solid
};

/// A sample on a lattice: a node is what lies at its centre.
struct CementedSample
{
  PhaseImage image;                ///< phases void 0, matrix 1, grain 2; platens are of phase grain
  std::vector<std::int32_t> grain; ///< #nodes: grain number from 1; 0: none; −1: platen
  /// #nodes: the parts of the voxel around each node that are grain, and grain or matrix; empty unless asked for. Along
  /// x they are exact, across it sums over 8 × 8 lines a voxel (disks: 16).
  std::vector<float> grainShare, solidShare;
  double width = 0; ///< α as used
  std::int64_t bridges = 0;
  MatrixFractions fractions;         ///< of the geometry, without platens
  MatrixFractions onLattice;         ///< of the nodes, without platens
  std::vector<std::string> warnings; ///< overlaps, and what the lattice is too coarse for
};

/// The other edges of the box are rounded to whole spacings; what sticks out is cut off, a rest is void.
/// @throws ParameterError: width, reach, saturation, nodes or platen outside their range; MemoryError
[[nodiscard]] CementedSample cement(const Packing& packing, const BridgeOptions& bridges, const RasterOptions& raster);

} // namespace lamella::packing
