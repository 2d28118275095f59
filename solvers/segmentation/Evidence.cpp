#include "segmentation/Evidence.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
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
    return 0;
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
      if (mask.at<std::uint8_t>(row, x) > 0)
        values.push_back(grey.at<float>(row, x));
  }
  return values;
}

/// @return how far every pixel lies from the nearest lumen; 0 within
cv::Mat lookAtWalls(const cv::Mat& lumen, Evidence& e)
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
      if (distance[x] > 0 && (here[x] != here[x + 1] || here[x] != above[x]))
        half.push_back(distance[x]);
  }
  if (half.empty())
    return away;
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
  return away;
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

/// Whether a place is a top that falls off on all sides, as steeply curved as a lumen 2 × 2 pixels wide with a third of
/// the contrast is through a lens of one pixel.
bool isSpot(const cv::Mat& smooth, int row, int x, double contrast)
{
  std::array<float, 9> v{};
  for (int k = 0; k < 9; ++k)
  {
    v[static_cast<std::size_t>(k)] = smooth.ptr<float>(row + k / 3 - 1)[x + k % 3 - 1];
    if (k != 4 && v[static_cast<std::size_t>(k)] >= smooth.ptr<float>(row)[x])
      return false;
  }
  // Second differences over three rows, columns.
  const double xx = (v[0] - 2 * v[1] + v[2] + 2 * (v[3] - 2 * v[4] + v[5]) + v[6] - 2 * v[7] + v[8]) / 4;
  const double yy = (v[0] - 2 * v[3] + v[6] + 2 * (v[1] - 2 * v[4] + v[7]) + v[2] - 2 * v[5] + v[8]) / 4;
  const double xy = (v[0] - v[2] - v[6] + v[8]) / 4;
  constexpr double curved = 0.04;
  return -((xx + yy) / 2 + std::hypot((xx - yy) / 2, xy)) > curved * contrast;
}

/// Bright spots within walls, and what they hold: the grain of noise has tops too, but not as curved.
void lookForSpots(const cv::Mat& lumen, const cv::Mat& even, const cv::Mat& away, Evidence& e)
{
  constexpr double sigma = 1;
  constexpr float flank = 1.8F; // nearer to a lumen its own flank bends
  constexpr int reach = 2;
  cv::Mat smooth;
  cv::GaussianBlur(even, smooth, cv::Size(), sigma, sigma, cv::BORDER_REFLECT);
  std::vector<float> inLumens = sampled(even, lumen);
  std::vector<float> inWalls = sampled(even, 255 - lumen);
  const double dark = quantile(inWalls, 0.25);
  const double contrast = std::max(1.0, quantile(inLumens, 0.5) - dark);
  cv::Mat counted(lumen.size(), CV_8U, cv::Scalar(0));
  double held = 0;
  const auto count = [&](int row, int x)
  {
    auto& seen = counted.ptr<std::uint8_t>(row)[x];
    if (seen == 0 && lumen.ptr<std::uint8_t>(row)[x] == 0)
    {
      seen = 1;
      held += std::clamp((even.ptr<float>(row)[x] - dark) / contrast, 0.0, 1.0);
    }
  };
  for (int row = 1; row + 1 < lumen.rows; ++row)
  {
    const auto* distance = away.ptr<float>(row);
    for (int x = 1; x + 1 < lumen.cols; ++x)
    {
      if (distance[x] < flank || !isSpot(smooth, row, x, contrast))
        continue;
      ++e.spots;
      for (int dy = -reach; dy <= reach; ++dy)
      {
        for (int dx = -reach; dx <= reach; ++dx)
        {
          const bool corner = std::abs(dy) == reach && std::abs(dx) == reach;
          const bool inside = row + dy >= 0 && row + dy < lumen.rows && x + dx >= 0 && x + dx < lumen.cols;
          if (inside && !corner)
            count(row + dy, x + dx);
        }
      }
    }
  }
  e.spotShare = held / static_cast<double>(lumen.total());
}

/// Places where a lumen of the narrower ones would fit with its wall all around, within the picture. Corners between
/// cells hold less.
void lookForBlindCells(const cv::Mat& away, double lumenRadius, double wallRadius, Evidence& e)
{
  const double radius = std::max(0.9 * lumenRadius + 2 * wallRadius, 3.5 * wallRadius + 1);
  cv::Mat holds = away > radius;
  const int margin = std::min({ static_cast<int>(radius), holds.rows / 2, holds.cols / 2 });
  const cv::Rect inner(margin, margin, holds.cols - 2 * margin, holds.rows - 2 * margin);
  cv::Mat labels;
  e.blind = inner.area() > 0 ? cv::connectedComponents(holds(inner), labels, 8, CV_32S) - 1 : 0;
}

void lookAtLumens(const cv::Mat& lumen, const cv::Mat& away, Evidence& e)
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
    if (!cut[label])
      whole.push_back(deepest[label]);
  constexpr float narrow = 2.6F; // from the middle pixel of five
  e.narrow = static_cast<double>(std::count_if(whole.begin(), whole.end(), [](float d) { return d < narrow; })) /
    std::max(1.0, static_cast<double>(whole.size()));
  e.lumenWidth = std::max(0.0, 2 * quantile(whole, 0.5) - 1);
  if (!whole.empty())
    lookForBlindCells(away, quantile(whole, 0.3), e.wallThickness / 2, e);
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
      whole.push_back(static_cast<double>(piece.area));
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
    return e;
  const std::vector<PieceShape> pieces = pieceShapes(lumen, smallest);
  e.lumens = sideShape(pieces);
  e.walls = sideShape(pieceShapes(wall, smallest));
  const auto contrastOf = [&](const cv::Mat& grey)
  { return std::max(1.0, std::abs(cv::mean(grey, lumen)[0] - cv::mean(grey, wall)[0])); };
  e.classes = greyClasses(asSeen, contrastOf(asSeen), noise);
  e.evenClasses = greyClasses(even, contrastOf(even), noise);
  const cv::Mat away = lookAtWalls(lumen, e);
  lookAtEdges(lumen, even, contrastOf(even), e);
  lookForSpots(lumen, even, away, e);
  lookAtLumens(lumen, away, e);
  lookForGaps(pieces, static_cast<double>(lumen.total()), e);
  return e;
}

} // namespace lamella::micrograph
