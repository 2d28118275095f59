#include "micrograph/Segmentation.h"

#include "lattice/Error.h"

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lamella::micrograph
{
namespace
{

constexpr float wallLevel = 64;
constexpr float lumenLevel = 192;

struct Otsu
{
  double threshold = 0;
  double separability = 0; ///< between-class over total variance
};

/// Otsu's threshold of a CV_32F picture, over its values in 0 … 256.
Otsu otsu(const cv::Mat& grey)
{
  std::array<double, 256> histogram{};
  for (int row = 0; row < grey.rows; ++row)
  {
    const auto* value = grey.ptr<float>(row);
    for (int x = 0; x < grey.cols; ++x)
    {
      histogram[static_cast<std::size_t>(std::clamp(value[x], 0.0F, 255.0F))] += 1;
    }
  }
  const double nodes = static_cast<double>(grey.total());
  double mean = 0;
  double variance = 0;
  for (std::size_t i = 0; i < 256; ++i)
  {
    mean += static_cast<double>(i) * histogram[i] / nodes;
  }
  for (std::size_t i = 0; i < 256; ++i)
  {
    variance += (static_cast<double>(i) - mean) * (static_cast<double>(i) - mean) * histogram[i] / nodes;
  }
  Otsu best;
  double below = 0;
  double sum = 0;
  for (std::size_t i = 0; i < 255; ++i)
  {
    below += histogram[i] / nodes;
    sum += static_cast<double>(i) * histogram[i] / nodes;
    if (below > 0 && below < 1)
    {
      const double apart = mean * below - sum;
      const double between = apart * apart / (below * (1 - below));
      if (variance > 0 && between / variance > best.separability)
      {
        best = { static_cast<double>(i) + 1, between / variance };
      }
    }
  }
  return best;
}

/// One channel of a picture as CV_32F in 0 … 255; row 0 is the first in memory.
cv::Mat channel(const Picture& picture, int which)
{
  const auto width = static_cast<int>(picture.lattice.size[0]);
  const auto height = static_cast<int>(picture.lattice.size[1]);
  const bool colour = which < 3;
  const std::uint16_t* from = colour ? picture.colour.data() + which : picture.grey.data();
  const std::size_t step = colour ? 3 : 1;
  // 16-bit cameras seldom use all 16 bits: scale by the brightest value.
  float top = 255;
  if (picture.bits == 16)
  {
    top = std::max<float>(1, *std::max_element(picture.grey.begin(), picture.grey.end()));
  }
  cv::Mat result(height, width, CV_32F);
  for (int row = 0; row < height; ++row)
  {
    auto* to = result.ptr<float>(row);
    for (int x = 0; x < width; ++x, from += step)
    {
      to[x] = std::min(255.0F, static_cast<float>(*from) * (255.0F / top));
    }
  }
  return result;
}

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

/// Standard deviation of the noise (Immerkær 1996: a mask blind to planes and edges of second order).
double noiseOf(const cv::Mat& grey)
{
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat response;
  cv::filter2D(grey, response, CV_32F, kernel);
  // The median rather than the mean, so that walls and their corners do not count as noise.
  std::vector<float> magnitudes(response.begin<float>(), response.end<float>());
  for (float& value : magnitudes)
  {
    value = std::abs(value);
  }
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return *middle / (0.6745 * 6);
}

/// Mean length of the runs of a mask along rows and columns.
double meanRun(const cv::Mat& mask)
{
  std::int64_t runs = 0;
  for (int row = 0; row < mask.rows; ++row)
  {
    const auto* value = mask.ptr<float>(row);
    const float* before = row > 0 ? mask.ptr<float>(row - 1) : nullptr;
    for (int x = 0; x < mask.cols; ++x)
    {
      runs += value[x] > 0 && (x == 0 || !(value[x - 1] > 0));
      runs += value[x] > 0 && (before == nullptr || !(before[x] > 0));
    }
  }
  return runs > 0 ? 2 * cv::sum(mask)[0] / static_cast<double>(runs) : 0;
}

struct Flattened
{
  cv::Mat grey;
  double scale = 0;
  double unevenness = 0;
};

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
      {
        row[static_cast<std::size_t>(term++)] = ofX * ofY;
      }
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
        {
          normal.at<double>(i, j) += w * row[static_cast<std::size_t>(i)] * row[static_cast<std::size_t>(j)];
        }
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
      {
        value += coefficients.at<double>(i) * row[static_cast<std::size_t>(i)];
      }
      surface.at<float>(y, x) = static_cast<float>(value);
    }
  }
  cv::resize(surface, surface, grey.size(), 0, 0, cv::INTER_LINEAR);
  return surface;
}

