#include "core/Clock.h"
#include "core/Error.h"
#include "lbm/Bounds.h"
#include "lbm/ContourDiffusion.h"
#include "outlines/ContourMeasures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

namespace lamella::lbm
{
namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

class OutlineStudy
{
public:
  OutlineStudy(const micrograph::ContourSet& contours, const ContourStudyOptions& options, MPI_Comm comm)
    : contours_(contours)
    , options_(options)
    , comm_(comm)
    , before_(options.axes.size(), unknown)
  {
    for (const int axis : options.axes)
      answers_.emplace_back().axis = axis;
  }

  std::vector<ContourAnswer> run()
  {
    first_ = micrograph::fitContours(contours_, options_.spacing, 2).lattice;
    multiple_ = 2;
    if (std::min(first_.size[0], first_.size[1]) >= 8)
    {
      multiple_ = 4;
      first_ = micrograph::fitContours(contours_, options_.spacing, multiple_).lattice;
      coarsest();
    }
    refine(-1, [](ContourAnswer&) {});
    solveCoarser();
    refine(0, [this](ContourAnswer& answer) { judge(answer); });
    if (options_.targetError > 0)
      reachTarget();
    return std::move(answers_);
  }

private:
  struct Solved
  {
    ContourStep step;
    SteadyResult result;
  };

  // Along every axis, on a lattice of 2^level of the first one's nodes along each axis.
  std::vector<Solved> solveOn(const micrograph::ContourSet& contours, int level)
  {
    const auto start = Clock::now();
    const double nodes = std::ldexp(static_cast<double>(first_.size[0]), level);
    const int multiple = std::max(1, static_cast<int>(std::ldexp(multiple_, level)));
    const micrograph::FittedContours fitted = micrograph::fitContours(contours, contours.size[0] / nodes, multiple);
    micrograph::ContourLatticeOptions make;
    make.spacing = fitted.lattice.spacing;
    make.lines = 1;
    make.across = true;
    make.grain = false;
    micrograph::ContourLattice made = micrograph::contourLattice(fitted.contours, make);
    if (&contours == &contours_)
      setBounds(made.lumenShare);
    if (options_.phases)
      options_.phases(fitted, made);
    const Lattice& lattice = made.image.lattice;
    SteadyOptions steady = options_.steady;
    steady.stencil = Stencil::D2Q5;
    steady.sides = Sides::Insulated;
    steady.fieldTolerance = std::max(steady.fieldTolerance, std::sqrt(steady.tolerance)); // nobody sees the field
    const Block block = decompose(lattice, comm_);
    const std::vector<std::uint8_t> phase = blockOf(made.image, block);
    const double ofEach = secondsSince(start) / static_cast<double>(answers_.size());
    std::optional<SteadyDiffusion> solver;
    std::vector<Solved> solved;
    for (ContourAnswer& answer : answers_)
    {
      const auto begin = Clock::now();
      // Cells are as long as they are wide after stretching. A link along x is shorter for its width than it should be
      // by the stretch, one along y longer.
      LinkTable links = linksOf(made, options_.conductivity, answer.axis);
      for (double& g : links.x)
        g /= fitted.stretch;
      for (double& g : links.y)
        g *= fitted.stretch;
      if (!solver || links.x != steady.links->x || links.y != steady.links->y)
      {
        steady.links = std::make_shared<LinkTable>(std::move(links));
        solver.emplace(lattice, block, phase, options_.conductivity, steady, comm_);
      }
      Solved s;
      s.result = solver->solve(answer.axis);
      // What the box conducts is known; the box that it is of is the true one.
      const double conducts = s.result.effective[static_cast<std::size_t>(answer.axis)];
      const double value = answer.axis == 0 ? conducts * fitted.stretch : conducts / fitted.stretch;
      s.step = { fitted.lattice.spacing, value, lattice.count(), s.result.iterations, ofEach + secondsSince(begin) };
      answer.seconds += s.step.seconds;
      solved.push_back(s);
    }
    return solved;
  }

