#include "outlines/LumenClasses.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

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
    result.mean += value / n;
  result.variance = 0;
  for (const double value : values)
    result.variance += (value - result.mean) * (value - result.mean) / n;
  result.variance = std::max(leastVariance, result.variance);
  return result;
}

/// Otsu's split of sorted values: how many belong to the lower class.
std::size_t split(std::span<const double> sorted)
{
  double all = 0;
  for (const double value : sorted)
    all += value;
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
      density += one.density(value);
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

/// How many belong to the lower class where the gap between neighbours is the widest; at least so many in either.
std::size_t widestGap(std::span<const double> sorted, std::size_t least)
{
  std::size_t best = least;
  for (std::size_t i = least; i + least <= sorted.size(); ++i)
    best = sorted[i] - sorted[i - 1] > sorted[best] - sorted[best - 1] ? i : best;
  return best;
}

/// Two Gaussians, the lower first, and what they say.
struct Pair
{
  std::array<Gaussian, 2> two;
  double logLikelihood = 0;
  double limit = 0; ///< between the two means, where the larger class begins to be the likelier
  double separability = 0;
  double ratio = 1;
  std::size_t larger = 0; ///< how many belong to the larger class
};

Pair fitPair(std::span<const double> sorted, std::size_t low)
{
  Pair pair{ { fit(sorted.first(low), sorted.size()), fit(sorted.subspan(low), sorted.size()) } };
  auto& two = pair.two;
  pair.logLikelihood = logLikelihood(sorted, two);
  for (int round = 0; round < 200; ++round)
  {
    improve(sorted, two);
    const double before = std::exchange(pair.logLikelihood, logLikelihood(sorted, two));
    if (pair.logLikelihood - before < 1e-9 * std::abs(pair.logLikelihood))
      break;
  }
  if (two[0].mean > two[1].mean)
    std::swap(two[0], two[1]);
  const double apart = two[1].mean - two[0].mean;
  pair.separability = std::numbers::sqrt2 * apart / std::sqrt(two[0].variance + two[1].variance);
  pair.ratio = std::exp(apart);
  double below = two[0].mean;
  double above = two[1].mean;
  for (int i = 0; i < 60; ++i)
  {
    const double middle = (below + above) / 2;
    (two[0].density(middle) > two[1].density(middle) ? below : above) = middle;
  }
  pair.limit = (below + above) / 2;
  pair.larger = static_cast<std::size_t>(sorted.end() - std::upper_bound(sorted.begin(), sorted.end(), pair.limit));
  return pair;
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
      throw ParameterError(fmt::format("a lumen of size {}", size), "give sizes above 0");
    logs.push_back(std::log(size));
  }
  std::sort(logs.begin(), logs.end());
  constexpr std::size_t least = 3;
  if (logs.size() < 2 * least)
    return result;
  const Gaussian one = fit(logs, logs.size());
  const double ofOne = logLikelihood(logs, std::span(&one, 1));
  const auto clean = [&](const Pair& pair)
  {
    constexpr double clearlyBetter = 10;
    const double better = 2 * (pair.logLikelihood - ofOne) - 3 * std::log(static_cast<double>(logs.size()));
    return better > clearlyBetter && pair.separability > 2 && pair.ratio >= 4 && pair.larger >= least &&
      2 * pair.larger < logs.size();
  };
  // The likelihood has more than one summit: with few vessels the two may both settle on the fibres.
  Pair best = fitPair(logs, split(logs));
  const Pair other = fitPair(logs, widestGap(logs, least));
  if (clean(other) && (!clean(best) || other.logLikelihood > best.logLikelihood))
    best = other;
  result.separability = best.separability;
  result.ratio = best.ratio;
  result.two = clean(best);
  if (!result.two)
    return result;
  result.threshold = std::exp(best.limit);
  result.vessels = best.larger;
  std::transform(
    sizes.begin(), sizes.end(), result.vessel.begin(), [&](double size) { return std::log(size) > best.limit; });
  return result;
}

LumenClasses tellVessels(std::span<const LumenExtent> lumens)
{
  constexpr double mostSlender = 3;
  const auto isSlender = [](const LumenExtent& one) { return one.length > mostSlender * one.width; };
  // Where it is the usual shape, in latewood, it sets nothing apart.
  const bool usual =
    2 * std::count_if(lumens.begin(), lumens.end(), isSlender) > static_cast<std::ptrdiff_t>(lumens.size());
  const auto slender = [&](const LumenExtent& one) { return !usual && isSlender(one); };
  const auto circle = [](const LumenExtent& one) { return one.length * one.length * std::numbers::pi / 4; };
  const auto area = [](const LumenExtent& one) { return one.length * one.width * std::numbers::pi / 4; };
  constexpr double ragged = 0.75;
  double largest = 0;
  for (const LumenExtent& one : lumens)
    largest = one.whole && one.solidity >= ragged ? std::max(largest, area(one)) : largest;
  const auto cell = [&](const LumenExtent& one)
  { return one.solidity >= ragged && (one.whole || largest == 0 || area(one) <= 3 * largest); };
  std::vector<double> sizes;
  for (const LumenExtent& one : lumens)
    if (one.whole && cell(one) && !slender(one))
      sizes.push_back(circle(one));
  LumenClasses classes = classifyLumens(sizes);
  classes.vessel.assign(lumens.size(), false);
  classes.vessels = 0;
  for (std::size_t i = 0; i < lumens.size() && classes.two; ++i)
  {
    const LumenExtent& one = lumens[i];
    // The cut may leave a slender part of a broad lumen: larger than a fibre all the same, as no cell of a ray is.
    const bool broad = !slender(one) || (!one.whole && area(one) > classes.threshold);
    classes.vessel[i] = broad && cell(one) && circle(one) > classes.threshold;
    classes.vessels += classes.vessel[i];
  }
  return classes;
}

} // namespace lamella::micrograph
