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

} // namespace lamella::generators
