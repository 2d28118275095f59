#include "statistics/Fit.h"

#include "core/Error.h"
#include "statistics/Distributions.h"

#include <fmt/format.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace lamella::statistics
{
namespace
{

constexpr double differenceStep = 0.05; // of a logarithm
constexpr double mostStep = 1.5;        // of a logarithm, at once
constexpr double farthest = 14;         // from the start: six decades
const double mostUncertain = std::log(10.0);
constexpr double alone = 0.8; // of a direction's square, for one parameter to be named
constexpr double leastFall = 1e-6;
constexpr double mostDamping = 1e8;
constexpr double farOff = 3;            // standard deviations
constexpr double leastCurvature = 1e-9; // of the largest one
constexpr double smallStep = 0.05;      // of a measurement's standard deviation: no more steps are worth it
constexpr int mostHalvings = 10;
constexpr double watched = 0.05;       // damping below which a step that went up is followed by one more
constexpr double farDifferences = 0.3; // of a logarithm: made anew at the end where they are from farther away

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd sigmasOf(const std::vector<FitMeasurement>& measurements)
{
  VectorXd sigma(static_cast<Eigen::Index>(measurements.size()));
  for (std::size_t j = 0; j < measurements.size(); ++j)
    sigma(static_cast<Eigen::Index>(j)) = measurements[j].halfWidth / coverage95;
  return sigma;
}

class Fitting
{
public:
  Fitting(const std::vector<FitParameter>& parameters, const std::vector<FitMeasurement>& measurements,
    const std::function<FitEvaluation(std::span<const double>)>& model, const FitOptions& options)
    : parameters_(parameters)
    , measurements_(measurements)
    , model_(model)
    , options_(options)
    , m_(static_cast<Eigen::Index>(parameters.size()))
    , n_(static_cast<Eigen::Index>(measurements.size()))
    , sigma_(sigmasOf(measurements))
    , start_(m_)
  {
    check();
    for (Eigen::Index i = 0; i < m_; ++i)
      start_(i) = std::log(parameters[static_cast<std::size_t>(i)].start);
  }

  FitResult run()
  {
    VectorXd x = start_;
    Point here = evaluate(x);
    scale(x, here);
    VectorXd madeAt = x; // differences
    if (!told_)
      differences(x, here);
    double damping = 1e-3;
    std::optional<std::pair<VectorXd, Point>> before; // from where a step went up that is followed all the same
    const auto refuse = [&]
    {
      if (before)
        std::tie(x, here) = *std::exchange(before, std::nullopt);
      damping = std::max(30 * damping, 0.1);
    };
    for (;;)
    {
      const MatrixXd normal = here.jacobian.transpose() * here.jacobian;
      MatrixXd damped = normal;
      damped.diagonal() *= 1 + damping;
      damped.diagonal().array() += leastCurvature * normal.diagonal().maxCoeff(); // of what hardly matters
      VectorXd step = damped.ldlt().solve(-here.jacobian.transpose() * here.rest);
      const bool cut = step.cwiseAbs().maxCoeff() > mostStep;
      step = step.cwiseMax(-mostStep).cwiseMin(mostStep); // what hardly matters may want to go far
      VectorXd next = x + step;
      const bool settled = damping < 1 && !cut &&
        (step.cwiseAbs().maxCoeff() <= options_.tolerance || (here.jacobian * step).cwiseAbs().maxCoeff() <= smallStep);
      if (before && (settled || (next - start_).cwiseAbs().maxCoeff() > farthest)) // nowhere better
      {
        refuse();
        continue;
      }
      requireNear(next, x, here);
      if (settled || damping > mostDamping) // or as far as it goes
      {
        if (!told_ && (x - madeAt).cwiseAbs().maxCoeff() > farDifferences)
          differences(x, here);
        if (settled && !edge_)
          take(step, x, here);
        break;
      }
      std::optional<Point> there = tried(next);
      bool shorter = false; // to where the model goes
      for (int half = 0; half < mostHalvings && !there; ++half, shorter = true)
      {
        step *= 0.5;
        next = x + step;
        there = tried(next);
      }
      if (there && !told_) // Broyden
        there->jacobian =
          here.jacobian + (there->rest - here.rest - here.jacobian * step) * step.transpose() / step.squaredNorm();
      const Point& best = before ? before->second : here;
      if (there && there->rest.squaredNorm() <= best.rest.squaredNorm() * (1 + leastFall))
      {
        const bool little = shorter && (here.jacobian * step).cwiseAbs().maxCoeff() <= smallStep;
        before.reset();
        x = next;
        here = *std::move(there);
        damping = std::max(damping / 10, 1e-9);
        if (little) // the rest is beyond
          break;
        continue;
      }
      // along a valley that bends the next step finds back, by the derivatives there
      if (there && told_ && !before && damping < watched)
      {
        before.emplace(std::exchange(x, next), std::exchange(here, *std::move(there)));
        continue;
      }
      refuse();
      if (there && !told_ && (x - madeAt).cwiseAbs().maxCoeff() > 0)
      {
        differences(x, here);
        madeAt = x;
      }
    }
    requireReached(x, here);
    requireTold(here.jacobian);
    return resultOf(x, here);
  }

private:
  struct Point
  {
    std::vector<double> values;
    VectorXd rest;     ///< value less measurement, over the standard deviation
    MatrixXd jacobian; ///< of that, by logarithms
  };

  void check() const
  {
    if (m_ == 0 || n_ < m_)
      throw ParameterError(fmt::format("{} measurements for {} unknowns", n_, m_),
        m_ == 0 ? "name what is looked for" : "give at least as many measurements as there are unknowns");
    for (const FitParameter& p : parameters_)
      if (!(std::isfinite(p.start) && p.start > 0))
        throw ParameterError(fmt::format("{} is looked for from {}", p.name, p.start), "start from a positive number");
    for (const FitMeasurement& m : measurements_)
      if (!std::isfinite(m.value) || !(std::isfinite(m.halfWidth) && m.halfWidth > 0))
        throw ParameterError(fmt::format("{} was measured as {} ± {}", m.name, m.value, m.halfWidth),
          "give a value and how far it may be off, above 0");
  }

  // All that scale, by what measurements are of the values.
  void scale(VectorXd& x, Point& here)
  {
    double sum = 0;
    int count = 0;
    for (std::size_t j = 0; j < measurements_.size(); ++j)
      if (measurements_[j].value > 0 && here.values[j] > 0)
      {
        sum += std::log(measurements_[j].value / here.values[j]);
        ++count;
      }
    const bool any = std::ranges::any_of(parameters_, [](const FitParameter& p) { return p.scales; });
    if (!any || count == 0)
      return;
    VectorXd scaled = x;
    for (Eigen::Index i = 0; i < m_; ++i)
      if (parameters_[static_cast<std::size_t>(i)].scales)
        scaled(i) += sum / count;
    if (std::optional<Point> there = tried(scaled))
    {
      x = start_ = scaled;
      here = *std::move(there);
    }
  }

  // The last step, as the model made linear has it.
  void take(const VectorXd& step, VectorXd& x, Point& here) const
  {
    x += step;
    const VectorXd change = here.jacobian * step;
    here.rest += change;
    for (Eigen::Index j = 0; j < n_; ++j)
      here.values[static_cast<std::size_t>(j)] += change(j) * sigma_(j);
  }

  // None where the model cannot have these parameters.
  std::optional<Point> tried(const VectorXd& x)
  {
    try
    {
      return evaluate(x);
    }
    catch (const ParameterError&)
    {
      edge_ = true;
      return std::nullopt;
    }
  }

  Point evaluate(const VectorXd& x)
  {
    if (evaluations_ >= options_.mostEvaluations)
      throw DivergenceError(
        fmt::format("no fit after {} evaluations", evaluations_), "start nearer to what is looked for");
    std::vector<double> p;
    for (const double value : x)
      p.push_back(std::exp(value));
    const FitEvaluation found = model_(p);
    ++evaluations_;
    if (options_.progress && !options_.progress(evaluations_))
      throw Cancelled();
    Point point{ found.values, VectorXd(n_), {} };
    for (Eigen::Index j = 0; j < n_; ++j)
    {
      const auto at = static_cast<std::size_t>(j);
      point.rest(j) = (found.values[at] - measurements_[at].value) / sigma_(j);
    }
    if (!point.rest.allFinite())
      throw DivergenceError("the model's values are not finite", "start nearer to what is looked for");
    told_ = !found.derivatives.empty();
    if (told_)
    {
      point.jacobian.resize(n_, m_);
      for (Eigen::Index j = 0; j < n_; ++j)
        for (Eigen::Index i = 0; i < m_; ++i)
          point.jacobian(j, i) =
            found.derivatives[static_cast<std::size_t>(j * m_ + i)] * p[static_cast<std::size_t>(i)] / sigma_(j);
    }
    return point;
  }

  void differences(const VectorXd& x, Point& point)
  {
    point.jacobian.resize(n_, m_);
    for (Eigen::Index i = 0; i < m_; ++i)
    {
      VectorXd beside = x;
      beside(i) += differenceStep;
      std::optional<Point> there = tried(beside);
      const double step = there ? differenceStep : -differenceStep;
      if (!there)
      {
        beside(i) = x(i) + step;
        there = evaluate(beside);
      }
      point.jacobian.col(i) = (there->rest - point.rest) / step;
    }
  }

  // Each direction that no measurement tells of is named by its parameters.
  void requireTold(const MatrixXd& jacobian) const
  {
    const Eigen::JacobiSVD<MatrixXd> svd(jacobian, Eigen::ComputeFullV);
    const Eigen::Index last = m_ - 1;
    const double least = svd.singularValues()(last);
    const double width = least > 0 ? coverage95 / least : std::numeric_limits<double>::infinity();
    if (width <= mostUncertain)
      return;
    const VectorXd direction = svd.matrixV().col(last);
    Eigen::Index most = 0;
    (void)direction.cwiseAbs().maxCoeff(&most);
    const auto nameOf = [&](Eigen::Index i) { return parameters_[static_cast<std::size_t>(i)].name; };
    if (direction(most) * direction(most) >= alone)
    {
      const double effect = jacobian.col(most).cwiseAbs().maxCoeff() / coverage95; // of a change e-fold, in half widths
      throw InputError(
        fmt::format(
          "the measurements do not tell {}: ten times as much of it changes them by {:.2g} of their uncertainty",
          nameOf(most), effect * mostUncertain),
        "give it a value, or measure something that depends on it, or more accurately");
    }
    std::string names;
    for (Eigen::Index i = 0; i < m_; ++i)
      if (std::abs(direction(i)) > 0.2)
        names += (names.empty() ? "" : " and ") + nameOf(i);
    throw InputError("the measurements tell " + names + " only together: one may be more if the other is less",
      "give one of them a value, or measure along another direction, on another sample, or more accurately");
  }

  // As many unknowns as measurements meet them, if anything does.
  void requireReached(const VectorXd& x, const Point& point) const
  {
    Eigen::Index worst = 0;
    if (n_ > m_ || point.rest.cwiseAbs().maxCoeff(&worst) < farOff)
      return;
    const auto j = static_cast<std::size_t>(worst);
    std::string names;
    for (Eigen::Index i = 0; i < m_; ++i)
      names +=
        fmt::format("{}{} {:.3g}", i > 0 ? ", " : "", parameters_[static_cast<std::size_t>(i)].name, std::exp(x(i)));
    throw InputError(
      fmt::format("nothing fits: the nearest, {}, has {} = {:.5g}, and {:.5g} ± {:.2g} was measured", names,
        measurements_[j].name, point.values[j], measurements_[j].value, measurements_[j].halfWidth),
      "the sample cannot have what was measured, whatever it is: look at the units and at the other phases");
  }

  // Far away a parameter is one that nothing tells, or that nothing fits.
  void requireNear(const VectorXd& next, const VectorXd& x, const Point& here) const
  {
    if ((next - start_).cwiseAbs().maxCoeff() <= farthest)
      return;
    requireReached(x, here);
    requireTold(here.jacobian);
    throw DivergenceError("the search for what fits goes ever farther away", "start nearer to what is looked for");
  }

  FitResult resultOf(const VectorXd& x, const Point& point) const
  {
    FitResult r;
    r.values = point.values;
    r.derivatives.resize(static_cast<std::size_t>(n_ * m_));
    for (Eigen::Index j = 0; j < n_; ++j)
      for (Eigen::Index i = 0; i < m_; ++i)
        r.derivatives[static_cast<std::size_t>(j * m_ + i)] = point.jacobian(j, i) * sigma_(j) / std::exp(x(i));
    for (const double value : x)
      r.parameters.push_back({ std::exp(value), 0, 0 });
    r.misfit = point.rest.squaredNorm();
    r.freedom = static_cast<int>(n_ - m_);
    r.chance = r.freedom > 0 ? chiSquareTail(r.misfit, r.freedom) : 1;
    r.evaluations = evaluations_;
    widen(r, measurements_);
    return r;
  }

  const std::vector<FitParameter>& parameters_;
  const std::vector<FitMeasurement>& measurements_;
  const std::function<FitEvaluation(std::span<const double>)>& model_;
  const FitOptions& options_;
  Eigen::Index m_;
  Eigen::Index n_;
  VectorXd sigma_;
  VectorXd start_; ///< logarithms
  int evaluations_ = 0;
  bool told_ = false; ///< derivatives, by the model
  bool edge_ = false; ///< it could not have some parameters: not a step farther than it was asked
};

} // namespace

FitResult fit(const std::vector<FitParameter>& parameters, const std::vector<FitMeasurement>& measurements,
  const std::function<FitEvaluation(std::span<const double>)>& model, const FitOptions& options)
{
  return Fitting(parameters, measurements, model, options).run();
}

void widen(FitResult& result, const std::vector<FitMeasurement>& measurements, const std::vector<FitError>& errors)
{
  const auto m = static_cast<Eigen::Index>(result.parameters.size());
  const auto n = static_cast<Eigen::Index>(measurements.size());
  const VectorXd sigma = sigmasOf(measurements);
  MatrixXd jacobian(n, m);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < m; ++i)
      jacobian(j, i) = result.derivatives[static_cast<std::size_t>(j * m + i)] *
        result.parameters[static_cast<std::size_t>(i)].value / sigma(j);
  MatrixXd covariance = (jacobian.transpose() * jacobian).inverse();
  if (!errors.empty())
  {
    const MatrixXd estimate = covariance * jacobian.transpose();
    std::map<int, VectorXd> causes; // in standard deviations of the measurements
    for (Eigen::Index j = 0; j < n; ++j)
    {
      const FitError& error = errors[static_cast<std::size_t>(j)];
      causes.try_emplace(error.cause, VectorXd::Zero(n)).first->second(j) = error.halfWidth / coverage95 / sigma(j);
    }
    for (const auto& [cause, together] : causes)
    {
      const VectorXd moved = estimate * together;
      covariance += moved * moved.transpose();
    }
  }
  result.covariance.assign(covariance.data(), covariance.data() + m * m);
  for (Eigen::Index i = 0; i < m; ++i)
  {
    FittedParameter& p = result.parameters[static_cast<std::size_t>(i)];
    const double factor = std::exp(coverage95 * std::sqrt(covariance(i, i)));
    p.low = p.value / factor;
    p.high = p.value * factor;
  }
}

} // namespace lamella::statistics
