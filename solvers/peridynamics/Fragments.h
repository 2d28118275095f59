#pragma once

#include "peridynamics/BondLattice.h"

#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

/// A part of the sample that bonds hold together.
struct Fragment
{
  std::int64_t nodes = 0; ///< of all ranks
  std::int64_t first = 0; ///< its first node: x + nx (y + ny z) in the whole lattice
  std::uint8_t fixed = 0; ///< components that are fixed somewhere on it, see findFragments()
};

struct Fragments
{
  std::vector<Fragment> pieces;     ///< in order of their first nodes; solid nodes without a bond are pieces too
  AlignedArray<std::int32_t> piece; ///< of every own node by position, -1 in voids and in the rim
};

/// @param fixed bits as FixedComponents, or null
/// Collective; the same on every rank and for any number of them.
[[nodiscard]] Fragments findFragments(const BondLattice& bonds, const AlignedArray<std::uint8_t>* fixed = nullptr);

} // namespace lamella::peridynamics
