#pragma once

#include "peridynamics/BondLattice.h"
#include "peridynamics/BondNumbers.h"
#include "peridynamics/RowSweep.h"
#include "peridynamics/kernels/RowKernels.h"

#include <cstddef>
#include <cstdint>

/// From rows of a bond lattice to the jobs of the row kernels; for this folder only.
namespace lamella::peridynamics
{

template <class Real>
[[nodiscard]] const RealRowKernels<Real>& kernelsOf(const BondLattice& bonds) noexcept
{
  if constexpr (sizeof(Real) == 8)
    return bonds.rowKernels().d;
  else
    return bonds.rowKernels().f;
}

/// Is this layer of rows in the lattice? Bonds that leave it are none, and a row near its end has many of them.
[[nodiscard]] inline bool inLattice(const BondLattice& bonds, std::size_t axis, std::int64_t at) noexcept
{
  const NodeLayout& l = bonds.layout();
  const std::int64_t global = at + l.start[axis];
  return bonds.periodic()[axis] || (global >= 0 && global < l.global[axis]);
}

/// What all jobs of a pass have in common: numbers of the kinds.
template <class Real>
void begin(RowJob<Real>& job, const BondLattice& bonds, const BondNumbers<Real>& numbers) noexcept
{
  job.planes = bonds.planes();
  job.stiffness = numbers.stiffness.data();
  job.critical = numbers.critical.data();
  job.safe = numbers.safe;
}

/// Sets what a job reads for the bonds of a chunk from the row (y, z): all but the kind of a run, f and buffers.
template <class Real>
void aim(RowJob<Real>& job, const BondLattice& bonds, const BondNumbers<Real>& numbers, const Chunk& chunk,
  const NodeField<Real>& u, std::int64_t y, std::int64_t z) noexcept
{
  const NodeLayout& l = bonds.layout();
  const std::int64_t i = l.index(0, y, z);
  const std::int64_t j = l.index(0, y + chunk.step[1], z + chunk.step[2]);
  job.count = chunk.count;
  job.bit = chunk.first % 32;
  job.stepX = chunk.step[0];
  job.marked = false;
  for (int p = 0; p < job.planes; ++p)
    job.words[p] = bonds.plane(p, chunk.first / 32) + i;
  for (int c = 0; c < l.dimension; ++c)
  {
    job.u[c] = u.component(c) + i;
    job.v[c] = u.component(c) + j;
    if (bonds.corrected())
    {
      job.shareI[c] = bonds.shares(c) + i;
      job.shareJ[c] = bonds.shares(c) + j;
    }
  }
  job.unit = numbers.of(0) + chunk.first;
}

/// Sets the kind of a run.
/// @return the Path of its kernel
template <class Real>
int follow(RowJob<Real>& job, const BondNumbers<Real>& numbers, const Chunk& chunk, const Run& run) noexcept
{
  const bool uniform = run.kind != 255;
  job.uniformKind = uniform ? run.kind : 1;
  job.kind = numbers.of(job.uniformKind) + chunk.first;
  return uniform ? static_cast<int>(Uniform) : job.planes <= 3 ? job.planes : static_cast<int>(ManyPlanes);
}

} // namespace lamella::peridynamics