/// Divides out the light, as the bright class shows it.
/// @return how much it varied, over the contrast
double evenLight(cv::Mat& grey, cv::Mat mask)
{
  cv::Mat light;
  double contrast = 1;
  for (int round = 0; round < 4; ++round)
  {
    light = smoothSurface(grey, mask);
    const cv::Mat dark = smoothSurface(grey, 1 - mask);
    contrast = std::max(1.0, cv::mean(light - dark)[0]);
    mask = above(grey, (light + dark) / 2);
  }
  double low = 0;
  double high = 0;
  cv::minMaxLoc(light, &low, &high);
  const double mean = cv::mean(light)[0];
  // Where hardly any light fell nothing can be brought back.
  grey = grey.mul(mean / cv::max(light, 0.05 * mean));
  return (high - low) / contrast;
}

/// Brings the local grey of the dark class to 64 and that of the bright one to 192.
Flattened flatten(cv::Mat grey, const std::optional<double>& scaleAsked)
{
  Flattened result;
  const double longest = std::max(grey.cols, grey.rows);
  // Over a tenth of the picture the light is even enough to tell cells from walls and to measure the cells.
  const auto aboveLocalMean = [&](double scale)
  { return above(grey, localMean(grey, cv::Mat(grey.size(), CV_32F, cv::Scalar(1)), scale)); };
  cv::Mat mask = aboveLocalMean(std::max(8.0, longest / 10));
  const double cell = meanRun(mask) + meanRun(1 - mask);
  result.scale = scaleAsked.value_or(std::clamp(5 * cell, 8.0, std::max(8.0, longest)));
  if (result.scale <= 0)
  {
    grey.copyTo(result.grey);
    return result;
  }
  // First the light, smooth over the whole picture, from a local mean that it does not mislead; then what stain and
  // thickness do over some cells.
  result.unevenness = evenLight(grey, aboveLocalMean(std::clamp(cell, 8.0, std::max(8.0, longest))));
  mask = aboveLocalMean(result.scale);
  cv::Mat bright;
  cv::Mat dark;
  for (int round = 0; round < 3; ++round)
  {
    bright = localMean(grey, mask, result.scale);
    dark = localMean(grey, 1 - mask, result.scale);
    mask = above(grey, (bright + dark) / 2);
  }
  const double contrast = std::max(1.0, cv::mean(bright - dark)[0]);
  // A place with hardly any contrast of its own keeps that of the whole.
  const cv::Mat span = cv::max(bright - dark, 0.3 * contrast);
  result.grey = (grey - dark).mul(1 / span) * (lumenLevel - wallLevel) + wallLevel;
  result.grey = cv::min(cv::max(result.grey, 0.0), 255.0);
  return result;
}

struct Pieces
{
  cv::Mat labels; ///< CV_32S
  std::vector<std::int64_t> area;
  std::vector<bool> enclosed; ///< does not touch the border
};

/// Pieces of a CV_8U mask, connected through faces, or through corners too; number 0 is what the mask leaves out.
Pieces piecesOf(const cv::Mat& mask, bool corners)
{
  Pieces result;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(mask, result.labels, stats, centres, corners ? 8 : 4, CV_32S);
  for (int i = 0; i < count; ++i)
  {
    const int left = stats.at<int>(i, cv::CC_STAT_LEFT);
    const int top = stats.at<int>(i, cv::CC_STAT_TOP);
    result.area.push_back(stats.at<int>(i, cv::CC_STAT_AREA));
    result.enclosed.push_back(left > 0 && top > 0 && left + stats.at<int>(i, cv::CC_STAT_WIDTH) < mask.cols &&
      top + stats.at<int>(i, cv::CC_STAT_HEIGHT) < mask.rows);
  }
  return result;
}

