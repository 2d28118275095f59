// Relaxation on nested windows: fast adaptive composite grids, in the manner of McCormick, Multilevel Adaptive Methods
// for Partial Differential Equations (1989), on Galerkin levels.
#include "peridynamics/fracture/EventHierarchy.h"

#include <algorithm>

namespace lamella::peridynamics
{
namespace
{

// Of conjugate gradients, down and up. One up does nearly what two do: the residual that is left is met again on the
// way down.
constexpr int stepsDown = 2;
constexpr int stepsUp = 1;

} // namespace

void EventHierarchy::product(std::size_t k, const Box& box, const WindowField& u, const WindowField& out)
{
  if (k == 0)
  {
    forRows(box, [&](std::int64_t y, std::int64_t z) { springs_.product(u, out, y, z, box.low[0], box.high[0]); });
    return;
  }
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
        std::fill_n(row.out[c], n, 0.0F);
      }
      level.pointTo(row, i);
      levelKernels().subtractProduct(l.dimension, n, row);
    });
  level.addBroken(u.field, out.field, box.low, box.high);
}

// Conjugate gradients, preconditioned by the nodes' blocks, on a level's window.
double EventHierarchy::relax(std::size_t k, int count, bool known)
{
  EventLevel& level = levels_[k];
  Level& matrix = multigrid_->level(k);
  const NodeLayout& l = matrix.layout;
  const Box& in = inner_[k];
  const Box& out = outer_[k];
  const std::int64_t n = in.high[0] - in.low[0];
  const std::int64_t wide = out.high[0] - out.low[0];
  const bool lean = matrix.r.components() == 0;
  const auto work = [&](NodeField<float>& own, std::size_t i) {
    return lean ? WindowField{ work_[i], out.low } : WindowField{ own };
  };
  const WindowField r = work(matrix.r, 0);
  const WindowField p = work(matrix.d, 1);
  const WindowField q = work(matrix.x, 2); // the product, then D⁻¹ r
  const LevelKernels& kernels = levelKernels();
  const EventKernels& event = eventKernels();

  const auto precondition = [&](const WindowField& z)
  {
    double sum = 0;
    forRows(in,
      [&](std::int64_t y, std::int64_t at)
      {
        const std::int64_t i = l.index(in.low[0], y, at);
        const float* inverse[6];
        const float* from[3];
        float* to[3];
        for (int e = 0; e < matrix.entries(); ++e)
          inverse[e] = matrix.inverse.component(e) + i;
        for (int c = 0; c < l.dimension; ++c)
        {
          from[c] = r.row(c, in.low[0], y, at);
          to[c] = z.row(c, in.low[0], y, at);
        }
        sum += event.precondition(l.dimension, n, inverse, from, to);
      });
    return sum;
  };
  if (!known)
  {
    product(k, in, { level.total }, r);
    forRows(in,
      [&](std::int64_t y, std::int64_t z)
      {
        const std::int64_t i = l.index(in.low[0], y, z);
        for (int c = 0; c < l.dimension; ++c)
          kernels.axpy(n, 1.0F, level.g.component(c) + i, r.row(c, in.low[0], y, z));
      });
  }
  double rz = precondition(p);
  for (int step = 0; step < count && rz > 0; ++step)
  {
    product(k, out, p, q);
    double pq = 0;
    forRows(in,
      [&](std::int64_t y, std::int64_t z)
      {
        for (int c = 0; c < l.dimension; ++c)
          pq -= event.dot(n, p.row(c, in.low[0], y, z), q.row(c, in.low[0], y, z));
      });
    if (!(pq > 0))
      break;
    const auto alpha = static_cast<float>(rz / pq);
    forRows(out,
      [&](std::int64_t y, std::int64_t z)
      {
        const std::int64_t i = l.index(out.low[0], y, z);
        for (int c = 0; c < l.dimension; ++c)
        {
          const float* force = q.row(c, out.low[0], y, z);
          kernels.axpy(wide, alpha, force, level.change.component(c) + i);
          if (lean)
            kernels.axpy(wide, alpha, force, level.g.component(c) + i);
        }
      });
    forRows(in,
      [&](std::int64_t y, std::int64_t z)
      {
        const std::int64_t i = l.index(in.low[0], y, z);
        for (int c = 0; c < l.dimension; ++c)
        {
          const float* along = p.row(c, in.low[0], y, z);
          if (lean)
            addToBase(std::min(n, l.size[0] - in.low[0]), alpha, along, base_.component(c) + i);
          else
          {
            kernels.axpy(n, alpha, along, level.w.component(c) + i);
            kernels.axpy(n, alpha, along, level.total.component(c) + i);
          }
          kernels.axpy(n, alpha, q.row(c, in.low[0], y, z), r.row(c, in.low[0], y, z));
        }
      });
    const double next = precondition(q);
    const auto beta = static_cast<float>(next / rz);
    rz = next;
    if (step + 1 < count)
      forRows(in,
        [&](std::int64_t y, std::int64_t z)
        {
          for (int c = 0; c < l.dimension; ++c)
            event.direction(n, q.row(c, in.low[0], y, z), beta, p.row(c, in.low[0], y, z));
        });
  }
  forRows(in,
    [&](std::int64_t y, std::int64_t z)
    {
      for (int c = 0; c < l.dimension; ++c)
        std::fill_n(p.row(c, in.low[0], y, z), n, 0.0F);
    });
  return rz;
}

