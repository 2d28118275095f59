// Relaxation on nested windows: fast adaptive composite grids, in the manner of McCormick, Multilevel Adaptive Methods
// for Partial Differential Equations (1989), on Galerkin levels.
#include "peridynamics/fracture/EventHierarchy.h"

#include <algorithm>
#include <array>

namespace lamella::peridynamics
{
namespace
{

// Of conjugate gradients, down and up. One up does nearly what two do: the residual that is left is met again on the
// way down.
constexpr int stepsDown = 2;
constexpr int stepsUp = 1;

// Of a level, one over it: larger windows are not worth the room.
constexpr std::int64_t largestShare = 16;

} // namespace

bool EventHierarchy::isSmall(std::size_t k) const
{
  const Level& level = multigrid_->level(k);
  return !level.packed() && largestShare * outer_[k].count() <= level.layout.owned();
}

WindowField EventHierarchy::work(std::size_t k, std::size_t which)
{
  Level& level = multigrid_->level(k);
  if (isSmall(k) || level.r.components() == 0)
    return { work_[k][which], outer_[k].low };
  return { which == 0 ? level.r : which == 1 ? level.d : level.x };
}

WindowField EventHierarchy::changeOf(std::size_t k)
{
  if (isSmall(k))
    return { work_[k][3], outer_[k].low };
  return { levels_[k].change };
}

double EventHierarchy::product(
  std::size_t k, const Box& box, const WindowField& u, const WindowField& out, const NodeField<float>* plus)
{
  const Level& level = multigrid_->level(k);
  const NodeLayout& l = level.layout;
  if (level.packed())
    return packedProduct(k, box, u, out, plus);
  const NodeLayout& from = u.field.layout();
  const NodeLayout& to = out.field.layout();
  double sum = 0;
  for (std::int64_t z = box.low[2]; z < box.high[2]; ++z)
  {
    const std::int64_t first = l.index(box.low[0], box.low[1], z);
    WindowRows rows;
    rows.rows = box.high[1] - box.low[1];
    rows.n = box.high[0] - box.low[0];
    rows.hereRow = from.pitch;
    rows.outRow = to.pitch;
    rows.plusRow = l.pitch;
    for (int c = 0; c < l.dimension; ++c)
    {
      rows.here[c] = u.row(c, box.low[0], box.low[1], z);
      rows.out[c] = out.row(c, box.low[0], box.low[1], z);
      rows.plus[c] = plus != nullptr ? plus->component(c) + first : nullptr;
    }
    if (k == 0)
    {
      sum += springs_.product(rows, from, box, z);
      continue;
    }
    BlockRow matrix;
    level.pointTo(matrix, first);
    jumps_.clear();
    for (const auto& s : level.half)
      jumps_.push_back(s[0] + from.pitch * (s[1] + from.rowsY() * s[2]));
    rows.jump = jumps_.data();
    mirrored_.clear();
    for (std::int64_t y = box.low[1]; y < box.high[1]; ++y)
      mirrored_.push_back(level.mirrored(y, z));
    sum += levelKernels().window(l.dimension, rows, matrix, l.pitch, mirrored_.data());
  }
  return sum;
}

// Where scales lie as the level's fields do.
double EventHierarchy::packedProduct(
  std::size_t k, const Box& box, const WindowField& u, const WindowField& out, const NodeField<float>* plus)
{
  const Level& level = multigrid_->level(k);
  const NodeLayout& l = level.layout; // of both fields, too
  const std::int64_t n = box.high[0] - box.low[0];
  BlockRow row;
  forRows(box,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(box.low[0], y, z);
      for (int c = 0; c < l.dimension; ++c)
      {
        row.here[c] = u.field.component(c) + i;
        row.out[c] = out.field.component(c) + i;
        if (plus != nullptr)
          std::copy_n(plus->component(c) + i, n, row.out[c]);
        else
          std::fill_n(row.out[c], n, 0.0F);
      }
      level.pointTo(row, i);
      levelKernels().subtractProduct(l.dimension, n, row);
    });
  level.addBroken(u.field, out.field, box.low, box.high);
  double sum = 0;
  forRows(box,
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(box.low[0], y, z);
      for (int c = 0; c < l.dimension; ++c)
        sum += eventKernels().dot(n, u.field.component(c) + i, out.field.component(c) + i);
    });
  return sum;
}

void EventHierarchy::addForce(const Box& box, float a, const WindowField& force, const WindowField& to)
{
  for (std::int64_t z = box.low[2]; z < box.high[2]; ++z)
    for (int c = 0; c < force.field.components(); ++c)
      eventKernels().addRows(box.high[1] - box.low[1], box.high[0] - box.low[0], a,
        force.row(c, box.low[0], box.low[1], z), force.field.layout().pitch, to.row(c, box.low[0], box.low[1], z),
        to.field.layout().pitch);
}

