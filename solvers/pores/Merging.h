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
  friend auto operator<=>(const Joint&, const Joint&) = default;
};

struct Merged
{
  std::vector<Pore> pores;         ///< label i + 1
  std::vector<std::int32_t> label; ///< by piece; 0: below the minimum size
  std::vector<float> size;         ///< by piece: that of its pore, NaN where it has no label
  PoreSummary summary;
  bool tooMany = false; ///< more pores than labels: summary.count tells how many, the rest is empty
};

/// @param pieces of every rank, one after the other
/// @param inOrder whether they rise by their first nodes
[[nodiscard]] Merged merge(const Lattice& lattice, std::span<const Piece> pieces, std::span<const Joint> joints,
  bool inOrder, const LabelOptions& options);

} // namespace lamella::pores