  // The third lattice, of which nothing is told.
  void coarsest()
  {
    try
    {
      const std::vector<Solved> solved = solveOn(contours_, -2);
      for (std::size_t i = 0; i < solved.size(); ++i)
        before_[i] = solved[i].step.value;
    }
    catch (const Cancelled&)
    {
      throw;
    }
    catch (const Error&) // no path through so few nodes
    {
    }
  }

  template <typename Judge>
  void refine(int level, const Judge& judge)
  {
    const std::vector<Solved> solved = solveOn(contours_, level);
    for (std::size_t i = 0; i < answers_.size(); ++i)
    {
      ContourAnswer& answer = answers_[i];
      if (answer.steps.size() > 1)
        before_[i] = answer.coarse.value;
      answer.coarse = answer.fine;
      answer.fine = solved[i].step;
      answer.steps.push_back(solved[i].step);
      answer.result = solved[i].result;
      judge(answer);
    }
  }

  void solveCoarser()
  {
    for (const micrograph::CoarserOutlines& outlines : options_.coarser)
    {
      for (ContourAnswer& answer : answers_)
        answer.coarser.push_back({ static_cast<double>(outlines.stride), {} });
      for (const micrograph::ContourSet& contours : outlines.sets)
      {
        std::vector<Solved> solved(answers_.size());
        try
        {
          solved = solveOn(contours, -1);
        }
        catch (const NoPathError&) // conducts nothing
        {
        }
        for (std::size_t i = 0; i < solved.size(); ++i)
          answers_[i].coarser.back().values.push_back(solved[i].step.value);
      }
    }
    const double deviations =
      options_.coarser.empty() ? 0 : outlineDeviations(contours_, options_.pixel, options_.shares);
    for (ContourAnswer& answer : answers_)
      answer.pictureError = options_.coarser.empty() ? 0 : outlineError(answer.fine.value, answer.coarser, deviations);
    doubt(options_.moved, &ContourAnswer::moved);
    doubt(options_.sealed, &ContourAnswer::sealed);
  }

  // Adds what other outlines, which may be the true ones, conduct otherwise to the picture's error.
  void doubt(const micrograph::ContourSet& other, double ContourAnswer::*change)
  {
    if (other.contours.empty())
      return;
    std::vector<Solved> solved(answers_.size());
    try
    {
      solved = solveOn(other, -1);
    }
    catch (const NoPathError&) // conducts nothing
    {
    }
    for (std::size_t i = 0; i < solved.size(); ++i)
    {
      ContourAnswer& answer = answers_[i];
      answer.*change = solved[i].step.value / answer.fine.value - 1;
      answer.pictureError = std::hypot(answer.pictureError, answer.*change);
    }
  }

  // Whatever the shape of the lumens; walls may be of several phases.
  void setBounds(std::span<const float> lumenShare)
  {
    const auto& k = options_.conductivity;
    if (k.size() < 2)
      return;
    const double lumen =
      std::accumulate(lumenShare.begin(), lumenShare.end(), 0.0) / static_cast<double>(lumenShare.size());
    const auto [least, most] = std::minmax_element(k.begin() + 1, k.end());
    const std::array<double, 2> share{ lumen, 1 - lumen };
    series_ = bounds(share, std::array{ k[0], *least }, 2).series;
    parallel_ = bounds(share, std::array{ k[0], *most }, 2).parallel;
  }

  void judge(ContourAnswer& answer) const
  {
    const double before = before_[static_cast<std::size_t>(&answer - answers_.data())];
    const double change = std::abs(answer.fine.value - answer.coarse.value);
    const double earlier = std::isfinite(before) ? std::abs(answer.coarse.value - before) / 3 : 0;
    answer.value = 2 * answer.fine.value - answer.coarse.value;
    // walls far below a spacing: what lies outside of the bounds errs by that at least, and as likely by more
    const double outside = std::max({ answer.value - parallel_, series_ - answer.value, 0.0 });
    answer.latticeError = std::max({ change, earlier, 2 * outside }) / answer.value;
    answer.error = std::sqrt(answer.latticeError * answer.latticeError + answer.pictureError * answer.pictureError);
  }

