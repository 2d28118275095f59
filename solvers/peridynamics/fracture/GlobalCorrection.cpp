#include "core/Error.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/fracture/EventHierarchy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

constexpr int everyDouble = 16; // global corrections: then round-off in the residual force is looked after
constexpr int mostLooks = 4;    // without it
constexpr int slow = 4;         // iterations of a correction that is worth remembering
constexpr double slightly = 4;  // times what is asked for: a residual that moves little

} // namespace

// Sums row by row, so that they do not depend on the number of threads and ranks.
template <class F>
double EventHierarchy::rowSum(F&& f)
{
  const NodeLayout& l = bonds_.layout();
  forShare([&](std::int64_t y, std::int64_t z) { sums_[static_cast<std::size_t>(y + l.size[1] * z)] = f(y, z); });
  share_.gather(sums_);
  double sum = 0;
  for (const double s : sums_)
    sum += s;
  return sum;
}

double EventHierarchy::dot(const NodeField<float>& a, const NodeField<float>& b)
{
  const NodeLayout& l = a.layout();
  return rowSum(
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      double sum = 0;
      for (int c = 0; c < l.dimension; ++c)
        sum += eventKernels().dot(l.size[0], a.component(c) + i, b.component(c) + i);
      return sum;
    });
}

double EventHierarchy::freeSquare(const NodeField<float>& r, std::int64_t y, std::int64_t z) const
{
  const NodeLayout& l = r.layout();
  const std::int64_t i = l.index(0, y, z);
  double sum = 0;
  for (int c = 0; c < l.dimension; ++c)
  {
    const float* v = r.component(c) + i;
    if (rowFixed_[static_cast<std::size_t>(y + l.size[1] * z)] == 0)
      sum += eventKernels().dot(l.size[0], v, v);
    else
      for (std::int64_t x = 0; x < l.size[0]; ++x)
        if ((fixed_[i + x] >> c & 1U) == 0)
          sum += static_cast<double>(v[x]) * static_cast<double>(v[x]);
  }
  return sum;
}

double EventHierarchy::freeNorm(const NodeField<float>& r)
{
  return std::sqrt(rowSum([&](std::int64_t y, std::int64_t z) { return freeSquare(r, y, z); }));
}

// Of what the parts come to, in place of the change: g₀ − A U₀. On own layers, as all of a global correction.
void EventHierarchy::measureResidual()
{
  const NodeLayout& l = bonds_.layout();
  NodeField<float>& residual = levels_.front().change;
  evaluate(0, shareBox(bonds_.stencil().layers()));
  linearForceOfLayers(bonds_, correction(), residual, share_.first(), share_.last());
  forShare(
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      for (int c = 0; c < l.dimension; ++c)
        levelKernels().axpy(l.size[0], 1.0F, levels_.front().g.component(c) + i, residual.component(c) + i);
    });
}

// After U₀ has been evaluated on own layers; the base of others is theirs.
void EventHierarchy::collapse()
{
  const NodeLayout& l = bonds_.layout();
  forShare(
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      for (int c = 0; c < l.dimension; ++c)
        for (std::int64_t x = i; x < i + l.size[0]; ++x)
          base_.component(c)[x] += static_cast<double>(correction().component(c)[x]);
    });
  for (EventLevel& level : levels_)
    level.w.fill(0);
}

// Forgets slowly, for the next break may be like the one before the last.
void EventHierarchy::learn(double size)
{
  constexpr double forget = 0.8;
  if (freed_ > 0 && std::isfinite(size_))
  {
    const double left = bonds_.dimension() == 3 ? std::sqrt(std::max(0.0, size * size - size_ * size_) / freed_)
                                                : std::max(0.0, size - size_) / freed_;
    left_ = std::isfinite(left_) ? std::max(left, forget * left_) : left;
  }
  freed_ = 0;
}

double EventHierarchy::expectedResidual() const noexcept
{
  constexpr double safety = 2;
  if (bonds_.dimension() == 3)
    return (freed_ > 0 ? std::sqrt(size_ * size_ + left_ * left_ * freed_) : size_) / reference_;
  const double left = freed_ > 0 ? safety * left_ * freed_ : 0;
  return (size_ + left) / reference_;
}

