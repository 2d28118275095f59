// Which nodes, and which pieces, are pieces of the next level, and the links between them.
#include "core/Error.h"
#include "lbm/lean/PieceBlocks.h"
#include "lbm/multigrid/Multigrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lamella::lbm
{
namespace
{

// The same as strongPart for all links along an axis, where spacings differ.
constexpr double strongAxis = 0.1;
// A part goes with another one of its block that has more than this part of its links.
constexpr double hangingPart = 0.5;
// Links in series keep at least this part of the link between: of blocks' pieces that all conduct alike, and of others,
// among which a link kept too large holds back what hangs by weak ones.
constexpr double leastAlike = static_cast<double>(leastBlockLink);
constexpr double leastUnlike = 0.125;
// A level that is not smaller than this part of the one before ends the coarsening.
constexpr double worthwhile = 0.8;
constexpr std::size_t mostNodes = PieceMultigrid::mostEdge * PieceMultigrid::mostEdge * PieceMultigrid::mostEdge;

// In double, for a link is made at either end of it, and both have to come to the same 16 bits.
double half(float inside)
{
  return inside > 0 ? 0.5 / static_cast<double>(inside) : 0.0;
}

double inSeries(double between, float insideHere, float insideThere, double least)
{
  return between > 0 ? std::max(least * between, 1 / (half(insideHere) + 1 / between + half(insideThere))) : 0.0;
}

// A few sums by key, in the order in which keys come first.
struct Few
{
  std::vector<std::uint32_t> key;
  std::vector<double> sum;
  void clear()
  {
    key.clear();
    sum.clear();
  }
  void add(std::uint32_t k, double value)
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

// What strong links have joined in a block, and the links that are left. A part that hangs on another one of the block
// by most of its links goes where that goes, and need not be an unknown of its own: sweeps find the rest. Not where its
// own links are stronger than those to others: sweeps do not move such a part as a whole.
class Hanging
{
public:
  void start(std::size_t parts)
  {
    if (to_.size() < parts)
      to_.resize(parts);
    for (std::size_t i = 0; i < parts; ++i)
      to_[i].clear();
    for (auto* sums : { &inside_, &outside_ })
      sums->assign(parts, 0.0);
  }
  void inwards(std::size_t part, double link) { inside_[part] += link; }
  void outwards(std::size_t part, double link) { outside_[part] += link; }
  void between(std::size_t part, std::size_t other, double link)
  {
    outwards(part, link);
    to_[part].add(static_cast<std::uint32_t>(other), link);
  }
  [[nodiscard]] double outside(std::size_t part) const { return outside_[part]; }
  // The part that this one hangs on, or itself.
  [[nodiscard]] std::size_t on(std::size_t part) const
  {
    const Few& few = to_[part];
    for (std::size_t k = 0; k < few.key.size(); ++k)
      if (few.sum[k] > hangingPart * outside_[part] && inside_[part] <= outside_[part])
        return few.key[k];
    return part;
  }

private:
  std::vector<double> inside_; // links within a part, from either end
  std::vector<double> outside_;
  std::vector<Few> to_;
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

} // namespace

// Joins the pieces of a block of nodes with those that they hang on.
// @param id phase of each node, or -1  @param parent of each node towards the least one of its piece
void PieceMultigrid::hangPieces(const LeanField& field, const std::array<std::int64_t, 3>& block,
  std::span<const int> id, std::span<std::uint8_t> parent) const
{
  const Links& links = field.links();
  const std::array<std::int64_t, 3> size = field.size();
  const auto root = [&](std::size_t i)
  {
    while (parent[i] != i)
      i = parent[i];
    return i;
  };
  std::array<std::size_t, mostNodes> piece{};
  for (std::size_t i = 0; i < id.size(); ++i)
    piece[i] = root(i);
  thread_local Hanging hanging;
  hanging.start(id.size());
  for (std::size_t i = 0; i < id.size(); ++i)
  {
    if (id[i] < 0)
      continue;
    const auto phase = static_cast<std::uint8_t>(id[i]);
    const auto at = static_cast<std::int64_t>(i);
    const std::array<std::int64_t, 3> inBlock{ at % edge_, at / edge_ % edge_, at / (edge_ * edge_) };
    for (std::size_t a = 0; a < 3; ++a)
      for (const int step : { -1, 1 })
      {
        std::array<std::int64_t, 3> p{ edge_ * block[0] + inBlock[0], edge_ * block[1] + inBlock[1],
          edge_ * block[2] + inBlock[2] };
        p[a] += step;
        const int axis = static_cast<int>(a);
        const std::int64_t global = lattice_->start[a] + p[a];
        if ((global < 0 || global >= lattice_->size[a]) && !periodic_[a])
        {
          if (links.boundary(axis) == Boundary::Fixed)
            hanging.outwards(piece[i], links.wall(phase, axis));
          continue;
        }
        const bool within = inBlock[a] + step >= 0 && inBlock[a] + step < edge_ && p[a] < size[a];
        if (!within && size[a] == lattice_->size[a])
          p[a] = (p[a] + size[a]) % size[a]; // else a ghost row
        const double link = links.factor(axis) * links.mean(phase, field.phaseRow(p[1], p[2])[p[0]], axis);
        if (!within)
          hanging.outwards(piece[i], link);
        else if (const std::size_t other = piece[nodeOf(p, edge_)]; other == piece[i])
          hanging.inwards(piece[i], link);
        else if (link > 0)
          hanging.between(piece[i], other, link);
      }
  }
  for (std::size_t i = 0; i < id.size(); ++i)
  {
    if (id[i] < 0 || piece[i] != i)
      continue;
    const std::size_t here = root(i);
    const std::size_t there = root(hanging.on(i));
    parent[std::max(here, there)] = static_cast<std::uint8_t>(std::min(here, there));
  }
}

// The pieces of every block of nodes.
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
  // which phases are joined, along which axes: a bit each
  std::vector<std::uint8_t> joined(256 * 256, 0);
  everyLink_ = true;
  const std::span<const std::uint8_t> ids = field.ids();
  const Links& links = field.links();
  for (const int axis : { 0, 1, 2 })
    for (const std::uint8_t a : ids)
      for (const std::uint8_t b : ids)
      {
        const double link = links.mean(a, b, axis);
        const bool strong = link > 0 && link >= strongPart * std::max(links.mean(a, a, axis), links.mean(b, b, axis));
        joined[static_cast<std::size_t>(a) * 256 + b] |= static_cast<std::uint8_t>((strong ? 1U : 0U) << axis);
        everyLink_ = everyLink_ && (strong || !(link > 0));
      }
  const std::array<bool, 3> alongJoined = strongAxes(links, lattice_->size);
  everyLink_ = everyLink_ && alongJoined == std::array<bool, 3>{ true, true, true };
  const std::array<std::size_t, 3> steps{ 1, static_cast<std::size_t>(edge), static_cast<std::size_t>(edge * edge) };
  forBlocks(first.blocks,
    [&](std::int64_t bx, std::int64_t by, std::int64_t bz, std::size_t block)
    {
      std::array<std::uint8_t, mostNodes> parent{}; // towards the least node of its piece
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
                (joined[static_cast<std::size_t>(id[n]) * 256 + static_cast<std::size_t>(id[n - steps[a]])] >> a &
                  1U) != 0)
              {
                const std::size_t i = root(n);
                const std::size_t j = root(n - steps[a]);
                parent[std::max(i, j)] = static_cast<std::uint8_t>(std::min(i, j));
              }
          }
        }
      if (!everyLink_)
        hangPieces(
          field, { bx, by, bz }, std::span<const int>(id).first(nodes), std::span<std::uint8_t>(parent).first(nodes));
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
  const double least = everyLink_ ? leastAlike : leastUnlike;
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
              few[here - begin][there >= begin && there < end ? 3 : axis].add(there, static_cast<double>(link));
          });
        for (std::uint32_t i = begin; i < end; ++i)
        {
          std::size_t at = level.row[i];
          const double wall =
            inSeries(static_cast<double>(level.wall[i]), level.work[static_cast<std::size_t>(axis_)][i], 0, least);
          double total = wall;
          for (std::size_t axis = 0; axis < 4; ++axis)
          {
            Few& f = few[i - begin][axis];
            for (std::size_t k = 0; k < f.key.size(); ++k, ++at)
              if (fill)
              {
                const double link =
                  axis == 3 ? f.sum[k] : inSeries(f.sum[k], level.work[axis][i], level.work[axis][f.key[k]], least);
                level.other[at] = f.key[k];
                level.link[at] = PieceLevel::packed(static_cast<float>(link));
                total += static_cast<double>(level.linkAt(at));
              }
            f.clear();
          }
          if (fill)
          {
            level.wall[i] = static_cast<float>(wall);
            level.inverse[i] = total > 0 ? static_cast<float>(1 / total) : 0.0F;
          }
          else
            level.row[i] = static_cast<std::uint32_t>(at); // a count, from 0
        }
      });
    if (fill)
      break;
    std::size_t before = 0;
    for (auto& r : level.row)
      before += r;
    if (lattice_->comm->any(before > std::numeric_limits<std::uint32_t>::max()))
      throw MemoryError("pieces of a rank's part have more links than can be counted", "solve on more ranks");
    startsFromCounts(level.row);
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
  // what conducts best in a piece: what hangs on it is not what a flux through it goes by
  std::vector<float> best(level.count(), 0.0F);
  // and what the links along an axis in it count for: those in a row are in series
  std::vector<float> inside(edge_ > 2 ? 3 * level.count() : 0, 1.0F);
  const auto counts = [&](std::uint32_t piece, double link)
  { return link >= strongPart * static_cast<double>(best[piece]); };
  forBlocks(
    blocks,
    [&](std::int64_t bx, std::int64_t by, std::int64_t bz, std::size_t block)
    {
      const std::uint32_t begin = level.start[block];
      // f(node's place in the box and in the block, its piece and phase)
      const auto forNodes = [&](auto&& f)
      {
        for (std::int64_t k = 0; k < edge_ * edge_ * edge_; ++k)
        {
          const std::array<std::int64_t, 3> in{ k % edge_, k / edge_ % edge_, k / (edge_ * edge_) };
          const std::array<std::int64_t, 3> p{ edge_ * bx + in[0], edge_ * by + in[1], edge_ * bz + in[2] };
          if (p[0] >= size[0] || p[1] >= size[1] || p[2] >= size[2])
            continue;
          const std::uint32_t piece = numbered(labels_.data() + block * words, begin, p);
          if (piece != PieceLevel::none)
            f(in, piece, field.phaseRow(p[1], p[2])[p[0]]);
        }
      };
      forNodes([&](const auto&, std::uint32_t piece, std::uint8_t id)
        { best[piece] = std::max(best[piece], static_cast<float>(field.links().diffusivity(id))); });
      if (edge_ == 2)
        return;
      thread_local std::vector<std::array<std::int64_t, 3>> low;
      thread_local std::vector<std::array<std::int64_t, 3>> high;
      low.assign(level.start[block + 1] - begin, { edge_, edge_, edge_ });
      high.assign(low.size(), { -1, -1, -1 });
      forNodes(
        [&](const auto& in, std::uint32_t piece, std::uint8_t id)
        {
          if (!counts(piece, field.links().diffusivity(id)))
            return;
          for (std::size_t a = 0; a < 3; ++a)
          {
            low[piece - begin][a] = std::min(low[piece - begin][a], in[a]);
            high[piece - begin][a] = std::max(high[piece - begin][a], in[a]);
          }
        });
      for (std::uint32_t piece = begin; piece < level.start[block + 1]; ++piece)
        for (std::size_t a = 0; a < 3; ++a)
          if (const auto length = static_cast<float>(high[piece - begin][a] - low[piece - begin][a]); length > 1)
            inside[3 * piece + a] = 1 / (length * length);
    });
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
            if (there == PieceLevel::none)
              continue;
            const double mean = field.links().mean(id, field.phaseRow(q[1], q[2])[q[0]], static_cast<int>(a));
            if (here == there && !counts(here, mean))
              continue;
            f(here, there,
              (here == there && edge_ > 2 ? inside[3 * here + a] : 1.0F) *
                static_cast<float>(field.links().factor(static_cast<int>(a)) * mean),
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
  std::vector<std::uint8_t> hangs(n, 0);  // on others of its piece
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
      // those that hang on others
      thread_local std::vector<std::uint32_t> part;
      thread_local Hanging hanging;
      part.resize(children.size());
      hanging.start(children.size());
      for (std::uint32_t k = 0; k < children.size(); ++k)
        part[k] = rootOf(parent, k);
      for (std::uint32_t k = 0; k < children.size(); ++k)
      {
        const std::uint32_t i = children[k];
        hanging.outwards(part[k], static_cast<double>(fine.wall[i]));
        for (std::size_t e = fine.row[i]; e < fine.row[i + 1]; ++e)
        {
          const std::uint32_t j = fine.other[e];
          const double link = static_cast<double>(fine.linkAt(e));
          if (!std::ranges::binary_search(children, j))
            hanging.outwards(part[k], link);
          else if (part[place[j]] == part[k])
            hanging.inwards(part[k], link);
          else
            hanging.between(part[k], part[place[j]], link);
        }
      }
      for (std::uint32_t k = 0; k < children.size(); ++k)
        if (part[k] == k)
        {
          const std::uint32_t a = rootOf(parent, k);
          const std::uint32_t b = rootOf(parent, static_cast<std::uint32_t>(hanging.on(k)));
          parent[std::max(a, b)] = std::min(a, b);
        }
      // where the most links are, a flux through the piece goes by
      thread_local std::vector<std::uint32_t> main;
      main.resize(children.size());
      std::iota(main.begin(), main.end(), 0U);
      for (std::uint32_t k = 0; k < children.size(); ++k)
        if (std::uint32_t& m = main[rootOf(parent, k)]; hanging.outside(part[k]) > hanging.outside(part[m]))
          m = k;
      for (std::uint32_t k = 0; k < children.size(); ++k)
        hangs[children[k]] = part[k] != part[main[rootOf(parent, k)]] ? 1 : 0;
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
            {
              const bool aside = here == fine.coarse[j] && (hangs[i] != 0 || hangs[j] != 0);
              f(here, fine.coarse[j], fine.linkAt(e), aside ? 3 : axisTo(block, j));
            }
        });
    });
  levels_.push_back(std::move(next));
  return true;
}

} // namespace lamella::lbm
