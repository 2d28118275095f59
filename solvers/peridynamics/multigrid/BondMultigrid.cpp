#include "peridynamics/multigrid/BondMultigrid.h"

#include "core/Together.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/multigrid/BondRows.h"
#include "peridynamics/multigrid/Fold.h"
#include "peridynamics/multigrid/FreeBlocks.h"
#include "peridynamics/multigrid/Galerkin.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lamella::peridynamics
{
namespace
{

// Reproducible numbers without a pattern, the same for a node whatever rank holds it.
constexpr int sweepsInstead = 10; // of a coarsest level that is too large to be factorised

float noise(std::uint64_t key)
{
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9ULL;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebULL;
  key ^= key >> 31;
  return static_cast<float>(key >> 40) / static_cast<float>(1U << 23) - 1.0F;
}

/// Axes along which the next level sees the last two nodes as one.
std::array<bool, 3> foldedAxes(const Level& level)
{
  return { isFolded(level.layout, level.periodic, 0), isFolded(level.layout, level.periodic, 1),
    isFolded(level.layout, level.periodic, 2) };
}

double dot(const NodeField<float>& a, const NodeField<float>& b)
{
  const NodeLayout& l = a.layout();
  std::vector<double> sums(static_cast<std::size_t>(l.size[1] * l.size[2]));
  forOwnRows(l,
    [&](std::int64_t y, std::int64_t z)
    {
      double sum = 0;
      const std::int64_t i = l.index(0, y, z);
      for (int c = 0; c < l.dimension; ++c)
        for (std::int64_t x = 0; x < l.size[0]; ++x)
          sum += static_cast<double>(a.component(c)[i + x]) * static_cast<double>(b.component(c)[i + x]);
      sums[static_cast<std::size_t>(y + l.size[1] * z)] = sum;
    });
  double total = 0;
  for (const double s : sums)
    total += s;
  return total;
}

} // namespace

BondMultigrid::BondMultigrid(
  const BondLattice& bonds, const FixedComponents& fixed, const MultigridOptions& options, NodeField<float>* work)
  : bonds_(bonds)
  , fixed_(fixed)
  , options_(options)
  , ownForce_(work != nullptr ? NodeField<float>() : NodeField<float>(bonds.layout()))
  , force_(work != nullptr ? *work : ownForce_)
{
  const NodeField<float> diagonal = buildFinest();
  if (coarsenable())
    coarsen(rowsOfBonds(bonds_, fixed_, diagonal));
  while (levels_.size() > 1 && !levels_.back()->gathered) // others have the rest
    if (coarsenable())
      coarsen(rowsOf(*levels_.back()));
    else if (levels_.back()->comm->parallel())
      gather();
    else
      break;
  together(*levels_.front()->comm, // who has no part in it would wait for those who failed
    [&]
    {
      if (levels_.size() > 1 && !levels_.back()->gathered && CoarsestLevel::possible(levels_.back()->layout))
        coarsest_.emplace(*levels_.back());
    });
  for (const auto& level : levels_)
    level->arrange();
  translation_ = NodeField<float>();
  if (options_.lean && (options_.degree != 1 || levels_.size() < 2 || levels_.front()->gathered))
    throw std::logic_error("a lean hierarchy smooths once, and has a coarser level at hand");
  if (options_.lean)
    levels_.front()->r = levels_.front()->d = NodeField<float>();
}

BondMultigrid::~BondMultigrid() = default;

NodeField<float> BondMultigrid::buildFinest()
{
  levels_.push_back(std::make_unique<Level>());
  Level& top = *levels_.front();
  top.layout = bonds_.layout();
  top.periodic = bonds_.periodic();
  top.comm = &bonds_.communicator();
  top.rim = LevelRim(top.layout, top.periodic, *top.comm);
  top.allocateVectors();

  FreeBlocks blocks(bonds_, fixed_);
  fixedNodes_ = std::move(blocks.fixedNodes);
  // a partly fixed node's block is singular for that reason
  hinges_ = top.comm->sum(invertBlocks(blocks.free, top.inverse) - blocks.partlyFixed);
  estimateSpectrum(0);
  return std::move(blocks.all);
}

bool BondMultigrid::halvable(const Level& level) const
{
  const NodeLayout& l = level.layout;
  std::int64_t nodes = 1;
  std::int64_t coarse = 1;
  bool possible = true;
  for (std::size_t a = 0; a < static_cast<std::size_t>(l.dimension); ++a)
  {
    nodes *= l.global[a];
    coarse *= l.global[a] / 2 + (level.periodic[a] ? 0 : 1);
    possible = possible && (!level.periodic[a] || l.global[a] >= 4);
    // the residual of the last two nodes comes from the rim, which is one deep at a horizon of one; and a bond leads
    // over them once
    possible = possible && (!isFolded(l, level.periodic, a) || (l.ghost > 1 && l.global[a] > reach(level) + 1));
  }
  return possible && nodes > options_.coarsest && coarse < nodes && levels_.size() < maxLevels &&
    (!level.comm->parallel() || nodes > options_.gather);
}

bool BondMultigrid::coarsenable() const
{
  const Level& level = *levels_.back();
  const NodeLayout& l = level.layout;
  if (!halvable(level))
    return false;
  if (!level.comm->parallel())
    return true;
  const auto a = static_cast<std::size_t>(l.dimension - 1);
  const bool last = l.start[a] + l.size[a] == l.global[a];
  const bool good = l.start[a] % 2 == 0 && (last || l.size[a] % 2 == 0) && l.size[a] / 2 >= coarseReach(reach(level));
  return !level.comm->any(!good);
}

int BondMultigrid::reach(const Level& level) const
{
  return &level == levels_.front().get() ? bonds_.stencil().layers() : level.layout.ghost;
}

void BondMultigrid::coarsen(const MatrixRows& rows)
{
  const Level& fine = *levels_.back();
  auto coarse = std::make_unique<Level>();
  coarse->halvings = fine.halvings + 1;
  const NodeLayout& l = fine.layout;
  std::array<std::int64_t, 3> size = l.size;
  std::array<std::int64_t, 3> start = l.start;
  std::array<std::int64_t, 3> global = l.global;
  for (std::size_t a = 0; a < static_cast<std::size_t>(l.dimension); ++a)
  {
    const bool end = l.start[a] + l.size[a] == l.global[a] && !fine.periodic[a];
    size[a] = l.size[a] / 2 + (end ? 1 : 0);
    start[a] = l.start[a] / 2;
    global[a] = l.global[a] / 2 + (fine.periodic[a] ? 0 : 1);
  }
  coarse->periodic = fine.periodic;
  coarse->layout = NodeLayout::make(l.dimension, coarseReach(rows.reach), size, start, global, coarse->periodic[0]);
  coarse->comm = fine.comm;
  coarse->rim = LevelRim(coarse->layout, coarse->periodic, *coarse->comm);
  const bool pack = options_.packFrom > 0 && coarse->layout.owned() >= options_.packFrom && coarse->rimless();
  galerkinProduct(rows, l, *coarse, pack);
  if (coarse->packed())
    balance(rows, *coarse);
  addLevel(std::move(coarse));
}

void BondMultigrid::addLevel(std::unique_ptr<Level> level)
{
  level->allocateVectors();
  invertBlocks(level->diagonal, level->inverse, level->packed() ? singularShareOfPacked : singularShare);
  levels_.push_back(std::move(level));
  estimateSpectrum(levels_.size() - 1);
}

// What a translation costs is that at fixed nodes alone, whatever rounding did to the blocks: diagonal blocks are that
// less the others of their row.
void BondMultigrid::balance(const MatrixRows& rows, Level& coarse)
{
  const Level& fine = *levels_.back();
  if (levels_.size() == 1)
    translate(rows);
  const NodeLayout& f = fine.layout;
  const NodeLayout& l = coarse.layout;
  const int d = l.dimension;
  const int entries = coarse.entries();
  NodeField<float> sums(l, entries);
  const std::int64_t reachZ = d == 3 ? 1 : 0;
  forOwnRows(l,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      for (int e = 0; e < entries; ++e)
      {
        RestrictedRow row;
        for (std::int64_t dz = -reachZ; dz <= reachZ; ++dz)
          for (std::int64_t dy = -1; dy <= 1; ++dy)
            if (2 * y + dy < f.size[1] && 2 * z + dz < f.size[2])
              row.add(translation_.component(e) + f.index(0, 2 * y + dy, 2 * z + dz), dy, dz);
        row.restrictTo(l.size[0], { sums.component(e) + i });
      }
      for (int e = 0; e < entries; ++e)
      {
        float* to = coarse.diagonal.component(e) + i;
        std::copy_n(sums.component(e) + i, l.size[0], to);
        for (std::size_t q = 0; q < coarse.half.size(); ++q)
        {
          const auto& s = coarse.half[q];
          const int component = static_cast<int>(q) * entries + e;
          const bool mirrored = y - s[1] >= 0 && y - s[1] < l.size[1] && z - s[2] >= 0;
          for (std::int64_t x = 0; x < l.size[0]; ++x)
          {
            to[x] -= coarse.value(component, i + x);
            if (mirrored && x - s[0] >= 0 && x - s[0] < l.size[0])
              to[x] -= coarse.value(component, l.index(x - s[0], y - s[1], z - s[2]));
          }
        }
      }
    });
  translation_ = std::move(sums);
}