void EventHierarchy::residualInDouble()
{
  const NodeLayout& l = bonds_.layout();
  NodeField<double> force(l);
  share_.exchange(base_, bonds_.stencil().layers());
  linearForceOfLayers(bonds_, base_, force, share_.first(), share_.last());
  forShare(
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      for (int c = 0; c < l.dimension; ++c)
        levelKernels().toFloat(l.size[0], 1, force.component(c) + i, levels_.front().g.component(c) + i);
    });
}

// The residuals of the coarse levels, when all else of them is zero; every rank then has all of them.
void EventHierarchy::restrictAll()
{
  share_.gather(levels_.front().g);
  for (std::size_t k = 0; k + 1 < levels_.size(); ++k)
  {
    const NodeLayout& l = levels_[k].g.layout();
    outer_[k] = whole(l);
    for (int c = 0; c < l.dimension; ++c)
      std::copy_n(levels_[k].g.component(c), l.count(), levels_[k].change.component(c));
    levels_[k + 1].g.fill(0);
    restrictChange(k);
    levels_[k + 1].change.fill(0);
  }
}

// What is known of them: their part of the residual force goes into the displacement of the finest level.
void EventHierarchy::takeOutSlowMotions()
{
  const NodeLayout& l = bonds_.layout();
  EventLevel& finest = levels_.front();
  NodeField<float>& p = finest.total;
  p.fill(0);
  slow_.answer(finest.g, p);
  share_.exchange(p, bonds_.stencil().layers());
  linearForceOfLayers(bonds_, p, finest.change, share_.first(), share_.last()); // −A p
  forShare(
    [&](std::int64_t y, std::int64_t z)
    {
      const std::int64_t i = l.index(0, y, z);
      for (int c = 0; c < l.dimension; ++c)
        levelKernels().axpy(l.size[0], 1.0F, finest.change.component(c) + i, finest.g.component(c) + i);
      move(1.0F, p, y, z);
    });
}

void EventHierarchy::addToBase(std::int64_t n, float a, const float* p, double* u)
{
  for (std::int64_t x = 0; x < n; ++x)
    u[x] += static_cast<double>(a * p[x]);
}

void EventHierarchy::move(float a, const NodeField<float>& p, std::int64_t y, std::int64_t z)
{
  const NodeLayout& l = bonds_.layout();
  const std::int64_t i = l.index(0, y, z);
  for (int c = 0; c < l.dimension; ++c)
  {
    if (inBase_)
      addToBase(l.size[0], a, p.component(c) + i, base_.component(c) + i);
    if (NodeField<float>& kept = inBase_ ? motion_ : levels_.front().w; kept.components() > 0)
      levelKernels().axpy(l.size[0], a, p.component(c) + i, kept.component(c) + i);
  }
}