  [[nodiscard]] bool enough(const ContourAnswer& answer) const { return answer.latticeError <= allowedOf(answer); }

  // What the lattice may leave: what the picture leaves of the target, or half of what it errs itself where that is
  // more than a lattice could mend.
  [[nodiscard]] double allowedOf(const ContourAnswer& answer) const
  {
    const double target = options_.targetError;
    const double picture = std::isfinite(answer.pictureError) ? answer.pictureError : 0;
    return picture < target ? std::sqrt(target * target - picture * picture) : 0.5 * picture;
  }

  void reachTarget()
  {
    const auto all = [&] { return std::all_of(answers_.begin(), answers_.end(), [&](auto& a) { return enough(a); }); };
    if (options_.plan && !all())
      options_.plan(plan());
    for (int level = 1; !all(); ++level)
    {
      if (options_.mostNodes > 0 && 4 * answers_.front().fine.nodes > options_.mostNodes)
        break;
      refine(level, [this](ContourAnswer& answer) { judge(answer); });
    }
  }

  [[nodiscard]] ContourPlan plan() const
  {
    ContourPlan plan;
    plan.target = options_.targetError;
    plan.nodes = answers_.front().fine.nodes;
    for (const ContourAnswer& answer : answers_)
    {
      plan.error = std::max(plan.error, answer.error);
      plan.pictureError = std::max(plan.pictureError, answer.pictureError);
      const double allowed = allowedOf(answer);
      double lattice = answer.latticeError;
      std::int64_t nodes = answer.fine.nodes;
      for (; lattice > allowed && nodes < std::numeric_limits<std::int64_t>::max() / 4; lattice /= 2)
        nodes *= 4;
      plan.nodes = std::max(plan.nodes, nodes);
    }
    return plan;
  }

  const micrograph::ContourSet& contours_;
  const ContourStudyOptions& options_;
  MPI_Comm comm_;
  Lattice first_;
  int multiple_ = 2;
  double series_ = 0;
  double parallel_ = std::numeric_limits<double>::infinity();
  std::vector<double> before_; ///< values on the lattice before `coarse`, one an axis
  std::vector<ContourAnswer> answers_;
};

} // namespace

double outlineDeviations(const micrograph::ContourSet& contours, double pixel, bool shares)
{
  if (shares)
    return 1;
  const double width = std::max(1.0, micrograph::leastWidth(contours) / pixel);
  return 1.4 + 6 / (width * width);
}

double outlineError(double value, std::span<const SubsampleValues> coarser, double deviations)
{
  double variance = 0;
  double weights = 0;
  for (const SubsampleValues& c : coarser)
  {
    if (c.values.size() < 2)
    {
      if (weights == 0)
        return unknown;
      continue;
    }
    double square = 0;
    for (const double v : c.values)
      square += (v / value - 1) * (v / value - 1) / static_cast<double>(c.values.size());
    const double weight = weights > 0 ? 0.25 : 0.75;
    variance += weight * square / (std::pow(c.stride, 3) - 1);
    weights += weight;
  }
  return weights > 0 ? deviations * std::sqrt(variance / weights) : unknown;
}

std::vector<ContourAnswer> studyContours(
  const micrograph::ContourSet& contours, const ContourStudyOptions& options, MPI_Comm comm)
{
  if (!(options.targetError >= 0) || !std::isfinite(options.targetError))
    throw ParameterError(
      fmt::format("a target of {} for the error", options.targetError), "give a share such as 0.001");
  if (!options.coarser.empty() && !(options.pixel > 0))
    throw ParameterError(fmt::format("coarser pictures of one with pixels of {} m", options.pixel), "give its pixel");
  return OutlineStudy(contours, options, comm).run();
}

} // namespace lamella::lbm
