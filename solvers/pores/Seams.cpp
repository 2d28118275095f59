#include "pores/Seams.h"

#include <algorithm>
#include <cstddef>
#include <map>

namespace lamella::pores
{
namespace
{

void joint(std::vector<Joint>& joints, std::uint32_t a, std::uint32_t b, int x, int y, int z)
{
  const Joint found{ a, b, { static_cast<std::int8_t>(x), static_cast<std::int8_t>(y), static_cast<std::int8_t>(z) } };
  if (joints.empty() || joints.back() != found)
    joints.push_back(found);
}

} // namespace

Seams::Seams(const Lattice& lattice, const Block& block, const Communicator& comm, const LabelOptions& options,
  std::span<const Slab> slabs, std::span<const Neighbour> near, std::uint32_t offset)
  : lattice_(lattice)
  , block_(block)
  , comm_(comm)
  , options_(options)
  , slabs_(slabs)
  , near_(near)
  , rows_{ block.size[1], block.size[2] }
  , offset_(offset)
{
}

std::vector<Joint> Seams::joints() const
{
  std::vector<Joint> joints;
  joinEnds(joints);
  joinSides(joints);
  std::sort(joints.begin(), joints.end());
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  return joints;
}

/// Pieces of the row, counted over all ranks from 1, 0 outside: what ranks show each other.
void Seams::writeRow(std::int64_t row, std::span<std::uint32_t> out) const
{
  const Slab& slab = slabOf(slabs_, row);
  std::vector<std::int32_t> edges(static_cast<std::size_t>(block_.size[0] + 16));
  const std::int64_t runs = runKernels().edges(slab.row(row).bits, block_.size[0], edges.data());
  std::fill(out.begin(), out.end(), 0U);
  const auto piece = slab.piecesOfRow(row);
  for (std::int64_t i = 0; i < runs; ++i)
    std::fill(out.begin() + edges[static_cast<std::size_t>(2 * i)],
      out.begin() + edges[static_cast<std::size_t>(2 * i + 1)],
      offset_ + slab.ofBlock(piece[static_cast<std::size_t>(i)]) + 1);
}

/// Where the block's rows touch each other over the ends of x.
void Seams::joinEnds(std::vector<Joint>& joints) const
{
  if (!options_.periodic[0])
    return;
  const std::int64_t last = block_.size[0] - 1;
  const auto touch = [&](std::int64_t pieceA, std::int64_t pieceB, int x)
  {
    if (pieceA >= 0 && pieceB >= 0)
      joint(
        joints, offset_ + static_cast<std::uint32_t>(pieceA), offset_ + static_cast<std::uint32_t>(pieceB), x, 0, 0);
  };
  for (std::int64_t row = 0; row < rows_.count(); ++row)
  {
    const Slab& slab = slabOf(slabs_, row);
    const std::int64_t begin = slab.at(row, 0);
    const std::int64_t end = slab.at(row, last);
    touch(begin, end, -1);
    for (const Neighbour& n : near_)
      if (const std::int64_t other = n.diagonal ? rows_.inside(row, n) : -1; other >= 0)
      {
        const Slab& there = slabOf(slabs_, other);
        touch(begin, there.at(other, last), -1);
        touch(end, there.at(other, 0), 1);
      }
  }
}

/// Where rows at the block's sides touch rows beyond: other ranks', or over the ends of y and z.
void Seams::joinSides(std::vector<Joint>& joints) const
{
  const bool wraps = options_.periodic[1] || (lattice_.dimension == 3 && options_.periodic[2]);
  if (!comm_.parallel() && !wraps)
    return;
  const Decomposition parts(lattice_, comm_);
  const Halo halo(lattice_.dimension, block_.size, parts, comm_, options_.periodic);
  const auto nx = static_cast<std::size_t>(block_.size[0]);
  const std::int64_t ny = block_.size[1];
  const std::int64_t nz = block_.size[2];
  // Rows of the outer layers, ours and those beyond, by their number in the halo.
  std::map<std::int64_t, std::vector<std::uint32_t>> layer;
  const auto rowAt = [&](std::int64_t y, std::int64_t z) -> std::vector<std::uint32_t>&
  {
    std::vector<std::uint32_t>& values = layer[halo.row(y, z)];
    if (values.empty())
    {
      values.assign(nx, 0);
      if (y >= 0 && y < ny && z >= 0 && z < nz)
        writeRow(y + ny * z, values);
    }
    return values;
  };
  const std::int64_t ghost = lattice_.dimension == 3 ? 1 : 0;
  halo.exchange(
    [&](std::int64_t row)
    {
      const std::int64_t y = row % (ny + 2) - 1;
      const std::int64_t z = row / (ny + 2) - ghost;
      return Halo::Segment{ reinterpret_cast<std::byte*>(rowAt(y, z).data()), nx * sizeof(std::uint32_t) };
    });
  for (std::int64_t row = 0; row < rows_.count(); ++row)
  {
    const auto [y, z] = rows_.place(row);
    for (const Neighbour& n : near_)
    {
      if (rows_.inside(row, n) >= 0)
        continue;
      std::array<int, 3> shift{ 0, 0, 0 };
      bool exists = true;
      const std::array<std::int64_t, 3> at{ 0, block_.start[1] + y + n.y, block_.start[2] + z + n.z };
      for (std::size_t axis = 1; axis < 3; ++axis)
      {
        shift[axis] = at[axis] < 0 ? -1 : at[axis] >= lattice_.size[axis] ? 1 : 0;
        exists = exists && (shift[axis] == 0 || options_.periodic[axis]);
      }
      if (exists)
        joinRows(rowAt(y, z), rowAt(y + n.y, z + n.z), n.diagonal, shift, joints);
    }
  }
}

/// @param a, b pieces by node, from 1; 0 outside
void Seams::joinRows(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b, bool diagonal,
  const std::array<int, 3>& shift, std::vector<Joint>& joints) const
{
  const auto n = static_cast<std::int64_t>(a.size());
  const int reach = diagonal ? 1 : 0;
  for (std::int64_t x = 0; x < n; ++x)
  {
    const std::uint32_t own = a[static_cast<std::size_t>(x)];
    if (own == 0)
      continue;
    for (int step = -reach; step <= reach; ++step)
    {
      const std::int64_t other = x + step;
      const int wrap = other < 0 ? -1 : other >= n ? 1 : 0;
      if (wrap != 0 && !options_.periodic[0])
        continue;
      if (const std::uint32_t piece = b[static_cast<std::size_t>(other - wrap * n)]; piece != 0)
        joint(joints, own - 1, piece - 1, wrap, shift[1], shift[2]);
    }
  }
}

} // namespace lamella::pores
