#pragma once

#include "lattice/Communicator.h"
#include "peridynamics/NodeField.h"

#include <array>
#include <vector>

namespace lamella::peridynamics
{

/// Fills the rim of an array of a layout in slabs along its slowest axis: images at periodic sides, the rows of the
/// neighbouring ranks. Elsewhere the rim is left alone. Collective.
template <class T>
void exchangeRim(const NodeLayout& layout, const std::array<bool, 3>& periodic, const Communicator& comm, T* data);

/// The lists of all ranks one after another, in order of rank; each entry is `stride` numbers. Collective.
[[nodiscard]] std::vector<std::int64_t> gather(
  const Communicator& comm, const std::vector<std::int64_t>& mine, int stride);

} // namespace lamella::peridynamics
