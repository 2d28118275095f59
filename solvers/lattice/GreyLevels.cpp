#include "lattice/GreyLevels.h"

#include "core/Error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella
{
namespace
{

constexpr std::size_t greyCount = 65536;

/// Share and mean times share of the values up to a grey.
struct Sums
{
  std::vector<double> share;
  std::vector<double> moment;
};

Sums sumsOf(std::span<const double> heights, double first, double width)
{
  Sums sums;
  sums.share.assign(heights.size() + 1, 0);
  sums.moment.assign(heights.size() + 1, 0);
  for (std::size_t i = 0; i < heights.size(); ++i)
  {
    sums.share[i + 1] = sums.share[i] + heights[i];
    sums.moment[i + 1] = sums.moment[i] + heights[i] * (first + width * static_cast<double>(i));
  }
  return sums;
}

/// What bins i … j - 1 add to the variance between classes.
double part(const Sums& sums, std::size_t i, std::size_t j)
{
  const double share = sums.share[j] - sums.share[i];
  const double moment = sums.moment[j] - sums.moment[i];
  return share > 0 ? moment * moment / share : 0;
}

/// The last bin of every class but the brightest.
std::vector<std::size_t> bestCuts(const Sums& sums, int classes)
{
  const std::size_t bins = sums.share.size() - 1;
  std::vector<std::size_t> best;
  double most = -1;
  for (std::size_t i = 1; i < bins; ++i)
  {
    if (classes == 2)
    {
      if (const double between = part(sums, 0, i) + part(sums, i, bins); between > most * (1 + 1e-12))
      {
        most = between;
        best = { i - 1 };
      }
      continue;
    }
    const double dark = part(sums, 0, i);
    for (std::size_t j = i + 1; j < bins; ++j)
    {
      if (const double between = dark + part(sums, i, j) + part(sums, j, bins); between > most * (1 + 1e-12))
      {
        most = between;
        best = { i - 1, j - 1 };
      }
    }
  }
  return best;
}

/// A level within a gap of greys that nothing has goes to the gap's middle.
int toMiddleOfGap(std::span<const std::int64_t> histogram, int last)
{
  int below = last;
  while (below > 0 && histogram[static_cast<std::size_t>(below)] == 0)
    --below;
  int above = last + 1;
  while (above < static_cast<int>(greyCount) - 1 && histogram[static_cast<std::size_t>(above)] == 0)
    ++above;
  return below + (above - below - 1) / 2;
}

/// Depth of the valley at a level, in bins of a sixteenth of the contrast, one of them at the level. A grey counts in
/// the two bins beside it and bins are smoothed, so that greys that come in steps make no peaks.
double valleyAt(std::span<const std::int64_t> histogram, int last, double dark, double bright)
{
  const double width = std::max(1.0, (bright - dark) / 16);
  constexpr int reach = 32;
  std::array<double, 2 * reach + 1> heights{};
  for (int grey = 0; grey < static_cast<int>(greyCount); ++grey)
  {
    const double place = (grey - last - 0.5) / width + reach;
    if (place >= 0 && place < 2 * reach)
    {
      const auto bin = static_cast<std::size_t>(place);
      const double beyond = place - std::floor(place);
      const auto count = static_cast<double>(histogram[static_cast<std::size_t>(grey)]);
      heights[bin] += (1 - beyond) * count;
      heights[bin + 1] += beyond * count;
    }
  }
  std::array<double, 2 * reach + 1> smooth = heights;
  for (std::size_t i = 1; i + 1 < heights.size(); ++i)
    smooth[i] = (heights[i - 1] + 2 * heights[i] + heights[i + 1]) / 4;
  const auto level = smooth.begin() + reach;
  const double lower = std::min(*std::max_element(smooth.begin(), level), *std::max_element(level + 1, smooth.end()));
  const double between = *std::min_element(level - 1, level + 2);
  return lower > 0 ? std::min(1.0, between / lower) : 1.0;
}

} // namespace

std::vector<std::int64_t> greyHistogram(std::span<const std::uint16_t> grey)
{
  std::vector<std::int64_t> histogram(greyCount, 0);
  for (const std::uint16_t value : grey)
    ++histogram[value];
  return histogram;
}

std::string GreyLevels::text() const
{
  std::string at;
  for (const int end : last)
    at += fmt::format("{}{}", at.empty() ? "" : " and ", end + 1);
  std::string means;
  for (const double one : mean)
    means += fmt::format("{}{:.1f}", means.empty() ? "" : ", ", one);
  return fmt::format(
    "greys: parted at {}, means {}, separability {:.3f}, valley {:.2f}", at, means, separability, valley);
}

std::string GreyLevels::doubt() const
{
  if (valley > shallowValley)
  {
    return fmt::format("the grey values have no valley where the phases are parted (the greys there are {:.0f} % as "
                       "common as those of the rarer phase): look at the result",
      100 * valley);
  }
  return separability < leastSeparability
    ? fmt::format("the phases are hard to tell apart (separability {:.2f}): look at the result", separability)
    : "";
}

GreyLevels describeLevels(std::span<const std::int64_t> histogram, std::vector<int> last)
{
  GreyLevels levels;
  levels.last = std::move(last);
  double total = 0;
  double mean = 0;
  double square = 0;
  for (std::size_t grey = 0; grey < greyCount; ++grey)
  {
    const double count = static_cast<double>(histogram[grey]);
    const double value = static_cast<double>(grey);
    total += count;
    mean += count * value;
    square += count * value * value;
  }
  mean /= std::max(1.0, total);
  const double variance = square / std::max(1.0, total) - mean * mean;
  double between = 0;
  std::size_t grey = 0;
  for (std::size_t k = 0; k <= levels.last.size(); ++k)
  {
    const std::size_t end = k < levels.last.size() ? static_cast<std::size_t>(levels.last[k]) + 1 : greyCount;
    double count = 0;
    double moment = 0;
    for (; grey < end; ++grey)
    {
      count += static_cast<double>(histogram[grey]);
      moment += static_cast<double>(histogram[grey]) * static_cast<double>(grey);
    }
    const double own = count > 0 ? moment / count : mean;
    levels.mean.push_back(own);
    between += count / std::max(1.0, total) * (own - mean) * (own - mean);
  }
  levels.separability = variance > 0 ? between / variance : 0;
  for (std::size_t k = 0; k < levels.last.size(); ++k)
    levels.valley = std::max(levels.valley, valleyAt(histogram, levels.last[k], levels.mean[k], levels.mean[k + 1]));
  return levels;
}

GreyLevels otsuLevels(std::span<const std::int64_t> histogram, int classes)
{
  const auto seen = [](std::int64_t count) { return count > 0; };
  const auto different = std::count_if(histogram.begin(), histogram.end(), seen);
  if (different < classes)
  {
    throw InputError(different == 1
        ? "the picture is of one single grey: there is nothing to tell apart"
        : fmt::format("{} grey values cannot be parted into {} classes", different, classes),
      "check that it is the picture you mean");
  }
  const auto low = std::find_if(histogram.begin(), histogram.end(), seen) - histogram.begin();
  const auto high = histogram.size() - 1 -
    static_cast<std::size_t>(std::find_if(histogram.rbegin(), histogram.rend(), seen) - histogram.rbegin());
  const std::size_t span = high - static_cast<std::size_t>(low) + 1;
  const std::size_t width = classes == 2 ? 1 : (span + 1023) / 1024;
  std::vector<double> heights((span + width - 1) / width, 0);
  double total = 0;
  for (std::size_t i = 0; i < span; ++i)
  {
    heights[i / width] += static_cast<double>(histogram[static_cast<std::size_t>(low) + i]);
    total += static_cast<double>(histogram[static_cast<std::size_t>(low) + i]);
  }
  for (double& height : heights)
    height /= total;
  const std::vector<std::size_t> cuts = bestCuts(sumsOf(heights, 0, static_cast<double>(width)), classes);
  std::vector<int> last;
  for (const std::size_t cut : cuts)
    last.push_back(toMiddleOfGap(histogram, static_cast<int>(static_cast<std::size_t>(low) + (cut + 1) * width - 1)));
  return describeLevels(histogram, last);
}

} // namespace lamella
