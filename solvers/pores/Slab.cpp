#include "pores/Slab.h"

#include "pores/Forest.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <numeric>

namespace lamella::pores
{
namespace
{

/// Values by piece of the block as values by piece of the slab.
template <typename Value>
std::vector<Value> bySlab(std::span<const Value> ofBlock, std::span<const std::uint32_t> blockPiece)
{
  std::vector<Value> values(blockPiece.size());
  std::transform(
    blockPiece.begin(), blockPiece.end(), values.begin(), [&](std::uint32_t piece) { return ofBlock[piece]; });
  return values;
}

template <typename Value, typename Kernel>
void fillRows(
  const Slab& slab, Kernel kernel, std::span<const Value> ofBlock, Value background, std::int64_t nx, Value* block)
{
  std::vector<Value> own;
  if (!slab.blockPiece.empty())
    own = bySlab<Value>(ofBlock, slab.blockPiece);
  const Value* const value = slab.blockPiece.empty() ? ofBlock.data() : own.data();
  std::vector<std::int32_t> edges(static_cast<std::size_t>(nx + 16));
  const std::int64_t end = slab.firstRow + slab.rows;
  for (std::int64_t r = slab.firstRow; r < end; ++r)
  {
    const std::int64_t runs = runKernels().edges(slab.row(r).bits, nx, edges.data());
    kernel(edges.data(), runs, slab.piecesOfRow(r).data(), value, background, block + r * nx, nx, (end - r) * nx);
  }
}

} // namespace

std::vector<Neighbour> neighbours(int connectivity)
{
  switch (connectivity)
  {
    case 4:
      return { { -1, 0, false } };
    case 8:
      return { { -1, 0, true } };
    case 6:
      return { { -1, 0, false }, { 0, -1, false } };
    case 18:
      return { { -1, 0, true }, { 0, -1, true }, { -1, -1, false }, { 1, -1, false } };
    default:
      return { { -1, 0, true }, { 0, -1, true }, { -1, -1, true }, { 1, -1, true } };
  }
}

void Slab::label(const Lattice& lattice, const std::array<std::int64_t, 3>& start, const Rows& block,
  std::span<const std::uint8_t> phase, std::uint8_t wanted, std::span<const Neighbour> near)
{
  const RunKernels& kernels = runKernels();
  const std::int64_t nx = lattice.size[0];
  bits.resize(static_cast<std::size_t>(rows * words));
  before.resize(bits.size());
  firstRun.assign(1, 0);
  firstRun.reserve(static_cast<std::size_t>(rows + 1));
  std::uint32_t runs = 0;
  for (std::int64_t r = 0; r < rows; ++r)
  {
    const auto at = static_cast<std::size_t>(r * words);
    const std::int64_t first = (firstRow + r) * nx;
    const std::int64_t readable = static_cast<std::int64_t>(phase.size()) - first;
    runs = kernels.scan(phase.data() + first, nx, readable, wanted, bits.data() + at, before.data() + at, runs);
    firstRun.push_back(runs);
  }
  pieceOf.resize(runs);
  for (std::int64_t blockRow = firstRow; blockRow < firstRow + rows; ++blockRow)
  {
    const auto first = firstRun[static_cast<std::size_t>(blockRow - firstRow)];
    const auto own = static_cast<std::ptrdiff_t>(piecesOfRow(blockRow).size());
    std::iota(pieceOf.begin() + first, pieceOf.begin() + first + own, first);
    for (const Neighbour& n : near)
      if (const std::int64_t other = block.inside(blockRow, n); other >= firstRow)
        kernels.unite(row(blockRow), row(other), words, n.diagonal, pieceOf.data());
  }
  count = numberRoots(pieceOf);
  pieces.resize(count + 1); // and one to work on
  sizes.resize(pieces.size());
  std::uint32_t known = 0;
  std::vector<std::int32_t> edges(static_cast<std::size_t>(nx + 16));
  for (std::int64_t blockRow = firstRow; blockRow < firstRow + rows; ++blockRow)
  {
    const std::int64_t found = kernels.edges(row(blockRow).bits, nx, edges.data());
    const auto [rowY, rowZ] = block.place(blockRow);
    const std::int64_t y = start[1] + rowY;
    const std::int64_t z = start[2] + rowZ;
    known = kernels.measure(edges.data(), found, piecesOfRow(blockRow).data(), known, lattice.index(0, y, z),
      static_cast<std::int32_t>(y), static_cast<std::int32_t>(z), pieces.data(), sizes.data());
  }
  pieces.pop_back();
  sizes.pop_back();
}

std::int64_t Slab::at(std::int64_t blockRow, std::int64_t x) const noexcept
{
  const Row r = row(blockRow);
  const std::int64_t w = x / 64;
  const std::uint64_t node = std::uint64_t{ 1 } << (x % 64);
  if ((r.bits[w] & node) == 0)
    return -1;
  const std::uint64_t last = w > 0 ? r.bits[w - 1] >> 63 : 0;
  const std::uint64_t begin = r.bits[w] & ~(r.bits[w] << 1 | last);
  const auto run = r.before[w] + static_cast<std::uint32_t>(std::popcount(begin & (node | (node - 1)))) - 1;
  return ofBlock(pieceOf[run]);
}

void Slab::fill(
  std::span<const std::int32_t> ofBlock, std::int32_t background, std::int64_t nx, std::int32_t* block) const
{
  fillRows(*this, runKernels().fillLabels, ofBlock, background, nx, block);
}

void Slab::fill(std::span<const float> ofBlock, float background, std::int64_t nx, float* block) const
{
  fillRows(*this, runKernels().fillSizes, ofBlock, background, nx, block);
}

const Slab& slabOf(std::span<const Slab> slabs, std::int64_t row)
{
  const auto after = std::upper_bound(slabs.begin(), slabs.end(), row,
    [](std::int64_t wantedRow, const Slab& slab) { return wantedRow < slab.firstRow; });
  return *std::prev(after);
}

} // namespace lamella::pores
