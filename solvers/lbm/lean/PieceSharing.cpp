// Levels of pieces on ranks: shared out anew, or gathered on all of them.
#include "lbm/lean/PieceBlocks.h"
#include "lbm/multigrid/Multigrid.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace lamella::lbm
{

RankShares sharesOf(const Communicator& comm, std::size_t mine)
{
  RankShares shares;
  const int count = static_cast<int>(mine);
  shares.counts.resize(static_cast<std::size_t>(comm.size()));
  MPI_Allgather(&count, 1, MPI_INT, shares.counts.data(), 1, MPI_INT, comm.handle());
  shares.starts.assign(shares.counts.size() + 1, 0);
  std::partial_sum(shares.counts.begin(), shares.counts.end(), shares.starts.begin() + 1);
  return shares;
}

std::array<bool, 3> PieceMultigrid::wraps(const PieceLevel& level) const
{
  std::array<bool, 3> wrapping = periodic_;
  for (std::size_t a = 0; a < 3 && level.shared; ++a)
    wrapping[a] = wrapping[a] && level.parts->parts()[a] == 1;
  return wrapping;
}

std::int64_t PieceMultigrid::total(const PieceLevel& level) const
{
  const auto count = static_cast<std::int64_t>(level.count());
  return level.shared ? lattice_->comm->sum(count) : count;
}

std::size_t PieceMultigrid::bytes() const noexcept
{
  std::size_t total =
    labels_.capacity() * sizeof(labels_[0]) + (places_.capacity() + own_.capacity()) * sizeof(places_[0]);
  for (const PieceLevel& level : levels_)
    total += level.bytes();
  return total;
}

bool PieceMultigrid::move()
{
  PieceLevel& part = levels_.back();
  const Communicator& comm = *lattice_->comm;
  Lattice blocks;
  blocks.dimension = lattice_->grid.dimension;
  blocks.size = part.all;
  PieceLevel next;
  next.shared = true;
  next.parts = std::make_shared<const Decomposition>(blocks, comm, unevennessAt(blocks.dimension, part.depth));
  if (next.parts->levels() == 0)
    return false;
  next.halvings = 0;
  next.depth = part.depth;
  next.all = part.all;
  next.blocks = next.parts->block().size;
  next.begin = next.parts->block().start;
  std::vector<Block> before;
  std::vector<Block> after;
  for (int r = 0; r < comm.size(); ++r)
  {
    before.push_back(part.block(r));
    after.push_back(next.block(r));
  }
  part.moved = std::make_unique<PieceMove>(comm, before, after, part.start);
  next.start = part.moved->start();
  next.halo = PieceHalo(comm, *next.parts, periodic_, next.blocks, next.start);

  const std::size_t n = next.count();
  next.wall.resize(n);
  next.inverse.resize(n);
  part.moved->forward(part.wall, next.wall);
  part.moved->forward(part.inverse, next.inverse);
  std::vector<std::uint32_t> lengths(part.count());
  for (std::size_t i = 0; i < lengths.size(); ++i)
    lengths[i] = part.row[i + 1] - part.row[i];
  std::vector<std::uint32_t> nextLengths(n);
  part.moved->forward(lengths, nextLengths);
  next.row.assign(n + 1, 0);
  std::partial_sum(nextLengths.begin(), nextLengths.end(), next.row.begin() + 1);

  // every rank knows an unknown by its block in the level and its place there
  std::vector<std::uint32_t> block(part.withGhosts());
  std::vector<std::uint32_t> piece(part.withGhosts());
  forBlocks(part.blocks,
    [&](std::int64_t bx, std::int64_t by, std::int64_t bz, std::size_t at)
    {
      for (std::uint32_t i = part.start[at]; i < part.start[at + 1]; ++i)
      {
        block[i] = static_cast<std::uint32_t>(blockIndex(part.all, { bx, by + part.begin[1], bz + part.begin[2] }));
        piece[i] = i - part.start[at];
      }
    });
  part.halo.exchange(block);
  part.halo.exchange(piece);
  const auto ofOthers = [&](const std::vector<std::uint32_t>& what)
  {
    std::vector<std::uint32_t> here(part.other.size());
    for (std::size_t e = 0; e < here.size(); ++e)
      here[e] = what[part.other[e]];
    std::vector<std::uint32_t> there(next.row.back());
    part.moved->forwardRows(part.row, here, next.row, there);
    return there;
  };
  const auto otherBlock = ofOthers(block);
  const auto otherPiece = ofOthers(piece);
  const std::vector<std::uint32_t> links(part.link.begin(), part.link.end()); // four bytes each, as they travel
  std::vector<std::uint32_t> nextLinks(next.row.back());
  part.moved->forwardRows(part.row, links, next.row, nextLinks);
  next.link.resize(nextLinks.size());
  std::ranges::transform(
    nextLinks, next.link.begin(), [](std::uint32_t link) { return static_cast<std::uint16_t>(link); });
  const auto firstOf = [&](std::int64_t index)
  {
    const std::array<std::int64_t, 3> at{ index % next.all[0], index / next.all[0] % next.all[1] - next.begin[1],
      index / (next.all[0] * next.all[1]) - next.begin[2] };
    const auto inside = [&](std::size_t a) { return at[a] >= 0 && at[a] < next.blocks[a]; };
    if (inside(1) && inside(2))
      return next.start[blockIndex(next.blocks, at)];
    std::size_t side = 0;
    const auto beyond = [&]
    {
      const std::size_t a = PieceHalo::axisOf(side);
      const std::int64_t wanted = side % 2 == 1 ? next.blocks[a] : -1;
      return next.halo.has(side) && inside(3 - a) && (at[a] - wanted) % next.all[a] == 0;
    };
    while (!beyond())
      ++side;
    return next.halo.start(side, next.halo.place(side, at));
  };
  next.other.resize(next.row.back());
  for (std::size_t e = 0; e < next.other.size(); ++e)
    next.other[e] = firstOf(otherBlock[e]) + otherPiece[e];

  next.b.assign(n, 0.0F);
  next.x.assign(next.withGhosts(), 0.0F);
  for (auto& v : next.work)
    v.assign(next.withGhosts(), 0.0F);
  part.dropMatrix();
  levels_.push_back(std::move(next));
  return true;
}

// The same unknowns, whole on every rank, in the order of the whole level's blocks.
void PieceMultigrid::gather()
{
  PieceLevel& part = levels_.back();
  const Communicator& comm = *lattice_->comm;
  PieceLevel whole;
  whole.blocks = whole.all = part.all;
  whole.depth = part.depth;
  std::vector<std::uint32_t> counts(blockCount(part.blocks));
  for (std::size_t i = 0; i < counts.size(); ++i)
    counts[i] = part.start[i + 1] - part.start[i];
  const auto allCounts = gatherAll<std::uint32_t>(comm, counts);
  // f(place of a block in the whole, its number of unknowns), rank by rank
  const auto forAll = [&](auto&& f)
  {
    std::size_t i = 0;
    for (int r = 0; r < comm.size(); ++r)
    {
      const Block block = part.block(r);
      for (std::int64_t z = 0; z < block.size[2]; ++z)
        for (std::int64_t y = 0; y < block.size[1]; ++y)
          for (std::int64_t x = 0; x < block.size[0]; ++x)
            f(blockIndex(whole.blocks, { x, y + block.start[1], z + block.start[2] }), allCounts[i++]);
    }
  };
  whole.start.assign(blockCount(whole.blocks) + 1, 0);
  forAll([&](std::size_t block, std::uint32_t count) { whole.start[block] = count; });
  startsFromCounts(whole.start);
  places_.reserve(whole.count());
  forAll(
    [&](std::size_t block, std::uint32_t count)
    {
      for (std::uint32_t k = 0; k < count; ++k)
        places_.push_back(whole.start[block] + k);
    });
  const auto before = static_cast<std::size_t>(comm.sumBefore(static_cast<std::int64_t>(part.count())));
  own_.assign(part.withGhosts(), 0);
  std::copy_n(places_.begin() + static_cast<std::ptrdiff_t>(before), part.count(), own_.begin());
  part.halo.exchange(own_);

  shares_ = sharesOf(comm, part.count());
  const auto placed = [&](const std::vector<float>& values)
  {
    const auto all = gatherAll<float>(comm, values, shares_);
    std::vector<float> out(all.size());
    for (std::size_t k = 0; k < all.size(); ++k)
      out[places_[k]] = all[k];
    return out;
  };
  whole.wall = placed(part.wall);
  whole.inverse = placed(part.inverse);
  std::vector<std::uint32_t> lengths(part.count());
  for (std::size_t i = 0; i < lengths.size(); ++i)
    lengths[i] = part.row[i + 1] - part.row[i];
  std::vector<std::uint32_t> others(part.other.size());
  for (std::size_t e = 0; e < others.size(); ++e)
    others[e] = own_[part.other[e]];
  const auto allLengths = gatherAll<std::uint32_t>(comm, lengths, shares_);
  const auto allOthers = gatherAll<std::uint32_t>(comm, others);
  std::vector<float> links(part.link.size());
  for (std::size_t e = 0; e < links.size(); ++e)
    links[e] = part.linkAt(e);
  const auto allLinks = gatherAll<float>(comm, links);
  whole.row.assign(whole.count() + 1, 0);
  for (std::size_t k = 0; k < allLengths.size(); ++k)
    whole.row[places_[k] + 1] = allLengths[k];
  std::partial_sum(whole.row.begin(), whole.row.end(), whole.row.begin());
  whole.other.resize(allOthers.size());
  whole.link.resize(allLinks.size());
  std::ptrdiff_t from = 0;
  for (std::size_t k = 0; k < allLengths.size(); from += allLengths[k++])
  {
    const auto to = static_cast<std::ptrdiff_t>(whole.row[places_[k]]);
    std::copy_n(allOthers.begin() + from, allLengths[k], whole.other.begin() + to);
    std::transform(
      allLinks.begin() + from, allLinks.begin() + from + allLengths[k], whole.link.begin() + to, PieceLevel::packed);
  }
  for (auto* v : { &whole.x, &whole.b, &whole.work[0], &whole.work[1], &whole.work[2] })
    v->assign(whole.count(), 0.0F);

  part.gathered = true;
  part.dropMatrix();
  levels_.push_back(std::move(whole));
}

} // namespace lamella::lbm
