#include "lbm/Connectivity.h"

#include <numeric>

namespace lamella::lbm
{
namespace
{

using LinkPosition = std::array<std::int64_t, 3>;

NodeSet conductingNodes(const Block& block, const Halo& halo, const Links& links, std::span<const std::uint8_t> phase)
{
  NodeSet set(block.size[0], halo);
  std::size_t i = 0;
  for (std::int64_t z = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
    {
      const std::int64_t row = halo.row(y, z);
      for (std::int64_t x = 0; x < block.size[0]; ++x, ++i)
        if (links.conducts(phase[i], x, y + block.start[1]))
          set.insert(row, x);
    }
  return set;
}

// All conducting nodes that the face on this side of the axis reaches.
NodeSet floodFromFace(const Lattice& lattice, const Block& block, const Halo& halo, const Communicator& comm,
  const Links& links, const NodeSet& conducting, int axis, bool high)
{
  NodeSet reached(block.size[0], halo);
  std::vector<LinkPosition> front;
  const auto visit = [&](const LinkPosition& p)
  {
    const std::int64_t row = halo.row(p[1], p[2]);
    if (conducting.contains(row, p[0]) && !reached.contains(row, p[0]))
    {
      reached.insert(row, p[0]);
      front.push_back(p);
    }
  };
  const std::int64_t nx = block.size[0];
  const auto wrapped = [&](std::int64_t x) {
    return links.boundary(0) != Boundary::Periodic ? x : x < 0 ? x + nx : x >= nx ? x - nx : x;
  };
  const auto owned = [&](const LinkPosition& p)
  { return p[1] >= 0 && p[1] < block.size[1] && p[2] >= 0 && p[2] < block.size[2]; };
  const auto spread = [&]
  {
    while (!front.empty())
    {
      const LinkPosition p = front.back();
      front.pop_back();
      for (const Direction& d : links.all())
      {
        const LinkPosition q{ wrapped(p[0] + d.x), p[1] + d.y, p[2] + d.z };
        if (q[0] >= 0 && q[0] < block.size[0] && owned(q) && links.open(d, p[0], p[1] + block.start[1]))
          visit(q);
      }
    }
  };

  const std::int64_t face = high ? lattice.size[axis] - 1 : 0;
  const int out = high ? 1 : -1;
  const Direction outwards{ axis == 0 ? out : 0, axis == 1 ? out : 0, axis == 2 ? out : 0 };
  for (std::int64_t z = 0; z < block.size[2]; ++z)
    for (std::int64_t y = 0; y < block.size[1]; ++y)
      for (std::int64_t x = 0; x < block.size[0]; ++x)
      {
        const LinkPosition p{ x, y, z };
        if (block.start[axis] + p[axis] == face && links.open(outwards, x, y + block.start[1]))
          visit(p);
        else if (axis == 0)
          x = std::max(x, face - 1); // skip to the only node of the row that lies on the face
      }
  spread();

  // Hand the front over to the neighbours, and round periodic sides, until nothing changes anywhere.
  const bool round = links.boundary(1) == Boundary::Periodic || links.boundary(2) == Boundary::Periodic;
  for (bool changed = comm.parallel() || round; changed;)
  {
    reached.exchange(halo);
    const auto fromGhost = [&](std::int64_t y, std::int64_t z)
    {
      reached.forEach(halo.row(y, z),
        [&](std::int64_t x)
        {
          for (const Direction& d : links.all())
          {
            const LinkPosition q{ wrapped(x + d.x), y + d.y, z + d.z };
            if (q[0] >= 0 && q[0] < block.size[0] && owned(q) && links.open(d, x, y + block.start[1]))
              visit(q);
          }
        });
    };
    const std::int64_t ghostZ = lattice.dimension == 3 ? 1 : 0;
    for (std::int64_t z = -ghostZ; z < block.size[2] + ghostZ; ++z)
      for (std::int64_t y = -1; y <= block.size[1]; ++y)
        if (!owned({ 0, y, z }))
          fromGhost(y, z);
    changed = comm.any(!front.empty());
    spread();
  }
  return reached;
}

// Clusters of a periodic medium with the number of times their loops wind around each axis.
class WindingClusters
{
public:
  explicit WindingClusters(std::size_t nodes)
    : parent_(nodes)
    , offset_(nodes, { 0, 0, 0 })
    , winds_(nodes, 0)
  {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  // Joins b = a + step, where `wrap` says how often the step crosses each periodic side.
  void join(std::uint32_t a, std::uint32_t b, const std::array<std::int32_t, 3>& wrap)
  {
    std::array<std::int32_t, 3> oa = find(a);
    std::array<std::int32_t, 3> ob = find(b);
    const std::uint32_t ra = parent_[a];
    const std::uint32_t rb = parent_[b];
    std::array<std::int32_t, 3> loop;
    for (int i = 0; i < 3; ++i)
      loop[i] = oa[i] + wrap[i] - ob[i];
    if (ra == rb)
    {
      for (int i = 0; i < 3; ++i)
        if (loop[i] != 0)
          winds_[ra] |= static_cast<std::uint8_t>(1U << i);
      return;
    }
    // the smaller id stays root, so that the result does not depend on the order of joins
    if (ra < rb)
    {
      parent_[rb] = ra;
      offset_[rb] = loop;
      winds_[ra] |= winds_[rb];
    }
    else
    {
      parent_[ra] = rb;
      for (int i = 0; i < 3; ++i)
        offset_[ra][i] = -loop[i];
      winds_[rb] |= winds_[ra];
    }
  }

  // Root of a, and after the call parent_[a] is that root; returns the offset of a from it.
  std::array<std::int32_t, 3> find(std::uint32_t a)
  {
    std::uint32_t root = a;
    std::array<std::int32_t, 3> total{ 0, 0, 0 };
    while (parent_[root] != root)
    {
      for (int i = 0; i < 3; ++i)
        total[i] += offset_[root][i];
      root = parent_[root];
    }
    std::array<std::int32_t, 3> rest = total;
    while (parent_[a] != root && a != root)
    {
      const std::uint32_t next = parent_[a];
      const auto own = offset_[a];
      parent_[a] = root;
      offset_[a] = rest;
      for (int i = 0; i < 3; ++i)
        rest[i] -= own[i];
      a = next;
    }
    return total;
  }
  std::uint32_t root(std::uint32_t a)
  {
    find(a);
    return parent_[a];
  }
  [[nodiscard]] bool winds(std::uint32_t root, int axis) const { return (winds_[root] >> axis) & 1U; }

private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::array<std::int32_t, 3>> offset_;
  std::vector<std::uint8_t> winds_;
};

// The conducting nodes of the whole box, rows in order, on every rank: 8 nodes a byte.
std::vector<std::uint8_t> gatherBits(const Lattice& lattice, const Decomposition& parts, const Communicator& comm,
  const Links& links, std::span<const std::uint8_t> phase)
{
  const std::int64_t nx = lattice.size[0];
  const std::int64_t rowBytes = (nx + 7) / 8;
  const auto pack = [&](const Block& b, auto&& isSet)
  {
    std::vector<std::uint8_t> bits(static_cast<std::size_t>(rowBytes * b.size[1] * b.size[2]), 0);
    for (std::int64_t r = 0; r < b.size[1] * b.size[2]; ++r)
      for (std::int64_t x = 0; x < nx; ++x)
        if (isSet(r * nx + x))
          bits[static_cast<std::size_t>(r * rowBytes + x / 8)] |= static_cast<std::uint8_t>(1U << (x % 8));
    return bits;
  };
  const Block& block = parts.block();
  const auto mine = pack(block,
    [&](std::int64_t i)
    { return links.conducts(phase[static_cast<std::size_t>(i)], i % nx, i / nx % block.size[1] + block.start[1]); });
  std::vector<std::uint8_t> all(static_cast<std::size_t>(rowBytes * lattice.size[1] * lattice.size[2]));
  std::vector<std::uint8_t> received = mine;
  std::vector<int> counts;
  std::vector<int> starts;
  if (comm.parallel())
  {
    int total = 0;
    for (int r = 0; r < comm.size(); ++r)
    {
      const Block b = parts.block(r);
      starts.push_back(total);
      counts.push_back(static_cast<int>(rowBytes * b.size[1] * b.size[2]));
      total += counts.back();
    }
    received.resize(static_cast<std::size_t>(total));
    MPI_Allgatherv(mine.data(), static_cast<int>(mine.size()), MPI_BYTE, received.data(), counts.data(), starts.data(),
      MPI_BYTE, comm.handle());
  }
  std::size_t from = 0;
  for (int r = 0; r < comm.size(); ++r)
  {
    const Block b = parts.block(r);
    for (std::int64_t z = 0; z < b.size[2]; ++z)
      for (std::int64_t y = 0; y < b.size[1]; ++y, from += static_cast<std::size_t>(rowBytes))
        std::copy_n(received.begin() + static_cast<std::ptrdiff_t>(from), rowBytes,
          all.begin() + (b.start[1] + y + lattice.size[1] * (b.start[2] + z)) * rowBytes);
  }
  return all;
}

Percolation periodicPercolation(const Lattice& lattice, const Decomposition& parts, const Halo& halo,
  const Communicator& comm, const Links& links, int axis, std::span<const std::uint8_t> phase)
{
  const std::int64_t nx = lattice.size[0]; // no structured binding: lambdas use them
  const std::int64_t ny = lattice.size[1];
  const std::int64_t nz = lattice.size[2];
  const std::int64_t rowBytes = (nx + 7) / 8;
  const auto bits = gatherBits(lattice, parts, comm, links, phase);
  const auto conducts = [&](const LinkPosition& p)
  { return (bits[static_cast<std::size_t>((p[1] + ny * p[2]) * rowBytes + p[0] / 8)] >> (p[0] % 8)) & 1U; };

  // Ranking on the whole box: a serial lattice of its own.
  const Communicator alone(MPI_COMM_SELF);
  const Decomposition whole(lattice, alone);
  const Halo wholeHalo(lattice.dimension, lattice.size, whole, alone, { false, false, false });
  NodeSet set(nx, wholeHalo);
  for (std::int64_t z = 0; z < nz; ++z)
    for (std::int64_t y = 0; y < ny; ++y)
      for (std::int64_t x = 0; x < nx; ++x)
        if (conducts({ x, y, z }))
          set.insert(wholeHalo.row(y, z), x);
  set.number();

  WindingClusters clusters(set.size());
  const auto forEachNode = [&](auto&& f)
  {
    for (std::int64_t z = 0; z < nz; ++z)
      for (std::int64_t y = 0; y < ny; ++y)
        set.forEach(
          wholeHalo.row(y, z),
          [&](std::int64_t x) {
            f(LinkPosition{ x, y, z });
          });
  };
  const auto idOf = [&](const LinkPosition& p) { return set.id(wholeHalo.row(p[1], p[2]), p[0]); };
  forEachNode(
    [&](const LinkPosition& p)
    {
      for (const Direction& d : links.forward())
      {
        LinkPosition q;
        std::array<std::int32_t, 3> wrap{ 0, 0, 0 };
        for (int a = 0; a < 3; ++a)
        {
          q[a] = p[a] + d[a];
          if (q[a] < 0 || q[a] >= lattice.size[a])
          {
            wrap[a] = q[a] < 0 ? -1 : 1;
            q[a] -= wrap[a] * lattice.size[a];
          }
        }
        if (conducts(q) && links.open(d, p[0], p[1]))
          clusters.join(idOf(p), idOf(q), wrap);
      }
    });

  Percolation result;
  const Block& block = parts.block();
  result.carrying = NodeSet(nx, halo);
  forEachNode(
    [&](const LinkPosition& p)
    {
      const std::uint32_t id = idOf(p);
      const std::uint32_t root = clusters.root(id);
      if (!clusters.winds(root, axis))
        return;
      result.exists = true;
      if (root == id)
        result.pins.push_back(p);
      const std::int64_t y = p[1] - block.start[1];
      const std::int64_t z = p[2] - block.start[2];
      if (y >= 0 && y < block.size[1] && z >= 0 && z < block.size[2])
        result.carrying.insert(halo.row(y, z), p[0]);
    });
  return result;
}

} // namespace

Percolation findPercolation(const Lattice& lattice, const Decomposition& parts, const Halo& halo,
  const Communicator& comm, const Links& links, int axis, std::span<const std::uint8_t> phase)
{
  Percolation result;
  if (links.boundary(axis) == Boundary::Periodic)
    result = periodicPercolation(lattice, parts, halo, comm, links, axis, phase);
  else
  {
    const Block& block = parts.block();
    const NodeSet conducting = conductingNodes(block, halo, links, phase);
    result.reachesLow = floodFromFace(lattice, block, halo, comm, links, conducting, axis, false);
    result.reachesHigh = floodFromFace(lattice, block, halo, comm, links, conducting, axis, true);
    result.carrying = result.reachesLow;
    result.carrying.intersect(result.reachesHigh);
    bool any = false;
    for (std::int64_t z = 0; z < block.size[2]; ++z)
      for (std::int64_t y = 0; y < block.size[1]; ++y)
        result.carrying.forEach(halo.row(y, z), [&](std::int64_t) { any = true; });
    result.exists = comm.any(any);
  }
  result.carrying.exchange(halo);
  result.carrying.number();
  return result;
}

} // namespace lamella::lbm
