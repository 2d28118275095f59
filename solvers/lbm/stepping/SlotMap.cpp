#include "lbm/stepping/SlotMap.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>

namespace lamella::lbm
{
namespace
{

// Arrays of populations begin at different places of a page, 7 lines of the cache apart: nine to nineteen of them are
// swept side by side.
std::int64_t strideOf(std::int64_t nodes)
{
  constexpr std::int64_t page = 512;
  constexpr std::int64_t offset = 7 * 8;
  return (nodes + page - 1) / page * page + offset;
}

bool same(const SlotPattern& a, const SlotPattern& b, int count)
{
  for (int q = 0; q < count; ++q)
    if (a.slot[q] != b.slot[q] || a.sign[q] != b.sign[q] || a.shift[q] != b.shift[q] || a.mirror[q] != b.mirror[q] ||
      a.fixed[q] != b.fixed[q])
      return false;
  return a.special == b.special && a.value == b.value && a.share == b.share;
}

} // namespace

SlotMap::SlotMap(const Lattice& lattice, const Decomposition& parts, const Halo& halo, const Communicator& comm,
  const Velocities& velocities, const SlotSides& sides, NodeSet stored)
  : lattice_(lattice)
  , parts_(parts)
  , comm_(comm)
  , halo_(halo)
  , velocities_(velocities)
  , sides_(sides)
  , set_(std::move(stored))
  , block_(parts.block())
  , nx_(block_.size[0])
{
  if (set_.size() > static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max()))
    throw ParameterError(fmt::format("{} nodes on one rank are more than 2147483647", set_.size()),
      "use more ranks with mpirun, or a smaller window");
  stride_ = strideOf(set_.size());
  const std::size_t count = static_cast<std::size_t>(block_.size[1] * block_.size[2]);
  rows_.resize(count);
  for (std::size_t r = 0; r < count; ++r)
  {
    Row& row = rows_[r];
    const std::int64_t at = setRow(r);
    row.first = static_cast<std::int32_t>(set_.rowBegin(at));
    row.count = static_cast<std::int32_t>(set_.rowBegin(at + 1)) - row.first;
    row.firstRun = static_cast<std::int32_t>(runs_.size());
    stored_ += row.count;
    if (row.count == nx_ && nx_ > 2 && wholeAround(r)) // three runs, however long the row
    {
      addNode(position(r, 0), row.first, 1, row);
      addNode(position(r, 1), row.first + 1, static_cast<std::int32_t>(nx_ - 2), row);
      addNode(position(r, nx_ - 1), row.first + row.count - 1, 1, row);
    }
    else
      forEach(r,
        [&](std::int32_t node, std::int64_t index)
        { addNode(position(r, index - static_cast<std::int64_t>(r) * nx_), node, 1, row); });
    row.runs = static_cast<std::int32_t>(runs_.size()) - row.firstRun;
  }
  matchGhosts();
}

std::uint64_t SlotMap::bytes() const noexcept
{
  std::uint64_t sum = set_.bytes() + rows_.size() * sizeof(Row) + runs_.size() * sizeof(SlotRun) +
    sources_.size() * sizeof(std::int32_t) + patterns_.size() * sizeof(SlotPattern);
  for (const Neighbour& n : neighbours_)
    sum += (n.mine.size() + n.ghost.size()) * sizeof(std::int64_t);
  return sum;
}

std::int64_t SlotMap::setRow(std::size_t row) const
{
  const auto r = static_cast<std::int64_t>(row);
  return halo_.row(r % block_.size[1], r / block_.size[1]);
}

std::array<std::int64_t, 3> SlotMap::position(std::size_t row, std::int64_t x) const
{
  const auto r = static_cast<std::int64_t>(row);
  return { x, block_.start[1] + r % block_.size[1], block_.start[2] + r / block_.size[1] };
}

double SlotMap::share(const std::array<std::int64_t, 3>& p) const
{
  double share = 1;
  if (sides_.onNodes)
    for (int a = 0; a < lattice_.dimension; ++a)
      if (sides_.boundary[a] != Boundary::Periodic && (p[a] == 0 || p[a] == lattice_.size[a] - 1))
        share *= 0.5;
  return share;
}

