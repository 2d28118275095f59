#include "lattice/Decomposition.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

namespace lamella
{
namespace
{

// Part i of n over `rows`, beginning at multiples of `alignment`.
std::int64_t partStart(std::int64_t rows, int i, int n, std::int64_t alignment)
{
  if (i >= n)
    return rows;
  const std::int64_t units = (rows + alignment - 1) / alignment;
  return std::min(rows, units * i / n * alignment);
}

std::int64_t largestPart(std::int64_t rows, int n, std::int64_t alignment)
{
  std::int64_t largest = 0;
  for (int i = 0; i < n; ++i)
    largest = std::max(largest, partStart(rows, i + 1, n, alignment) - partStart(rows, i, n, alignment));
  return largest;
}

bool everyPartHasRows(std::int64_t rows, int n, std::int64_t alignment)
{
  for (int i = 0; i < n; ++i)
    if (partStart(rows, i + 1, n, alignment) <= partStart(rows, i, n, alignment))
      return false;
  return true;
}

} // namespace

Decomposition::Decomposition(const Lattice& lattice, const Communicator& comm, double unevenness)
  : lattice_(lattice)
  , rank_(comm.rank())
{
  const int ranks = comm.size();
  const std::int64_t ny = lattice.size[1];
  const std::int64_t nz = lattice.size[2];

  // The split with the smallest halo; z first, since its planes are contiguous.
  std::int64_t best = std::numeric_limits<std::int64_t>::max();
  for (int pz = 1; pz <= ranks; ++pz)
  {
    if (ranks % pz != 0 || pz > nz || ranks / pz > ny)
      continue;
    const int py = ranks / pz;
    const std::int64_t halo = (pz - 1) * ny + (py - 1) * nz;
    if (halo <= best) // the last of equals has the most parts along z
    {
      best = halo;
      parts_ = { 1, py, pz };
    }
  }
  if (best == std::numeric_limits<std::int64_t>::max())
    throw ParameterError(fmt::format("{} ranks cannot share {} rows of the lattice ({} × {} × {} nodes)", ranks,
                           ny * nz, lattice.size[0], ny, nz),
      "start fewer ranks: every rank needs at least one row along x");

  // The largest alignment whose largest part is even enough; an even number of rows, which a multigrid that halves them
  // needs, is worth two rows more.
  constexpr double enoughRows = 8;
  for (const int levels : { 7, 6, 5, 4, 3, 2, 1, 0 })
  {
    const std::int64_t alignment = std::int64_t{ 1 } << levels;
    bool good = true;
    for (const int axis : { 1, 2 })
      if (parts_[axis] > 1)
      {
        const double even = static_cast<double>(lattice.size[axis]) / parts_[axis];
        good = good && everyPartHasRows(lattice.size[axis], parts_[axis], alignment) &&
          ((levels == 1 && even >= enoughRows) ||
            static_cast<double>(largestPart(lattice.size[axis], parts_[axis], alignment)) <= (1 + unevenness) * even);
      }
    if (good || levels == 0)
    {
      alignment_ = alignment;
      levels_ = levels;
      break;
    }
  }
  block_ = block(rank_);
}

Block Decomposition::block(int rank) const
{
  Block b;
  const std::array<int, 3> position{ 0, rank % parts_[1], rank / parts_[1] };
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto n = lattice_.size[axis];
    b.start[axis] = partStart(n, position[axis], parts_[axis], parts_[axis] > 1 ? alignment_ : 1);
    b.size[axis] = partStart(n, position[axis] + 1, parts_[axis], parts_[axis] > 1 ? alignment_ : 1) - b.start[axis];
  }
  return b;
}

int Decomposition::neighbour(int axis, int step, bool periodic) const
{
  std::array<int, 3> position{ 0, rank_ % parts_[1], rank_ / parts_[1] };
  position[axis] += step;
  if (position[axis] < 0 || position[axis] >= parts_[axis])
  {
    if (!periodic)
      return -1;
    position[axis] = (position[axis] + parts_[axis]) % parts_[axis];
  }
  return position[1] + parts_[1] * position[2];
}

