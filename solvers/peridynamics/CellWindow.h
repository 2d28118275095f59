#pragma once

#include "lattice/Communicator.h"
#include "lattice/Decomposition.h"
#include "lattice/Lattice.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::peridynamics
{

/// A part of a sample, the same on every rank.
struct CellWindow
{
  Lattice lattice;
  std::vector<std::uint8_t> phase; ///< lattice.count()
  std::vector<std::int32_t> grain; ///< likewise, or empty
};

/// The whole sample where it has at most `most` nodes; else the largest centred part of its shape that has. Sides that
/// can be halved often solve fastest, so they are cut to multiples of 16 nodes, or of 2.
[[nodiscard]] Block centredPart(const Lattice& lattice, std::int64_t most);

/// Brings a part of a sample together that ranks hold in slabs. Collective.
/// @param slab of this rank; phase and grain are those of its nodes, grain may be empty
[[nodiscard]] CellWindow collect(const Lattice& lattice, const Block& slab, std::span<const std::uint8_t> phase,
  std::span<const std::int32_t> grain, const Block& part, const Communicator& comm);

/// The same picture with every node split in n along each axis; `slab` is the part of the finer lattice that is made.
[[nodiscard]] Lattice split(const Lattice& lattice, int n);
[[nodiscard]] CellWindow split(const CellWindow& window, int n, const Block& slab);

} // namespace lamella::peridynamics