// For relax() on the finest window; the direction is zero outside of it.
void EventHierarchy::makeRoom()
{
  if (multigrid_->level(0).r.components() > 0)
    return;
  const NodeLayout& l = bonds_.layout();
  const Box& box = outer_.front();
  std::array<std::int64_t, 3> size{};
  for (std::size_t a = 0; a < 3; ++a)
    size[a] = box.high[a] - box.low[a];
  const NodeLayout window = NodeLayout::make(l.dimension, l.ghost, size, {}, size, false);
  if (work_.front().layout() != window)
    for (NodeField<float>& f : work_)
      f = NodeField<float>(window);
}

// What relaxation changed of a level's residual, handed to the next level.
void EventHierarchy::restrictChange(std::size_t k)
{
  EventLevel& level = levels_[k];
  EventLevel& next = levels_[k + 1];
  NodeField<float>& residual = multigrid_->level(k + 1).r; // relax() may know it
  const NodeLayout& l = level.g.layout();
  const NodeLayout& coarse = next.g.layout();
  const Box& box = outer_[k];
  if (k == 0)
    forManyRows(box, [&](std::int64_t y, std::int64_t z) { maskRow(level.change, y, z, box.low[0], box.high[0]); });
  const Box to = parents(box, coarse);
  const std::int64_t n = to.high[0] - to.low[0];
  const bool last = k + 2 == levels_.size();
  const std::int64_t reachZ = l.dimension == 3 ? 1 : 0;
  forManyRows(
    to,
    [&](std::int64_t y, std::int64_t z)
    {
      thread_local std::vector<float> sum;
      for (int c = 0; c < l.dimension; ++c)
      {
        sum.assign(static_cast<std::size_t>(n), 0.0F);
        for (std::int64_t dz = -reachZ; dz <= reachZ; ++dz)
          for (std::int64_t dy = -1; dy <= 1; ++dy)
          {
            const std::int64_t fy = 2 * y + dy;
            const std::int64_t fz = 2 * z + dz;
            if (fy < box.low[1] || fy >= box.high[1] || fz < box.low[2] || fz >= box.high[2])
              continue;
            const std::int64_t most =
              std::min(n, coarse.size[0] - to.low[0]); // no further than the finer row's padding
            levelKernels().restrictRow(most, (dy == 0 ? 1.0F : 0.5F) * (dz == 0 ? 1.0F : 0.5F),
              level.change.component(c) + l.index(2 * to.low[0], fy, fz), sum.data());
          }
        const std::int64_t i = coarse.index(to.low[0], y, z);
        levelKernels().axpy(n, 1.0F, sum.data(), next.g.component(c) + i);
        levelKernels().axpy(n, 1.0F, sum.data(), residual.component(c) + i);
        if (!last)
          levelKernels().axpy(n, 1.0F, sum.data(), next.change.component(c) + i);
      }
    });
  forManyRows(box,
    [&](std::int64_t y, std::int64_t z)
    {
      for (int c = 0; c < l.dimension; ++c)
        std::fill_n(level.change.component(c) + l.index(box.low[0], y, z), box.high[0] - box.low[0], 0.0F);
    });
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
  makeRoom();
  Local local;
  local.window = inner_.front();
  const std::size_t last = levels_.size() - 1;
  for (std::size_t k = levels_.size(); k-- > 0;)
    evaluateFrom(k, outer_[k]);
  while (local.cycles < maxCycles)
  {
    for (std::size_t k = 0; k < last; ++k)
    {
      relax(k, stepsDown, local.cycles > 0); // the way up has left it
      restrictChange(k);
    }
    relaxCoarsest();
    for (std::size_t k = last; k-- > 0;)
    {
      evaluateFrom(k, outer_[k]);
      local.residual = relax(k, stepsUp, false);
    }
    ++local.cycles;
    local.visited += (1 + stepsDown + stepsUp + (local.cycles > 1 ? 0 : 1)) * outer_.front().count();
    if (!(local.residual > target))
      break;
  }
  for (std::size_t k = 0; k < last; ++k)
    restrictChange(k);
  return local;
}

} // namespace lamella::peridynamics
