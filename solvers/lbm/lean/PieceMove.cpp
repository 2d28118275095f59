#include "lbm/lean/PieceMove.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace lamella::lbm
{
namespace
{

// f(place in a, place in b) of the blocks that both have, in one order
template <class F>
void forCommon(const Block& a, const Block& b, F&& f)
{
  const auto first = [&](std::size_t k) { return std::max(a.start[k], b.start[k]); };
  const auto last = [&](std::size_t k) { return std::min(a.start[k] + a.size[k], b.start[k] + b.size[k]); };
  const auto place = [](const Block& c, std::int64_t x, std::int64_t y, std::int64_t z)
  { return static_cast<std::size_t>(x + c.size[0] * (y - c.start[1] + c.size[1] * (z - c.start[2]))); };
  for (std::int64_t z = first(2); z < last(2); ++z)
    for (std::int64_t y = first(1); y < last(1); ++y)
      for (std::int64_t x = 0; x < a.size[0]; ++x)
        f(place(a, x, y, z), place(b, x, y, z));
}

using Words = std::vector<std::uint32_t>;

// What goes to some ranks for what comes from others, whose lengths are known. One's own is handed over.
void swapWords(const Communicator& comm, const std::vector<int>& to, std::vector<Words>& send,
  const std::vector<int>& from, std::vector<Words>& received)
{
  constexpr int tag = 10;
  std::vector<MPI_Request> requests;
  for (std::size_t k = 0; k < from.size(); ++k)
    if (from[k] != comm.rank())
      MPI_Irecv(received[k].data(), static_cast<int>(received[k].size()), MPI_UINT32_T, from[k], tag, comm.handle(),
        &requests.emplace_back());
  for (std::size_t k = 0; k < to.size(); ++k)
    if (to[k] != comm.rank())
      MPI_Isend(send[k].data(), static_cast<int>(send[k].size()), MPI_UINT32_T, to[k], tag, comm.handle(),
        &requests.emplace_back());
    else
      received[static_cast<std::size_t>(std::ranges::find(from, comm.rank()) - from.begin())] = std::move(send[k]);
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

} // namespace

PieceMove::PieceMove(const Communicator& comm, const std::vector<Block>& before, const std::vector<Block>& after,
  std::span<const std::uint32_t> start)
  : comm_(&comm)
{
  const auto rank = static_cast<std::size_t>(comm.rank());
  std::vector<int> to;
  std::vector<int> from;
  std::vector<Words> send;
  std::vector<Words> received;
  for (std::size_t r = 0; r < before.size(); ++r)
  {
    Words counts;
    Share leaving{ static_cast<int>(r), {} };
    forCommon(before[rank], after[r],
      [&](std::size_t block, std::size_t)
      {
        counts.push_back(start[block + 1] - start[block]);
        for (std::uint32_t i = start[block]; i < start[block + 1]; ++i)
          leaving.unknowns.push_back(i);
      });
    if (!counts.empty())
    {
      to.push_back(leaving.rank);
      send.push_back(std::move(counts));
      leaving_.push_back(std::move(leaving));
    }
    std::size_t coming = 0;
    forCommon(before[r], after[rank], [&](std::size_t, std::size_t) { ++coming; });
    if (coming > 0)
    {
      from.push_back(static_cast<int>(r));
      received.emplace_back(coming);
    }
  }
  swapWords(comm, to, send, from, received);
  start_.assign(static_cast<std::size_t>(after[rank].count()) + 1, 0);
  const auto forArriving = [&](auto&& f) // f(share, block, its number of unknowns)
  {
    for (std::size_t k = 0; k < from.size(); ++k)
    {
      std::size_t next = 0;
      forCommon(
        before[static_cast<std::size_t>(from[k])], after[rank],
        [&](std::size_t, std::size_t block) { f(k, block, received[k][next++]); });
    }
  };
  forArriving([&](std::size_t, std::size_t block, std::uint32_t count) { start_[block] = count; });
  std::uint32_t total = 0;
  for (auto& s : start_)
    s = std::exchange(total, total + s);
  for (const int r : from)
    arriving_.push_back({ r, {} });
  forArriving(
    [&](std::size_t k, std::size_t block, std::uint32_t count)
    {
      for (std::uint32_t i = 0; i < count; ++i)
        arriving_[k].unknowns.push_back(start_[block] + i);
    });
}

void PieceMove::moveRows(const Shares& from, const Shares& to, const std::uint32_t* rowFrom, const void* source,
  const std::uint32_t* rowTo, void* target) const
{
  const auto* in = static_cast<const std::byte*>(source);
  auto* out = static_cast<std::byte*>(target);
  const auto begin = [](const std::uint32_t* row, std::uint32_t i)
  { return std::size_t{ row == nullptr ? i : row[i] }; };
  const auto length = [](const std::uint32_t* row, std::uint32_t i)
  { return row == nullptr ? std::size_t{ 1 } : std::size_t{ row[i + 1] - row[i] }; };
  std::vector<int> toRanks;
  std::vector<int> fromRanks;
  std::vector<Words> send(from.size());
  std::vector<Words> received(to.size());
  for (std::size_t k = 0; k < from.size(); ++k)
  {
    toRanks.push_back(from[k].rank);
    std::size_t count = 0;
    for (const std::uint32_t i : from[k].unknowns)
      count += length(rowFrom, i);
    send[k].resize(count);
    std::size_t at = 0;
    for (const std::uint32_t i : from[k].unknowns)
    {
      std::memcpy(send[k].data() + at, in + 4 * begin(rowFrom, i), 4 * length(rowFrom, i));
      at += length(rowFrom, i);
    }
  }
  for (std::size_t k = 0; k < to.size(); ++k)
  {
    fromRanks.push_back(to[k].rank);
    std::size_t count = 0;
    for (const std::uint32_t i : to[k].unknowns)
      count += length(rowTo, i);
    received[k].resize(count);
  }
  swapWords(*comm_, toRanks, send, fromRanks, received);
  for (std::size_t k = 0; k < to.size(); ++k)
  {
    std::size_t at = 0;
    for (const std::uint32_t i : to[k].unknowns)
    {
      std::memcpy(out + 4 * begin(rowTo, i), received[k].data() + at, 4 * length(rowTo, i));
      at += length(rowTo, i);
    }
  }
}

void PieceMove::move(const Shares& from, const Shares& to, const void* source, void* target) const
{
  moveRows(from, to, nullptr, source, nullptr, target);
}

std::size_t PieceMove::bytes() const noexcept
{
  std::size_t total = start_.capacity();
  for (const Shares* shares : { &leaving_, &arriving_ })
    for (const Share& share : *shares)
      total += share.unknowns.capacity();
  return sizeof(std::uint32_t) * total;
}

} // namespace lamella::lbm
