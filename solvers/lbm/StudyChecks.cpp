#include "lbm/StudyChecks.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "lattice/AxisNames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::lbm
{
namespace
{

Method leanest(const StudySize& size)
{
  return leanest(size.lattice, size.stencil, size.conducting == size.lattice.count());
}

// In doubles, for a refinement typed wrongly can have more nodes than 64 bits count. Beside the solver's arrays: the
// refined picture on every rank, a copy of the part of a rank that has not all, and on rank 0 value and flux as they
// are written.
double bytesAt(const StudySize& size, int refinement)
{
  const Lattice& lattice = size.lattice;
  const auto count = static_cast<double>(lattice.count());
  const auto solver = static_cast<double>(estimateBytes(lattice, size.stencil, leanest(size), size.conducting));
  const double scale = std::pow(static_cast<double>(refinement), lattice.dimension);
  Lattice refined = lattice;
  for (std::int64_t& n : refined.size)
    n *= refinement;
  const int sharing = ranksSharing(refined, size.stencil, size.ranks);
  return scale *
    (solver * size.ranksOnMachine / sharing + count * (size.ranksOnMachine + (size.ranks > 1 ? 1 : 0)) +
      (size.fields ? count * (8 + 24 + 2) : 0) + (size.membranes ? 2 * count * size.ranksOnMachine : 0));
}

// Processor time for a node, set-up and solve to 1e-6, on the machine of docs/benchmarks/volumes.md.
double secondsANode(Method method)
{
  switch (method)
  {
    case Method::LeanMultigrid:
      return 1.4e-7;
    case Method::PieceMultigrid:
      return 5e-7;
    case Method::Multigrid:
      return 4.5e-7;
    default:
      return 7.5e-6;
  }
}

std::string percent(double share)
{
  return std::isfinite(share) ? fmt::format("{:.2g} %", 100 * share) : "unknown";
}

} // namespace

void requireMemory(const StudySize& size)
{
  const Lattice& lattice = size.lattice;
  const int refinement = size.refinement;
  const auto bytes = [&](int n) { return bytesAt(size, n); };
  const auto available = static_cast<double>(availableMemory());
  if (bytes(refinement) <= available)
    return;
  // Bytes grow with the refinement to the power of the dimension.
  const double largest = std::pow(available / bytes(1), 1.0 / lattice.dimension);
  const int fits = std::min(refinement - 1, static_cast<int>(std::min(largest, 1e6)));
  std::string nodes;
  for (int axis = 0; axis < lattice.dimension; ++axis)
    nodes += fmt::format(
      "{}{:.0f}", axis == 0 ? "" : " × ", static_cast<double>(refinement) * static_cast<double>(lattice.size[axis]));
  throw MemoryError(fmt::format("{} nodes at refinement {} need about {} of memory, and {} are free", nodes, refinement,
                      bytesText(bytes(refinement)), bytesText(available)),
    fmt::format("{}take a smaller window, or share the work between machines with mpirun",
      fits > 0 ? fmt::format("refinement {} fits; or ", fits) : ""));
}

std::string plan(const StudySize& size, int solves, int threads)
{
  constexpr double many = 3e7;
  const double nodes =
    static_cast<double>(size.lattice.count()) * std::pow(static_cast<double>(size.refinement), size.lattice.dimension);
  if (nodes < many)
    return {};
  const Method method = leanest(size);
  const double seconds = nodes * secondsANode(method) / (size.ranks * std::max(1, threads));
  return fmt::format("{:.4g} million nodes: about {} of memory, and something like {}{}", nodes / 1e6,
    bytesText(bytesAt(size, size.refinement)),
    seconds < 100 ? fmt::format("{:.2g} s", seconds) : fmt::format("{:.2g} min", seconds / 60),
    solves > 1 ? " for each direction" : "");
}

void requirePaths(SteadyDiffusion& solver, std::span<const int> axes, int dimension)
{
  std::string blocked;
  std::string open;
  for (int axis = 0; axis < dimension; ++axis)
  {
    const bool asked = std::ranges::find(axes, axis) != axes.end();
    if (solver.percolates(axis))
      open += (open.empty() ? "" : " or ") + std::string(axisNames[axis]);
    else if (asked)
      blocked += (blocked.empty() ? "" : " or ") + std::string(axisNames[axis]);
  }
  if (!blocked.empty())
    throw NoPathError("no conducting path crosses the sample along " + blocked,
      (open.empty() ? "" : "direction " + open + " has one; or ") +
        std::string("give a phase that blocks the way a conductivity above 0"));
}

const char* name(Target target) noexcept
{
  switch (target)
  {
    case Target::Reached:
      return "reached";
    case Target::PictureTooCoarse:
      return "picture too coarse";
    case Target::MemoryShort:
      return "memory short";
    case Target::None:
      break;
  }
  return "none";
}

std::string text(const TargetPlan& plan)
{
  return fmt::format(
    "this error needs refinement {} as far as can be foreseen: {} nodes, {} of the {} it may take, {:.2g} s",
    plan.refinement, plan.nodes, bytesText(static_cast<double>(plan.bytes)),
    bytesText(static_cast<double>(plan.allowed)), plan.seconds);
}

double worst(std::span<const DiffusionAnswer> answers, double ErrorEstimate::*kind)
{
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (const auto& answer : answers)
    worst = std::isnan(worst) || answer.error.*kind > worst ? answer.error.*kind : worst;
  return worst;
}

Shortfall shortfall(std::span<const DiffusionAnswer> answers, double target, bool outlines)
{
  const DiffusionAnswer& first = answers.front();
  const std::string asked = fmt::format("an error below {} was asked for, and {} was reached", percent(target),
    percent(worst(answers, &ErrorEstimate::relative)));
  if (first.target == Target::MemoryShort)
    return { asked +
        fmt::format(": refinement {} needs about {}, more than the {} it may take", first.plan.refinement,
          bytesText(static_cast<double>(first.plan.bytes)), bytesText(static_cast<double>(first.plan.allowed))),
      "use a smaller window, a machine with more free memory, or several with mpirun" };
  if (first.target == Target::PictureTooCoarse)
    return { asked +
        fmt::format(": {} of it is the picture's own, which splitting its pixels does not change",
          percent(worst(answers, &ErrorEstimate::picture))),
      std::string("only a picture with smaller pixels reaches it") +
        (outlines ? ", or outlines through these, which err less: lamella micrograph" : "") };
  return {};
}

} // namespace lamella::lbm
