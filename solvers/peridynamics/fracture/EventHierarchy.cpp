#include "peridynamics/fracture/EventHierarchy.h"

#include "peridynamics/multigrid/FreeBlocks.h"

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

// Layers of a part must reach as far as bonds do; else every rank does all.
LayerShare shareOf(const BondLattice& bonds, const Communicator& team)
{
  const std::int64_t layers = layersOf(bonds.layout());
  const LayerShare share(layers, team);
  return share.fewest() >= bonds.stencil().layers() ? share : LayerShare(layers, EventHierarchy::alone());
}

} // namespace

const Communicator& EventHierarchy::alone()
{
  static const Communicator self(MPI_COMM_SELF);
  return self;
}

EventHierarchy::EventHierarchy(BondLattice& bonds, const FixedComponents& fixed, const NodeField<double>& displacement,
  double tolerance, const std::function<bool(double)>& progress, const Communicator& team)
  : bonds_(bonds)
  , fixed_(fixed)
  , share_(shareOf(bonds, team))
  , inBase_(multigridOptions(bonds.dimension()).lean)
  , base_(displacement)
  , slow_(bonds, share_)
  , springs_(bonds)
{
  const NodeLayout& l = bonds.layout();
  prepare();

  // the forces on free components while these have not moved
  NodeField<double> still = base_;
  for (int c = 0; c < l.dimension; ++c)
    for (std::int64_t i = 0; i < l.count(); ++i)
      if ((fixed[i] >> c & 1U) == 0)
        still.component(c)[i] = 0;
  std::swap(still, base_);
  residualInDouble();
  std::swap(still, base_);
  reference_ = freeNorm(levels_.front().g);
  if (reference_ > 0)
    solve(tolerance, progress);
  slow_.clear(); // what the load does is none
}

EventHierarchy::EventHierarchy(
  BondLattice& bonds, const FixedComponents& fixed, Renewed state, const Communicator& team)
  : bonds_(bonds)
  , fixed_(fixed)
  , share_(shareOf(bonds, team))
  , inBase_(multigridOptions(bonds.dimension()).lean)
  , base_(std::move(state.base))
  , slow_(bonds, share_)
  , reference_(state.reference)
  , springs_(bonds)
{
  prepare();
  residualInDouble();
  restrictAll();
}

// In space there are many nodes, and so memory is short; the matrices are most of it, and what products wait for. In
// the plane cracks are to go the ways that they went.
MultigridOptions EventHierarchy::multigridOptions(int dimension) noexcept
{
  MultigridOptions options;
  options.lean = dimension == 3;
  options.twiceBelow = BondMultigrid::maxLevels;
  options.gather = 4096; // what is done by layers of whole samples is sent to all
  options.packFrom = dimension == 3 ? options.gather : 0;
  if (dimension == 2)
    options.twiceFrom = 4; // the larger levels twice cost more than the iterations that they save
  return options;
}

void EventHierarchy::prepare()
{
  const NodeLayout& l = bonds_.layout();
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
    {
      const std::uint8_t* row = fixed_.data() + l.index(0, y, z);
      rowFixed_.push_back(std::any_of(row, row + l.size[0], [](std::uint8_t f) { return f != 0; }) ? 1 : 0);
    }
  sums_.resize(rowFixed_.size());
  build();
}

void EventHierarchy::renew()
{
  evaluate(0, shareBox(0));
  collapse();
  share_.gather(base_);
  slow_.clear();
  for (EventLevel& level : levels_)
    for (NodeField<float>* f : { &level.g, &level.total, &level.change })
      f->fill(0);
  build();
  residualInDouble();
  restrictAll();
  sinceDouble_ = looks_ = 0;
  looked_ = little_ = false;
  freed_ = 0;
  size_ = left_ = unmeasured;
}

// Also when round-off has got the better of the matrices.
void EventHierarchy::build()
{
  const bool first = levels_.empty();
  if (first)
  {
    levels_.reserve(BondMultigrid::maxLevels); // a field of the first one is lent
    levels_.emplace_back(bonds_.layout(), !inBase_);
  }
  multigrid_.reset(); // there is room for one
  multigrid_ =
    std::make_unique<BondMultigrid>(bonds_, fixed_, multigridOptions(bonds_.dimension()), &levels_.front().change);
  multigrid_->shareOut(share_);
  levels_.front().change.fill(0);
  clearDirections();
  if (!first)
    return;
  while (levels_.size() < multigrid_->levelCount())
    levels_.emplace_back(multigrid_->level(levels_.size()).layout, true);
  inner_.resize(levels_.size());
  outer_.resize(levels_.size());
  work_.resize(levels_.size());
}

void EventHierarchy::clearDirections()
{
  for (std::size_t k = 0; k < multigrid_->levelCount(); ++k)
    multigrid_->level(k).d.fill(0); // relax() counts on it
}