std::int64_t enclosedPieces(const cv::Mat& mask)
{
  const Pieces pieces = piecesOf(mask, false);
  std::int64_t count = 0;
  for (std::size_t i = 1; i < pieces.area.size(); ++i)
  {
    count += pieces.enclosed[i] && pieces.area[i] >= 30;
  }
  return count;
}

/// Clears pieces of a mask smaller than a limit.
/// @return how many there were
std::int64_t clearSmall(cv::Mat& mask, std::int64_t smallest, bool corners, bool enclosedOnly, std::int64_t& changed)
{
  const Pieces pieces = piecesOf(mask, corners);
  std::int64_t count = 0;
  std::vector<bool> clear(pieces.area.size(), false);
  for (std::size_t i = 1; i < pieces.area.size(); ++i)
  {
    clear[i] = pieces.area[i] < smallest && (pieces.enclosed[i] || !enclosedOnly);
    count += clear[i];
    changed += clear[i] ? pieces.area[i] : 0;
  }
  for (int row = 0; row < mask.rows && count > 0; ++row)
  {
    auto* value = mask.ptr<std::uint8_t>(row);
    const auto* label = pieces.labels.ptr<int>(row);
    for (int x = 0; x < mask.cols; ++x)
    {
      value[x] = clear[static_cast<std::size_t>(label[x])] ? 0 : value[x];
    }
  }
  return count;
}

/// A twentieth of the usual lumen, told by how far one can go in it (its area would mislead where lumens run together),
/// and never less than 3 × 3 pixels.
std::int64_t smallestPiece(const cv::Mat& lumen)
{
  cv::Mat mask;
  lumen.convertTo(mask, CV_32F, 1.0 / 255);
  const double run = meanRun(mask);
  return std::max<std::int64_t>(9, std::llround(run * run / 20));
}

void growBy(cv::Mat& lumen, double pixels)
{
  const bool outwards = pixels > 0;
  cv::Mat distance;
  cv::distanceTransform(outwards ? cv::Mat(255 - lumen) : lumen, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  if (outwards)
  {
    lumen = distance <= pixels;
  }
  else
  {
    lumen = distance > -pixels;
  }
}

void check(const Picture& picture, const SegmentOptions& options)
{
  if (picture.lattice.dimension != 2)
  {
    throw ParameterError("segmentation of a volume", "segment pictures; give volumes as labels");
  }
  const auto refuse = [](const char* what, double value, const char* hint)
  { throw ParameterError(fmt::format("a {} of {} for the segmentation", what, value), hint); };
  for (const auto& [what, value] :
    { std::pair{ "background scale", options.background }, std::pair{ "smoothing", options.smoothing } })
  {
    if (value && (!(*value >= 0) || !(*value <= 1e5)))
    {
      refuse(what, *value, "give it in pixels, 0 for none");
    }
  }
  if (options.threshold && (!(*options.threshold > 0) || !(*options.threshold < 255)))
  {
    refuse("threshold", *options.threshold, "it lies between 0 and 255, on the flattened grey");
  }
  if (!(std::abs(options.grow) <= 1000))
  {
    refuse("growth", options.grow, "give it in pixels, 0 for none");
  }
  for (const auto& value : { options.smallestLumen, options.smallestWall })
  {
    if (value && *value < 0)
    {
      refuse("smallest size", static_cast<double>(*value), "give it in pixels, 0 to keep all");
    }
  }
}

} // namespace

std::vector<std::string> SegmentReport::lines() const
{
  std::vector<std::string> text;
  text.push_back(fmt::format("channel: {}, lumens are {}", channel, brightLumen ? "bright" : "dark"));
  text.push_back(background > 0
      ? fmt::format(
          "light: flattened over {:.0f} pixels; it varied by {:.0f} % of the contrast", background, 100 * unevenness)
      : "light: taken as even");
  text.push_back(fmt::format("noise: {:.1f} % of the contrast, smoothed over {:.1f} pixels", 100 * noise, smoothing));
  text.push_back(fmt::format("threshold: {:.0f} of 255, separability {:.3f}", threshold, separability));
  text.push_back(fmt::format("cleaning: {} specks of lumen below {} pixels, {} of wall below {}, {} pixels in all",
    lumensRemoved, smallestLumen, wallsRemoved, smallestWall, nodesChanged));
  text.push_back(fmt::format("result: {} lumens, {:.2f} % of the picture", lumens, 100 * lumenFraction));
  return text;
}