// Of the finest level: the springs that lead to fixed nodes, and what holds a partly fixed one.
void BondMultigrid::translate(const MatrixRows& rows)
{
  Level& top = *levels_.front();
  const NodeLayout& l = top.layout;
  const int d = l.dimension;
  const std::uint8_t all = allComponents(d);
  translation_ = NodeField<float>(l, top.entries());
  for (int c = 0; c < d; ++c)
  {
    for (int a = 0; a < d; ++a)
      for (std::int64_t i = 0; i < l.count(); ++i)
        top.d.component(a)[i] = a == c && fixed_[i] != all ? 1.0F : 0.0F;
    linearForce(bonds_, top.d, force_); // −A d
    for (int e = 0; e < top.entries(); ++e)
      if (entryColumn[d - 2][e] == c)
        for (std::int64_t i = 0; i < l.count(); ++i)
          translation_.component(e)[i] = -force_.component(entryRow[d - 2][e])[i];
  }
  std::vector<float> diagonal(static_cast<std::size_t>(l.pitch * top.entries()));
  for (const std::int64_t i : fixedNodes_)
  {
    if (fixed_[i] != all)
    {
      const std::array<std::int64_t, 3> n = l.node(i);
      rows.diagonal(n[1], n[2], diagonal.data(), l.pitch);
      for (int c = 0; c < d; ++c)
        if ((fixed_[i] >> c & 1U) != 0)
          translation_.component(c)[i] +=
            diagonal[static_cast<std::size_t>(c * l.pitch + n[0])] * (fixedSpring / (1 + fixedSpring));
      continue;
    }
    for (int e = 0; e < top.entries(); ++e)
      translation_.component(e)[i] = 0;
  }
}

