#include "lbm/lean/PieceHalo.h"

#include <cstring>

namespace lamella::lbm
{
namespace
{

// Places of the blocks along a side, in order.
std::vector<std::size_t> blocksAlong(const std::array<std::int64_t, 3>& blocks, std::size_t side)
{
  const bool above = side % 2 == 1;
  const std::size_t axis = PieceHalo::axisOf(side);
  const std::int64_t layer = above ? blocks[axis] - 1 : 0;
  std::vector<std::size_t> places;
  for (std::int64_t i = 0; i < (axis == 1 ? blocks[2] : blocks[1]); ++i)
    for (std::int64_t x = 0; x < blocks[0]; ++x)
      places.push_back(
        static_cast<std::size_t>(x + blocks[0] * (axis == 1 ? layer + blocks[1] * i : i + blocks[1] * layer)));
  return places;
}

} // namespace

PieceHalo::PieceHalo(const Communicator& comm, const Decomposition& parts, const std::array<bool, 3>& periodic,
  const std::array<std::int64_t, 3>& blocks, std::span<const std::uint32_t> start)
  : blocks_(blocks)
{
  for (std::size_t side = 0; side < sides; ++side)
  {
    const auto axis = static_cast<int>(axisOf(side));
    const int other = parts.neighbour(axis, side % 2 == 1 ? 1 : -1, periodic[axisOf(side)]);
    if (other >= 0 && other != comm.rank())
      rank_[side] = other;
    if (has(side))
      comm_ = &comm;
  }
  if (!parallel())
    return;
  std::vector<std::uint32_t> counts(start.size() - 1);
  for (std::size_t i = 0; i < counts.size(); ++i)
    counts[i] = start[i + 1] - start[i];
  const auto beyond = ofBlocks(counts);
  std::uint32_t next = start.back();
  for (std::size_t side = 0; side < sides; ++side)
  {
    if (!has(side))
      continue;
    for (const std::size_t block : blocksAlong(blocks_, side))
      for (std::uint32_t i = start[block]; i < start[block + 1]; ++i)
        along_[side].push_back(i);
    for (const std::uint32_t count : beyond[side])
    {
      start_[side].push_back(next);
      next += count;
    }
    start_[side].push_back(next);
  }
  ghosts_ = next - start.back();
}

std::size_t PieceHalo::sideWith(std::uint32_t ghost) const noexcept
{
  std::size_t side = 0;
  while (!has(side) || ghost < start_[side].front() || ghost >= start_[side].back())
    ++side;
  return side;
}

std::array<std::vector<std::uint32_t>, PieceHalo::sides> PieceHalo::ofBlocks(
  std::span<const std::uint32_t> byBlock, std::size_t each) const
{
  std::array<std::vector<std::uint32_t>, sides> mine;
  for (std::size_t side = 0; side < sides; ++side)
    if (has(side))
      for (const std::size_t block : blocksAlong(blocks_, side))
        for (std::size_t k = 0; k < each; ++k)
          mine[side].push_back(byBlock[each * block + k]);
  return swap(mine);
}

// What goes up arrives from below.
std::array<std::vector<std::uint32_t>, PieceHalo::sides> PieceHalo::swap(
  const std::array<std::vector<std::uint32_t>, sides>& mine) const
{
  std::array<std::vector<std::uint32_t>, sides> theirs;
  std::vector<MPI_Request> requests;
  for (std::size_t side = 0; side < sides; ++side)
    if (has(side))
      MPI_Isend(mine[side].data(), static_cast<int>(mine[side].size()), MPI_UINT32_T, rank_[side],
        static_cast<int>(side), comm_->handle(), &requests.emplace_back());
  for (std::size_t side = 0; side < sides; ++side)
    if (has(side))
    {
      const int tag = static_cast<int>(side ^ 1);
      MPI_Status status;
      MPI_Probe(rank_[side], tag, comm_->handle(), &status);
      int count = 0;
      MPI_Get_count(&status, MPI_UINT32_T, &count);
      theirs[side].resize(static_cast<std::size_t>(count));
      MPI_Recv(theirs[side].data(), count, MPI_UINT32_T, rank_[side], tag, comm_->handle(), MPI_STATUS_IGNORE);
    }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  return theirs;
}

void PieceHalo::exchange(std::byte* values) const
{
  std::array<MPI_Request, 2 * sides> requests;
  int count = 0;
  for (std::size_t side = 0; side < sides; ++side)
    if (has(side))
      MPI_Irecv(values + std::size_t{ 4 } * start_[side].front(),
        static_cast<int>(start_[side].back() - start_[side].front()), MPI_UINT32_T, rank_[side],
        static_cast<int>(side ^ 1), comm_->handle(), &requests[static_cast<std::size_t>(count++)]);
  for (std::size_t side = 0; side < sides; ++side)
    if (has(side))
    {
      std::vector<std::uint32_t>& send = send_[side];
      send.resize(along_[side].size());
      for (std::size_t i = 0; i < send.size(); ++i)
        std::memcpy(&send[i], values + std::size_t{ 4 } * along_[side][i], 4);
      MPI_Isend(send.data(), static_cast<int>(send.size()), MPI_UINT32_T, rank_[side], static_cast<int>(side),
        comm_->handle(), &requests[static_cast<std::size_t>(count++)]);
    }
  MPI_Waitall(count, requests.data(), MPI_STATUSES_IGNORE);
}

std::size_t PieceHalo::bytes() const noexcept
{
  std::size_t total = 0;
  for (std::size_t side = 0; side < sides; ++side)
    total += sizeof(std::uint32_t) * (start_[side].capacity() + along_[side].capacity() + send_[side].capacity());
  return total;
}

} // namespace lamella::lbm