EventHierarchy::Reached EventHierarchy::correctGlobally(
  const Goal& goal, const std::optional<Goal>& further, const std::function<bool(double)>& progress)
{
  const NodeLayout& l = bonds_.layout();
  EventLevel& finest = levels_.front();
  NodeField<float>& r = finest.g;
  NodeField<float>& q = finest.change;
  NodeField<float>& p = finest.total;
  measureResidual();
  double size = freeNorm(q);
  learn(size);
  const auto [tolerance, maxIterations] = further && size <= goal.tolerance * reference_ ? *further : goal;
  const double target = tolerance * reference_;
  looked_ = size <= target && ++looks_ < mostLooks;
  size_ = size;
  little_ = l.dimension == 3 && size <= slightly * target;
  if (looked_)
  {
    share_.gather(q); // force()
    return { 0, tolerance };
  }
  looks_ = 0;
  collapse();
  if (++sinceDouble_ >= everyDouble)
  {
    sinceDouble_ = 0;
    residualInDouble();
    size = freeNorm(r);
  }
  else
    std::swap(r, q);
  const bool moves = size > target;
  motion_ = NodeField<float>();
  if (moves && !slow_.empty())
  {
    if (inBase_)
      motion_ = NodeField<float>(l);
    takeOutSlowMotions();
    size = freeNorm(r);
  }
  double rz = 0;
  float alpha = 0;
  int iterations = 0;
  bool rebuilt = false;
  for (bool restart = true; size > target && iterations < maxIterations;)
  {
    if (inBase_ && iterations == 1 && motion_.components() == 0) // it may be a slow one
    {
      motion_ = NodeField<float>(l);
      forShare(
        [&](std::int64_t y, std::int64_t zz)
        {
          const std::int64_t i = l.index(0, y, zz);
          for (int c = 0; c < l.dimension; ++c)
            levelKernels().axpy(l.size[0], alpha, p.component(c) + i, motion_.component(c) + i);
        });
    }
    const NodeField<float>& z = multigrid_->apply(r);
    const double next = dot(r, z);
    const auto beta = static_cast<float>(restart ? 0 : next / rz);
    rz = next;
    forShare(
      [&](std::int64_t y, std::int64_t zz)
      {
        const std::int64_t i = l.index(0, y, zz);
        for (int c = 0; c < l.dimension; ++c)
          eventKernels().direction(l.size[0], z.component(c) + i, beta, p.component(c) + i);
      });
    share_.exchange(p, bonds_.stencil().layers());
    linearForceOfLayers(bonds_, p, q, share_.first(), share_.last()); // −A p
    const double pq = -dot(p, q);
    restart = false;
    if (!(rz > 0) || !(pq > 0) || !std::isfinite(rz / pq))
    {
      if (rebuilt)
        throw DivergenceError(
          fmt::format("a displacement without stiffness (r·z = {:.1e}, p·Kp = {:.1e}) in a global correction", rz, pq),
          "use the accurate method for this sample, and report it");
      rebuilt = restart = true;
      p.fill(0);
      build(); // round-off of many breaks
      continue;
    }
    alpha = static_cast<float>(rz / pq);
    size = std::sqrt(rowSum(
      [&](std::int64_t y, std::int64_t zz)
      {
        const std::int64_t i = l.index(0, y, zz);
        move(alpha, p, y, zz);
        for (int c = 0; c < l.dimension; ++c)
          levelKernels().axpy(l.size[0], alpha, q.component(c) + i, r.component(c) + i);
        return freeSquare(r, y, zz);
      }));
    ++iterations;
    if (progress && progress(std::clamp(std::log(size / reference_) / std::log(tolerance), 0.0, 1.0)))
      throw Cancelled();
  }
  if (iterations >= slow)
  {
    NodeField<float>& motion = inBase_ ? motion_ : finest.w;
    share_.gather(motion);
    slow_.keep(inBase_ ? std::move(motion) : NodeField<float>(motion), q);
  }
  motion_ = NodeField<float>();
  if (moves && !inBase_)
  {
    forShare(
      [&](std::int64_t y, std::int64_t z)
      {
        const std::int64_t i = l.index(0, y, z);
        for (int c = 0; c < l.dimension; ++c)
          for (std::int64_t x = i; x < i + l.size[0]; ++x)
            base_.component(c)[x] += static_cast<double>(finest.w.component(c)[x]);
      });
    finest.w.fill(0);
  }
  share_.gather(base_);
  for (EventLevel& level : levels_) // w is zero since it was collapsed
  {
    level.total.fill(0);
    level.change.fill(0);
  }
  clearDirections();
  restrictAll();
  size_ = size;
  return { iterations, tolerance };
}

int EventHierarchy::solve(double tolerance, const std::function<bool(double)>& progress)
{
  constexpr int most = 2000;
  int iterations = 0;
  for (int round = 0; round < 8; ++round)
  {
    sinceDouble_ = everyDouble;
    looks_ = mostLooks;
    const int now = correctGlobally({ 0.5 * tolerance, most }, {}, progress).iterations;
    iterations += now;
    if (now == 0)
      return iterations;
    if (iterations >= most)
      break;
    residualInDouble(); // in single precision no more than some five digits of it are true
    if (freeNorm(levels_.front().g) <= tolerance * reference_)
    {
      restrictAll();
      return iterations;
    }
  }
  throw DivergenceError(fmt::format("the residual force is still {:.1e} of the load after {} iterations",
                          freeNorm(levels_.front().g) / reference_, iterations),
    "a looser tolerance, or a coarser sample if walls are one node thin");
}

} // namespace lamella::peridynamics