// The same lattice in thicker slabs on fewer ranks, where it can be halved then; otherwise whole on every rank, which
// then does the rest for itself.
void BondMultigrid::gather()
{
  Level& part = *levels_.back();
  part.gathered = true;
  const NodeLayout& l = part.layout;
  const std::int64_t slabs = halvable(part)
    ? Agglomeration::slabs(l.global[static_cast<std::size_t>(l.dimension - 1)], coarseReach(reach(part)), *part.comm)
    : 1;
  auto whole = std::make_unique<Level>();
  whole->halvings = part.halvings;
  whole->comm = &alone_;
  whole->layout = NodeLayout::make(l.dimension, l.ghost, l.global, {}, l.global, part.periodic[0]);
  if (slabs > 1)
  {
    part.agglomeration = std::make_unique<Agglomeration>(l, *part.comm, slabs);
    whole->comm = &part.agglomeration->comm();
    whole->layout = part.agglomeration->layout();
  }
  const bool mine = slabs == 1 || part.agglomeration->leads();
  if (mine)
  {
    whole->periodic = part.periodic;
    whole->rim = LevelRim(whole->layout, whole->periodic, *whole->comm);
    whole->half = part.half;
    whole->blocks = NodeField<float>(whole->layout, part.blocks.components());
    whole->diagonal = NodeField<float>(whole->layout, part.diagonal.components());
  }
  for (auto [from, to] : { std::pair(&part.blocks, &whole->blocks), std::pair(&part.diagonal, &whole->diagonal) })
    for (int c = 0; c < from->components(); ++c) // one by one: a message is shorter
      gatherField(part, *from, c, 1, mine ? to : nullptr);
  // corrections and residuals are left
  part.half.clear();
  part.blocks = part.diagonal = part.inverse = part.d = NodeField<float>();
  if (!mine)
    return;
  whole->rim.fill(whole->blocks);
  whole->rim.fill(whole->diagonal);
  addLevel(std::move(whole));
}

