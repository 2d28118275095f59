#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace lamella::generators
{

/// For every node of an nx × ny lattice the nearest one that is marked, in whole numbers.
struct Nearest
{
  static constexpr std::int32_t none = -1;
  std::vector<std::int32_t> node;    ///< index of the nearest marked node, or none
  std::vector<std::int32_t> squared; ///< squared distance [nodes²]
};

/// Exact squared Euclidean distances in two passes over columns and rows (Meijster, Roerdink, Hesselink 2000).
/// @param marked nx × ny, not 0 where marked. Time and memory are proportional to the nodes.
[[nodiscard]] Nearest nearestMarked(const std::vector<std::uint8_t>& marked, std::int64_t nx, std::int64_t ny);

} // namespace lamella::generators
