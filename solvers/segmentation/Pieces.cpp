#include "segmentation/Pieces.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{

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
    count += pieces.enclosed[i] && pieces.area[i] >= 30;
  return count;
}

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
      value[x] = clear[static_cast<std::size_t>(label[x])] ? 0 : value[x];
  }
  return count;
}

void growBy(cv::Mat& lumen, double pixels)
{
  const bool outwards = pixels > 0;
  cv::Mat distance;
  cv::distanceTransform(outwards ? cv::Mat(255 - lumen) : lumen, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  if (outwards)
    lumen = distance <= pixels;
  else
    lumen = distance > -pixels;
}

std::int64_t openPieces(cv::Mat& mask, double radius)
{
  if (!(radius > 0))
    return 0;
  const Pieces pieces = piecesOf(mask, false);
  cv::Mat depth;
  cv::distanceTransform(mask, depth, cv::DIST_L2, cv::DIST_MASK_5);
  std::vector<float> disk(pieces.area.size(), 0.0F);
  for (int row = 0; row < mask.rows; ++row)
  {
    const auto* label = pieces.labels.ptr<int>(row);
    const auto* deep = depth.ptr<float>(row);
    for (int x = 0; x < mask.cols; ++x)
    {
      auto& widest = disk[static_cast<std::size_t>(label[x])];
      widest = std::max(widest, deep[x]);
    }
  }
  for (float& widest : disk)
    widest = std::min(static_cast<float>(radius), widest / 4);
  cv::Mat outside(mask.size(), CV_8U);
  for (int row = 0; row < mask.rows; ++row)
  {
    const auto* label = pieces.labels.ptr<int>(row);
    const auto* deep = depth.ptr<float>(row);
    auto* out = outside.ptr<std::uint8_t>(row);
    for (int x = 0; x < mask.cols; ++x)
      out[x] = label[x] > 0 && deep[x] > disk[static_cast<std::size_t>(label[x])] ? 0 : 255;
  }
  cv::Mat& distance = depth;
  cv::distanceTransform(outside, distance, cv::DIST_L2, cv::DIST_MASK_5);
  std::int64_t changed = 0;
  for (int row = 0; row < mask.rows; ++row)
  {
    const auto* label = pieces.labels.ptr<int>(row);
    const auto* away = distance.ptr<float>(row);
    auto* value = mask.ptr<std::uint8_t>(row);
    for (int x = 0; x < mask.cols; ++x)
    {
      if (label[x] > 0 && away[x] > disk[static_cast<std::size_t>(label[x])])
      {
        value[x] = 0;
        ++changed;
      }
    }
  }
  return changed;
}

} // namespace lamella::micrograph