void BondMultigrid::gatherField(
  const Level& part, const NodeField<float>& field, int first, int count, NodeField<float>* out) const
{
  if (part.agglomeration)
  {
    part.agglomeration->gather(field, out, first, count);
    return;
  }
  const auto a = static_cast<std::size_t>(part.layout.dimension - 1);
  const Communicator& comm = *part.comm;
  const std::int64_t layer = (part.layout.dimension == 3 ? part.layout.rowsY() : 1) * part.layout.pitch;
  std::vector<int> counts(static_cast<std::size_t>(comm.size()));
  std::vector<int> begins(counts.size());
  const int mine = static_cast<int>(layer * part.layout.size[a]);
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, comm.handle());
  for (std::size_t r = 1; r < counts.size(); ++r)
    begins[r] = begins[r - 1] + counts[r - 1];
  for (int c = first; c < first + count; ++c) // the pitch is the same
    MPI_Allgatherv(field.component(c) + part.layout.begin(0) + part.layout.ghost * layer, mine, MPI_FLOAT,
      out->component(c) + out->layout().begin(0) + out->layout().ghost * layer, counts.data(), begins.data(), MPI_FLOAT,
      comm.handle());
}

// What the ranks with the level's thicker slabs, or each for itself, find for it.
void BondMultigrid::visitGathered(std::size_t index)
{
  Level& level = *levels_[index];
  const int d = level.layout.dimension;
  Level* whole = index + 1 < levels_.size() ? levels_[index + 1].get() : nullptr;
  gatherField(level, level.r, 0, d, whole != nullptr ? &whole->r : nullptr);
  if (whole != nullptr)
    visit(index + 1);
  if (level.agglomeration)
  {
    level.agglomeration->spread(whole != nullptr ? &whole->x : nullptr, level.x);
    return;
  }
  const auto a = static_cast<std::size_t>(d - 1);
  const std::int64_t layer = (d == 3 ? level.layout.rowsY() : 1) * level.layout.pitch;
  for (int c = 0; c < d; ++c)
    std::copy_n(whole->x.component(c) + whole->layout.begin(0) + (whole->layout.ghost + level.layout.start[a]) * layer,
      level.layout.size[a] * layer, level.x.component(c) + level.layout.begin(0) + level.layout.ghost * layer);
}

void BondMultigrid::shareOut(const LayerShare& layers)
{
  if (!layers.parallel())
    return;
  levels_.front()->share = layers;
  for (std::size_t k = 0; k < levels_.size(); ++k)
  {
    Level& level = *levels_[k];
    if (k > 0)
      level.share = levels_[k - 1]->share.halved(layersOf(level.layout));
    const bool all = k > 0 && (k + 1 == levels_.size() || level.layout.owned() <= options_.gather);
    level.shared = !all && (k == 0 || levels_[k - 1]->shared) && level.share.fewest() >= reach(level);
    if (!level.shared)
      return;
  }
}

std::int64_t BondMultigrid::bytes() const noexcept
{
  std::int64_t total = static_cast<std::int64_t>(sizeof(float)) * ownForce_.components() * ownForce_.layout().count() +
    (coarsest_ ? coarsest_->bytes() : 0);
  for (const auto& level : levels_)
    total += level->bytes();
  for (const auto& trace : traces_)
    total += trace.layout().count() * static_cast<std::int64_t>(sizeof(float));
  return total;
}

