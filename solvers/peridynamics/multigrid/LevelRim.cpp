#include "peridynamics/multigrid/LevelRim.h"

#include "peridynamics/RimExchange.h"

#include <algorithm>
#include <vector>

namespace lamella::peridynamics
{

LevelRim::LevelRim(const NodeLayout& layout, const std::array<bool, 3>& periodic, const Communicator& comm)
  : layout_(layout)
  , periodic_(periodic)
  , comm_(&comm)
{
  const int ranks = comm.size();
  const bool ring = periodic_[static_cast<std::size_t>(slowest())];
  if (comm.rank() > 0 || ring)
    below_ = (comm.rank() + ranks - 1) % ranks;
  if (comm.rank() + 1 < ranks || ring)
    above_ = (comm.rank() + 1) % ranks;
}

namespace
{

template <class Real>
MPI_Datatype mpiType();
template <>
MPI_Datatype mpiType<float>()
{
  return MPI_FLOAT;
}

/// Sends to one neighbour what comes from the other; -1: nobody.
template <class Real>
void pass(const Communicator& comm, const Real* source, int to, Real* target, int from, std::int64_t count)
{
  if (to == comm.rank() && from == comm.rank())
  {
    std::copy_n(source, count, target);
    return;
  }
  MPI_Sendrecv(source, static_cast<int>(count), mpiType<Real>(), to < 0 ? MPI_PROC_NULL : to, 0, target,
    static_cast<int>(count), mpiType<Real>(), from < 0 ? MPI_PROC_NULL : from, 0, comm.handle(), MPI_STATUS_IGNORE);
}

} // namespace

template <class Real>
void LevelRim::fill(NodeField<Real>& field) const
{
  std::vector<Real*> arrays; // all at once: one wait
  for (int c = 0; c < field.components(); ++c)
    arrays.push_back(field.component(c));
  RimInFlight<Real>(layout_, periodic_, *comm_, arrays);
}

template <class Real>
void LevelRim::addBack(NodeField<Real>& field) const
{
  const NodeLayout& l = layout_;
  const std::int64_t g = l.ghost;
  const std::int64_t nx = l.size[0];
  const std::int64_t ny = l.size[1];
  const std::int64_t layer = (l.dimension == 3 ? l.rowsY() : 1) * l.pitch;
  const std::int64_t n = l.size[static_cast<std::size_t>(slowest())];
  std::vector<Real> come(static_cast<std::size_t>(layer), Real(0));
  const auto wrapped = [](std::int64_t i, std::int64_t size) { return ((i % size) + size) % size; };
  for (int c = 0; c < field.components(); ++c)
  {
    Real* v = field.component(c) + l.begin(0);
    if (below_ >= 0 || above_ >= 0)
    {
      pass(*comm_, v + (g + n) * layer, above_, come.data(), below_, layer);
      for (std::size_t i = 0; i < come.size(); ++i)
        v[g * layer + static_cast<std::int64_t>(i)] += come[i];
    }
    if (l.dimension == 3 && periodic_[1])
      for (std::int64_t z = 0; z < l.size[2]; ++z)
        for (std::int64_t y = -g; y < ny + g; ++y)
          if (y < 0 || y >= ny)
          {
            const Real* from = v + l.row(y, z) * l.pitch;
            Real* to = v + l.row(wrapped(y, ny), z) * l.pitch;
            for (std::int64_t i = 0; i < l.pitch; ++i)
              to[i] += from[i];
          }
    if (periodic_[0])
      for (std::int64_t z = 0; z < l.size[2]; ++z)
        for (std::int64_t y = 0; y < ny; ++y)
        {
          Real* row = field.component(c) + l.index(0, y, z);
          for (std::int64_t i = 0; i < g; ++i)
          {
            row[wrapped(-1 - i, nx)] += row[-1 - i];
            row[i % nx] += row[nx + i];
          }
        }
  }
}

template void LevelRim::fill(NodeField<float>&) const;
template void LevelRim::addBack(NodeField<float>&) const;

} // namespace lamella::peridynamics