SlotMap::Source SlotMap::source(const std::array<std::int64_t, 3>& p, int q) const
{
  Direction d = velocities_.c[q];
  int component[3] = { d.x, d.y, d.z };
  std::array<std::int64_t, 3> at{ p[0], p[1] - block_.start[1], p[2] - block_.start[2] };
  Source s;
  s.row = halo_.row(at[1], at[2]);
  s.x = p[0];
  s.slot = q;
  s.own = true; // what comes back from a wall waits in the node's own slot
  for (int a = 0; a < lattice_.dimension; ++a)
  {
    const std::int64_t beyond = p[a] - component[a];
    if (beyond >= 0 && beyond < lattice_.size[a])
      continue;
    s.wall = sides_.boundary[a] == Boundary::Fixed || (sides_.boundary[a] == Boundary::Insulated && sides_.onNodes);
    if (!s.wall)
      continue;
    if (sides_.boundary[a] == Boundary::Fixed && !sides_.onNodes)
    {
      s.sign = -1;
      s.shift = 2 * velocities_.weight[q] * sides_.value[a][beyond < 0 ? 0 : 1];
    }
    return s;
  }
  double shift = 0;
  for (int a = 0; a < lattice_.dimension; ++a)
  {
    const std::int64_t beyond = p[a] - component[a];
    if (beyond >= 0 && beyond < lattice_.size[a])
      at[a] -= component[a];
    else if (sides_.boundary[a] == Boundary::Insulated)
      component[a] = -component[a]; // specular: it left its source towards the side
    else
    {
      shift += (beyond < 0 ? 1 : -1) * velocities_.weight[q] * sides_.drop[a];
      at[a] = parts_.parts()[a] == 1 ? (beyond + lattice_.size[a]) % lattice_.size[a] : at[a] - component[a];
    }
  }
  const std::int64_t row = halo_.row(at[1], at[2]);
  if (!set_.contains(row, at[0]))
    return s;
  d = { component[0], component[1], component[2] };
  s.row = row;
  s.x = at[0];
  s.slot = velocities_.opposite(velocities_.find(d));
  s.own = false;
  s.ghost = at[1] < 0 || at[1] >= block_.size[1] || at[2] < 0 || at[2] >= block_.size[2];
  s.shift = shift;
  return s;
}

// Do all populations of the inner nodes of this row come from whole rows?
bool SlotMap::wholeAround(std::size_t r) const
{
  for (int q = velocities_.rest; q < velocities_.count(); ++q)
  {
    const Source s = source(position(r, 1), q);
    if (set_.rowBegin(s.row + 1) - set_.rowBegin(s.row) != static_cast<std::uint32_t>(nx_))
      return false;
    if (s.own && q >= velocities_.rest && !s.wall) // a void beyond, here or all along: leave it to the slow way
      return false;
  }
  return true;
}

std::int32_t SlotMap::patternOf(const std::array<std::int64_t, 3>& p, const std::vector<Source>& sources)
{
  SlotPattern pattern{};
  double unknown = 0;
  for (int q = 0; q < velocities_.count(); ++q)
  {
    const Source& s = sources[q];
    const Direction& c = velocities_.c[q];
    pattern.slot[q] = static_cast<std::uint8_t>(s.own ? velocities_.opposite(q) : s.slot);
    pattern.sign[q] = s.sign;
    pattern.shift[q] = s.shift;
    pattern.mirror[q] = static_cast<std::uint8_t>(q);
    pattern.special = pattern.special || s.sign != 1 || s.shift != 0;
    if (!sides_.onNodes)
      continue;
    int component[3] = { c.x, c.y, c.z };
    bool mirrored = false;
    for (int a = 0; a < lattice_.dimension && !pattern.fixed[q]; ++a)
    {
      const std::int64_t beyond = p[a] - component[a];
      if ((beyond >= 0 && beyond < lattice_.size[a]) || sides_.boundary[a] == Boundary::Periodic)
        continue;
      pattern.special = true;
      if (sides_.boundary[a] == Boundary::Fixed)
      {
        pattern.fixed[q] = true;
        pattern.value = sides_.value[a][beyond < 0 ? 0 : 1];
        unknown += velocities_.weight[q];
      }
      component[a] = -component[a];
      mirrored = true;
    }
    if (mirrored && !pattern.fixed[q])
      pattern.mirror[q] = static_cast<std::uint8_t>(velocities_.find({ component[0], component[1], component[2] }));
  }
  pattern.share = unknown > 0 ? 1 / unknown : 0.0;
  for (std::size_t k = 0; k < patterns_.size(); ++k)
    if (same(patterns_[k], pattern, velocities_.count()))
      return static_cast<std::int32_t>(k);
  patterns_.push_back(pattern);
  return static_cast<std::int32_t>(patterns_.size()) - 1;
}

