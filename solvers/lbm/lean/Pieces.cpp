#include "lbm/lean/Pieces.h"

#include "lbm/multigrid/Multigrid.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

namespace lamella::lbm
{
namespace
{

constexpr int pieceSweeps = 3; // before and after
// Links of at least this part of the strongest ones join nodes; halved from level to level.
constexpr double strongPart = 0.25;
// The same for all links along an axis, where spacings differ.
constexpr double strongAxis = 0.1;
// Small enough to be solved directly.
constexpr std::int64_t coarsestCount = 1000;
// Levels of fewer unknowns are gathered: each rank relaxes them sooner than it hears of its neighbours.
constexpr std::int64_t sharedCount = 3000;
// A level that is not smaller than this part of the one before ends the coarsening.
constexpr double worthwhile = 0.8;
// The coarsest level, where it is too large for that, is relaxed that often.
constexpr int coarsestSweeps = 30;
constexpr std::size_t threadedCount = 20000;
// In labels of four bits; those of larger blocks have eight.
constexpr std::uint32_t apart = 15;
// Where more than this part of the nodes would be pieces, as in noise, blocks are made of twice as many along each
// axis.
constexpr double manyPieces = 0.22;
constexpr std::int64_t mostEdge = 4;
constexpr std::size_t mostNodes = mostEdge * mostEdge * mostEdge;

float half(float inside)
{
  return inside > 0 ? 0.5F / inside : 0.0F;
}

float inSeries(float between, float insideHere, float insideThere, float least)
{
  return between > 0 ? std::max(least * between, 1 / (half(insideHere) + 1 / between + half(insideThere))) : 0.0F;
}

// A few sums by key, in the order in which keys come first.
struct Few
{
  std::vector<std::uint32_t> key;
  std::vector<float> sum;
  void clear()
  {
    key.clear();
    sum.clear();
  }
  void add(std::uint32_t k, float value)
  {
    for (std::size_t i = 0; i < key.size(); ++i)
      if (key[i] == k)
      {
        sum[i] += value;
        return;
      }
    key.push_back(k);
    sum.push_back(value);
  }
};

// Where spacings differ, links along an axis may be weak altogether.
std::array<bool, 3> strongAxes(const Links& links, const std::array<std::int64_t, 3>& size)
{
  double strongest = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (size[a] > 1)
      strongest = std::max(strongest, links.factor(static_cast<int>(a)));
  std::array<bool, 3> strong{};
  for (std::size_t a = 0; a < 3; ++a)
    strong[a] = size[a] == 1 || links.factor(static_cast<int>(a)) >= strongAxis * strongest;
  return strong;
}

std::size_t blockCount(const std::array<std::int64_t, 3>& blocks)
{
  return static_cast<std::size_t>(blocks[0] * blocks[1] * blocks[2]);
}

void startsFromCounts(std::vector<std::uint32_t>& start)
{
  std::uint32_t before = 0;
  for (auto& s : start)
    s = std::exchange(before, before + s);
}

std::size_t blockIndex(const std::array<std::int64_t, 3>& blocks, const std::array<std::int64_t, 3>& p)
{
  return static_cast<std::size_t>(p[0] + blocks[0] * (p[1] + blocks[1] * p[2]));
}

// Ghosts are parts of the next level's ghosts: their owners tell which, by its place along the side.
void coarseOfGhosts(PieceLevel& fine, const PieceLevel& next)
{
  std::array<std::vector<std::uint32_t>, PieceHalo::sides> mine;
  std::vector<std::uint32_t> place(next.count(), PieceLevel::none);
  for (std::size_t side = 0; side < PieceHalo::sides; ++side)
  {
    const auto& along = next.halo.along(side);
    for (std::size_t k = 0; k < along.size(); ++k)
      place[along[k]] = static_cast<std::uint32_t>(k);
    for (const std::uint32_t i : fine.halo.along(side))
      mine[side].push_back(fine.coarse[i] == PieceLevel::none ? PieceLevel::none : place[fine.coarse[i]]);
  }
  const auto theirs = fine.halo.swap(mine);
  for (std::size_t side = 0; side < PieceHalo::sides; ++side)
    for (std::size_t k = 0; k < theirs[side].size(); ++k)
      if (theirs[side][k] != PieceLevel::none)
        fine.coarse[fine.halo.start(side, 0) + k] = next.halo.start(side, 0) + theirs[side][k];
}

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

// The ranks' values in their order, on every rank. Four bytes each.
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

// A node's place in its block.
std::size_t nodeOf(const std::array<std::int64_t, 3>& p, std::int64_t edge)
{
  const std::int64_t last = edge - 1; // a power of two, less one
  return static_cast<std::size_t>((p[0] & last) + edge * ((p[1] & last) + edge * (p[2] & last)));
}

std::uint32_t labelOf(const std::uint32_t* labels, std::size_t node, std::int64_t edge)
{
  return edge == 2 ? (labels[0] >> (4 * node)) & 15 : (labels[node / 4] >> (8 * (node % 4))) & 255;
}

std::size_t labelWords(std::int64_t edge)
{
  return edge == 2 ? 1 : static_cast<std::size_t>(edge * edge * edge) / 4;
}

std::uint32_t apartIn(std::int64_t edge)
{
  return edge == 2 ? 15 : 255;
}

std::uint32_t rootOf(std::vector<std::uint32_t>& parent, std::uint32_t i)
{
  while (parent[i] != i)
    i = parent[i] = parent[parent[i]];
  return i;
}

} // namespace

std::size_t PieceLevel::bytes() const noexcept
{
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return of(start) + of(row) + of(other) + of(link) + of(wall) + of(inverse) + of(coarse) + of(x) + of(b) +
    of(work[0]) + of(work[1]) + of(work[2]) + halo.bytes() + (moved ? moved->bytes() : 0);
}

Block PieceLevel::block(int rank) const
{
  const Block whole = parts->block(rank);
  const std::int64_t unit = std::int64_t{ 1 } << halvings;
  Block b;
  for (std::size_t a = 0; a < 3; ++a)
  {
    b.start[a] = whole.start[a] / unit;
    b.size[a] = (whole.start[a] + whole.size[a] + unit - 1) / unit - b.start[a];
  }
  return b;
}

void PieceLevel::dropMatrix()
{
  for (auto* v : { &wall, &inverse })
    *v = {};
  link = {};
  row = {};
  other = {};
  work = {};
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

PieceMultigrid::PieceMultigrid(const LeanField& field, int threads)
  : lattice_(&field.level())
  , periodic_(field.periodic())
  , axis_(field.axis())
  , threads_(std::max(1, threads))
{
  label(field, 2);
  const bool aligned = !lattice_->comm->parallel() || lattice_->parts->levels() > 1;
  const auto nodes = static_cast<double>(lattice_->size[0] * lattice_->size[1] * lattice_->size[2]);
  if (aligned && static_cast<double>(total(levels_.front())) > manyPieces * nodes)
    label(field, mostEdge);
  PieceLevel& first = levels_.front();
  first.halo = PieceHalo(*lattice_->comm, *lattice_->parts, periodic_, first.blocks, first.start);
  linkFirst(field);
  double strong = everyLink_ ? 0 : strongPart;
  int halvings = lattice_->parts->levels() - (edge_ == 2 ? 1 : 2);
  for (std::int64_t count = total(levels_.back()); count > coarsestCount; count = total(levels_.back()))
  {
    const bool shared = levels_.back().shared;
    if (shared && (count < sharedCount || (halvings == 0 && !move())))
      gather();
    else if (shared && halvings == 0) // moved
      halvings = levels_.back().parts->levels();
    else if (!coarsen(strong *= 0.5))
      break;
    else
      --halvings;
  }
  if (levels_.back().shared)
    gather();
  factorize();
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

// The pieces of every block of nodes. Of blocks of 4 × 4 × 4 single nodes are none: relaxation is enough for them, and
// in noise they would be most of the pieces.
void PieceMultigrid::label(const LeanField& field, std::int64_t edge)
{
  const std::array<std::int64_t, 3> size = field.size();
  edge_ = edge;
  levels_.clear();
  PieceLevel& first = levels_.emplace_back();
  first.shared = lattice_->comm->parallel();
  first.parts = std::make_shared<const Decomposition>(*lattice_->parts);
  first.halvings = first.depth = edge == 2 ? 1 : 2;
  for (std::size_t a = 0; a < 3; ++a)
  {
    first.blocks[a] = (size[a] + edge - 1) / edge;
    first.begin[a] = lattice_->start[a] / edge;
    first.all[a] = (lattice_->size[a] + edge - 1) / edge;
  }
  const auto nodes = static_cast<std::size_t>(edge * edge * edge);
  labels_.assign(blockCount(first.blocks) * labelWords(edge), 0);
  const std::uint32_t apart = apartIn(edge);
  first.start.assign(blockCount(first.blocks) + 1, 0);
  // which phases are joined
  std::vector<std::uint8_t> joined(256 * 256, 0);
  everyLink_ = true;
  const std::span<const std::uint8_t> ids = field.ids();
  for (const std::uint8_t a : ids)
    for (const std::uint8_t b : ids)
    {
      const double link = field.links().mean(a, b);
      const bool strong = link > 0 && link >= strongPart * std::max(field.links().mean(a, a), field.links().mean(b, b));
      joined[static_cast<std::size_t>(a) * 256 + b] = strong ? 1 : 0;
      everyLink_ = everyLink_ && (strong || !(link > 0));
    }
  const std::array<bool, 3> alongJoined = strongAxes(field.links(), lattice_->size);
  everyLink_ = everyLink_ && alongJoined == std::array<bool, 3>{ true, true, true };
  const std::array<std::size_t, 3> steps{ 1, static_cast<std::size_t>(edge), static_cast<std::size_t>(edge * edge) };
  forBlocks(first.blocks,
    [&](std::int64_t bx, std::int64_t by, std::int64_t bz, std::size_t block)
    {
      std::array<std::uint8_t, mostNodes> parent{}; // towards the least node of its piece
      std::array<std::uint8_t, mostNodes> count{};
      std::array<int, mostNodes> id{};
      const auto root = [&](std::size_t i)
      {
        while (parent[i] != i)
          i = parent[i] = parent[parent[i]];
        return i;
      };
      std::size_t n = 0;
      for (std::int64_t z = 0; z < edge; ++z)
        for (std::int64_t y = 0; y < edge; ++y)
        {
          const bool inside = edge * by + y < size[1] && edge * bz + z < size[2];
          const std::uint8_t* row = inside ? field.phaseRow(edge * by + y, edge * bz + z) + edge * bx : nullptr;
          for (std::int64_t x = 0; x < edge; ++x, ++n)
          {
            id[n] = inside && edge * bx + x < size[0] && field.links().conducts(row[x]) ? row[x] : -1;
            parent[n] = static_cast<std::uint8_t>(n);
            if (id[n] < 0)
              continue;
            const std::array<bool, 3> has{ x > 0, y > 0, z > 0 };
            for (std::size_t a = 0; a < 3; ++a)
              if (has[a] && alongJoined[a] && id[n - steps[a]] >= 0 &&
                joined[static_cast<std::size_t>(id[n]) * 256 + static_cast<std::size_t>(id[n - steps[a]])] != 0)
              {
                const std::size_t i = root(n);
                const std::size_t j = root(n - steps[a]);
                parent[std::max(i, j)] = static_cast<std::uint8_t>(std::min(i, j));
              }
          }
        }
      for (std::size_t i = 0; i < nodes; ++i)
        ++count[root(i)];
      std::uint32_t pieces = 0;
      std::array<std::uint32_t, mostNodes> number{};
      for (std::size_t i = 0; i < nodes; ++i)
      {
        const std::size_t least = root(i);
        if (least == i)
          number[i] = id[i] < 0 ? apart : pieces++;
        const std::size_t bits = edge == 2 ? 4 : 8;
        labels_[block * labelWords(edge) + i * bits / 32] |= number[least] << (bits * i % 32);
      }
      first.start[block] = pieces;
    });
  startsFromCounts(first.start);
}

// The links of a level whose pieces are known. gather(bx, by, bz, f) calls f(here, there, link, axis) for every link of
// every child in a block, from either end: there is `none` beyond a wall, axis is 3 inside a child's own block.
template <class Gather>
void PieceMultigrid::link(PieceLevel& level, const Gather& gather) const
{
  const std::size_t n = level.count();
  for (auto* v : { &level.b, &level.inverse, &level.wall })
    v->assign(n, 0.0F);
  level.x.assign(level.withGhosts(), 0.0F);
  for (auto& v : level.work)
    v.assign(level.withGhosts(), 0.0F); // first: the links inside each piece along x, y, z
  level.row.assign(n + 1, 0);
  forBlocks(level.blocks,
    [&](std::int64_t bx, std::int64_t by, std::int64_t bz, std::size_t)
    {
      gather(bx, by, bz,
        [&](std::uint32_t here, std::uint32_t there, float link, std::size_t axis)
        {
          if (there == PieceLevel::none)
            level.wall[here] += link;
          else if (here == there && axis < 3)
            level.work[axis][here] += 0.5F * link; // it comes from either end
        });
    });
  for (auto& v : level.work)
    level.halo.exchange(v);
  constexpr float least = leastBlockLink;
  // how many links an unknown has, then which
  for (const bool fill : { false, true })
  {
    forBlocks(level.blocks,
      [&](std::int64_t bx, std::int64_t by, std::int64_t bz, std::size_t block)
      {
        thread_local std::vector<std::array<Few, 4>> few; // by piece and by axis; 3: to a piece of the same block
        const std::uint32_t begin = level.start[block];
        const std::uint32_t end = level.start[block + 1];
        if (few.size() < end - begin)
          few.resize(end - begin);
        gather(bx, by, bz,
          [&](std::uint32_t here, std::uint32_t there, float link, std::size_t axis)
          {
            if (there != PieceLevel::none && here != there)
              few[here - begin][there >= begin && there < end ? 3 : axis].add(there, link);
          });
        for (std::uint32_t i = begin; i < end; ++i)
        {
          std::size_t at = level.row[i];
          const float wall = inSeries(level.wall[i], level.work[static_cast<std::size_t>(axis_)][i], 0, least);
          double total = static_cast<double>(wall);
          for (std::size_t axis = 0; axis < 4; ++axis)
          {
            Few& f = few[i - begin][axis];
            for (std::size_t k = 0; k < f.key.size(); ++k, ++at)
              if (fill)
              {
                const float link =
                  axis == 3 ? f.sum[k] : inSeries(f.sum[k], level.work[axis][i], level.work[axis][f.key[k]], least);
                level.other[at] = f.key[k];
                level.link[at] = PieceLevel::packed(link);
                total += static_cast<double>(level.linkAt(at));
              }
            f.clear();
          }
          if (fill)
          {
            level.wall[i] = wall;
            level.inverse[i] = total > 0 ? static_cast<float>(1 / total) : 0.0F;
          }
          else
            level.row[i] = at; // a count, from 0
        }
      });
    if (fill)
      break;
    std::size_t before = 0;
    for (auto& r : level.row)
      r = std::exchange(before, before + r);
    level.other.assign(before, 0);
    level.link.assign(before, 0);
  }
}

// The links between the pieces of blocks of nodes.
void PieceMultigrid::linkFirst(const LeanField& field)
{
  PieceLevel& level = levels_.front();
  const std::array<std::int64_t, 3> size = field.size();
  const std::array<std::int64_t, 3> blocks = level.blocks;
  const auto beyond = level.halo.parallel() ? level.halo.ofBlocks(labels_, labelWords(edge_))
                                            : std::array<std::vector<std::uint32_t>, PieceHalo::sides>{};
  const std::size_t words = labelWords(edge_);
  const std::uint32_t apart = apartIn(edge_);
  const auto numbered = [&](const std::uint32_t* labels, std::uint32_t start, const std::array<std::int64_t, 3>& p)
  {
    const std::uint32_t piece = labelOf(labels, nodeOf(p, edge_), edge_);
    return piece == apart ? PieceLevel::none : start + piece;
  };
  const auto blockOf = [&](const std::array<std::int64_t, 3>& p) {
    return std::array<std::int64_t, 3>{ p[0] / edge_, p[1] / edge_, p[2] / edge_ };
  };
  const auto unknown = [&](const std::array<std::int64_t, 3>& p)
  {
    const std::size_t block = blockIndex(blocks, blockOf(p));
    return numbered(labels_.data() + block * words, level.start[block], p);
  };
  // what the links along an axis in a piece count for: those in a row are in series
  std::vector<float> inside;
  if (edge_ > 2)
  {
    inside.assign(3 * level.count(), 1.0F);
    forBlocks(blocks,
      [&](std::int64_t, std::int64_t, std::int64_t, std::size_t block)
      {
        const std::uint32_t n = level.start[block + 1] - level.start[block];
        for (std::uint32_t piece = 0; piece < n; ++piece)
        {
          std::array<std::int64_t, 3> low{ 9, 9, 9 };
          std::array<std::int64_t, 3> high{ -1, -1, -1 };
          for (std::int64_t k = 0; k < edge_ * edge_ * edge_; ++k)
            if (labelOf(labels_.data() + block * words, static_cast<std::size_t>(k), edge_) == piece)
            {
              const std::array<std::int64_t, 3> p{ k % edge_, k / edge_ % edge_, k / (edge_ * edge_) };
              for (std::size_t a = 0; a < 3; ++a)
              {
                low[a] = std::min(low[a], p[a]);
                high[a] = std::max(high[a], p[a]);
              }
            }
          for (std::size_t a = 0; a < 3; ++a)
            if (const auto length = static_cast<float>(high[a] - low[a]); length > 1)
              inside[3 * (level.start[block] + piece) + a] = 1 / (length * length);
        }
      });
  }
  link(level,
    [&](std::int64_t bx, std::int64_t by, std::int64_t bz, auto&& f)
    {
      for (std::int64_t k = 0; k < edge_ * edge_ * edge_; ++k)
      {
        const std::array<std::int64_t, 3> p{ edge_ * bx + k % edge_, edge_ * by + k / edge_ % edge_,
          edge_ * bz + k / (edge_ * edge_) };
        if (p[0] >= size[0] || p[1] >= size[1] || p[2] >= size[2])
          continue;
        const std::uint32_t here = unknown(p);
        if (here == PieceLevel::none)
          continue;
        const std::uint8_t id = field.phaseRow(p[1], p[2])[p[0]];
        for (std::size_t a = 0; a < 3; ++a)
          for (const int step : { -1, 1 })
          {
            std::array<std::int64_t, 3> q = p;
            q[a] += step;
            const bool leaves = q[a] < 0 || q[a] >= size[a];
            std::uint32_t there = PieceLevel::none;
            if (leaves && a > 0 && level.halo.has(PieceHalo::sideOf(a, step)))
            {
              const std::size_t side = PieceHalo::sideOf(a, step);
              const std::size_t place = level.halo.place(side, blockOf(p));
              there = numbered(beyond[side].data() + place * words, level.halo.start(side, place), q);
            }
            else if (leaves)
            {
              if (field.links().boundary(static_cast<int>(a)) == Boundary::Fixed)
                f(here, PieceLevel::none, static_cast<float>(field.links().wall(id, static_cast<int>(a))), a);
              if (!periodic_[a])
                continue;
              q[a] = (q[a] + size[a]) % size[a];
              there = unknown(q);
            }
            else
              there = unknown(q);
            if (there != PieceLevel::none)
              f(here, there,
                (here == there && edge_ > 2 ? inside[3 * here + a] : 1.0F) *
                  static_cast<float>(field.links().factor(static_cast<int>(a)) *
                    field.links().mean(id, field.phaseRow(q[1], q[2])[q[0]])),
                a);
          }
      }
    });
}

// The next level. Links of at least `strong` of the strongest at both ends join. Returns whether that was worth while.
bool PieceMultigrid::coarsen(double strong)
{
  PieceLevel next;
  PieceLevel& fine = levels_.back();
  const std::array<std::int64_t, 3> size = fine.blocks;
  next.shared = fine.shared;
  next.parts = fine.parts;
  next.halvings = fine.halvings + 1;
  next.depth = fine.depth + 1;
  for (std::size_t a = 0; a < 3; ++a)
  {
    next.blocks[a] = (size[a] + 1) / 2;
    next.begin[a] = fine.begin[a] / 2;
    next.all[a] = (fine.all[a] + 1) / 2;
  }
  const bool halves = next.blocks != size;
  if (fine.shared ? !lattice_->comm->any(halves) : !halves)
    return false;
  const std::size_t n = fine.count();
  fine.coarse.assign(fine.withGhosts(), PieceLevel::none);
  next.start.assign(blockCount(next.blocks) + 1, 0);

  std::vector<float>& strongest = fine.work[0]; // link of each unknown
  for (std::size_t i = 0; i < n; ++i)
  {
    strongest[i] = 0;
    for (std::size_t e = fine.row[i]; e < fine.row[i + 1]; ++e)
      strongest[i] = std::max(strongest[i], fine.linkAt(e));
  }
  // f(unknown of the fine level, its block, where along x that is) for all of a coarse block, in order
  const auto forChildren = [&](std::int64_t bx, std::int64_t by, std::int64_t bz, auto&& f)
  {
    for (std::int64_t z = 2 * bz; z < std::min(2 * bz + 2, size[2]); ++z)
      for (std::int64_t y = 2 * by; y < std::min(2 * by + 2, size[1]); ++y)
        for (std::int64_t x = 2 * bx; x < std::min(2 * bx + 2, size[0]); ++x)
        {
          const std::array<std::int64_t, 3> block{ x, y, z };
          const std::size_t at = blockIndex(size, block);
          for (std::uint32_t i = fine.start[at]; i < fine.start[at + 1]; ++i)
            f(i, block);
        }
  };
  // pieces, numbered within their block at first
  std::vector<std::uint32_t> place(n, 0); // of a child in its block
  forBlocks(next.blocks,
    [&](std::int64_t bx, std::int64_t by, std::int64_t bz, std::size_t block)
    {
      thread_local std::vector<std::uint32_t> children;
      thread_local std::vector<std::uint32_t> parent;
      children.clear();
      forChildren(bx, by, bz,
        [&](std::uint32_t i, const auto&)
        {
          place[i] = static_cast<std::uint32_t>(children.size());
          children.push_back(i);
        });
      parent.resize(children.size());
      std::iota(parent.begin(), parent.end(), 0U);
      for (std::uint32_t k = 0; k < children.size(); ++k)
      {
        const std::uint32_t i = children[k];
        for (std::size_t e = fine.row[i]; e < fine.row[i + 1]; ++e)
        {
          const std::uint32_t j = fine.other[e];
          const float enough = static_cast<float>(strong) * std::max(strongest[i], strongest[j]);
          if (j > i || j < children.front() || !std::ranges::binary_search(children, j) || fine.linkAt(e) < enough)
            continue;
          const std::uint32_t a = rootOf(parent, k);
          const std::uint32_t b = rootOf(parent, place[j]);
          parent[std::max(a, b)] = std::min(a, b);
        }
      }
      std::uint32_t pieces = 0;
      for (std::uint32_t k = 0; k < children.size(); ++k)
      {
        const std::uint32_t root = rootOf(parent, k);
        std::uint32_t& coarse = fine.coarse[children[k]];
        if (root != k)
          coarse = fine.coarse[children[root]];
        else if (fine.inverse[children[k]] > 0) // else an island that is whole: nothing is left to correct
          coarse = pieces++;
      }
      next.start[block] = pieces;
    });
  startsFromCounts(next.start);
  if (static_cast<double>(total(next)) > worthwhile * static_cast<double>(total(fine)))
  {
    fine.coarse = {};
    return false;
  }
  forBlocks(next.blocks,
    [&](std::int64_t bx, std::int64_t by, std::int64_t bz, std::size_t block)
    {
      forChildren(bx, by, bz,
        [&](std::uint32_t i, const auto&)
        {
          if (fine.coarse[i] != PieceLevel::none)
            fine.coarse[i] += next.start[block];
        });
    });
  place = {};
  if (next.shared)
  {
    next.halo = PieceHalo(*lattice_->comm, *next.parts, periodic_, next.blocks, next.start);
    coarseOfGhosts(fine, next);
  }
  // the axis along which the block of unknown j follows or precedes this one; 3: it is the same
  const auto axisTo = [&](const std::array<std::int64_t, 3>& block, std::uint32_t j)
  {
    const auto holds = [&](const std::array<std::int64_t, 3>& p)
    {
      const std::size_t at = blockIndex(size, p);
      return j >= fine.start[at] && j < fine.start[at + 1];
    };
    if (j >= n)
      return PieceHalo::axisOf(fine.halo.sideWith(j));
    if (holds(block))
      return std::size_t{ 3 };
    for (const std::size_t a : { std::size_t{ 0 }, std::size_t{ 1 } })
      for (const std::int64_t step : { std::int64_t{ -1 }, std::int64_t{ 1 } })
      {
        std::array<std::int64_t, 3> p = block;
        p[a] += step;
        if (wraps(fine)[a])
          p[a] = (p[a] + size[a]) % size[a];
        if (p[a] >= 0 && p[a] < size[a] && holds(p))
          return a;
      }
    return std::size_t{ 2 };
  };
  link(next,
    [&](std::int64_t bx, std::int64_t by, std::int64_t bz, auto&& f)
    {
      forChildren(bx, by, bz,
        [&](std::uint32_t i, const std::array<std::int64_t, 3>& block)
        {
          const std::uint32_t here = fine.coarse[i];
          if (here == PieceLevel::none)
            return;
          if (fine.wall[i] > 0)
            f(here, PieceLevel::none, fine.wall[i], std::size_t{ 0 });
          for (std::size_t e = fine.row[i]; e < fine.row[i + 1]; ++e)
            if (const std::uint32_t j = fine.other[e]; fine.coarse[j] != PieceLevel::none)
              f(here, fine.coarse[j], fine.linkAt(e), axisTo(block, j));
        });
    });
  levels_.push_back(std::move(next));
  return true;
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
    lengths[i] = static_cast<std::uint32_t>(part.row[i + 1] - part.row[i]);
  std::vector<std::uint32_t> nextLengths(n);
  part.moved->forward(lengths, nextLengths);
  next.row.assign(n + 1, 0);
  std::partial_sum(nextLengths.begin(), nextLengths.end(), next.row.begin() + 1, std::plus<std::size_t>());

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
    lengths[i] = static_cast<std::uint32_t>(part.row[i + 1] - part.row[i]);
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

void PieceMultigrid::factorize()
{
  const PieceLevel& level = levels_.back();
  if (static_cast<std::int64_t>(level.count()) > coarsestCount)
    return;
  // Where the constant is free, a little more than the sum of links chooses one; never where walls do.
  const bool walls = std::ranges::any_of(level.wall, [](float w) { return w > 0; });
  const double more = walls ? 1.0 : 1 + 1e-5;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < level.count(); ++i)
  {
    double total = static_cast<double>(level.wall[i]);
    for (std::size_t e = level.row[i]; e < level.row[i + 1]; ++e)
      total += static_cast<double>(level.linkAt(e));
    entries.emplace_back(i, i, total > 0 ? more * total : 1.0);
    for (std::size_t e = level.row[i]; e < level.row[i + 1]; ++e)
      entries.emplace_back(i, level.other[e], -static_cast<double>(level.linkAt(e)));
  }
  const auto n = static_cast<Eigen::Index>(level.count());
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  direct_.compute(matrix);
  factorized_ = direct_.info() == Eigen::Success;
}

// Block by block, and by the parity of their places: blocks of one parity are never neighbours, but where an odd number
// of them begins again. (There other ranks' unknowns are those before.)
void PieceMultigrid::relax(PieceLevel& level, bool forward) const
{
  bool meet = false;
  for (std::size_t a = 0; a < 3; ++a)
    meet = meet || (wraps(level)[a] && level.blocks[a] % 2 != 0);
  const int threads = meet || level.count() < threadedCount ? 1 : threads_;
  const auto& blocks = level.blocks;
  const auto update = [&](std::uint32_t i)
  {
    float s = level.b[i];
    for (std::size_t e = level.row[i]; e < level.row[i + 1]; ++e)
      s += level.linkAt(e) * level.x[level.other[e]];
    level.x[i] = s * level.inverse[i];
  };
  for (const int pass : { 0, 1 })
  {
    const std::int64_t colour = (forward ? pass : 1 - pass) + level.begin[0] + level.begin[1] + level.begin[2];
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
    for (std::int64_t r = 0; r < blocks[1] * blocks[2]; ++r)
      for (std::int64_t x = (r % blocks[1] + r / blocks[1] + colour) & 1; x < blocks[0]; x += 2)
      {
        const auto block = static_cast<std::size_t>(x + blocks[0] * r);
        if (forward)
          for (std::uint32_t i = level.start[block]; i < level.start[block + 1]; ++i)
            update(i);
        else
          for (std::uint32_t i = level.start[block + 1]; i-- > level.start[block];)
            update(i);
      }
    level.halo.exchange(level.x);
  }
}

template <std::size_t N>
std::array<double, N> PieceMultigrid::products(const PieceLevel& level, const std::array<Vectors, N>& pairs) const
{
  // parts do not depend on how many threads there are
  constexpr std::size_t part = 4096;
  const auto parts = static_cast<std::int64_t>((level.count() + part - 1) / part);
  std::vector<std::array<double, N>> sums(static_cast<std::size_t>(parts));
  const int threads = level.count() < threadedCount ? 1 : threads_;
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t p = 0; p < parts; ++p)
  {
    std::array<double, N> s{};
    const std::size_t begin = static_cast<std::size_t>(p) * part;
    for (std::size_t k = 0; k < N; ++k)
    {
      const Vectors& v = pairs[k];
      for (std::size_t i = begin; i < std::min(level.count(), begin + part); ++i)
        s[k] += static_cast<double>((*v[0])[i]) * static_cast<double>((*v[1])[i]);
    }
    sums[static_cast<std::size_t>(p)] = s;
  }
  std::array<double, N> all{};
  for (const auto& s : sums)
    for (std::size_t k = 0; k < N; ++k)
      all[k] += s[k];
  return all;
}

void PieceMultigrid::sumUp(const PieceLevel& level, std::span<double> sums) const
{
  if (level.shared)
    lattice_->comm->sum(sums);
}

void PieceMultigrid::cycle(std::size_t index)
{
  PieceLevel& level = levels_[index];
  std::fill(level.x.begin(), level.x.end(), 0.0F);
  if (index + 1 == levels_.size())
  {
    if (factorized_)
    {
      const auto n = static_cast<Eigen::Index>(level.count());
      const Eigen::VectorXd x = direct_.solve(Eigen::Map<const Eigen::VectorXf>(level.b.data(), n).cast<double>());
      Eigen::Map<Eigen::VectorXf>(level.x.data(), n) = x.cast<float>();
      return;
    }
    for (const bool forward : { true, false })
      for (int s = 0; s < coarsestSweeps; ++s)
        relax(level, forward);
    return;
  }
  PieceLevel& next = levels_[index + 1];
  if (level.gathered)
  {
    const auto all = gatherAll<float>(*lattice_->comm, level.b, shares_);
    for (std::size_t k = 0; k < all.size(); ++k)
      next.b[places_[k]] = all[k];
    cycleTwice(index + 1);
    for (std::size_t i = 0; i < own_.size(); ++i)
      level.x[i] = next.x[own_[i]];
    return;
  }
  if (level.moved)
  {
    level.moved->forward(level.b, next.b);
    cycleTwice(index + 1);
    level.moved->backward(next.x, level.x);
    level.halo.exchange(level.x);
    return;
  }
  for (int s = 0; s < pieceSweeps; ++s)
    relax(level, true);
  std::fill(next.b.begin(), next.b.end(), 0.0F);
  for (std::size_t i = 0; i < level.count(); ++i)
    if (level.coarse[i] != PieceLevel::none)
      next.b[level.coarse[i]] += level.b[i] - product(level, i);
  cycleTwice(index + 1);
  for (std::size_t i = 0; i < level.withGhosts(); ++i)
    if (level.coarse[i] != PieceLevel::none)
      level.x[i] += next.x[level.coarse[i]];
  for (int s = 0; s < pieceSweeps; ++s)
    relax(level, false);
}

// (A x) of an unknown. Differences first: sums of large values that nearly cancel would be round-off, once pieces that
// conduct well are linked weakly.
float PieceMultigrid::product(const PieceLevel& level, std::size_t i)
{
  const float x = level.x[i];
  float s = level.wall[i] * x;
  for (std::size_t e = level.row[i]; e < level.row[i + 1]; ++e)
    s += level.linkAt(e) * (x - level.x[level.other[e]]);
  return s;
}

// Two steps of flexible conjugate gradients around the cycle. The ranks sum once a step.
void PieceMultigrid::cycleTwice(std::size_t index)
{
  PieceLevel& level = levels_[index];
  cycle(index);
  if (index + 1 == levels_.size() || level.gathered || level.moved)
    return;
  std::vector<float>& before = level.work[0];
  std::vector<float>& first = level.work[1];
  std::vector<float>& ofX = level.work[2];
  const auto multiply = [&]
  {
    for (std::size_t i = 0; i < level.count(); ++i)
      ofX[i] = product(level, i);
  };
  multiply();
  auto firstSums = products<5>(level,
    { Vectors{ &level.x, &ofX }, { &level.x, &level.b }, { &ofX, &ofX }, { &level.b, &ofX }, { &level.b, &level.b } });
  sumUp(level, firstSums);
  const auto [xq, xb, qq, bq, bb] = firstSums;
  if (!(xq > 0))
    return;
  const double alpha = xb / xq;
  if (bb - 2 * alpha * bq + alpha * alpha * qq <= 0.0625 * bb) // what is left of b: good enough at once
  {
    for (float& x : level.x)
      x *= static_cast<float>(alpha);
    return;
  }
  first = level.x;
  std::ranges::copy(level.b, before.begin());
  for (std::size_t i = 0; i < level.count(); ++i)
    level.b[i] -= static_cast<float>(alpha) * ofX[i];
  cycle(index);
  const auto [ownZq, ownZb] = products<2>(level, { Vectors{ &level.x, &ofX }, { &level.x, &level.b } });
  multiply();
  std::array<double, 3> secondSums{ ownZq, ownZb, products<1>(level, { Vectors{ &level.x, &ofX } })[0] };
  sumUp(level, secondSums);
  const auto [zq, zb, zz] = secondSums;
  const double beta = zq / xq;
  const double energy = zz - beta * zq;
  const double gamma = energy > 0 ? zb / energy : 0;
  const auto ofFirst = static_cast<float>(alpha - gamma * beta);
  for (std::size_t i = 0; i < level.x.size(); ++i)
    level.x[i] = ofFirst * first[i] + static_cast<float>(gamma) * level.x[i];
  std::copy_n(before.begin(), level.count(), level.b.begin());
}

void PieceMultigrid::correct(LeanField& field)
{
  PieceLevel& level = levels_.front();
  const std::array<std::int64_t, 3> size = field.size();
  const auto& blocks = level.blocks;
  const std::size_t words = labelWords(edge_);
  const std::uint32_t apart = apartIn(edge_);
  const std::size_t shift = edge_ == 2 ? 0 : 1; // of every other node of a row, along x
  // f(y, z, place in its block of a row's first node, or of the part-th)
  const auto forRows = [&](std::int64_t by, std::int64_t bz, auto&& f)
  {
    for (std::int64_t z = edge_ * bz; z < std::min(edge_ * (bz + 1), size[2]); ++z)
      for (std::int64_t y = edge_ * by; y < std::min(edge_ * (by + 1), size[1]); ++y)
        f(y, z, nodeOf({ 0, y, z }, edge_));
  };
  // the piece of the i-th even (part 0) or odd node of a row, block `at` the first of it, and its block
  const auto pieceOf = [&](std::size_t at, std::size_t i, std::size_t node, std::size_t part)
  {
    const std::size_t block = at + (i >> shift);
    const std::uint32_t piece =
      labelOf(labels_.data() + block * words, node + part + 2 * (i & ((std::size_t{ 1 } << shift) - 1)), edge_);
    return piece == apart ? PieceLevel::none : level.start[block] + piece;
  };
  // the residual, summed over pieces; of one colour, as the other one was relaxed last
  const auto restricted = [&]
  {
    forBlockRows(
      blocks,
      [&](std::int64_t by, std::int64_t bz)
      {
        thread_local std::vector<float> row;
        const auto at = static_cast<std::size_t>(blocks[0] * (by + blocks[1] * bz));
        std::fill(level.b.begin() + level.start[at],
          level.b.begin() + level.start[at + static_cast<std::size_t>(blocks[0])], 0.0F);
        forRows(
          by, bz,
          [&](std::int64_t y, std::int64_t z, std::size_t node)
          {
            {
              const int part = static_cast<int>((y + z) & 1);
              row.assign(static_cast<std::size_t>((size[0] + 1 - part) / 2), 0.0F);
              field.addResidual(y, z, part, row.data());
              for (std::size_t x = 0; x < row.size(); ++x)
                if (const std::uint32_t i = pieceOf(at, x, node, static_cast<std::size_t>(part)); i != PieceLevel::none)
                  level.b[i] += row[x];
            }
          });
      });
  };
  const auto add = [&]
  {
    forBlockRows(blocks,
      [&](std::int64_t by, std::int64_t bz)
      {
        const auto at = static_cast<std::size_t>(blocks[0] * (by + blocks[1] * bz));
        forRows(by, bz,
          [&](std::int64_t y, std::int64_t z, std::size_t node)
          {
            for (const std::size_t part : { std::size_t{ 0 }, std::size_t{ 1 } })
            {
              float* v = field.halfRow(y, z, static_cast<int>(part));
              const std::size_t n = (static_cast<std::size_t>(size[0]) + 1 - part) / 2;
              for (std::size_t x = 0; x < n; ++x)
                if (const std::uint32_t i = pieceOf(at, x, node, part); i != PieceLevel::none)
                  v[x] += level.x[i];
            }
          });
      });
    field.exchange();
  };
  restricted();
  if (levels_.size() > 1)
    cycleTwice(0);
  else
    cycle(0);
  add();
}

} // namespace lamella::lbm
