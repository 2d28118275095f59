#pragma once

#include "lattice/Lattice.h"
#include "pores/Runs.h"
#include "pores/Unfilled.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamella::pores
{

/// A row that touches the one at (0, 0) and comes before it in memory.
struct Neighbour
{
  int y;
  int z;
  bool diagonal; ///< also where only corners meet, x one off
};

[[nodiscard]] std::vector<Neighbour> neighbours(int connectivity);

/// Where a block's rows lie, counted from its first one, y fastest.
struct Rows
{
  std::int64_t ny = 0;
  std::int64_t nz = 0;

  [[nodiscard]] std::int64_t count() const noexcept { return ny * nz; }
  [[nodiscard]] std::array<std::int64_t, 2> place(std::int64_t row) const noexcept { return { row % ny, row / ny }; }
  /// The row of a neighbour inside the block, or −1.
  [[nodiscard]] std::int64_t inside(std::int64_t row, const Neighbour& n) const noexcept
  {
    const auto [y, z] = place(row);
    const bool in = y + n.y >= 0 && y + n.y < ny && z + n.z >= 0;
    return in ? row + n.y + n.z * ny : -1;
  }
};

/// Rows that one thread does by itself.
struct Slab
{
  std::int64_t firstRow = 0; ///< counted in the block, y fastest
  std::int64_t rows = 0;
  std::int64_t words = 0;                ///< a row
  UnfilledVector<std::uint64_t> bits;    ///< rows × words
  UnfilledVector<std::uint32_t> before;  ///< rows × words
  std::vector<std::uint32_t> firstRun;   ///< rows + 1
  UnfilledVector<std::uint32_t> pieceOf; ///< by run
  std::uint32_t count = 0;               ///< pieces of the slab
  UnfilledVector<Piece> pieces;          ///< emptied once they are the block's
  UnfilledVector<std::uint32_t> sizes;   ///< of the pieces [nodes], close together; emptied likewise
  std::vector<std::uint32_t> blockPiece; ///< by piece of the slab; empty when there is one slab: they are the same

  /// From nodes to pieces.
  /// @param phase of the block's nodes
  /// @param start of the block in the lattice
  void label(const Lattice& lattice, const std::array<std::int64_t, 3>& start, const Rows& block,
    std::span<const std::uint8_t> phase, std::uint8_t wanted, std::span<const Neighbour> near);

  [[nodiscard]] Row row(std::int64_t blockRow) const noexcept
  {
    const auto at = static_cast<std::size_t>((blockRow - firstRow) * words);
    return { bits.data() + at, before.data() + at };
  }
  [[nodiscard]] std::span<const std::uint32_t> piecesOfRow(std::int64_t blockRow) const noexcept
  {
    const auto r = static_cast<std::size_t>(blockRow - firstRow);
    return std::span(pieceOf).subspan(firstRun[r], firstRun[r + 1] - firstRun[r]);
  }
  /// The block's piece at a node, or −1.
  [[nodiscard]] std::int64_t at(std::int64_t blockRow, std::int64_t x) const noexcept;
  [[nodiscard]] std::uint32_t ofBlock(std::uint32_t piece) const noexcept
  {
    return blockPiece.empty() ? piece : blockPiece[piece];
  }
  /// Writes the value of its piece into every node of the slab's rows.
  /// @param ofBlock by piece of the block  @param block the block's nodes
  void fill(std::span<const std::int32_t> ofBlock, std::int32_t background, std::int64_t nx, std::int32_t* block) const;
  void fill(std::span<const float> ofBlock, float background, std::int64_t nx, float* block) const;
};

/// @param slabs in the order of their rows, which they share out
[[nodiscard]] const Slab& slabOf(std::span<const Slab> slabs, std::int64_t row);

} // namespace lamella::pores
