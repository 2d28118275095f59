// Equilibrium in single precision, for what is asked for to a few digits: around the preconditioner, which is in single
// precision anyway, conjugate gradients move half as much memory.
#include "peridynamics/Equilibrium.h"

#include "core/Clock.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/Preconditioner.h"
#include "peridynamics/RowSums.h"
#include "peridynamics/fracture/EventKernels.h"
#include "peridynamics/multigrid/LevelKernels.h"

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{
namespace
{

// Below, round-off of the recurrence could show.
constexpr double leastTolerance = 1e-4;

} // namespace

EquilibriumResult Equilibrium::solveRoughly(NodeField<double>& u, const NodeField<double>* load, double reference)
{
  if (options_.solver != EquilibriumSolver::Multigrid || options_.tolerance < leastTolerance)
    return solve(u, load, reference);
  const double start = seconds();
  const NodeLayout& l = u.layout();
  const Communicator& comm = bonds_.communicator();
  const LevelKernels& k = levelKernels();
  const EventKernels& event = eventKernels();
  EquilibriumResult result;
  result.setupSeconds = setupSeconds_;

  // the unknown is the correction over the norm of the residual that u leaves
  NodeField<float> r(l);
  double scale = 0;
  {
    NodeField<double> exact(l);
    residual(u, load, exact, false);
    scale = norm(exact);
    forOwnRows(l,
      [&](std::int64_t y, std::int64_t z)
      {
        for (int c = 0; c < l.dimension; ++c)
          k.toFloat(l.size[0], scale > 0 ? 1 / scale : 0, exact.component(c) + l.index(0, y, z),
            r.component(c) + l.index(0, y, z));
      });
  }
  NodeField<float> x(l);
  NodeField<float> p(l);
  NodeField<float> q(l);
  const double target = scale > 0 ? options_.tolerance * reference / scale : 1;
  double size = scale > 0 ? 1 : 0;
  double rz = 0;
  bool sound = true;
  while (size > target && sound)
  {
    const NodeField<float>& z = preconditioner_->apply(r);
    const auto dot = [&](const NodeField<float>& a, const NodeField<float>& b)
    {
      return sumOfRows(comm, l,
        [&](std::int64_t i)
        {
          double sum = 0;
          for (int c = 0; c < l.dimension; ++c)
            sum += event.dot(l.size[0], a.component(c) + i, b.component(c) + i);
          return sum;
        });
    };
    const double next = dot(r, z);
    const auto beta = static_cast<float>(result.iterations == 0 ? 0 : next / rz);
    rz = next;
    forOwnRows(l,
      [&](std::int64_t y, std::int64_t zz)
      {
        for (int c = 0; c < l.dimension; ++c)
          event.direction(l.size[0], z.component(c) + l.index(0, y, zz), beta, p.component(c) + l.index(0, y, zz));
      });
    ++products_;
    exchangeAndLinearForce(bonds_, p, q); // −A p
    hold(q);
    const double pq = -dot(p, q);
    sound = rz > 0 && pq > 0 && std::isfinite(rz / pq) && result.iterations < options_.maxIterations;
    if (!sound)
      break;
    const auto alpha = static_cast<float>(rz / pq);
    size = std::sqrt(sumOfRows(comm, l,
      [&](std::int64_t i)
      {
        double sum = 0;
        for (int c = 0; c < l.dimension; ++c)
        {
          k.axpy(l.size[0], alpha, p.component(c) + i, x.component(c) + i);
          k.axpy(l.size[0], alpha, q.component(c) + i, r.component(c) + i);
          sum += event.dot(l.size[0], r.component(c) + i, r.component(c) + i);
        }
        return sum;
      }));
    ++result.iterations;
    report(std::clamp(std::log(size) / std::log(target), 0.0, 1.0));
  }
  forOwnRows(l,
    [&](std::int64_t y, std::int64_t z)
    {
      for (int c = 0; c < l.dimension; ++c)
        for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
          u.component(c)[i] += scale * static_cast<double>(x.component(c)[i]);
    });
  bonds_.exchange(u);
  if (!sound) // round-off, or nothing holds: that one finds out which
  {
    EquilibriumResult rest = solve(u, load, reference);
    rest.iterations += result.iterations;
    return rest;
  }
  result.residual = size * scale / reference;
  result.levels = preconditioner_->levels();
  result.hinges = preconditioner_->hinges();
  result.solveSeconds = seconds() - start;
  return result;
}

} // namespace lamella::peridynamics