Segmentation segment(const Picture& picture, const SegmentOptions& options)
{
  check(picture, options);
  Segmentation result;
  SegmentReport& report = result.report;

  static constexpr std::array channels{ "red", "green", "blue", "grey" };
  cv::Mat grey;
  Otsu first;
  for (int which = picture.colour.empty() ? 3 : 0; which < (picture.colour.empty() ? 4 : 3); ++which)
  {
    cv::Mat candidate = channel(picture, which);
    const Otsu split = otsu(candidate);
    if (grey.empty() || split.separability > first.separability)
    {
      grey = candidate;
      first = split;
      report.channel = channels[static_cast<std::size_t>(which)];
    }
  }
  if (first.separability <= 0)
  {
    throw InputError(fmt::format("the picture is of one single grey, {:.0f} of 255: there is nothing to tell apart",
                       static_cast<double>(grey.at<float>(0, 0))),
      "check that it is the picture you mean");
  }

  Flattened flat = flatten(grey, options.background);
  report.background = flat.scale;
  report.unevenness = flat.unevenness;
  const Otsu rough = otsu(flat.grey);
  cv::Mat brightMask = flat.grey >= rough.threshold;
  const double contrast = std::max(1e-3, cv::mean(flat.grey, brightMask)[0] - cv::mean(flat.grey, 255 - brightMask)[0]);
  report.noise = noiseOf(flat.grey) / contrast;
  // Noise of a tenth of the contrast would put a pixel in a hundred thousand on the wrong side; edges suffer earlier.
  report.smoothing = options.smoothing.value_or(report.noise < 0.03 ? 0.0 : report.noise < 0.1 ? 1.0 : 1.5);
  if (report.smoothing > 0)
  {
    cv::GaussianBlur(flat.grey, flat.grey, cv::Size(), report.smoothing, report.smoothing, cv::BORDER_REFLECT);
  }

  const Otsu split = otsu(flat.grey);
  report.threshold = options.threshold.value_or(split.threshold);
  report.separability = split.separability;
  brightMask = flat.grey >= report.threshold;
  report.brightLumen = options.lumen == LumenSide::Bright ||
    (options.lumen == LumenSide::Auto && enclosedPieces(brightMask) >= enclosedPieces(255 - brightMask));
  cv::Mat lumen = report.brightLumen ? brightMask : cv::Mat(255 - brightMask);

  const std::int64_t smallest = smallestPiece(lumen);
  report.smallestLumen = options.smallestLumen.value_or(smallest);
  report.smallestWall = options.smallestWall.value_or(smallest);
  report.lumensRemoved = clearSmall(lumen, report.smallestLumen, false, false, report.nodesChanged);
  cv::Mat wall = 255 - lumen;
  report.wallsRemoved = clearSmall(wall, report.smallestWall, true, true, report.nodesChanged);
  lumen = 255 - wall;
  if (options.grow != 0)
  {
    growBy(lumen, options.grow);
  }

  report.lumens = static_cast<std::int64_t>(piecesOf(lumen, false).area.size()) - 1;
  report.lumenFraction = static_cast<double>(cv::countNonZero(lumen)) / static_cast<double>(lumen.total());
  if (report.separability < 0.7)
  {
    result.warnings.push_back(fmt::format(
      "lumens and walls are hard to tell apart (separability {:.2f}): look at the result", report.separability));
  }
  if (report.lumenFraction <= 0 || report.lumenFraction >= 1)
  {
    result.warnings.push_back(report.lumenFraction <= 0 ? "no lumen was found" : "no wall was found");
  }

  result.image.lattice = picture.lattice;
  result.image.phases = PhaseTable({ "lumen", "wall" });
  result.image.phase.resize(picture.grey.size());
  for (int row = 0; row < lumen.rows; ++row)
  {
    const auto* value = lumen.ptr<std::uint8_t>(row);
    std::transform(value, value + lumen.cols,
      result.image.phase.begin() + static_cast<std::ptrdiff_t>(row) * lumen.cols,
      [](std::uint8_t inside) { return static_cast<std::uint8_t>(inside == 0); });
  }
  return result;
}

} // namespace lamella::micrograph
