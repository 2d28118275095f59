#include "micrograph/LumenClasses.h"

#include "lattice/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lamella::micrograph
{
namespace
{

struct Gaussian
{
  double share = 1;
  double mean = 0;
  double variance = 1;

  [[nodiscard]] double density(double x) const
  {
    return share * std::exp(-(x - mean) * (x - mean) / (2 * variance)) / std::sqrt(2 * std::numbers::pi * variance);
  }
};

/// No class is sharper than 5 % in size.
constexpr double leastVariance = 0.05 * 0.05;

Gaussian fit(std::span<const double> values, std::size_t all)
{
  Gaussian result;
  const auto n = static_cast<double>(values.size());
  result.share = n / static_cast<double>(all);
  result.mean = 0;
  for (const double value : values)
  {
    result.mean += value / n;
  }
  result.variance = 0;
  for (const double value : values)
  {
    result.variance += (value - result.mean) * (value - result.mean) / n;
  }
  result.variance = std::max(leastVariance, result.variance);
  return result;
}

/// Otsu's split of sorted values: how many belong to the lower class.
std::size_t split(std::span<const double> sorted)
{
  double all = 0;
  for (const double value : sorted)
  {
    all += value;
  }
  std::size_t best = sorted.size() / 2;
  double most = -1;
  double sum = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i)
  {
    sum += sorted[i - 1];
    const auto low = static_cast<double>(i);
    const auto high = static_cast<double>(sorted.size() - i);
    const double apart = sum / low - (all - sum) / high;
    if (low * high * apart * apart > most)
    {
      most = low * high * apart * apart;
      best = i;
    }
  }
  return best;
}

double logLikelihood(std::span<const double> values, std::span<const Gaussian> classes)
{
  double sum = 0;
  for (const double value : values)
  {
    double density = 1e-300;
    for (const Gaussian& one : classes)
    {
      density += one.density(value);
    }
    sum += std::log(density);
  }
  return sum;
}

void improve(std::span<const double> values, std::array<Gaussian, 2>& classes)
{
  std::array<double, 2> n{};
  std::array<double, 2> sum{};
  std::array<double, 2> square{};
  for (const double value : values)
  {
    const std::array density{ classes[0].density(value) + 1e-300, classes[1].density(value) + 1e-300 };
    for (std::size_t i = 0; i < 2; ++i)
    {
      const double part = density[i] / (density[0] + density[1]);
      n[i] += part;
      sum[i] += part * value;
      square[i] += part * value * value;
    }
  }
  for (std::size_t i = 0; i < 2; ++i)
  {
    if (n[i] > 1e-9)
    {
      const double mean = sum[i] / n[i];
      classes[i] = { n[i] / static_cast<double>(values.size()), mean,
        std::max(leastVariance, square[i] / n[i] - mean * mean) };
    }
  }
}

} // namespace

LumenClasses classifyLumens(std::span<const double> sizes)
{
  LumenClasses result;
  result.vessel.assign(sizes.size(), false);
  std::vector<double> logs;
  logs.reserve(sizes.size());
  for (const double size : sizes)
  {
    if (!(size > 0) || !std::isfinite(size))
    {
      throw ParameterError(fmt::format("a lumen of size {}", size), "give sizes above 0");
    }
    logs.push_back(std::log(size));
  }
  std::sort(logs.begin(), logs.end());
  constexpr std::size_t least = 3;
  if (logs.size() < 2 * least)
  {
    return result;
  }
  const Gaussian one = fit(logs, logs.size());
  const auto low = split(logs);
  const std::span<const double> values(logs);
  std::array<Gaussian, 2> two{ fit(values.first(low), logs.size()), fit(values.subspan(low), logs.size()) };
  double before = logLikelihood(logs, two);
  for (int round = 0; round < 200; ++round)
  {
    improve(logs, two);
    const double now = logLikelihood(logs, two);
    if (now - before < 1e-9 * std::abs(now))
    {
      break;
    }
    before = now;
  }
  if (two[0].mean > two[1].mean)
  {
    std::swap(two[0], two[1]);
  }
  const double better = 2 * (logLikelihood(logs, two) - logLikelihood(logs, std::span(&one, 1))) -
    3 * std::log(static_cast<double>(logs.size()));
  const double apart = two[1].mean - two[0].mean;
  result.separability = std::numbers::sqrt2 * apart / std::sqrt(two[0].variance + two[1].variance);
  result.ratio = std::exp(apart);
  // Between the two means, where the larger class begins to be the likelier.
  double below = two[0].mean;
  double above = two[1].mean;
  for (int i = 0; i < 60; ++i)
  {
    const double middle = (below + above) / 2;
    (two[0].density(middle) > two[1].density(middle) ? below : above) = middle;
  }
  const double limit = (below + above) / 2;
  const auto vessels = static_cast<std::size_t>(logs.end() - std::upper_bound(logs.begin(), logs.end(), limit));
  constexpr double clearlyBetter = 10;
  result.two = better > clearlyBetter && result.separability > 2 && result.ratio >= 4 && vessels >= least &&
    2 * vessels < logs.size();
  if (!result.two)
  {
    return result;
  }
  result.threshold = std::exp(limit);
  result.vessels = vessels;
  std::transform(
    sizes.begin(), sizes.end(), result.vessel.begin(), [&](double size) { return std::log(size) > limit; });
  return result;
}

} // namespace lamella::micrograph
