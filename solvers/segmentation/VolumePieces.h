#pragma once

#include "lattice/Lattice.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::micrograph
{

/// What clearPieces() did.
struct ClearedPieces
{
  std::int64_t pieces = 0;
  std::int64_t voxels = 0;
};

/// Gives every piece of one phase, connected through faces, that has fewer than `smallest` voxels the phase of most
/// of the faces around it. Small pieces do not vote, unless there is nobody else.
/// @param phase lattice.count() ids, changed in place
/// Time: linear. Memory: 12 bytes a run of one phase along x.
/// @throws MemoryError where there are more than 2³¹ runs
ClearedPieces clearPieces(const Lattice& lattice, std::span<std::uint8_t> phase, std::int64_t smallest);

/// How many voxels thick each phase is: 2 over the share of its voxels that have another phase at one of their faces,
/// which is the thickness of a sheet along the axes (a sheet at an angle seems up to 1.7 times as thick, a sphere two
/// thirds of its radius). 0 for a phase that is nowhere; as thick as the volume is long where no edge is seen.
[[nodiscard]] std::vector<double> thicknesses(
  const Lattice& lattice, std::span<const std::uint8_t> phase, std::size_t phases);

/// Gives voxels of a middle class (ids rise with grey) that have a darker one within `reach` voxels on one side and a
/// brighter one on the other, along an axis, to the nearer of darkest and brightest: of what blur makes of an edge
/// between those two.
/// @param cls     ids of classes, rising with grey, changed in place
/// @param grey    the volume
/// @param between grey from which on a voxel goes to the bright side
/// @return how many voxels changed
std::int64_t clearShells(
  const Lattice& lattice, std::span<std::uint8_t> cls, std::span<const std::uint16_t> grey, double between, int reach);

} // namespace lamella::micrograph