std::int64_t EventHierarchy::bytes() const noexcept
{
  std::int64_t total = multigrid_->bytes() + springs_.bytes() + slow_.bytes();
  for (const auto& fields : work_)
    for (const NodeField<float>& f : fields)
      total += f.components() * f.layout().count() * static_cast<std::int64_t>(sizeof(float));
  for (const EventLevel& level : levels_)
    total += (3 * level.g.components() + level.w.components()) * level.g.layout().count() *
      static_cast<std::int64_t>(sizeof(float));
  const std::int64_t nodes = base_.components() * base_.layout().count();
  return total + nodes * static_cast<std::int64_t>(sizeof(double));
}

Box EventHierarchy::shareBox(std::int64_t around) const
{
  const NodeLayout& l = bonds_.layout();
  Box box = whole(l);
  const std::size_t slowest = l.dimension == 3 ? 2 : 1;
  box.low[slowest] = std::max<std::int64_t>(0, share_.first() - around);
  box.high[slowest] = std::min(l.size[slowest], share_.last() + around);
  return box;
}

void EventHierarchy::maskRow(
  const WindowField& field, std::int64_t y, std::int64_t z, std::int64_t x0, std::int64_t x1) const
{
  const NodeLayout& l = bonds_.layout();
  if (rowFixed_[static_cast<std::size_t>(y + l.size[1] * z)] == 0)
    return;
  const std::int64_t i = l.index(x0, y, z);
  for (int c = 0; c < l.dimension; ++c)
    for (std::int64_t x = 0; x < std::min(x1, l.size[0]) - x0; ++x)
      if ((fixed_[i + x] >> c & 1U) != 0)
        field.row(c, x0, y, z)[x] = 0;
}

void EventHierarchy::evaluate(std::size_t k, const Box& box)
{
  if (k + 1 < levels_.size())
    evaluate(k + 1, parents(box, levels_[k + 1].g.layout()));
  evaluateFrom(k, box);
}

// U_l = w_l + P U_{l+1}
void EventHierarchy::evaluateFrom(std::size_t k, const Box& box)
{
  EventLevel& level = levels_[k];
  const NodeLayout& l = level.g.layout();
  const std::int64_t n = box.high[0] - box.low[0];
  const bool part = level.w.components() > 0;
  const bool last = k + 1 == levels_.size();
  forManyRows(box,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(box.low[0], y, z);
      for (int c = 0; c < l.dimension; ++c)
      {
        float* to = level.total.component(c) + i;
        if (last)
        {
          std::copy_n(level.w.component(c) + i, n, to);
          continue;
        }
        const NodeField<float>& coarse = levels_[k + 1].total;
        const float* rows[4];
        int count = 0;
        for (std::int64_t cz = z / 2; cz <= (z + 1) / 2; ++cz)
          for (std::int64_t cy = y / 2; cy <= (y + 1) / 2; ++cy)
            rows[count++] = coarse.component(c) + coarse.layout().index(box.low[0] / 2, cy, cz);
        // fixed components have no part
        const float* plus = part ? level.w.component(c) + i : nullptr;
        levelKernels().interpolateRow(n, 1.0F / static_cast<float>(count), count, rows, plus, to);
      }
      if (last)
        return;
      if (k == 0)
        maskRow({ level.total }, y, z, box.low[0], box.high[0]);
      if (box.high[0] > l.size[0]) // the padding, which a coarse node at or beyond the last one reaches
        for (int c = 0; c < l.dimension; ++c)
          std::fill(level.total.component(c) + l.index(l.size[0], y, z), level.total.component(c) + i + n, 0.0F);
    });
}

double EventHierarchy::elongation(std::int64_t index, int offset)
{
  const NodeLayout& l = bonds_.layout();
  const Offset& half = bonds_.stencil().half()[static_cast<std::size_t>(offset)];
  const auto n = l.node(index);
  Box ends;
  for (std::size_t a = 0; a < 3; ++a)
  {
    ends.low[a] = std::min(n[a], n[a] + half.step[a]);
    ends.high[a] = std::max(n[a], n[a] + half.step[a]) + 1;
  }
  evaluate(grown(ends, 0, l));
  const std::int64_t other = index + bonds_.jump(offset);
  double along = 0;
  for (int c = 0; c < l.dimension; ++c)
  {
    const double moved = base_.component(c)[other] - base_.component(c)[index] +
      static_cast<double>(correction().component(c)[other]) - static_cast<double>(correction().component(c)[index]);
    along += moved * half.step[static_cast<std::size_t>(c)] / half.length;
  }
  return along;
}

