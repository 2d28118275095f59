#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace lamella
{

/// What values at spacings that double tell of the limit, where errors are a part in proportion to the spacing and one
/// to its square: of surfaces that the shares of voxels tell.
struct SpacingError
{
  /// fine + (fine − coarse) (5 − r)/3, r = (coarse − coarser)/(fine − coarse) within 2 (the first part alone) and 4
  /// (the second); without a coarser one 2 × fine − coarse.
  double extrapolated = 0;
  /// 1.5 |fine − coarse|, or a third of the change before that one where it is more.
  double bar = 0;
};

[[nodiscard]] SpacingError spacingError(double fine, double coarse, std::optional<double> coarser);

/// The part of the voxels that hold some of both phases, at least 2 %, by their ids' shares of the second: where it is
/// large, surfaces lie so close that spacings hardly tell them apart.
[[nodiscard]] double mixedPart(std::span<const std::uint8_t> ids, std::span<const double> shares);

} // namespace lamella
