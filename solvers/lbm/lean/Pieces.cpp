#include "lbm/lean/Pieces.h"

#include "lbm/lean/PieceBlocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lamella::lbm
{
namespace
{

constexpr int pieceSweeps = 3; // before and after
// Small enough to be solved directly.
constexpr std::int64_t coarsestCount = 1000;
// Levels of fewer unknowns are gathered: each rank relaxes them sooner than it hears of its neighbours.
constexpr std::int64_t sharedCount = 3000;
// The coarsest level, where it is too large for that, is relaxed that often.
constexpr int coarsestSweeps = 30;
// Where some phases do not conduct, blocks are made of twice as many nodes along each axis if more than this part of
// the nodes would be pieces, as in noise. Where all conduct they always are: half the memory, and as quick.
constexpr double manyPieces = 0.22;

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

PieceMultigrid::PieceMultigrid(const LeanField& field, int threads)
  : lattice_(&field.level())
  , periodic_(field.periodic())
  , axis_(field.axis())
  , threads_(std::max(1, threads))
{
  const bool aligned = !lattice_->comm->parallel() || lattice_->parts->levels() > 1;
  const bool allConduct = std::ranges::all_of(field.ids(), [&](std::uint8_t id) { return field.links().conducts(id); });
  label(field, aligned && allConduct ? mostEdge : 2);
  const auto nodes = static_cast<double>(lattice_->size[0] * lattice_->size[1] * lattice_->size[2]);
  if (aligned && edge_ == 2 && static_cast<double>(total(levels_.front())) > manyPieces * nodes)
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

void PieceMultigrid::factorize()
{
  const PieceLevel& level = levels_.back();
  if (static_cast<std::int64_t>(level.count()) > coarsestCount)
    return;
  // Where a constant is free, a little more than the sum of links chooses one, and it is taken off (levelled()).
  const std::size_t n = level.count();
  std::vector<std::uint32_t> parent(n);
  std::iota(parent.begin(), parent.end(), 0U);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t e = level.row[i]; e < level.row[i + 1]; ++e)
    {
      const std::uint32_t a = rootOf(parent, static_cast<std::uint32_t>(i));
      const std::uint32_t b = rootOf(parent, level.other[e]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::uint8_t> held(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    if (level.wall[i] > 0)
      held[rootOf(parent, static_cast<std::uint32_t>(i))] = 1;
  free_.assign(n, PieceLevel::none);
  for (std::size_t i = 0; i < n; ++i)
    if (const std::uint32_t root = rootOf(parent, static_cast<std::uint32_t>(i)); held[root] == 0)
      free_[i] = root;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < n; ++i)
  {
    double total = static_cast<double>(level.wall[i]);
    for (std::size_t e = level.row[i]; e < level.row[i + 1]; ++e)
      total += static_cast<double>(level.linkAt(e));
    const double more = free_[i] == PieceLevel::none ? 1.0 : 1 + 1e-5;
    entries.emplace_back(i, i, total > 0 ? more * total : 1.0);
    for (std::size_t e = level.row[i]; e < level.row[i + 1]; ++e)
      entries.emplace_back(i, level.other[e], -static_cast<double>(level.linkAt(e)));
  }
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  direct_.compute(matrix);
  factorized_ = direct_.info() == Eigen::Success;
}

// Less the mean of each set of linked unknowns of which a constant is free.
Eigen::VectorXd PieceMultigrid::levelled(Eigen::VectorXd v) const
{
  std::vector<double> sum(free_.size(), 0.0);
  std::vector<double> count(free_.size(), 0.0);
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (free_[i] != PieceLevel::none)
    {
      sum[free_[i]] += v[static_cast<Eigen::Index>(i)];
      count[free_[i]] += 1;
    }
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (free_[i] != PieceLevel::none)
      v[static_cast<Eigen::Index>(i)] -= sum[free_[i]] / count[free_[i]];
  return v;
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
      // else round-off in b would come back as a large constant
      const Eigen::VectorXd b = levelled(Eigen::Map<const Eigen::VectorXf>(level.b.data(), n).cast<double>());
      const Eigen::VectorXd x = levelled(direct_.solve(b));
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
