#include "lattice/Redistribution.h"

#include <algorithm>
#include <utility>

namespace lamella
{

Redistribution::Redistribution(int dimension, std::array<std::int64_t, 3> size, std::vector<Block> before,
  std::vector<Block> after, const Communicator& comm, int ghosts)
  : ghostY_(ghosts)
  , ghostZ_(dimension == 3 ? ghosts : 0)
  , size_(size)
  , before_(std::move(before))
  , after_(std::move(after))
  , comm_(&comm)
{
}

Redistribution::Range Redistribution::padded(const Block& block) const
{
  const auto along = [&](std::size_t axis, std::int64_t ghost) -> std::array<std::int64_t, 2>
  {
    const std::int64_t first = block.start[axis];
    const std::int64_t last = first + block.size[axis];
    return { first == 0 ? -ghost : first, last == size_[axis] ? last + ghost : last };
  };
  return { along(1, ghostY_), along(2, ghostZ_) };
}

void Redistribution::move(const std::vector<Block>& from, const std::vector<Block>& to, const std::byte* source,
  std::byte* target, std::size_t rowBytes) const
{
  const auto rank = static_cast<std::size_t>(comm_->rank());
  // f(index of the row in the padded array of `home`) for all rows that both ranges have
  const auto forCommon = [&](const Block& one, const Block& other, const Block& home, auto&& f)
  {
    const Range a = padded(one);
    const Range b = padded(other);
    for (std::int64_t z = std::max(a.z[0], b.z[0]); z < std::min(a.z[1], b.z[1]); ++z)
      for (std::int64_t y = std::max(a.y[0], b.y[0]); y < std::min(a.y[1], b.y[1]); ++y)
        f(static_cast<std::size_t>(
          (z - home.start[2] + ghostZ_) * (home.size[1] + 2 * ghostY_) + y - home.start[1] + ghostY_));
  };
  const std::size_t ranks = from.size();
  MPI_Datatype row = MPI_DATATYPE_NULL; // a count of bytes might be more than an int
  MPI_Type_contiguous(static_cast<int>(rowBytes), MPI_BYTE, &row);
  MPI_Type_commit(&row);
  // Only those that have rows in common: a collective would take as many messages as there are ranks.
  std::vector<std::vector<std::byte>> send(ranks);
  std::vector<std::vector<std::byte>> received(ranks);
  std::vector<MPI_Request> requests;
  for (std::size_t r = 0; r < ranks; ++r)
  {
    std::size_t rows = 0;
    forCommon(from[r], to[rank], to[rank], [&](std::size_t) { ++rows; });
    received[r].resize(rows * rowBytes);
    if (rows > 0 && r != rank)
      MPI_Irecv(received[r].data(), static_cast<int>(rows), row, static_cast<int>(r), 9, comm_->handle(),
        &requests.emplace_back());
  }
  for (std::size_t r = 0; r < ranks; ++r)
  {
    forCommon(from[rank], to[r], from[rank],
      [&](std::size_t at) { send[r].insert(send[r].end(), source + at * rowBytes, source + (at + 1) * rowBytes); });
    if (r == rank)
      received[r] = std::move(send[r]);
    else if (!send[r].empty())
      MPI_Isend(send[r].data(), static_cast<int>(send[r].size() / rowBytes), row, static_cast<int>(r), 9,
        comm_->handle(), &requests.emplace_back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  MPI_Type_free(&row);
  for (std::size_t r = 0; r < ranks; ++r)
  {
    const std::byte* next = received[r].data();
    forCommon(from[r], to[rank], to[rank],
      [&](std::size_t at)
      {
        std::copy_n(next, rowBytes, target + at * rowBytes);
        next += rowBytes;
      });
  }
}

} // namespace lamella
