#include "peridynamics/RimExchange.h"

#include <cstring>
#include <numeric>

namespace lamella::peridynamics
{
namespace
{

template <class T>
void copyRows(const NodeLayout& layout, T* data, std::int64_t from, std::int64_t to, std::int64_t rows)
{
  std::memcpy(
    data + layout.begin(to), data + layout.begin(from), static_cast<std::size_t>(rows * layout.pitch) * sizeof(T));
}

// Images at the sides that this rank has both of: of x in owned rows, then of y in space.
template <class T>
void wrap(const NodeLayout& layout, const std::array<bool, 3>& periodic, T* data)
{
  const std::int64_t g = layout.ghost;
  const auto [nx, ny, nz] = layout.size;
  if (periodic[0])
    for (std::int64_t z = 0; z < nz; ++z)
      for (std::int64_t y = 0; y < ny; ++y)
      {
        T* row = data + layout.index(0, y, z);
        for (std::int64_t k = 1; k <= g; ++k)
        {
          row[-k] = row[nx - k];
          row[nx + k - 1] = row[k - 1];
        }
      }
  if (layout.dimension == 3 && periodic[1])
    for (std::int64_t z = 0; z < nz; ++z)
    {
      copyRows(layout, data, layout.row(ny - g, z), layout.row(-g, z), g);
      copyRows(layout, data, layout.row(0, z), layout.row(ny, z), g);
    }
}

} // namespace

template <class T>
RimInFlight<T>::RimInFlight(
  const NodeLayout& layout, const std::array<bool, 3>& periodic, const Communicator& comm, std::span<T* const> arrays)
{
  for (T* data : arrays)
    wrap(layout, periodic, data);
  // the slowest axis: g layers of whole rows, in one piece
  const bool space = layout.dimension == 3;
  const std::size_t axis = space ? 2 : 1;
  const std::int64_t layer = space ? layout.rowsY() : 1; // in rows
  const std::int64_t g = layout.ghost;
  const std::int64_t n = layout.size[axis];
  const std::int64_t first = g * layer;                 // row of the first owned layer
  const std::int64_t lastOut = first + (n - g) * layer; // of the last g owned layers
  const std::int64_t high = first + n * layer;          // of the upper rim
  if (!comm.parallel())
  {
    if (periodic[axis])
      for (T* data : arrays)
      {
        copyRows(layout, data, lastOut, 0, g * layer);
        copyRows(layout, data, first, high, g * layer);
      }
    return;
  }
  const int size = comm.size();
  const int rank = comm.rank();
  const int up = rank + 1 < size ? rank + 1 : periodic[axis] ? 0 : MPI_PROC_NULL;
  const int down = rank > 0 ? rank - 1 : periodic[axis] ? size - 1 : MPI_PROC_NULL;
  low_ = down != MPI_PROC_NULL;
  high_ = up != MPI_PROC_NULL;
  MPI_Type_contiguous(static_cast<int>(layout.pitch * static_cast<std::int64_t>(sizeof(T))), MPI_BYTE, &row_);
  MPI_Type_commit(&row_);
  const int rows = static_cast<int>(g * layer);
  for (T* data : arrays)
  {
    MPI_Irecv(data + layout.begin(0), rows, row_, down, 71, comm.handle(), &requests_.emplace_back());
    MPI_Irecv(data + layout.begin(high), rows, row_, up, 72, comm.handle(), &requests_.emplace_back());
  }
  for (T* data : arrays)
  {
    MPI_Isend(data + layout.begin(lastOut), rows, row_, up, 71, comm.handle(), &requests_.emplace_back());
    MPI_Isend(data + layout.begin(first), rows, row_, down, 72, comm.handle(), &requests_.emplace_back());
  }
}

template <class T>
void RimInFlight<T>::poll()
{
  int done = 0;
  if (!requests_.empty())
    MPI_Testall(static_cast<int>(requests_.size()), requests_.data(), &done, MPI_STATUSES_IGNORE);
}

template <class T>
void RimInFlight<T>::finish()
{
  if (!requests_.empty())
    MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  requests_.clear();
  if (row_ != MPI_DATATYPE_NULL)
    MPI_Type_free(&row_);
}

template class RimInFlight<double>;
template class RimInFlight<float>;

template <class T>
void exchangeRim(const NodeLayout& layout, const std::array<bool, 3>& periodic, const Communicator& comm, T* data)
{
  RimInFlight<T>(layout, periodic, comm, std::span<T* const>(&data, 1));
}

template void exchangeRim(const NodeLayout&, const std::array<bool, 3>&, const Communicator&, double*);
template void exchangeRim(const NodeLayout&, const std::array<bool, 3>&, const Communicator&, float*);
template void exchangeRim(const NodeLayout&, const std::array<bool, 3>&, const Communicator&, std::uint8_t*);
template void exchangeRim(const NodeLayout&, const std::array<bool, 3>&, const Communicator&, std::int32_t*);

std::vector<std::int64_t> gather(const Communicator& comm, const std::vector<std::int64_t>& mine, int stride)
{
  if (!comm.parallel())
    return mine;
  MPI_Datatype entry = MPI_DATATYPE_NULL; // counts in entries: longer lists before an int overflows
  MPI_Type_contiguous(stride, MPI_INT64_T, &entry);
  MPI_Type_commit(&entry);
  const int own = static_cast<int>(mine.size()) / stride;
  std::vector<int> counts(static_cast<std::size_t>(comm.size()));
  MPI_Allgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, comm.handle());
  std::vector<int> begins(counts.size(), 0);
  std::partial_sum(counts.begin(), counts.end() - 1, begins.begin() + 1);
  std::vector<std::int64_t> values(
    static_cast<std::size_t>(begins.back() + counts.back()) * static_cast<std::size_t>(stride));
  MPI_Allgatherv(mine.data(), own, entry, values.data(), counts.data(), begins.data(), entry, comm.handle());
  MPI_Type_free(&entry);
  return values;
}

} // namespace lamella::peridynamics
