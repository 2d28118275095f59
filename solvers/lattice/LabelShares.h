#pragma once

#include "lattice/Lattice.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella
{

/// Shares of two phases are told in steps of 1/(shareLevels − 1).
constexpr int shareLevels = 255;

/// The share of each step: 0 … 1.
[[nodiscard]] std::vector<double> evenShares();

/// How much of each node the second of two phases fills, from labels: by a smooth surface through their staircase.
///
/// A level f is 2 G s − G G s, s = ±1 the labels and G a blur of variance 2 (binomial, of radius 4 along each axis). Of
/// a blur alone its zero lies off a surface of curvature κ by about σ²κ/2; here that part cancels. f keeps the sign of
/// the label. A node's share is what f's tangent plane leaves of it, with the mean of the second differences; where
/// these are large beside the slope the mean of its octants' (in pictures: quarters'), each with a plane of its own.
/// Then f moves, twice, by as much as the labels exceed the shares over the surface's area, both over a window of
/// variance 4 (radius 8): so volumes are those of the labels around every place of the surface, and neither grow nor
/// shrink with curvature or in thin walls.
///
/// Every node is more than half of the phase of its label, and 0 or 1 where the surface does not reach it. Swapping the
/// labels swaps the shares, and mirroring mirrors them, exactly; the number of threads changes nothing. In units of
/// nodes, so voxels need not be cubes. How near: docs/benchmarks/volumes.md.
///
/// @param label  #nodes
/// @param second label of the second phase; all others are the first
/// @param wraps  whether the sample repeats along x, y, z; else its surfaces go straight on beyond its faces
/// @returns #nodes: shares in steps, 0 … shareLevels − 1: evenShares() by it
/// Memory beside labels and shares: 4 bytes a node. Time: docs/benchmarks/volumes.md.
/// @throws ParameterError for another number of labels
[[nodiscard]] std::vector<std::uint8_t> labelShares(const Lattice& lattice, std::span<const std::uint8_t> label,
  std::uint8_t second, const std::array<bool, 3>& wraps, int threads);

/// The part of the cube of edge 1 about the origin in which value + slope · x > 0.
/// R. Scardovelli and S. Zaleski, J. Comput. Phys. 164 (2000) 228.
[[nodiscard]] double cubeShare(double value, const std::array<double, 3>& slope) noexcept;

} // namespace lamella
