#include "elasticity/StiffnessError.h"

#include "lattice/PictureError.h"
#include "lattice/SpacingError.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <limits>

#include <optional>

namespace lamella::elasticity
{
namespace
{

double barOf(const PictureError& error, double left)
{
  return left * (error.bar() - error.scatter()) + error.scatter();
}

/// One number of every tensor, in its own unit.
PictureError errorOf(
  double value, std::span<const SubsampleTensors> subsamples, const std::function<double(std::size_t, std::size_t)>& of)
{
  std::vector<SubsampleValues> values;
  for (std::size_t s = 0; s < subsamples.size(); ++s)
  {
    values.push_back({ subsamples[s].stride, {} });
    for (std::size_t t = 0; t < subsamples[s].tensors.size(); ++t)
      values.back().values.push_back(of(s, t));
  }
  return { value, values, 1 };
}

} // namespace

namespace
{

// The limit may lie so far off that it is none.
void keepLimit(StiffnessError& e, int dimension, double zero)
{
  const ElasticConstants constants = elasticConstants(e.extrapolated, dimension, zero);
  if (constants.eigenvalues.front() >= -zero * constants.eigenvalues.back())
    e.constants = constants;
}

// The largest relative one on the diagonal.
double largestOf(const StiffnessError& e, std::span<const double> stiffness, std::size_t n, double zero)
{
  double most = 0;
  for (std::size_t a = 0; a < n; ++a)
    most = std::max(most, stiffness[a * n + a]);
  double largest = 0;
  for (std::size_t i = 0; i < n * n; i += n + 1)
    if (stiffness[i] > zero * most)
      largest = std::max(largest, e.components[i] / stiffness[i]);
  return largest;
}

} // namespace

StiffnessError sharedStiffnessError(std::span<const double> stiffness, std::span<const double> coarse,
  std::span<const double> coarser, int dimension, double zero, double mixed)
{
  const std::size_t n = dimension == 3 ? 6 : 3;
  const double longer = 1 + 12 * std::max(0.0, mixed - 0.25);
  const bool close = longer > 1; // then no number is better known than the worst one on the diagonal
  StiffnessError e;
  for (std::size_t i = 0; i < n * n; ++i)
  {
    const SpacingError error =
      spacingError(stiffness[i], coarse[i], coarser.empty() ? std::nullopt : std::optional(coarser[i]));
    e.extrapolated.push_back(error.extrapolated);
    e.components.push_back(longer * error.bar);
  }
  e.relative = largestOf(e, stiffness, n, zero);
  for (std::size_t i = 0; close && i < n * n; ++i)
    e.components[i] = std::max(e.components[i], e.relative * std::abs(stiffness[i]));
  const auto values = [&](std::span<const double> tensor)
  { return constantValues(elasticConstants(tensor, dimension, zero)); };
  const std::vector<double> own = values(stiffness);
  const std::vector<double> larger = values(coarse);
  const std::vector<double> largest = coarser.empty() ? std::vector<double>{} : values(coarser);
  for (std::size_t c = 0; c < own.size(); ++c)
  {
    const bool known =
      std::isfinite(own[c]) && std::isfinite(larger[c]) && (largest.empty() || std::isfinite(largest[c]));
    e.ofConstants.push_back(known
        ? longer * spacingError(own[c], larger[c], largest.empty() ? std::nullopt : std::optional(largest[c])).bar
        : std::numeric_limits<double>::quiet_NaN());
    if (close)
      e.ofConstants.back() = std::max(e.ofConstants.back(), e.relative * std::abs(own[c]));
  }
  keepLimit(e, dimension, zero);
  return e;
}

StiffnessError stiffnessError(std::span<const double> stiffness, std::span<const SubsampleTensors> subsamples,
  int dimension, const StiffnessErrorRule& rule)
{
  const std::size_t n = dimension == 3 ? 6 : 3;
  StiffnessError e;
  const double lattice = rule.lattice;
  const double zero = rule.zero;
  e.lattice = lattice;
  for (std::size_t i = 0; i < n * n; ++i)
  {
    const PictureError error =
      errorOf(stiffness[i], subsamples, [&](std::size_t s, std::size_t t) { return subsamples[s].tensors[t][i]; });
    e.extrapolated.push_back(stiffness[i] + error.bias());
    e.components.push_back(barOf(error, rule.leftOverChange) + lattice * std::abs(stiffness[i]));
  }
  e.relative = largestOf(e, stiffness, n, zero);

  const std::vector<double> own = constantValues(elasticConstants(stiffness, dimension, zero));
  std::vector<std::vector<std::vector<double>>> others;
  for (const SubsampleTensors& s : subsamples)
  {
    others.emplace_back();
    for (const std::vector<double>& tensor : s.tensors)
      others.back().push_back(constantValues(elasticConstants(tensor, dimension, zero)));
  }
  for (std::size_t c = 0; c < own.size(); ++c)
  {
    bool known = true; // Poisson's ratio of what resists nothing is none
    const auto of = [&](std::size_t s, std::size_t t)
    {
      known = known && std::isfinite(others[s][t][c]);
      return others[s][t][c];
    };
    const double bar = barOf(errorOf(own[c], subsamples, of), rule.leftOverChange);
    e.ofConstants.push_back(known ? bar + lattice * std::abs(own[c]) : std::numeric_limits<double>::quiet_NaN());
  }
  keepLimit(e, dimension, zero);
  return e;
}

} // namespace lamella::elasticity
