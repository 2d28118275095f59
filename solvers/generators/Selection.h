#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lamella::generators
{

/// Marks the `count` nodes of smallest key with 1, all others with 0: a solid fraction met to the node. Among equal
/// keys the first nodes are taken.
/// @param keys finite, ≥ 0; 0 ≤ count ≤ keys.size()
/// Time O(keys), no copy of the keys.
[[nodiscard]] std::vector<std::uint8_t> markSmallest(std::span<const float> keys, std::int64_t count);

/// Nodes of a cross-section with another cell to the right, above or diagonally above get the key 0, wall whatever its
/// thickness: this thinnest wall is connected through faces and lets no lumen touch another, not even at a corner.
/// @param key, cell nx × ny values each, rows along x
/// @return how many they are
std::int64_t closeWalls(std::span<float> key, std::span<const std::int32_t> cell, std::int64_t nx, std::int64_t ny);

/// How many nodes a solid fraction asks for.
/// @param closed that walls one node thick take  @throws ParameterError when that is more
[[nodiscard]] std::int64_t solidNodes(double solidFraction, double spacing, std::int64_t nodes, std::int64_t closed);

} // namespace lamella::generators
