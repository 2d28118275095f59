#pragma once

#include "core/Communicator.h"
#include "peridynamics/NodeField.h"
#include "peridynamics/multigrid/Level.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamella::peridynamics
{

/// Over own rows of all ranks, and the same on any number of threads. Collective.
/// @param ofRow given where a row begins
template <class OfRow>
double sumOfRows(const Communicator& comm, const NodeLayout& l, OfRow&& ofRow)
{
  std::vector<double> sums(static_cast<std::size_t>(l.size[1] * l.size[2]));
  forOwnRows(l,
    [&](std::int64_t y, std::int64_t z)
    { sums[static_cast<std::size_t>(y + l.size[1] * z)] = ofRow(l.index(0, y, z)); });
  double total = 0;
  for (const double s : sums)
    total += s;
  return comm.sum(total);
}

/// a·b over own nodes of all ranks. Collective.
inline double dot(const Communicator& comm, const NodeField<double>& a, const NodeField<double>& b)
{
  const NodeLayout& l = a.layout();
  return sumOfRows(comm, l,
    [&](std::int64_t i)
    {
      double sum = 0;
      for (int c = 0; c < l.dimension; ++c)
        sum += levelKernels().dot(l.size[0], a.component(c) + i, b.component(c) + i);
      return sum;
    });
}

} // namespace lamella::peridynamics
