#include "micrograph/Evidence.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamella::micrograph
{
namespace
{

template <class T>
double quantile(std::vector<T>& values, double share)
{
  if (values.empty())
  {
    return 0;
  }
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Every so many pixels, so that no more than some hundred thousand are sorted.
std::vector<float> sampled(const cv::Mat& grey, const cv::Mat& mask)
{
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(grey.total()) / 4e5)));
  std::vector<float> values;
  for (int row = 0; row < grey.rows; row += step)
  {
    for (int x = 0; x < grey.cols; x += step)
    {
      if (mask.at<std::uint8_t>(row, x) > 0)
      {
        values.push_back(grey.at<float>(row, x));
      }
    }
  }
  return values;
}

void lookAtWalls(const cv::Mat& lumen, Evidence& e)
{
  cv::Mat away;
  cv::Mat nearest;
  cv::distanceTransform(255 - lumen, away, nearest, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_CCOMP);
  // Half way between two lumens their regions meet.
  std::vector<float> half;
  for (int row = 0; row + 1 < lumen.rows; ++row)
  {
    const int* const here = nearest.ptr<int>(row);
    const int* const above = nearest.ptr<int>(row + 1);
    const auto* distance = away.ptr<float>(row);
    for (int x = 0; x + 1 < lumen.cols; ++x)
    {
      if (distance[x] > 0 && (here[x] != here[x + 1] || here[x] != above[x]))
      {
        half.push_back(distance[x]);
      }
    }
  }
  if (half.empty())
  {
    return;
  }
  // Pixels' centres lie half a pixel from the outline at least.
  e.wallThickness = 2 * quantile(half, 0.5) - 1;
  // Whole wood has walls of one thickness, and its corners hold disks half as wide again. The thinner ones are asked:
  // where every other cell is filled the median is no wall's.
  const double radius = 2.5 * quantile(half, 0.3) + 1;
  const cv::Mat deep = away > radius;
  if (cv::countNonZero(deep) > 0)
  {
    cv::Mat toDeep;
    cv::distanceTransform(255 - deep, toDeep, cv::DIST_L2, cv::DIST_MASK_5);
    const cv::Mat thick = toDeep <= radius;
    e.wallShareThick =
      cv::countNonZero(thick) / std::max(1.0, static_cast<double>(lumen.total()) - cv::countNonZero(lumen));
  }
}

/// The width of a step's ramp from how steep it is at the outline: a Gaussian's is height / (√(2π) s), and from 10 to
/// 90 % it takes 2.563 s.
void lookAtEdges(const cv::Mat& lumen, const cv::Mat& even, double contrast, Evidence& e)
{
  std::vector<float> steep;
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(lumen.total()) / 4e6)));
  for (int row = 1; row + 1 < lumen.rows; row += step)
  {
    const auto* mask = lumen.ptr<std::uint8_t>(row);
    for (int x = 1; x + 1 < lumen.cols; ++x)
    {
      const bool beside = mask[x] != mask[x + 1];
      const bool over = mask[x] != lumen.at<std::uint8_t>(row + 1, x);
      if (beside || over)
      {
        const float dx = even.at<float>(row, x + 1) - even.at<float>(row, beside ? x : x - 1);
        const float dy = even.at<float>(row + 1, x) - even.at<float>(over ? row : row - 1, x);
        steep.push_back(std::hypot(beside ? dx : dx / 2, over ? dy : dy / 2));
      }
    }
  }
  const double slope = quantile(steep, 0.5);
  e.edgeWidth = slope > 0 ? 2.563 * contrast / (std::sqrt(2 * std::numbers::pi) * slope) : 0;
}

/// Tops of the grey within walls that fall off on all sides. The grain of noise has them too: they must be as curved as
/// a lumen two pixels wide of an eighth of the contrast is.
void lookForSpots(const cv::Mat& lumen, const cv::Mat& even, Evidence& e)
{
  constexpr double sigma = 1;
  constexpr double away = 1.8; // from lumens, whose own flanks bend
  constexpr double reach = 2.5;
  cv::Mat smooth;
  cv::GaussianBlur(even, smooth, cv::Size(), sigma, sigma, cv::BORDER_REFLECT);
  const cv::Mat wall = 255 - lumen;
  std::vector<float> inLumens = sampled(even, lumen);
  std::vector<float> inWalls = sampled(even, wall);
  const double bright = quantile(inLumens, 0.5);
  const double dark = quantile(inWalls, 0.25);
  const double contrast = std::max(1.0, bright - dark);
  cv::Mat distance;
  cv::distanceTransform(wall, distance, cv::DIST_L2, cv::DIST_MASK_5);
  cv::Mat xx;
  cv::Mat yy;
  cv::Mat xy;
  cv::Sobel(smooth, xx, CV_32F, 2, 0, 3, 0.25);
  cv::Sobel(smooth, yy, CV_32F, 0, 2, 3, 0.25);
  cv::Sobel(smooth, xy, CV_32F, 1, 1, 3, 0.25);
  cv::Mat spots(lumen.size(), CV_8U, cv::Scalar(255));
  for (int row = 1; row + 1 < lumen.rows; ++row)
  {
    for (int x = 1; x + 1 < lumen.cols; ++x)
    {
      if (distance.at<float>(row, x) < away)
      {
        continue;
      }
      const float value = smooth.at<float>(row, x);
      bool top = true;
      for (int k = 0; k < 9 && top; ++k)
      {
        top = k == 4 || smooth.at<float>(row + k / 3 - 1, x + k % 3 - 1) < value;
      }
      if (!top)
      {
        continue;
      }
      const double mean = (xx.at<float>(row, x) + yy.at<float>(row, x)) / 2;
      const double apart = std::hypot((xx.at<float>(row, x) - yy.at<float>(row, x)) / 2, xy.at<float>(row, x));
      constexpr double curved = 0.04;
      if (-(mean + apart) > curved * contrast)
      {
        ++e.spots;
        spots.at<std::uint8_t>(row, x) = 0;
      }
    }
  }
  if (e.spots == 0)
  {
    return;
  }
  cv::Mat toSpot;
  cv::distanceTransform(spots, toSpot, cv::DIST_L2, cv::DIST_MASK_5);
  double held = 0;
  for (int row = 0; row < lumen.rows; ++row)
  {
    for (int x = 0; x < lumen.cols; ++x)
    {
      if (toSpot.at<float>(row, x) <= reach && wall.at<std::uint8_t>(row, x) > 0)
      {
        held += std::clamp((even.at<float>(row, x) - dark) / contrast, 0.0, 1.0);
      }
    }
  }
  e.spotShare = held / static_cast<double>(lumen.total());
}

