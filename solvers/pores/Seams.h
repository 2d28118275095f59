#pragma once

#include "core/Communicator.h"
#include "lattice/Decomposition.h"
#include "lattice/Lattice.h"
#include "pores/Merging.h"
#include "pores/PoreLabelling.h"
#include "pores/Slab.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::pores
{

/// Where the pieces of a block touch over the seams: the periodic ends of x, and the block's sides, beyond which are
/// other ranks' rows or its own.
class Seams
{
public:
  /// @param near rows that a row touches
  /// @param offset pieces of the ranks before
  Seams(const Lattice& lattice, const Block& block, const Communicator& comm, const LabelOptions& options,
    std::span<const Slab> slabs, std::span<const Neighbour> near, std::uint32_t offset);

  /// Collective. Sorted, each once.
  [[nodiscard]] std::vector<Joint> joints() const;

private:
  void writeRow(std::int64_t row, std::span<std::uint32_t> out) const;
  void joinEnds(std::vector<Joint>& joints) const;
  void joinSides(std::vector<Joint>& joints) const;
  void joinRows(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b, bool diagonal,
    const std::array<int, 3>& shift, std::vector<Joint>& joints) const;

  const Lattice& lattice_;
  const Block& block_;
  const Communicator& comm_;
  const LabelOptions& options_;
  std::span<const Slab> slabs_;
  std::span<const Neighbour> near_;
  Rows rows_;
  std::uint32_t offset_;
};

} // namespace lamella::pores