Block decompose(const Lattice& lattice, MPI_Comm comm)
{
  return Decomposition(lattice, Communicator(comm)).block();
}

Halo::Halo(int dimension, std::array<std::int64_t, 3> size, const Decomposition& parts, const Communicator& comm,
  std::array<bool, 3> periodic)
  : comm_(&comm)
  , size_(size)
  , ghostZ_(dimension == 3 ? 1 : 0)
{
  for (const int axis : { 1, 2 })
    if (axis == 1 || dimension == 3)
      neighbour_[axis] = { parts.neighbour(axis, -1, periodic[axis]), parts.neighbour(axis, +1, periodic[axis]) };
}

// Moves data along `step`: for +1 the last layer of the lower neighbour becomes the ghost layer -1 here. Layers of z
// take the ghost rows of y along: beyond the box those belong to nobody else.
std::vector<Halo::RowPair> Halo::rowPairs(int axis, int step) const
{
  const std::int64_t n = size_[static_cast<std::size_t>(axis)];
  const std::int64_t sendLayer = step > 0 ? n - 1 : 0;
  const std::int64_t receiveLayer = step > 0 ? -1 : n;
  std::vector<RowPair> rows;
  if (axis == 2)
    for (std::int64_t y = -1; y <= size_[1]; ++y)
      rows.push_back({ row(y, sendLayer), row(y, receiveLayer) });
  else
    for (std::int64_t z = -ghostZ_; z < size_[2] + ghostZ_; ++z)
      rows.push_back({ row(sendLayer, z), row(receiveLayer, z) });
  return rows;
}

void Halo::exchange(const RowSegment& segment) const
{
  for (const int axis : { 2, 1 })
  {
    const auto& neighbours = neighbour_[static_cast<std::size_t>(axis)];
    if (neighbours[0] < 0 && neighbours[1] < 0)
      continue;
    if (neighbours[0] == comm_->rank() && neighbours[1] == comm_->rank())
    {
      for (const int step : { +1, -1 })
        for (const auto& [source, target] : rowPairs(axis, step))
        {
          const Segment s = segment(source);
          std::memmove(segment(target).data, s.data, s.bytes);
        }
      continue;
    }
    // both ways at once: one wait an axis
    struct Way
    {
      std::vector<RowPair> rows;
      std::vector<std::byte> send;
      std::vector<std::byte> receive;
    };
    std::array<Way, 2> ways;
    std::vector<MPI_Request> requests;
    for (const int step : { +1, -1 })
    {
      Way& way = ways[step > 0 ? 0 : 1];
      const int from = neighbours[step > 0 ? 0 : 1];
      way.rows = rowPairs(axis, step);
      if (from < 0)
        continue;
      std::size_t bytes = 0;
      for (const auto& pair : way.rows)
        bytes += segment(pair.target).bytes;
      way.receive.resize(bytes);
      MPI_Irecv(way.receive.data(), static_cast<int>(bytes), MPI_BYTE, from, step > 0 ? 7 : 8, comm_->handle(),
        &requests.emplace_back());
    }
    for (const int step : { +1, -1 })
    {
      Way& way = ways[step > 0 ? 0 : 1];
      const int to = neighbours[step > 0 ? 1 : 0];
      if (to < 0)
        continue;
      for (const auto& pair : way.rows)
      {
        const Segment s = segment(pair.source);
        way.send.insert(way.send.end(), s.data, s.data + s.bytes);
      }
      MPI_Isend(way.send.data(), static_cast<int>(way.send.size()), MPI_BYTE, to, step > 0 ? 7 : 8, comm_->handle(),
        &requests.emplace_back());
    }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    for (const Way& way : ways)
    {
      const std::byte* from = way.receive.data();
      for (std::size_t i = 0; !way.receive.empty() && i < way.rows.size(); ++i)
      {
        const Segment s = segment(way.rows[i].target);
        std::memcpy(s.data, from, s.bytes);
        from += s.bytes;
      }
    }
  }
}