// Conjugate gradients, preconditioned by the nodes' blocks, on a level's window.
double EventHierarchy::relax(std::size_t k, int count, bool known, bool evaluated)
{
  EventLevel& level = levels_[k];
  const Level& matrix = multigrid_->level(k);
  const NodeLayout& l = matrix.layout;
  const Box& in = inner_[k];
  const Box& out = outer_[k];
  const bool intoBase = level.w.components() == 0;
  const WindowField r = work(k, 0);
  const WindowField p = work(k, 1);
  const WindowField q = work(k, 2); // the product, then D⁻¹ r
  const EventKernels& event = eventKernels();
  const NodeLayout& own = p.field.layout();
  const std::int64_t height = in.high[1] - in.low[1];

  // by layers
  const auto forSteps = [&](auto&& f)
  {
    double sum = 0;
    for (std::int64_t z = in.low[2]; z < in.high[2]; ++z)
    {
      StepRows s;
      s.rows = height;
      s.n = in.high[0] - in.low[0];
      s.workRow = own.pitch;
      s.levelRow = l.pitch;
      const std::int64_t i = l.index(in.low[0], in.low[1], z);
      for (int c = 0; c < l.dimension; ++c)
      {
        s.r[c] = r.row(c, in.low[0], in.low[1], z);
        s.p[c] = p.row(c, in.low[0], in.low[1], z);
        s.q[c] = q.row(c, in.low[0], in.low[1], z);
        s.moved[0][c] = intoBase ? nullptr : level.w.component(c) + i;
        s.moved[1][c] = intoBase || !evaluated ? nullptr : level.total.component(c) + i;
      }
      for (int e = 0; e < matrix.entries(); ++e)
        s.inverse[e] = matrix.inverse.component(e) + i;
      sum += f(s);
    }
    return sum;
  };
  if (!known)
    product(k, in, { level.total }, r, &level.g);
  double rz = forSteps([&](const StepRows& s) { return event.precondition(l.dimension, s); });
  for (int step = 0; step < count && rz > 0; ++step)
  {
    const double pq = -product(k, out, p, q); // p is zero beyond the inner window
    if (!(pq > 0))
      break;
    const auto alpha = static_cast<float>(rz / pq);
    addForce(out, alpha, q, changeOf(k));
    if (intoBase)
      addForce(out, alpha, q, { level.g });
    if (intoBase)
      forRows(
        in,
        [&](std::int64_t y, std::int64_t z)
        {
          for (int c = 0; c < l.dimension; ++c)
            addToBase(std::min(in.high[0], l.size[0]) - in.low[0], alpha, p.row(c, in.low[0], y, z),
              base_.component(c) + l.index(in.low[0], y, z));
        });
    const double next = forSteps([&](const StepRows& s) { return event.step(l.dimension, s, alpha); });
    const auto beta = static_cast<float>(next / rz);
    rz = next;
    if (step + 1 < count)
      forSteps(
        [&](const StepRows& s)
        {
          event.turn(l.dimension, s, beta);
          return 0.0;
        });
  }
  forRows(in,
    [&](std::int64_t y, std::int64_t z)
    {
      for (int c = 0; c < l.dimension; ++c)
        std::fill_n(p.row(c, in.low[0], y, z), in.high[0] - in.low[0], 0.0F);
    });
  return rz;
}

// For relax(). The direction is zero outside of the inner window, and so where there is more room than that.
void EventHierarchy::makeRoom(std::size_t k)
{
  const Level& level = multigrid_->level(k);
  const bool small = isSmall(k);
  if (!small && level.r.components() > 0)
    return;
  const NodeLayout& l = level.layout;
  const Box& box = outer_[k];
  const NodeLayout& had = work_[k].front().layout();
  std::array<std::int64_t, 3> needed{};
  std::array<std::int64_t, 3> size{};
  for (std::size_t a = 0; a < 3; ++a)
  {
    needed[a] = box.high[a] - box.low[a];
    size[a] = std::max(had.size[a], needed[a]);
  }
  if (largestShare * size[0] * size[1] * size[2] > l.owned())
    size = needed;
  if (size != had.size || work_[k][0].components() == 0)
  {
    const NodeLayout window = NodeLayout::make(l.dimension, l.ghost, size, {}, size, false);
    for (NodeField<float>& f : work_[k])
      f = NodeField<float>(window);
  }
  if (!small)
    work_[k][3] = NodeField<float>(); // the level's own
  else if (work_[k][3].components() == 0)
    work_[k][3] = NodeField<float>(work_[k][0].layout());
}

