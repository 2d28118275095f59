#pragma once

#include "pores/PoreLabelling.h"
#include "pores/Runs.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// The end of PoreLabelling: pieces and where they touch become pores with numbers.
namespace lamella::pores
{

/// A node of piece `a` touches one of piece `b` that lies `shift` periods further on along each axis.
struct Joint
{
  std::uint32_t a;
  std::uint32_t b;
  std::array<std::int8_t, 3> shift;
  std::int8_t unused = 0; ///< so that equal joints are equal bytes
  // NOLINTNEXTLINE(modernize-use-nullptr): it means the comparison with 0 inside
  auto operator<=>(const Joint&) const = default;
};

[[nodiscard]] Piece emptyPiece();
/// @param moved nodes by which the piece is moved before
void add(Piece& sum, const Piece& piece, const std::array<std::int64_t, 3>& moved = { 0, 0, 0 });

struct Merged
{
  UnfilledVector<Pore> pores;         ///< label i + 1
  UnfilledVector<std::int32_t> label; ///< by piece; 0: below the minimum size
  UnfilledVector<float> size;         ///< by piece: that of its pore; empty unless asked for
  PoreSummary summary;
  bool tooMany = false; ///< more pores than labels: summary.count tells how many, the rest is empty
};

/// @param pieces of every rank, one after the other
/// @param sizes of the pieces, once more, or empty
/// @param ranks there are several: pieces need not rise by their first nodes, and `size` is wanted
[[nodiscard]] Merged merge(const Lattice& lattice, std::span<const Piece> pieces, std::span<const std::uint32_t> sizes,
  std::span<const Joint> joints, bool ranks, const LabelOptions& options);

} // namespace lamella::pores
