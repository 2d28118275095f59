#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/kernels/RowKernels.h"

#include <vector>

namespace lamella::peridynamics
{

/// What the kernels need to know of the kinds and offsets of a lattice; made anew for each sum, which is cheap.
template <class Real>
struct BondNumbers
{
  /// @param only kind whose stiffness counts, that of the others being 0; 0: all
  explicit BondNumbers(const BondLattice& bonds, int only = 0);

  /// Of the offsets, for k = 1 (kind 0) or the k of a kind.
  [[nodiscard]] const OffsetNumbers<Real>* of(int kind) const noexcept
  {
    return offsets.data() + static_cast<std::size_t>(kind) * perKind;
  }

  std::size_t perKind;
  std::vector<OffsetNumbers<Real>> offsets;
  std::vector<Real> stiffness; ///< at least 8 values
  std::vector<Real> critical;  ///< (1 + s₀)² − 1
  std::vector<Real> inverse;   ///< 1/s₀, 0 where nothing breaks it
  Real safe;
};

} // namespace lamella::peridynamics