void lookAtLumens(const cv::Mat& lumen, Evidence& e)
{
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(lumen, labels, stats, centres, 4, CV_32S);
  cv::Mat depth;
  cv::distanceTransform(lumen, depth, cv::DIST_L2, cv::DIST_MASK_5);
  std::vector<float> deepest(static_cast<std::size_t>(count), 0.0F);
  std::vector<bool> cut(deepest.size(), false);
  for (int row = 0; row < lumen.rows; ++row)
  {
    for (int x = 0; x < lumen.cols; ++x)
    {
      const auto label = static_cast<std::size_t>(labels.at<int>(row, x));
      deepest[label] = std::max(deepest[label], depth.at<float>(row, x));
      cut[label] = cut[label] || row == 0 || x == 0 || row + 1 == lumen.rows || x + 1 == lumen.cols;
    }
  }
  std::vector<float> whole;
  for (std::size_t label = 1; label < deepest.size(); ++label)
  {
    if (!cut[label])
    {
      whole.push_back(deepest[label]);
    }
  }
  constexpr float narrow = 2.6F; // from the middle pixel of five
  e.narrow = static_cast<double>(std::count_if(whole.begin(), whole.end(), [](float d) { return d < narrow; })) /
    std::max(1.0, static_cast<double>(whole.size()));
  e.lumenWidth = std::max(0.0, 2 * quantile(whole, 0.5) - 1);
}

/// Tears and what lies beside the tissue are larger than cells and ragged, or open along the border. A vessel that the
/// border cuts is as large among fibres, but touches it along its own width alone.
void lookForGaps(const std::vector<PieceShape>& pieces, double nodes, Evidence& e)
{
  std::vector<double> whole;
  double all = 0;
  for (const PieceShape& piece : pieces)
  {
    all += static_cast<double>(piece.area);
    if (!piece.cut && piece.solidity >= compactSolidity)
    {
      whole.push_back(static_cast<double>(piece.area));
    }
  }
  if (whole.empty())
  {
    e.compactWithoutGaps = e.lumens.compact;
    return;
  }
  const double usual = quantile(whole, 0.5);
  const double largest = *std::max_element(whole.begin(), whole.end());
  constexpr double ragged = 0.75;
  double inGaps = 0;
  double compactGaps = 0;
  for (const PieceShape& piece : pieces)
  {
    const auto area = static_cast<double>(piece.area);
    if ((piece.solidity < ragged && area > 3 * usual) || (piece.open && area > 3 * largest))
    {
      ++e.gaps;
      inGaps += area;
      compactGaps += piece.solidity >= compactSolidity ? area : 0;
      e.gapBoxes.push_back(piece.box);
    }
  }
  e.gapShare = inGaps / nodes;
  e.compactWithoutGaps = (e.lumens.compact * all - compactGaps) / std::max(1.0, all - inGaps);
}

} // namespace

Evidence gather(const cv::Mat& lumen, const cv::Mat& asSeen, const cv::Mat& even, double noise, std::int64_t smallest)
{
  Evidence e;
  const cv::Mat wall = 255 - lumen;
  const int inside = cv::countNonZero(lumen);
  if (inside == 0 || inside == static_cast<int>(lumen.total()))
  {
    return e;
  }
  const std::vector<PieceShape> pieces = pieceShapes(lumen, smallest);
  e.lumens = sideShape(pieces);
  e.walls = sideShape(pieceShapes(wall, smallest));
  const auto contrastOf = [&](const cv::Mat& grey)
  { return std::max(1.0, std::abs(cv::mean(grey, lumen)[0] - cv::mean(grey, wall)[0])); };
  e.classes = greyClasses(asSeen, contrastOf(asSeen), noise);
  e.evenClasses = greyClasses(even, contrastOf(even), noise);
  lookAtWalls(lumen, e);
  lookAtEdges(lumen, even, contrastOf(even), e);
  lookForSpots(lumen, even, e);
  lookAtLumens(lumen, e);
  lookForGaps(pieces, static_cast<double>(lumen.total()), e);
  return e;
}

} // namespace lamella::micrograph