// What relaxation changed of a level's residual, handed to the next level.
void EventHierarchy::restrictChange(std::size_t k, const WindowField& change, const Box& box,
  const WindowField* nextChange, const WindowField* nextResidual)
{
  EventLevel& next = levels_[k + 1];
  const NodeLayout& l = levels_[k].g.layout();
  const NodeLayout& coarse = next.g.layout();
  if (k == 0)
    forManyRows(box, [&](std::int64_t y, std::int64_t z) { maskRow(change, y, z, box.low[0], box.high[0]); });
  const Box to = parentsOf(box, coarse);
  const std::int64_t n = std::min(to.high[0], coarse.size[0]) - to.low[0];
  const std::int64_t reachZ = l.dimension == 3 ? 1 : 0;
  forManyRows(
    to,
    [&](std::int64_t y, std::int64_t z)
    {
      for (int c = 0; c < l.dimension; ++c)
      {
        RestrictedRow row;
        for (std::int64_t dz = -reachZ; dz <= reachZ; ++dz)
          for (std::int64_t dy = -1; dy <= 1; ++dy)
          {
            const std::int64_t fy = 2 * y + dy;
            const std::int64_t fz = 2 * z + dz;
            if (fy >= box.low[1] && fy < box.high[1] && fz >= box.low[2] && fz < box.high[2])
              row.add(change.row(c, 2 * to.low[0], fy, fz), dy, dz);
          }
        float* g = next.g.component(c) + coarse.index(to.low[0], y, z);
        if (nextResidual != nullptr)
          row.restrictTo(n, { g, nextChange->row(c, to.low[0], y, z), nextResidual->row(c, to.low[0], y, z) });
        else if (nextChange != nullptr)
          row.restrictTo(n, { g, nextChange->row(c, to.low[0], y, z) });
        else
          row.restrictTo(n, { g });
      }
    });
  forManyRows(box,
    [&](std::int64_t y, std::int64_t z)
    {
      for (int c = 0; c < l.dimension; ++c)
        std::fill_n(change.row(c, box.low[0], y, z), box.high[0] - box.low[0], 0.0F);
    });
}

void EventHierarchy::restrictChange(std::size_t k)
{
  const WindowField next{ levels_[k + 1].change };
  restrictChange(k, { levels_[k].change }, outer_[k], k + 2 < levels_.size() ? &next : nullptr, nullptr);
}

void EventHierarchy::restrictWindow(std::size_t k, bool known)
{
  if (k + 2 == levels_.size())
  {
    restrictChange(k, changeOf(k), outer_[k], nullptr, nullptr);
    return;
  }
  const WindowField change = changeOf(k + 1);
  const WindowField residual = work(k + 1, 0);
  restrictChange(k, changeOf(k), outer_[k], &change, known ? &residual : nullptr);
}

void EventHierarchy::relaxCoarsest()
{
  EventLevel& last = levels_.back();
  Level& matrix = multigrid_->level(levels_.size() - 1);
  const NodeLayout& l = matrix.layout;
  const auto copy = [&](const NodeField<float>& from, NodeField<float>& to)
  {
    for (int c = 0; c < l.dimension; ++c)
      std::copy_n(from.component(c), l.count(), to.component(c));
  };
  copy(last.g, matrix.r);
  multigrid_->solveCoarsest();
  copy(matrix.x, last.w);
  copy(matrix.x, last.total);
}

EventHierarchy::Local EventHierarchy::correct(
  const Box& box, int radius, int coarseRadius, double target, int maxCycles)
{
  if (looked_) // the residual force is there
    levels_.front().change.fill(0);
  looked_ = false;
  nest(box, radius, coarseRadius);
  springs_.read(bonds_, outer_.front());
  for (std::size_t k = 0; k + 1 < levels_.size(); ++k)
    makeRoom(k);
  Local local;
  local.window = inner_.front();
  const std::size_t last = levels_.size() - 1;
  for (std::size_t k = levels_.size(); k-- > 0;)
    evaluateFrom(k, outer_[k]);
  while (local.cycles < maxCycles)
  {
    for (std::size_t k = 0; k < last; ++k)
    {
      relax(k, stepsDown, local.cycles > 0, false); // the way up has left the residual
      restrictWindow(k, local.cycles > 0);
    }
    relaxCoarsest();
    for (std::size_t k = last; k-- > 0;)
    {
      evaluateFrom(k, outer_[k]);
      local.residual = relax(k, stepsUp, false, true);
    }
    ++local.cycles;
    local.visited += (1 + stepsDown + stepsUp + (local.cycles > 1 ? 0 : 1)) * outer_.front().count();
    if (!(local.residual > target))
      break;
  }
  for (std::size_t k = 0; k < last; ++k)
    restrictWindow(k, false);
  return local;
}

} // namespace lamella::peridynamics