// Adds nodes that share everything but their place to the runs, or makes the last run longer.
void SlotMap::addNode(const std::array<std::int64_t, 3>& p, std::int32_t node, std::int32_t count, Row& row)
{
  const int moving = velocities_.count() - velocities_.rest;
  std::vector<Source> from(static_cast<std::size_t>(velocities_.count()));
  std::uint32_t own = 0;
  for (int q = 0; q < velocities_.count(); ++q)
  {
    from[q] = source(p, q);
    if (from[q].own)
      own |= 1U << q;
    row.late = row.late || from[q].ghost;
  }
  bool inner = true;
  for (int a = 0; a < lattice_.dimension; ++a)
    inner = inner && p[a] > 0 && p[a] < lattice_.size[a] - 1;
  if (inner && innerPattern_ < 0)
    innerPattern_ = patternOf(p, from);
  const std::int32_t pattern = inner ? innerPattern_ : patternOf(p, from);
  row.special = row.special || (sides_.onNodes && patterns_[pattern].special);
  bool joins = static_cast<std::int32_t>(runs_.size()) > row.firstRun;
  if (joins)
  {
    const SlotRun& last = runs_.back();
    joins = last.pattern == pattern && last.own == own && last.first + last.count == node;
    for (int k = 0; joins && k < moving; ++k)
    {
      const Source& s = from[k + velocities_.rest];
      joins = sources_[sources_.size() - moving + k] + last.count == static_cast<std::int32_t>(set_.id(s.row, s.x));
    }
  }
  if (joins)
  {
    runs_.back().count += count;
    return;
  }
  runs_.push_back({ node, count, pattern, own });
  for (int q = velocities_.rest; q < velocities_.count(); ++q)
    sources_.push_back(static_cast<std::int32_t>(set_.id(from[q].row, from[q].x)));
}

std::array<SlotMap::Plane, 2> SlotMap::planes(int axis) const
{
  std::array<Plane, 2> planes;
  const std::int64_t n = lattice_.size[axis];
  const Boundary side = sides_.boundary[axis];
  const bool faces = side == Boundary::Fixed && !sides_.onNodes;
  const std::int64_t beyond[2] = { side == Boundary::Fixed ? 1 : 0, side == Boundary::Fixed ? n - 1 : n / 2 };
  for (std::size_t r = 0; r < rows_.size(); ++r)
    forEach(r,
      [&](std::int32_t node, std::int64_t index)
      {
        const auto p = position(r, index - static_cast<std::int64_t>(r) * nx_);
        for (int k = 0; k < 2; ++k)
          for (int q = velocities_.rest; q < velocities_.count(); ++q)
          {
            const int c = velocities_.c[q][axis];
            if (c == 0)
              continue;
            if (faces ? p[axis] != (k == 0 ? 0 : n - 1) || c != (k == 0 ? 1 : -1)
                      : p[axis] != (c > 0 ? beyond[k] : (beyond[k] + n - 1) % n))
              continue;
            const Source s = source(p, q);
            if (s.own != faces)
              continue;
            // a straight link along a mirror on the nodes has half its width in the box
            double weight = faces ? 2.0 : 1.0;
            for (int a = 0; a < lattice_.dimension && sides_.onNodes; ++a)
              if (a != axis && velocities_.c[q][a] == 0 && sides_.boundary[a] != Boundary::Periodic &&
                (p[a] == 0 || p[a] == lattice_.size[a] - 1))
                weight *= 0.5;
            planes[k].terms.emplace_back(q * stride_ + node, c * weight);
            // a mean gradient counts once a link, and both of its populations carry it
            planes[k].constant -= c * s.shift * (faces ? 1.0 : 0.5 * weight);
          }
      });
  return planes;
}

