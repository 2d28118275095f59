#include "peridynamics/Equilibrium.h"

#include "core/Clock.h"
#include "core/Error.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/Preconditioner.h"
#include "peridynamics/RowSums.h"
#include "peridynamics/ValueShare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::peridynamics
{
Equilibrium::Equilibrium(const BondLattice& bonds, FixedComponents fixed, EquilibriumOptions options)
  : bonds_(bonds)
  , fixed_(std::move(fixed))
  , options_(std::move(options))
{
  const double start = seconds();
  const NodeLayout& l = bonds_.layout();
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        if (fixed_[i] != 0)
          fixedNodes_.push_back(i);
  if (options_.solver == EquilibriumSolver::Multigrid)
    preconditioner_ = std::make_unique<MultigridPreconditioner>(bonds_, fixed_, options_.multigrid);
  else if (options_.solver == EquilibriumSolver::Jacobi)
    preconditioner_ = std::make_unique<JacobiPreconditioner>(bonds_, fixed_);
  setupSeconds_ = seconds() - start;
}

Equilibrium::~Equilibrium() = default;

double Equilibrium::dot(const NodeField<double>& a, const NodeField<double>& b) const
{
  return peridynamics::dot(bonds_.communicator(), a, b);
}

double Equilibrium::norm(const NodeField<double>& a) const
{
  return std::sqrt(dot(a, a));
}

void Equilibrium::residual(NodeField<double>& u, const NodeField<double>* load, NodeField<double>& r, bool large)
{
  ++products_;
  if (large)
    exchangeAndNonlinearForce(bonds_, u, r);
  else
    exchangeAndLinearForce(bonds_, u, r);
  if (load != nullptr)
    forOwnRows(r.layout(),
      [&](std::int64_t y, std::int64_t z)
      {
        const std::int64_t i = r.layout().index(0, y, z);
        for (int c = 0; c < r.components(); ++c)
          levelKernels().axpyDouble(r.layout().size[0], 1, load->component(c) + i, r.component(c) + i);
      });
  hold(r);
}

// Norm of the forces on free components while these have not moved.
double Equilibrium::forcing(const NodeField<double>& u, const NodeField<double>* load)
{
  const NodeLayout& l = u.layout();
  NodeField<double> still(l);
  for (const std::int64_t i : fixedNodes_)
    for (int c = 0; c < l.dimension; ++c)
      if ((fixed_[i] >> c & 1U) != 0)
        still.component(c)[i] = u.component(c)[i];
  NodeField<double> r(l);
  residual(still, load, r, false);
  return norm(r);
}

EquilibriumResult Equilibrium::solve(NodeField<double>& u, const NodeField<double>* load, std::optional<double> given)
{
  const double start = seconds();
  EquilibriumResult result;
  result.setupSeconds = setupSeconds_;
  const std::int64_t before = products_;
  const double reference = given ? *given : forcing(u, load);
  if (!std::isfinite(reference))
    throw ParameterError("a displacement or a load that is given is not finite", "look for NaN in what is prescribed");
  if (reference > 0)
    switch (options_.solver)
    {
      case EquilibriumSolver::Direct:
        solveDirectly(u, load, result);
        break;
      case EquilibriumSolver::DynamicRelaxation:
        relaxDynamically(u, load, reference, result);
        break;
      default:
        conjugateGradients(u, load, options_.tolerance * reference, reference, nullptr, result);
    }
  else
    for (int c = 0; c < u.components(); ++c) // nothing moves anything
      for (std::int64_t i = 0; i < u.layout().count(); ++i)
        if ((fixed_[i] >> c & 1U) == 0)
          u.component(c)[i] = 0;
  if (options_.doubt && options_.strains == Strains::Small && reference > 0)
    refine(u, load, reference, result);
  if (options_.strains == Strains::Large && reference > 0)
    newton(u, load, reference, result);
  bonds_.exchange(u);
  result.products = products_ - before + (preconditioner_ ? preconditioner_->products() : 0);
  const std::int64_t vectors = 3 * u.components() * u.layout().count() * static_cast<std::int64_t>(sizeof(double));
  result.bytes = vectors + fixed_.size() + (preconditioner_ ? preconditioner_->bytes() : 0);
  result.levels = preconditioner_ ? preconditioner_->levels() : 1;
  result.hinges = preconditioner_ ? preconditioner_->hinges() : 0;
  result.solveSeconds = seconds() - start;
  return result;
}

void Equilibrium::report(double share) const
{
  if (options_.progress && bonds_.communicator().any(options_.progress(share)))
    throw Cancelled();
}

// Of the load: what the recurrence drifts by is far below.
constexpr double driftShare = 1e-4;

// With `tangentAt`, u is a correction to that state, and the residual is that of the nonlinear forces there.
void Equilibrium::conjugateGradients(NodeField<double>& u, const NodeField<double>* load, double target,
  double reference, const NodeField<double>* tangentAt, EquilibriumResult& result)
{
  const NodeLayout& l = bonds_.layout();
  const LevelKernels& k = levelKernels();
  NodeField<double> r(l);
  NodeField<double> p(l);
  NodeField<double> q(l);
  if (tangentAt == nullptr)
    residual(u, load, r, false);
  else
  {
    NodeField<double> state = *tangentAt;
    residual(state, load, r, true);
  }
  double size = norm(r);
  const double first = size;
  double rz = 0;
  double best = size;
  std::int64_t sinceBest = 0;
  for (std::int64_t iteration = 0; size > target; ++iteration)
  {
    if (!std::isfinite(size))
      throw DivergenceError(fmt::format("the residual force is not finite after {} iterations", result.iterations),
        "please report this with the sample and the material data");
    if (iteration >= options_.maxIterations || sinceBest > 200 + options_.maxIterations / 20)
      throw DivergenceError(
        fmt::format("the residual force is still {:.1e} of the load after {} iterations (asked for {:.1e})",
          size / reference, result.iterations, target / reference),
        "a looser tolerance, or a coarser sample if walls are one node thin");
    const NodeField<float>& z = preconditioner_->apply(r, 1 / size);
    // z is of the residual over its norm
    const double rzNew = sumOfRows(bonds_.communicator(), l,
                           [&](std::int64_t i)
                           {
                             double sum = 0;
                             for (int c = 0; c < l.dimension; ++c)
                               sum += k.dotMixed(l.size[0], r.component(c) + i, z.component(c) + i);
                             return sum;
                           }) *
      size;
    const double beta = iteration == 0 ? 0 : rzNew / rz;
    rz = rzNew;
    const auto scale = size;
    forOwnRows(l,
      [&](std::int64_t y, std::int64_t zz)
      {
        const std::int64_t i = l.index(0, y, zz);
        for (int c = 0; c < l.dimension; ++c)
          k.direction(l.size[0], z.component(c) + i, scale, beta, p.component(c) + i);
      });
    ++products_;
    if (tangentAt == nullptr)
      exchangeAndLinearForce(bonds_, p, q); // −A p
    else
    {
      bonds_.exchange(p);
      tangentProduct(bonds_, *tangentAt, p, q);
    }
    hold(q);
    const double pq = -dot(p, q);
    if (!(pq > 0))
    {
      if (tangentAt != nullptr && iteration > 0)
        return; // the tangent is not positive there: take what there is
      throw DivergenceError(
        fmt::format("a displacement without stiffness (p·Kp = {:.1e}) after {} iterations", pq, result.iterations),
        "a piece of the sample is not held: fix it, or take it out");
    }
    const double alpha = rz / pq;
    size = std::sqrt(sumOfRows(bonds_.communicator(), l,
      [&](std::int64_t i)
      {
        double sum = 0;
        for (int c = 0; c < l.dimension; ++c)
        {
          k.axpyDouble(l.size[0], alpha, p.component(c) + i, u.component(c) + i);
          k.axpyDouble(l.size[0], alpha, q.component(c) + i, r.component(c) + i);
          sum += k.dot(l.size[0], r.component(c) + i, r.component(c) + i);
        }
        return sum;
      }));
    sinceBest = size < 0.99 * best ? 0 : sinceBest + 1;
    best = std::min(best, size);
    ++result.iterations;
    if (size <= target && tangentAt == nullptr && target < driftShare * reference)
    {
      // the recurrence may have drifted from the truth by round-off
      residual(u, load, r, false);
      const double truth = norm(r);
      if (truth > target && truth > 2 * size)
        rz = std::numeric_limits<double>::infinity(); // start again from here
      size = truth;
    }
    report(std::clamp(std::log(size / first) / std::log(target / first), 0.0, 1.0));
  }
  result.residual = size / reference;
}

void Equilibrium::refine(
  NodeField<double>& u, const NodeField<double>* load, double reference, EquilibriumResult& result)
{
  const auto ask = [&]
  {
    NodeField<double> f(u.layout());
    exchangeAndLinearForce(bonds_, u, f);
    if (load != nullptr)
      for (int c = 0; c < f.components(); ++c)
        levelKernels().axpyDouble(u.layout().count(), 1, load->component(c), f.component(c));
    return options_.doubt(u, f);
  };
  const double wanted = shareLeft(bonds_, options_.tolerance);
  const std::int64_t most = options_.maxIterations;
  const std::int64_t further = 2 * result.iterations + 50;
  double target = options_.tolerance * reference;
  result.doubt = ask();
  constexpr int rounds = 6;
  constexpr double leastTarget = 1e-12; // round-off is not far below
  for (int round = 0; preconditioner_ && result.doubt > wanted && round < rounds; ++round)
  {
    if (result.iterations >= further || target < leastTarget * reference)
      break;
    options_.maxIterations = std::min(most, further - result.iterations);
    target *= std::clamp(0.5 * wanted / result.doubt, 1e-4, 0.1); // in proportion
    const NodeField<double> before = u;
    try
    {
      conjugateGradients(u, load, target, reference, nullptr, result);
      result.doubt = ask();
    }
    catch (const DivergenceError&) // nothing carries, or round-off: the tolerance was met before
    {
      const double reached = ask();
      if (reached < result.doubt)
        result.doubt = reached;
      else
        u = before;
      break;
    }
  }
  options_.maxIterations = most;
}

void Equilibrium::newton(
  NodeField<double>& u, const NodeField<double>* load, double reference, EquilibriumResult& result)
{
  const NodeLayout& l = bonds_.layout();
  NodeField<double> r(l);
  const double target = options_.tolerance * reference;
  residual(u, load, r, true);
  double size = norm(r);
  for (int step = 0; size > target; ++step)
  {
    if (step == 30)
      throw DivergenceError(
        fmt::format("Newton's method did not converge: the residual force is {:.1e} of the load", size / reference),
        "load it in smaller steps");
    NodeField<double> correction(l);
    conjugateGradients(correction, load, std::max(0.3 * target, 1e-3 * size), reference, &u, result);
    // shorter until the residual falls
    for (double length = 1;; length /= 2)
    {
      NodeField<double> next = u;
      forOwnRows(l,
        [&](std::int64_t y, std::int64_t z)
        {
          const std::int64_t i = l.index(0, y, z);
          for (int c = 0; c < l.dimension; ++c)
            levelKernels().axpyDouble(l.size[0], length, correction.component(c) + i, next.component(c) + i);
        });
      residual(next, load, r, true);
      const double now = norm(r);
      if (now < size || length < 1e-3)
      {
        if (!(now < size))
          throw DivergenceError(
            fmt::format("no step lowers the residual force, which is {:.1e} of the load", size / reference),
            "load it in smaller steps");
        u = std::move(next);
        size = now;
        break;
      }
    }
    ++result.newtonSteps;
  }
  result.residual = size / reference;
}

} // namespace lamella::peridynamics
