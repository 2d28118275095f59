#pragma once

#include "cracks/CrackPaths.h"

namespace lamella::cracks
{

/// What bonds say of a path and its points.
/// @param own places in `bonds` of those that cross it, and which point each is nearest to
struct OwnBond
{
  std::size_t bond;
  std::size_t point;
};
void measure(CrackPath& path, std::span<const CutBond> bonds, std::span<const OwnBond> own, const Lattice& lattice,
  double horizon, const BondCount& count, std::span<const std::uint8_t> phase);

/// Of all segments of some paths.
[[nodiscard]] Orientation orientationOf(std::span<const CrackPath> paths);

/// Puts shares of two lists together.
void add(std::vector<PairShare>& all, std::span<const PairShare> more);

} // namespace lamella::cracks
