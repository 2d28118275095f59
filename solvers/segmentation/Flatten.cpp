#include "segmentation/Flatten.h"

#include "segmentation/Pieces.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lamella::micrograph
{

namespace
{

constexpr float wallLevel = 64;
constexpr float lumenLevel = 192;

/// Mean over a Gaussian window of the pixels that a mask (0 or 1, CV_32F) leaves, computed on a coarser picture. Where
/// there are few such pixels near it goes over to their mean over the whole picture.
cv::Mat localMean(const cv::Mat& grey, const cv::Mat& mask, double scale)
{
  const double shrink = std::max(1.0, scale / 8);
  const cv::Size coarse(std::max(1, static_cast<int>(std::lround(grey.cols / shrink))),
    std::max(1, static_cast<int>(std::lround(grey.rows / shrink))));
  cv::Mat sum;
  cv::Mat weight;
  cv::resize(grey.mul(mask), sum, coarse, 0, 0, cv::INTER_AREA);
  cv::resize(mask, weight, coarse, 0, 0, cv::INTER_AREA);
  const double overall = cv::sum(sum)[0] / std::max(1e-9, cv::sum(weight)[0]);
  cv::GaussianBlur(sum, sum, cv::Size(), scale / shrink, scale / shrink, cv::BORDER_REFLECT);
  cv::GaussianBlur(weight, weight, cv::Size(), scale / shrink, scale / shrink, cv::BORDER_REFLECT);
  constexpr double faith = 0.02; // share of the window from which on the local mean counts
  cv::Mat mean = (sum + faith * overall) / (weight + faith);
  cv::resize(mean, mean, grey.size(), 0, 0, cv::INTER_LINEAR);
  return mean;
}

cv::Mat above(const cv::Mat& grey, const cv::Mat& limit)
{
  cv::Mat mask;
  cv::Mat(grey > limit).convertTo(mask, CV_32F, 1.0 / 255);
  return mask;
}

/// The smooth surface (a polynomial of fourth degree in x and y, least squares) through the pixels that a mask leaves:
/// it follows a slope of the light up to the picture's edge, where a local mean cannot.
cv::Mat smoothSurface(const cv::Mat& grey, const cv::Mat& mask)
{
  constexpr int degree = 4;
  constexpr int terms = (degree + 1) * (degree + 2) / 2;
  constexpr int coarse = 96; // samples along a side
  const auto fill = [](double x, double y, std::array<double, terms>& row)
  {
    int term = 0;
    double ofX = 1;
    for (int i = 0; i <= degree; ++i, ofX *= x)
    {
      double ofY = 1;
      for (int j = 0; i + j <= degree; ++j, ofY *= y)
        row[static_cast<std::size_t>(term++)] = ofX * ofY;
    }
  };
  const cv::Size size(std::min(coarse, grey.cols), std::min(coarse, grey.rows));
  cv::Mat sum;
  cv::Mat weight;
  cv::resize(grey.mul(mask), sum, size, 0, 0, cv::INTER_AREA);
  cv::resize(mask, weight, size, 0, 0, cv::INTER_AREA);

  // A trace of ridge keeps the system regular for pictures a few pixels wide.
  cv::Mat normal = cv::Mat::eye(terms, terms, CV_64F) * 1e-6;
  cv::Mat right = cv::Mat::zeros(terms, 1, CV_64F);
  std::array<double, terms> row{};
  const auto at = [](int i, int n) { return 2 * (i + 0.5) / n - 1; };
  for (int y = 0; y < size.height; ++y)
  {
    for (int x = 0; x < size.width; ++x)
    {
      const double w = weight.at<float>(y, x);
      fill(at(x, size.width), at(y, size.height), row);
      for (int i = 0; i < terms && w > 0; ++i)
      {
        right.at<double>(i) += row[static_cast<std::size_t>(i)] * sum.at<float>(y, x);
        for (int j = 0; j < terms; ++j)
          normal.at<double>(i, j) += w * row[static_cast<std::size_t>(i)] * row[static_cast<std::size_t>(j)];
      }
    }
  }
  cv::Mat coefficients;
  cv::solve(normal, right, coefficients, cv::DECOMP_SVD);
  cv::Mat surface(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
  {
    for (int x = 0; x < size.width; ++x)
    {
      fill(at(x, size.width), at(y, size.height), row);
      double value = 0;
      for (int i = 0; i < terms; ++i)
        value += coefficients.at<double>(i) * row[static_cast<std::size_t>(i)];
      surface.at<float>(y, x) = static_cast<float>(value);
    }
  }
  cv::resize(surface, surface, grey.size(), 0, 0, cv::INTER_LINEAR);
  return surface;
}

/// The light, as the bright class shows it.
struct Light
{
  cv::Mat surface;
  double unevenness = 0; ///< how much it varies, over the contrast
};

Light lightOf(const cv::Mat& grey, cv::Mat mask)
{
  Light light;
  double contrast = 1;
  for (int round = 0; round < 4; ++round)
  {
    light.surface = smoothSurface(grey, mask);
    const cv::Mat dark = smoothSurface(grey, 1 - mask);
    contrast = std::max(1.0, cv::mean(light.surface - dark)[0]);
    mask = above(grey, (light.surface + dark) / 2);
  }
  double low = 0;
  double high = 0;
  cv::minMaxLoc(light.surface, &low, &high);
  light.unevenness = (high - low) / contrast;
  return light;
}

} // namespace

double noiseOf(const cv::Mat& grey)
{
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat response;
  cv::filter2D(grey, response, CV_32F, kernel);
  // The median rather than the mean, so that walls and their corners do not count as noise.
  response = thinned(response, 5e5);
  std::vector<float> magnitudes(response.begin<float>(), response.end<float>());
  for (float& value : magnitudes)
    value = std::abs(value);
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return *middle / (0.6745 * 6);
}

cv::Mat thinned(const cv::Mat& grey, double most)
{
  const int step = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(grey.total()) / most))));
  const int shortest = std::min(grey.rows, grey.cols);
  if (step == 1 || shortest < 2 * step)
    return grey;
  cv::Mat result(grey.rows / step, grey.cols / step, CV_32F);
  for (int row = 0; row < result.rows; ++row)
  {
    const auto* from = grey.ptr<float>(row * step);
    auto* to = result.ptr<float>(row);
    for (int x = 0; x < result.cols; ++x)
      to[x] = from[static_cast<std::ptrdiff_t>(x) * step];
  }
  return result;
}