double EventHierarchy::breakBond(std::int64_t index, int offset)
{
  const NodeLayout& l = bonds_.layout();
  const SpringWeights spring = multigrid_->weights(index, offset);
  const std::int64_t other = index + bonds_.jump(offset);
  // a level's residual changes by what the bond pulled with in the parts that are finer
  double along = 0;
  for (int c = 0; c < l.dimension; ++c)
    along += (base_.component(c)[other] - base_.component(c)[index]) * spring.direction[static_cast<std::size_t>(c)];
  for (int c = 0; c < l.dimension; ++c)
  {
    const auto pull = static_cast<float>(spring.stiffness * along * spring.direction[static_cast<std::size_t>(c)]);
    levels_.front().g.component(c)[index] -= pull;
    levels_.front().g.component(c)[other] += pull;
  }
  for (std::size_t k = 0; k < levels_.size(); ++k)
  {
    EventLevel& level = levels_[k];
    double finer = along;
    for (const SpringWeights::Node& n : spring.levels[k])
    {
      const std::int64_t i = level.g.layout().index(n.node[0], n.node[1], n.node[2]);
      for (int c = 0; c < l.dimension; ++c)
      {
        const double e = spring.direction[static_cast<std::size_t>(c)];
        if (k > 0)
          level.g.component(c)[i] += static_cast<float>(spring.stiffness * finer * n.weight * e);
        if (level.w.components() > 0)
          along += n.weight * e * static_cast<double>(level.w.component(c)[i]);
      }
    }
  }
  const Bond bond = bonds_.bond(index, offset);
  bonds_.breakBonds({ &bond, 1 });
  multigrid_->subtract(spring);
  const double force = std::abs(spring.stiffness * along);
  freed_ += l.dimension == 3 ? force * force : force;
  slow_.breakBond(index, offset, spring.stiffness);
  return spring.stiffness;
}

double EventHierarchy::dipole(std::int64_t index, int offset, double force) const
{
  const Offset& half = bonds_.stencil().half()[static_cast<std::size_t>(offset)];
  const NodeField<float>& inverse = multigrid_->level(0).inverse;
  constexpr int entry3[3][3] = { { 0, 3, 5 }, { 3, 1, 4 }, { 5, 4, 2 } };
  constexpr int entry2[2][2] = { { 0, 2 }, { 2, 1 } };
  const int d = bonds_.dimension();
  double sum = 0;
  for (const std::int64_t i : { index, index + bonds_.jump(offset) })
    for (int a = 0; a < d; ++a)
      for (int b = 0; b < d; ++b)
        sum += half.step[static_cast<std::size_t>(a)] * half.step[static_cast<std::size_t>(b)] *
          static_cast<double>(inverse.component(d == 3 ? entry3[a][b] : entry2[a][b])[i]);
  return force * force * sum / (half.length * half.length);
}

double EventHierarchy::inconsistency()
{
  levels_.front().change.fill(0);
  for (std::size_t k = 0; k < levels_.size(); ++k)
    evaluate(k, whole(levels_[k].g.layout()));
  std::vector<NodeField<float>> residual;
  for (std::size_t k = 0; k < levels_.size(); ++k)
  {
    residual.emplace_back(levels_[k].g.layout());
    const Box all = whole(levels_[k].g.layout());
    if (k == 0)
      springs_.read(bonds_, all);
    product(k, all, { levels_[k].total }, { residual[k] });
    for (int c = 0; c < bonds_.dimension(); ++c)
      for (std::int64_t i = 0; i < levels_[k].g.layout().count(); ++i)
        residual[k].component(c)[i] += levels_[k].g.component(c)[i];
    if (k == 0)
      forRows(all, [&](std::int64_t y, std::int64_t z) { maskRow({ residual[0] }, y, z, 0, all.high[0]); });
  }
  double size = 0;
  double worst = 0;
  for (int c = 0; c < bonds_.dimension(); ++c)
    for (std::int64_t i = 0; i < residual[0].layout().count(); ++i)
      size = std::max(size, std::abs(static_cast<double>(residual[0].component(c)[i])));
  for (std::size_t k = 0; k + 1 < levels_.size(); ++k)
  {
    std::swap(levels_[k].change, residual[k]);
    outer_[k] = whole(levels_[k].g.layout());
    const NodeField<float> before = levels_[k + 1].g;
    levels_[k + 1].g.fill(0);
    restrictChange(k);
    for (int c = 0; c < bonds_.dimension(); ++c)
      for (std::int64_t i = 0; i < before.layout().count(); ++i)
        worst = std::max(
          worst, std::abs(static_cast<double>(levels_[k + 1].g.component(c)[i] - residual[k + 1].component(c)[i])));
    levels_[k + 1].g = before;
    levels_[k + 1].change.fill(0);
  }
  return size > 0 ? worst / size : 0;
}

// Windows on every level, each around what the finer one's product reaches.
void EventHierarchy::nest(const Box& box, int radius, int coarseRadius)
{
  for (std::size_t k = 0; k < levels_.size(); ++k)
  {
    const NodeLayout& l = levels_[k].g.layout();
    if (k + 1 == levels_.size())
    {
      inner_[k] = outer_[k] = whole(l);
      return;
    }
    Box centre = box; // the box's parents, without the rounding of windows
    for (std::size_t j = 0; j < k; ++j)
      for (std::size_t a = 0; a < 3; ++a)
      {
        centre.low[a] /= 2;
        centre.high[a] = centre.high[a] / 2 + 1;
      }
    inner_[k] = grown(centre, k == 0 ? radius : coarseRadius, l);
    outer_[k] = expanded(inner_[k], k == 0 ? bonds_.stencil().layers() : l.ghost, l);
    if (k > 0)
      outer_[k] = united(outer_[k], parentsOf(outer_[k - 1], l));
    outer_[k] = inVectors(outer_[k], l);
  }
}

} // namespace lamella::peridynamics
