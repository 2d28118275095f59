#pragma once

#include "core/Communicator.h"
#include "lattice/Decomposition.h"
#include "lattice/Lattice.h"
#include "lattice/Subsample.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::peridynamics
{

/// A sample, or a part of it.
struct CellWindow
{
  Lattice lattice;
  std::vector<std::uint8_t> phase; ///< lattice.count()
  std::vector<std::int32_t> grain; ///< likewise, or empty
};

/// A coarser picture of a cell that repeats, from its own pixels.
struct CellThinning
{
  PeriodicThinning pixels; ///< of the lattice's pixels
  std::array<std::int64_t, 3> first{ 0, 0, 0 };
  int split = 1; ///< nodes along each axis that a pixel of the sample has, and of the picture
  /// How often the picture stands beside itself, by axis: of a cell that repeats the same, but longer than a bond.
  std::array<std::int64_t, 3> times{ 1, 1, 1 };
};

/// Its lattice: of pixels.stride times the spacing.
[[nodiscard]] Lattice thinned(const Lattice& lattice, const CellThinning& thinning);

/// The picture, on every rank, from a sample that ranks hold in slabs. Collective.
/// @param lattice the whole one; its sizes are multiples of `split`
/// @param slab of this rank; phase and grain are those of its nodes, grain may be empty
[[nodiscard]] CellWindow thinned(const Lattice& lattice, const Block& slab, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const CellThinning& thinning, const Communicator& comm);

/// The part of a sample that a rank's slab is.
[[nodiscard]] CellWindow partOf(const CellWindow& whole, const Block& slab);

} // namespace lamella::peridynamics
