#pragma once

#include "lbm/lean/Pieces.h"

#include <mpi.h>

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

/// What the parts of PieceMultigrid share: places of blocks and nodes, and loops over them.
namespace lamella::lbm
{

/// Loops of fewer blocks or unknowns are not worth another thread.
inline constexpr std::size_t threadedCount = 20000;

inline std::size_t blockCount(const std::array<std::int64_t, 3>& blocks)
{
  return static_cast<std::size_t>(blocks[0] * blocks[1] * blocks[2]);
}

inline void startsFromCounts(std::vector<std::uint32_t>& start)
{
  std::uint32_t before = 0;
  for (auto& s : start)
    s = std::exchange(before, before + s);
}

inline std::size_t blockIndex(const std::array<std::int64_t, 3>& blocks, const std::array<std::int64_t, 3>& p)
{
  return static_cast<std::size_t>(p[0] + blocks[0] * (p[1] + blocks[1] * p[2]));
}

/// A node's place in its block.
inline std::size_t nodeOf(const std::array<std::int64_t, 3>& p, std::int64_t edge)
{
  const std::int64_t last = edge - 1; // a power of two, less one
  return static_cast<std::size_t>((p[0] & last) + edge * ((p[1] & last) + edge * (p[2] & last)));
}

inline std::uint32_t labelOf(const std::uint32_t* labels, std::size_t node, std::int64_t edge)
{
  return edge == 2 ? (labels[0] >> (4 * node)) & 15 : (labels[node / 4] >> (8 * (node % 4))) & 255;
}

inline std::size_t labelWords(std::int64_t edge)
{
  return edge == 2 ? 1 : static_cast<std::size_t>(edge * edge * edge) / 4;
}

inline std::uint32_t apartIn(std::int64_t edge)
{
  return edge == 2 ? 15 : 255;
}

/// Of sets whose members point towards their least one.
inline std::uint32_t rootOf(std::vector<std::uint32_t>& parent, std::uint32_t i)
{
  while (parent[i] != i)
    i = parent[i] = parent[parent[i]];
  return i;
}

[[nodiscard]] RankShares sharesOf(const Communicator& comm, std::size_t mine);

/// The ranks' values in their order, on every rank. Four bytes each.
template <class T>
std::vector<T> gatherAll(const Communicator& comm, std::span<const T> mine, const RankShares& shares)
{
  static_assert(sizeof(T) == 4);
  std::vector<T> all(static_cast<std::size_t>(shares.starts.back()));
  MPI_Allgatherv(mine.data(), static_cast<int>(mine.size()), MPI_UINT32_T, all.data(), shares.counts.data(),
    shares.starts.data(), MPI_UINT32_T, comm.handle());
  return all;
}

template <class T>
std::vector<T> gatherAll(const Communicator& comm, std::span<const T> mine)
{
  return gatherAll(comm, mine, sharesOf(comm, mine.size()));
}

template <class F>
void PieceMultigrid::forBlockRows(const std::array<std::int64_t, 3>& blocks, F&& f) const
{
  const int threads = blockCount(blocks) < threadedCount ? 1 : threads_;
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(dynamic, 16)
  for (std::int64_t i = 0; i < blocks[1] * blocks[2]; ++i)
    f(i % blocks[1], i / blocks[1]);
}

template <class F>
void PieceMultigrid::forBlocks(const std::array<std::int64_t, 3>& blocks, F&& f) const
{
  forBlockRows(
    blocks,
    [&](std::int64_t by, std::int64_t bz)
    {
      for (std::int64_t bx = 0; bx < blocks[0]; ++bx)
        f(bx, by, bz, blockIndex(blocks, { bx, by, bz }));
    });
}

} // namespace lamella::lbm
