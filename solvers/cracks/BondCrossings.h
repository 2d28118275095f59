#pragma once

#include "cracks/CrackCurves.h"
#include "cracks/CutBond.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::cracks
{

/// Where a bond meets the curves.
struct Crossing
{
  std::int32_t curve = -1; ///< −1: none
  std::int32_t point = 0;  ///< of the curve, the nearest to where it crosses
};

/// For every bond the crossing that is nearest to its middle or, where it crosses none, the curve that comes nearest to
/// it, if that is less than half a spacing away.
[[nodiscard]] std::vector<Crossing> crossings(std::span<const CrackCurve> curves, std::span<const CutBond> bonds);

} // namespace lamella::cracks