Flattened flatten(const cv::Mat& grey, const std::optional<double>& scaleAsked)
{
  Flattened result;
  // The maps are smooth: half a million pixels, taken out one by one so that no edge is blurred, tell them.
  cv::Mat few = thinned(grey, 5e5);
  const double step = static_cast<double>(grey.cols) / few.cols;
  const double longest = std::max(few.cols, few.rows);
  const double least = std::max(2.0, 8 / step);
  // Over a tenth of the picture the light is even enough to tell cells from walls and to measure the cells.
  const auto aboveLocalMean = [&](double scale)
  { return above(few, localMean(few, cv::Mat(few.size(), CV_32F, cv::Scalar(1)), scale)); };
  cv::Mat mask = aboveLocalMean(std::max(least, longest / 10));
  const double cell = meanRun(mask) + meanRun(1 - mask);
  const double scale = scaleAsked ? *scaleAsked / step : std::clamp(5 * cell, least, std::max(least, longest));
  result.scale = scaleAsked.value_or(scale * step);
  if (result.scale <= 0)
  {
    grey.copyTo(result.grey);
    return result;
  }
  // First the light, smooth over the whole picture, from a local mean that it does not mislead; then what stain and
  // thickness do over some cells.
  const Light light = lightOf(few, aboveLocalMean(std::clamp(cell, least, std::max(least, longest))));
  result.unevenness = light.unevenness;
  const double mean = cv::mean(light.surface)[0];
  // Where hardly any light fell nothing can be brought back.
  const cv::Mat gain = mean / cv::max(light.surface, 0.05 * mean);
  // A new buffer: the old one may be the caller's.
  few = cv::Mat(few.mul(gain));
  mask = aboveLocalMean(scale);
  cv::Mat bright;
  cv::Mat dark;
  for (int round = 0; round < 3; ++round)
  {
    bright = localMean(few, mask, scale);
    dark = localMean(few, 1 - mask, scale);
    mask = above(few, (bright + dark) / 2);
  }
  const double contrast = std::max(1.0, cv::mean(bright - dark)[0]);
  // A place with hardly any contrast of its own keeps that of the whole.
  cv::Mat slope = (lumenLevel - wallLevel) / cv::max(bright - dark, 0.3 * contrast);
  cv::Mat offset = wallLevel - dark.mul(slope);
  slope = slope.mul(gain);
  cv::resize(slope, slope, grey.size(), 0, 0, cv::INTER_LINEAR);
  cv::resize(offset, offset, grey.size(), 0, 0, cv::INTER_LINEAR);
  result.grey.create(grey.size(), CV_32F);
  for (int row = 0; row < grey.rows; ++row)
  {
    const auto* from = grey.ptr<float>(row);
    const auto* times = slope.ptr<float>(row);
    const auto* plus = offset.ptr<float>(row);
    auto* to = result.grey.ptr<float>(row);
    for (int x = 0; x < grey.cols; ++x)
      to[x] = std::clamp(from[x] * times[x] + plus[x], 0.0F, 255.0F);
  }
  return result;
}

} // namespace lamella::micrograph