void BondMultigrid::subtract(std::size_t index)
{
  Level& level = *levels_[index];
  level.rim.fill(level.d);
  if (level.shared)
    level.share.exchange(level.d, reach(level));
  if (index > 0)
  {
    subtractProduct(level, level.d, level.r);
    return;
  }
  multiply(level.d);
  forOwnRows(level,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = level.layout.index(0, y, z);
      for (int c = 0; c < level.layout.dimension; ++c)
        levelKernels().axpy(level.layout.size[0], 1.0F, force_.component(c) + i, level.r.component(c) + i);
    });
  release(level.r);
}

void BondMultigrid::multiply(NodeField<float>& u)
{
  const Level& level = *levels_.front();
  ++products_;
  if (level.shared)
    linearForceOfLayers(bonds_, u, force_, level.share.first(), level.share.last());
  else
    linearForce(bonds_, u, force_);
}

void BondMultigrid::leanResidual(const NodeField<float>& input)
{
  Level& level = *levels_.front();
  level.rim.fill(level.x);
  if (level.shared)
    level.share.exchange(level.x, reach(level));
  multiply(level.x);
  forOwnRows(level,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = level.layout.index(0, y, z);
      for (int c = 0; c < level.layout.dimension; ++c)
        levelKernels().axpy(level.layout.size[0], 1.0F, input.component(c) + i, force_.component(c) + i);
    });
  release(force_);
}

// What is fixed has no inverse, so nothing need be taken out of the input.
void BondMultigrid::leanCycle(const NodeField<float>& input)
{
  Level& level = *levels_.front();
  const float scale = 4.0F / (3.0F * level.lambda);
  chebyshev(level, input, 0.0F, scale, true);
  leanResidual(input);
  restrictResidual(0, force_);
  visit(1);
  interpolate(0);
  leanResidual(input);
  chebyshev(level, force_, 0.0F, scale, false);
}

void BondMultigrid::release(NodeField<float>& field) const
{
  for (const std::int64_t i : fixedNodes_)
    for (int c = 0; c < field.components(); ++c)
      if ((fixed_[i] >> c & 1U) != 0)
        field.component(c)[i] = 0;
}

void BondMultigrid::chebyshev(Level& level, const NodeField<float>& residual, float a, float b, bool first)
{
  const bool kept = level.d.components() > 0;
  const NodeLayout& l = level.layout;
  forOwnRows(level,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      const float* inverse[6];
      const float* r[3];
      float* d[3];
      float* x[3];
      thread_local std::vector<float> step; // nobody asks for it afterwards
      if (!kept)
        step.resize(static_cast<std::size_t>(l.size[0]));
      for (int e = 0; e < level.entries(); ++e)
        inverse[e] = level.inverse.component(e) + i;
      for (int c = 0; c < l.dimension; ++c)
      {
        r[c] = residual.component(c) + i;
        d[c] = kept ? level.d.component(c) + i : step.data();
        x[c] = level.x.component(c) + i;
      }
      levelKernels().chebyshev(l.dimension, l.size[0], a, b, inverse, r, d, x, first);
    });
}

// x += p(D⁻¹A) D⁻¹ r. The residual is left as it is before the last step, whose step is in d.
void BondMultigrid::smooth(std::size_t index, bool first)
{
  Level& level = *levels_[index];
  const float scale = 4.0F / level.lambda;
  chebyshev(level, level.r, 0.0F, scale / 3.0F, first);
  for (int k = 1; k < options_.degree; ++k)
  {
    subtract(index);
    const auto n = static_cast<float>(2 * k + 3);
    chebyshev(level, level.r, static_cast<float>(2 * k - 1) / n, scale * static_cast<float>(2 * k + 1) / n, false);
  }
}

