#pragma once

#include "peridynamics/NodeField.h"

#include <array>
#include <cstdint>

namespace lamella::peridynamics
{

/// Calls f(index, node) for all nodes of this rank, node as in the whole lattice.
template <class F>
void eachOwnNode(const NodeLayout& l, F&& f)
{
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        f(l.index(x, y, z), std::array<std::int64_t, 3>{ x + l.start[0], y + l.start[1], z + l.start[2] });
}

} // namespace lamella::peridynamics
