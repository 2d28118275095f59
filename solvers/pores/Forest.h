#pragma once

#include <cstdint>
#include <span>

/// Disjoint sets in one array: each element's parent, none above its child; a root is its own.
namespace lamella::pores
{

/// With path halving.
[[nodiscard]] inline std::uint32_t rootOf(std::span<std::uint32_t> parent, std::uint32_t i) noexcept
{
  while (parent[i] != i)
  {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

/// In place: parents become numbers of their roots in rising order. @returns how many roots
[[nodiscard]] inline std::uint32_t numberRoots(std::span<std::uint32_t> parent) noexcept
{
  std::uint32_t roots = 0;
  for (std::uint32_t i = 0; i < parent.size(); ++i)
  {
    const std::uint32_t above = parent[i];
    const std::uint32_t known = parent[above]; // lower ones are numbers already
    // a mask, not a branch: which runs are roots cannot be guessed
    const std::uint32_t root = above == i ? 1U : 0U;
    parent[i] = known ^ ((known ^ roots) & (0U - root));
    roots += root;
  }
  return roots;
}

} // namespace lamella::pores