// A W-cycle from the third level to the fifth, where it costs next to nothing: it is there that bilinear interpolation
// no longer knows how thin walls bend.
void BondMultigrid::visit(std::size_t index)
{
  cycle(index, true);
  const Level& level = *levels_[index];
  if (level.halvings < options_.twiceFrom || level.halvings >= options_.twiceBelow || level.gathered ||
    index + 1 == levels_.size())
    return;
  subtract(index); // what smoothing added last: r is the residual of x again
  cycle(index, false);
}

void BondMultigrid::cycle(std::size_t index, bool fromZero)
{
  Level& level = *levels_[index];
  if (level.gathered)
  {
    visitGathered(index);
    return;
  }
  if (index > 0 && index + 1 == levels_.size())
  {
    if (coarsest_)
    {
      coarsest_->solve(level);
      return;
    }
    // too large, and periodic sides that cannot be halved, of two or three nodes: what smoothing can do
    smooth(index, fromZero);
    for (int sweep = 1; sweep < sweepsInstead; ++sweep)
    {
      subtract(index);
      smooth(index, false);
    }
    return;
  }
  smooth(index, fromZero);
  if (index + 1 == levels_.size())
    return;
  subtract(index);
  restrictResidual(index, level.r);
  visit(index + 1);
  interpolate(index);
  subtract(index);
  smooth(index, false);
}

void BondMultigrid::restrictResidual(std::size_t index, NodeField<float>& residual)
{
  Level& level = *levels_[index];
  Level& next = *levels_[index + 1];
  level.rim.fill(residual);
  if (level.shared)
    level.share.exchange(residual, 1);
  const NodeLayout& l = level.layout;
  const NodeLayout& c = next.layout;
  const std::array<bool, 3> folded = foldedAxes(level);
  // rows of the residual around coarse row i: two more where the last two count as one
  const auto around = [&](std::size_t a, std::int64_t i) -> std::array<std::int64_t, 2>
  {
    if (a >= static_cast<std::size_t>(l.dimension))
      return { 0, 0 };
    const bool first = folded[a] && i + c.start[a] == 0;
    const bool last = folded[a] && i + c.start[a] == c.global[a] - 1;
    return { first ? -2 : -1, last ? 2 : 1 };
  };
  const bool parts = level.shared; // of the next level, too, which may then be done whole
  forLayers(c, parts ? next.share.first() : 0, parts ? next.share.last() : layersOf(c),
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t out = c.index(0, y, z);
      const auto [lowY, highY] = around(1, y);
      const auto [lowZ, highZ] = around(2, z);
      for (int a = 0; a < l.dimension; ++a)
      {
        float* to = next.r.component(a) + out;
        std::fill_n(to, c.size[0], 0.0F);
        RestrictedRow row;
        for (std::int64_t dz = lowZ; dz <= highZ; ++dz)
          for (std::int64_t dy = lowY; dy <= highY; ++dy)
          {
            if (2 * y + dy >= l.size[1] + l.ghost || 2 * z + dz >= l.size[2] + l.ghostZ())
              continue;
            const float* from = residual.component(a) + l.index(0, 2 * y + dy, 2 * z + dz);
            const float weight = row.add(from, dy, dz);
            if (folded[0])
            {
              to[0] += 0.5F * weight * from[-2];
              to[c.size[0] - 1] += 0.5F * weight * from[l.size[0] - 1];
            }
          }
        row.restrictTo(c.size[0], { to });
      }
    });
  if (parts && !next.shared)
    next.share.gather(next.r);
}

