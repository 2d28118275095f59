#include "lbm/ContourChecks.h"

#include "core/Error.h"
#include "core/Memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella::lbm
{
namespace
{

constexpr double kShare = 0.5; // of the memory that is free, for a target's sake

std::string percentText(double share)
{
  return fmt::format("{:.2g} %", 100 * share);
}

char axisName(const ContourAnswer& answer)
{
  return answer.axis == 0 ? 'x' : 'y';
}

/// The one whose error is the largest; one whose error is not known before all others.
const ContourAnswer& worstOf(std::span<const ContourAnswer> answers)
{
  return *std::max_element(
    answers.begin(), answers.end(),
    [](const ContourAnswer& a, const ContourAnswer& b) { return std::isfinite(a.error) && !(b.error <= a.error); });
}

} // namespace

ContourBudget contourBudget(const micrograph::ContourSet& contours, double spacing, bool lamella)
{
  const Lattice lattice = micrograph::fitContours(contours, spacing, 2).lattice;
  const auto nodes = static_cast<double>(lattice.count());
  // The solver, its links, the lattice and what its outlines cut; directions where there is a lamella.
  const double bytes =
    static_cast<double>(estimateBytes(lattice, Stencil::D2Q5, Method::AlgebraicMultigrid, lattice.count())) +
    nodes * (16 + 9 + 30 + (lamella ? 60 : 0));
  const auto available = static_cast<double>(availableMemory());
  if (bytes > available)
    throw MemoryError(fmt::format("diffusion on {} × {} nodes takes about {}, and {} are free", lattice.size[0],
                        lattice.size[1], bytesText(bytes), bytesText(available)),
      "take a larger spacing or a part of the picture");
  return { bytes / nodes, available, static_cast<std::int64_t>(kShare * available / bytes * nodes) };
}

std::string text(const ContourPlan& plan, const ContourBudget& budget)
{
  const double takes = budget.bytesPerNode * static_cast<double>(plan.nodes);
  std::string text = fmt::format("the error bar is {}; ", percentText(plan.error));
  text += plan.pictureError < plan.target
    ? percentText(plan.target) + " takes"
    : fmt::format("of the {} asked for only a finer picture can reach, half of the picture's {} takes",
        percentText(plan.target), percentText(plan.pictureError));
  text += fmt::format(" about {} nodes and {} of memory", plan.nodes, bytesText(takes));
  if (takes > kShare * budget.available)
    text += fmt::format(", and no more than half of the {} that are free is taken", bytesText(budget.available));
  return text;
}

Target targetOf(std::span<const ContourAnswer> answers, double target)
{
  const ContourAnswer& worst = worstOf(answers);
  if (worst.error <= target)
    return Target::Reached;
  return std::isfinite(worst.error) && worst.pictureError < target ? Target::MemoryShort : Target::PictureTooCoarse;
}

Shortfall shortfall(std::span<const ContourAnswer> answers, double target)
{
  const ContourAnswer& worst = worstOf(answers);
  const std::string asked = fmt::format("an error of {} was asked for, and ", percentText(target));
  const std::string reached = fmt::format("{} along {} was reached", percentText(worst.error), axisName(worst));
  switch (targetOf(answers, target))
  {
    case Target::PictureTooCoarse:
      if (!std::isfinite(worst.error))
        return { asked + fmt::format("that of the picture along {} is not known", axisName(worst)),
          "take a picture of smaller pixels, or outlines as vectors" };
      return { asked + reached,
        fmt::format("{} of it is the picture's: only smaller pixels or outlines as vectors lower that",
          percentText(worst.pictureError)) };
    case Target::MemoryShort:
      return { asked + reached,
        fmt::format("the next lattice, of {} nodes, would take more than half of the free memory: use a part of the "
                    "picture, or a machine with more",
          4 * worst.fine.nodes) };
    default:
      return {};
  }
}

double worst(std::span<const ContourAnswer> answers, double ContourAnswer::*kind)
{
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (const ContourAnswer& answer : answers)
    worst = std::isnan(worst) || answer.*kind > worst ? answer.*kind : worst;
  return worst;
}

ContourProgress::ContourProgress(const ContourStudyOptions& options)
  : axes_(options.axes.size())
{
  std::size_t lattices = 2;
  for (const micrograph::ContourSet* set : { &options.moved, &options.sealed })
    lattices += set->contours.empty() ? 0 : 1;
  for (const micrograph::CoarserOutlines& outlines : options.coarser)
    lattices += outlines.sets.size();
  coarse_ = lattices * axes_;
}

double ContourProgress::weight(std::size_t solve) const
{
  return (solve <= coarse_ ? 1.0 : 4.0) / static_cast<double>(coarse_ + 4 * axes_);
}

double ContourProgress::operator()(double share)
{
  if (share <= 0 || begun_ == 0)
  {
    before_ += begun_ > 0 ? weight(begun_) : 0;
    ++begun_;
  }
  if (begun_ > coarse_ + axes_)
  {
    const std::size_t ofThis = (begun_ - 1 - coarse_) % axes_;
    return (static_cast<double>(ofThis) + share) / static_cast<double>(axes_);
  }
  return std::min(1.0, before_ + share * weight(begun_));
}

} // namespace lamella::lbm