void Halo::exchange(void* base, std::size_t rowBytes) const
{
  const auto& along = neighbour_[2];
  const auto& across = neighbour_[1];
  if (along[0] < 0 && along[1] < 0 && across[0] < 0 && across[1] < 0)
    return; // alone; perhaps without MPI
  const bool planesOnly = ghostZ_ > 0 && across[0] < 0 && across[1] < 0;
  const bool elsewhere = along[0] != comm_->rank() && along[1] != comm_->rank();
  if (planesOnly && elsewhere)
  {
    // planes of rows are contiguous: no copying
    const std::size_t plane = static_cast<std::size_t>(size_[1] + 2) * rowBytes;
    const auto at = [&](std::int64_t z)
    { return static_cast<std::byte*>(base) + static_cast<std::size_t>(z + 1) * plane; };
    const int count = static_cast<int>(plane);
    std::array<MPI_Request, 4> requests;
    int n = 0;
    const auto handle = comm_->handle();
    if (along[0] >= 0)
      MPI_Irecv(at(-1), count, MPI_BYTE, along[0], 7, handle, &requests[static_cast<std::size_t>(n++)]);
    if (along[1] >= 0)
      MPI_Irecv(at(size_[2]), count, MPI_BYTE, along[1], 8, handle, &requests[static_cast<std::size_t>(n++)]);
    if (along[1] >= 0)
      MPI_Isend(at(size_[2] - 1), count, MPI_BYTE, along[1], 7, handle, &requests[static_cast<std::size_t>(n++)]);
    if (along[0] >= 0)
      MPI_Isend(at(0), count, MPI_BYTE, along[0], 8, handle, &requests[static_cast<std::size_t>(n++)]);
    MPI_Waitall(n, requests.data(), MPI_STATUSES_IGNORE);
    return;
  }
  exchange(
    [base, rowBytes](std::int64_t r) {
      return Segment{ static_cast<std::byte*>(base) + static_cast<std::size_t>(r) * rowBytes, rowBytes };
    });
}

void Halo::addHighGhosts(float* base, std::size_t rowLength) const
{
  // y first, ghosts of z included, then z: the reverse of exchange(), so that corners arrive.
  for (const int axis : { 1, 2 })
  {
    const int to = neighbour_[axis][1];
    const int from = neighbour_[axis][0];
    if (to < 0 && from < 0)
      continue;
    std::vector<std::pair<std::int64_t, std::int64_t>> rows; // (ghost to send, row to add to)
    if (axis == 1)
      for (std::int64_t z = -ghostZ_; z < size_[2] + ghostZ_; ++z)
        rows.emplace_back(row(size_[1], z), row(0, z));
    else
      for (std::int64_t y = -1; y <= size_[1]; ++y)
        rows.emplace_back(row(y, size_[2]), row(y, 0));

    std::vector<float> send(to >= 0 ? rows.size() * rowLength : 0);
    std::vector<float> receive(from >= 0 ? rows.size() * rowLength : 0);
    for (std::size_t i = 0; to >= 0 && i < rows.size(); ++i)
      std::copy_n(base + static_cast<std::size_t>(rows[i].first) * rowLength, rowLength, send.data() + i * rowLength);
    if (to == comm_->rank() && from == comm_->rank())
      receive = send;
    else
      MPI_Sendrecv(send.data(), static_cast<int>(send.size()), MPI_FLOAT, to >= 0 ? to : MPI_PROC_NULL, 8,
        receive.data(), static_cast<int>(receive.size()), MPI_FLOAT, from >= 0 ? from : MPI_PROC_NULL, 8,
        comm_->handle(), MPI_STATUS_IGNORE);
    for (std::size_t i = 0; from >= 0 && i < rows.size(); ++i)
    {
      float* target = base + static_cast<std::size_t>(rows[i].second) * rowLength;
      const float* source = receive.data() + i * rowLength;
      for (std::size_t k = 0; k < rowLength; ++k)
        target[k] += source[k];
    }
  }
}

} // namespace lamella