void BondMultigrid::interpolate(std::size_t index)
{
  Level& level = *levels_[index];
  Level& next = *levels_[index + 1];
  next.rim.fill(next.x);
  if (next.shared)
    next.share.exchange(next.x, 1);
  const NodeLayout& l = level.layout;
  const NodeLayout& c = next.layout;
  const std::array<bool, 3> folded = foldedAxes(level);
  const bool kept = level.d.components() > 0;
  const auto position = [&](std::size_t a, std::int64_t i)
  { return folded[a] && i + l.start[a] == l.global[a] - 1 ? i - 1 : i; };
  forOwnRows(level,
    [&](std::int64_t y, std::int64_t z)
    {
      thread_local std::vector<float> step;
      if (!kept && folded[0])
        step.resize(static_cast<std::size_t>(l.size[0]));
      const std::int64_t atY = position(1, y);
      const std::int64_t atZ = position(2, z);
      for (int a = 0; a < l.dimension; ++a)
      {
        const float* rows[4];
        int count = 0;
        for (std::int64_t cz = atZ / 2; cz <= (atZ + 1) / 2; ++cz)
          for (std::int64_t cy = atY / 2; cy <= (atY + 1) / 2; ++cy)
            rows[count++] = next.x.component(a) + c.index(0, cy, cz);
        const std::int64_t i = l.index(0, y, z);
        float* x = level.x.component(a) + i;
        const float weight = 1.0F / static_cast<float>(count);
        if (!kept && !folded[0])
        {
          levelKernels().interpolateRow(l.size[0], weight, count, rows, x, x);
          continue;
        }
        float* d = kept ? level.d.component(a) + i : step.data();
        levelKernels().interpolateRow(l.size[0] - (folded[0] ? 1 : 0), weight, count, rows, nullptr, d);
        if (folded[0])
          d[l.size[0] - 1] = d[l.size[0] - 2];
        levelKernels().axpy(l.size[0], 1.0F, d, x);
      }
    });
  if (index == 0)
  {
    if (kept)
      release(level.d);
    release(level.x);
  }
}

// Power iteration; a tenth over what it finds, which errs on the low side.
void BondMultigrid::estimateSpectrum(std::size_t index)
{
  constexpr int steps = 8;
  constexpr float margin = 1.1F;
  Level& level = *levels_[index];
  const NodeLayout& l = level.layout;
  forOwnRows(l,
    [&](std::int64_t y, std::int64_t z)
    {
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        for (int c = 0; c < l.dimension; ++c)
        {
          const std::int64_t node = x + l.global[0] * (y + l.start[1] + l.global[1] * (z + l.start[2]));
          level.r.component(c)[l.index(x, y, z)] = noise(static_cast<std::uint64_t>(3 * node + c) + 1);
        }
    });
  if (index == 0)
    release(level.r);
  double lambda = 0;
  for (int k = 0; k < steps; ++k)
  {
    chebyshev(level, level.r, 0.0F, 1.0F, true); // d = D⁻¹ r
    const double before = level.comm->sum(dot(level.r, level.d));
    if (!(before > 0))
      break;
    level.r.fill(0);
    subtract(index); // r = −A d
    const double product = -level.comm->sum(dot(level.r, level.d));
    lambda = product / before; // Rayleigh quotient of d
    const double scale = 1 / std::sqrt(before);
    forOwnRows(l,
      [&](std::int64_t y, std::int64_t z)
      {
        const std::int64_t i = l.index(0, y, z);
        for (int c = 0; c < l.dimension; ++c)
          for (std::int64_t x = 0; x < l.size[0]; ++x)
            level.r.component(c)[i + x] *= static_cast<float>(scale);
      });
  }
  level.lambda = lambda > 0 ? static_cast<float>(lambda) * margin : 1.0F;
}

template <class F>
const NodeField<float>& BondMultigrid::applyTo(F&& row)
{
  Level& top = *levels_.front();
  const NodeLayout& l = top.layout;
  forOwnRows(top,
    [&](std::int64_t y, std::int64_t z)
    {
      for (int c = 0; c < l.dimension; ++c)
        row(l.index(0, y, z), c);
    });
  release(top.r);
  cycle(0, true);
  return top.x;
}

const NodeField<float>& BondMultigrid::apply(const NodeField<double>& input, double scale)
{
  Level& top = *levels_.front();
  return applyTo([&](std::int64_t i, int c)
    { levelKernels().toFloat(top.layout.size[0], scale, input.component(c) + i, top.r.component(c) + i); });
}

const NodeField<float>& BondMultigrid::apply(const NodeField<float>& input)
{
  Level& top = *levels_.front();
  if (options_.lean)
  {
    leanCycle(input);
    return top.x;
  }
  return applyTo(
    [&](std::int64_t i, int c) { std::copy_n(input.component(c) + i, top.layout.size[0], top.r.component(c) + i); });
}

} // namespace lamella::peridynamics
