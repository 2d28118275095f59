#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/kernels/RowKernels.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

/// How the sums over bonds walk through a lattice; for this folder only.
namespace lamella::peridynamics
{

/// Some bonds of the stencil that lead to the same row and lie in one word.
struct Chunk
{
  int first = 0; ///< in Stencil::half()
  int count = 0;
  std::array<int, 3> step{}; ///< of the first
};

/// @param largest bonds a chunk: 1, or all sizes that RealRowKernels has
[[nodiscard]] std::vector<Chunk> chunks(const Stencil& stencil, int largest);

/// A part of a row, in multiples of 16 nodes from x = 0.
struct Run
{
  std::int64_t begin = 0;
  std::int64_t end = 0;
  int kind = 0; ///< 255 mixed

  bool operator==(const Run&) const = default;
};

/// What of a row has bonds, and what they reach.
struct RowRuns
{
  std::vector<Run> push; ///< nodes with bonds of their own
  std::vector<Run> pull; ///< nodes that may be the second ends
  std::vector<Run> gaps; ///< in pull but not in push: the buffers must be zero there

  /// @param unit runs end at a multiple of it past the last node: a vector's length
  /// @return false when the row has no bond
  bool find(const BondLattice& bonds, std::int64_t row, int unit);
};

/// A thread's share of the owned rows: [begin, end) of z size[1] + y.
struct Band
{
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

/// Shares of the owned rows, or of those of a band, with about equal numbers of strips to visit.
[[nodiscard]] std::vector<Band> bands(const BondLattice& bonds, int count);
[[nodiscard]] std::vector<Band> bands(const BondLattice& bonds, int count, const Band& within);

/// Is this row in the band?
[[nodiscard]] inline bool inBand(const NodeLayout& l, const Band& band, std::int64_t y, std::int64_t z) noexcept
{
  const std::int64_t ordinal = z * l.size[1] + y;
  return y >= 0 && y < l.size[1] && z >= 0 && z < l.size[2] && ordinal >= band.begin && ordinal < band.end;
}

/// Calls zero(row) for each row of the band, before it is first written, and visit(y, z, row, own) for every row whose
/// bonds have an end in the band, in order; own: the row itself is in the band.
template <class Zero, class Visit>
void sweep(const NodeLayout& l, int reach, const Band& band, Zero&& zero, Visit&& visit)
{
  if (band.begin >= band.end)
    return;
  const std::int64_t ny = l.size[1];
  const auto rowOf = [&](std::int64_t ordinal) { return l.row(ordinal % ny, ordinal / ny); };
  // the farthest row that a row's bonds reach
  const std::int64_t ahead = (l.dimension == 3 ? reach * l.rowsY() : 0) + reach;
  const std::int64_t first = std::max<std::int64_t>(0, rowOf(band.begin) - ahead);
  const std::int64_t last = rowOf(band.end - 1);
  std::int64_t next = band.begin;
  for (std::int64_t row = first; row <= last; ++row)
  {
    for (; next < band.end && rowOf(next) <= row + ahead; ++next)
      zero(rowOf(next));
    const std::int64_t y = row % l.rowsY() - l.ghost;
    const std::int64_t z = row / l.rowsY() - l.ghostZ();
    visit(y, z, row, inBand(l, band, y, z));
  }
}

/// Sets the padding and the rim of a row to zero.
template <class Real>
void clearRim(const NodeLayout& l, Real* row)
{
  std::fill(row - l.before, row, Real(0));
  std::fill(row + l.size[0], row + l.pitch - l.before, Real(0));
}

} // namespace lamella::peridynamics
