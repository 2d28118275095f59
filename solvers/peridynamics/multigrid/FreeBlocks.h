#pragma once

#include "peridynamics/BondLattice.h"

#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

[[nodiscard]] constexpr std::uint8_t allComponents(int dimension) noexcept
{
  return static_cast<std::uint8_t>((1U << dimension) - 1);
}

/// Diagonal blocks of the stiffness matrix.
struct FreeBlocks
{
  FreeBlocks(const BondLattice& bonds, const FixedComponents& fixed);

  NodeField<float> all;                 ///< of all nodes
  NodeField<float> free;                ///< rows and columns of fixed components are zero
  std::vector<std::int64_t> fixedNodes; ///< own positions with a fixed component
  std::int64_t partlyFixed = 0;         ///< of them, those with a free component too
};

} // namespace lamella::peridynamics