// Ranks ask the owners for the slots that they will share, and both keep the order.
void SlotMap::matchGhosts()
{
  if (!comm_.parallel())
    return;
  const int ranks = comm_.size();
  std::vector<Block> blocks;
  for (int rank = 0; rank < ranks; ++rank)
    blocks.push_back(parts_.block(rank));
  std::vector<std::vector<std::int64_t>> asked(static_cast<std::size_t>(ranks));
  std::vector<std::vector<std::int64_t>> ghost(asked.size());
  for (std::size_t r = 0; r < rows_.size(); ++r)
    if (rows_[r].late)
      forEach(r,
        [&](std::int32_t, std::int64_t index)
        {
          const auto p = position(r, index - static_cast<std::int64_t>(r) * nx_);
          for (int q = velocities_.rest; q < velocities_.count(); ++q)
          {
            const Source s = source(p, q);
            if (!s.ghost)
              continue;
            const std::int64_t wide = block_.size[1] + 2;
            const std::int64_t deep = lattice_.dimension == 3 ? s.row / wide - 1 : 0;
            const std::int64_t y = (s.row % wide - 1 + block_.start[1] + lattice_.size[1]) % lattice_.size[1];
            const std::int64_t z = (deep + block_.start[2] + lattice_.size[2]) % lattice_.size[2];
            const auto owner = std::find_if(blocks.begin(), blocks.end(),
              [&](const Block& b) {
                return y >= b.start[1] && y < b.start[1] + b.size[1] && z >= b.start[2] && z < b.start[2] + b.size[2];
              });
            const auto rank = static_cast<std::size_t>(owner - blocks.begin());
            asked[rank].push_back(lattice_.index(s.x, y, z) * maxPopulations + s.slot);
            ghost[rank].push_back(s.slot * stride_ + set_.id(s.row, s.x));
          }
        });
  std::vector<int> toSend(asked.size());
  std::vector<int> toReceive(asked.size());
  for (std::size_t k = 0; k < asked.size(); ++k)
    toSend[k] = static_cast<int>(asked[k].size());
  MPI_Alltoall(toSend.data(), 1, MPI_INT, toReceive.data(), 1, MPI_INT, comm_.handle());
  std::vector<MPI_Request> requests;
  std::vector<std::vector<std::int64_t>> wanted(asked.size());
  for (int rank = 0; rank < ranks; ++rank)
  {
    const auto k = static_cast<std::size_t>(rank);
    wanted[k].resize(static_cast<std::size_t>(toReceive[k]));
    if (toReceive[k] > 0)
      MPI_Irecv(wanted[k].data(), toReceive[k], MPI_INT64_T, rank, 0, comm_.handle(), &requests.emplace_back());
    if (toSend[k] > 0)
      MPI_Isend(asked[k].data(), toSend[k], MPI_INT64_T, rank, 0, comm_.handle(), &requests.emplace_back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  for (int rank = 0; rank < ranks; ++rank)
  {
    const auto k = static_cast<std::size_t>(rank);
    if (wanted[k].empty() && ghost[k].empty())
      continue;
    Neighbour& n = neighbours_.emplace_back();
    n.rank = rank;
    n.ghost = std::move(ghost[k]);
    for (const std::int64_t key : wanted[k])
    {
      const std::int64_t index = key / maxPopulations;
      const std::int64_t y = index / lattice_.size[0] % lattice_.size[1] - block_.start[1];
      const std::int64_t z = index / lattice_.size[0] / lattice_.size[1] - block_.start[2];
      n.mine.push_back(key % maxPopulations * stride_ + set_.id(halo_.row(y, z), index % lattice_.size[0]));
    }
  }
}

} // namespace lamella::lbm
