#include "segmentation/GreyClasses.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace lamella::micrograph
{
namespace
{

constexpr std::size_t greys = 256;
using Histogram = std::array<double, greys>;

/// Every so many bands of rows, so that about a million pixels are left: enough to tell classes by. Where bands meet
/// there are no flat places, or few.
cv::Mat bands(const cv::Mat& grey)
{
  constexpr double plenty = 1e6;
  constexpr int height = 64;
  const int step = std::max(1, static_cast<int>(std::lround(static_cast<double>(grey.total()) / plenty)));
  if (step == 1 || grey.rows < 4 * step * height)
    return grey;
  std::vector<cv::Mat> kept;
  for (int row = 0; row + height <= grey.rows; row += step * height)
    kept.push_back(grey.rowRange(row, row + height));
  cv::Mat result;
  cv::vconcat(kept, result);
  return result;
}

/// Greys of flat places, as shares; all 0 where there are hardly any.
Histogram flatGreys(const cv::Mat& grey, double contrast, double noise)
{
  constexpr double noiseLeft = 0.02;
  constexpr double flatness = 1.0 / 16;
  cv::Mat smooth;
  const double sigma = std::clamp(noise / (noiseLeft * 2 * std::sqrt(std::numbers::pi)), 1.0, 3.0);
  cv::GaussianBlur(grey, smooth, cv::Size(), sigma, sigma, cv::BORDER_REFLECT);
  cv::Mat low;
  cv::Mat high;
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, cv::Size(3, 3));
  cv::erode(smooth, low, cross);
  cv::dilate(smooth, high, cross);
  Histogram counts{};
  double all = 0;
  for (int row = 0; row < grey.rows; ++row)
  {
    const auto* value = smooth.ptr<float>(row);
    const auto* lowest = low.ptr<float>(row);
    const auto* highest = high.ptr<float>(row);
    for (int x = 0; x < grey.cols; ++x)
    {
      if (highest[x] - lowest[x] < flatness * contrast)
      {
        counts[static_cast<std::size_t>(std::clamp(value[x], 0.0F, 255.0F))] += 1;
        all += 1;
      }
    }
  }
  constexpr double enough = 100; // pixels
  for (double& count : counts)
    count = all < enough ? 0 : count / all;
  return counts;
}

Histogram smoothed(const Histogram& shares, double width)
{
  Histogram result{};
  for (std::size_t i = 0; i < greys; ++i)
  {
    for (std::size_t j = 0; j < greys; ++j)
    {
      const double apart = (static_cast<double>(i) - static_cast<double>(j)) / width;
      result[i] += shares[j] * std::exp(-apart * apart / 2);
    }
  }
  return result;
}

/// Summits with a valley between them that is deep enough.
std::vector<std::size_t> summits(const Histogram& curve)
{
  constexpr double shallow = 0.75;
  std::vector<std::size_t> found;
  double valley = 0;
  for (std::size_t i = 0; i < greys; ++i)
  {
    valley = std::min(valley, curve[i]);
    if ((i > 0 && curve[i] <= curve[i - 1]) || (i + 1 < greys && curve[i] < curve[i + 1]))
      continue;
    if (!found.empty() && valley > shallow * std::min(curve[found.back()], curve[i]))
      found.back() = curve[i] > curve[found.back()] ? i : found.back();
    else
      found.push_back(i);
    valley = curve[found.back()];
  }
  return found;
}

} // namespace

std::vector<GreyClass> greyClasses(const cv::Mat& grey, double contrast, double noise, double least)
{
  const Histogram shares = flatGreys(bands(grey), contrast, noise);
  const Histogram curve = smoothed(shares, std::max(2.5, contrast / 20));
  const auto valleyBetween = [&](std::size_t low, std::size_t high)
  { return static_cast<std::size_t>(std::min_element(&curve[low], &curve[high]) - curve.data()); };
  const auto shareOf = [&](std::size_t from, std::size_t to)
  {
    double share = 0;
    for (std::size_t i = from; i < to; ++i)
    {
      share += shares[i];
    }
    return share;
  };
  const std::vector<std::size_t> at = summits(curve);
  std::vector<GreyClass> classes;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < at.size(); ++i)
  {
    const std::size_t from = i == 0 ? 0 : valleyBetween(at[i - 1], at[i]);
    const std::size_t to = i + 1 == at.size() ? greys : valleyBetween(at[i], at[i + 1]);
    const double share = shareOf(from, to);
    if (share >= least)
    {
      classes.push_back({ static_cast<double>(at[i]), share, 0 });
      kept.push_back(at[i]);
    }
  }
  for (std::size_t i = 1; i < classes.size(); ++i)
    classes[i].from = static_cast<double>(valleyBetween(kept[i - 1], kept[i]));
  return classes;
}

} // namespace lamella::micrograph
