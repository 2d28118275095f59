#include "segmentation/Rims.h"

#include "segmentation/EdgeProfile.h"
#include "segmentation/Pieces.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace lamella::micrograph
{
namespace
{

/// How far the outline lies outside the centre of a pixel at the edge of a mask, along the edge's normal.
float beyond(const cv::Mat& mask, const cv::Mat& bright, double threshold, int row, int x)
{
  const double here = bright.at<float>(row, x);
  const auto along = [&](int dy, int dx) -> std::optional<double>
  {
    std::optional<double> nearest;
    for (const int side : { -1, 1 })
    {
      const int r = row + side * dy;
      const int c = x + side * dx;
      if (r < 0 || c < 0 || r >= mask.rows || c >= mask.cols || mask.at<std::uint8_t>(r, c) > 0)
        continue;
      const double there = bright.at<float>(r, c);
      // Where the mask was cut, not found by the threshold, the outline lies between the two pixels.
      const double part =
        there < threshold && here > there ? std::clamp((here - threshold) / (here - there), 0.02, 1.0) : 0.5;
      nearest = nearest ? std::min(*nearest, part) : part;
    }
    return nearest;
  };
  const auto vertical = along(1, 0);
  const auto horizontal = along(0, 1);
  if (vertical && horizontal)
    return static_cast<float>(1 / std::hypot(1 / *vertical, 1 / *horizontal));
  return static_cast<float>(vertical.value_or(horizontal.value_or(0.5)));
}

/// Where a curve passes a value, going from point to point; none if it does not.
std::optional<double> crossing(const std::vector<std::array<double, 2>>& points, std::size_t from, double value)
{
  for (std::size_t i = from; i + 1 < points.size(); ++i)
  {
    const double a = points[i][1] - value;
    const double b = points[i + 1][1] - value;
    if (a == 0 || a * b < 0)
      return points[i][0] + (points[i + 1][0] - points[i][0]) * (a / (a - b));
  }
  return std::nullopt;
}

/// The vertex of the parabola through a point and its two neighbours.
double vertex(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c)
{
  const double left = (b[1] - a[1]) / (b[0] - a[0]);
  const double right = (c[1] - b[1]) / (c[0] - b[0]);
  return right > left ? std::clamp((a[0] + b[0]) / 2 - left * (c[0] - a[0]) / (2 * (right - left)), a[0], c[0]) : b[0];
}

Rim rimOf(const std::vector<std::array<double, 2>>& inside, const std::vector<std::array<double, 2>>& wall,
  double contrastOfBest)
{
  Rim rim;
  if (inside.size() < 3 || wall.size() < 4)
    return rim;
  const double lumenLevel = inside.back()[1];
  double peak = lumenLevel;
  for (const auto& point : inside)
    peak = std::max(peak, point[1]);
  const auto darker = [](const auto& a, const auto& b) { return a[1] < b[1]; };
  const auto darkest = static_cast<std::size_t>(std::min_element(wall.begin(), wall.end(), darker) - wall.begin());
  const double wallLevel =
    (*std::max_element(wall.begin() + static_cast<std::ptrdiff_t>(darkest), wall.end(), darker))[1];
  const double dip = wallLevel - wall[darkest][1];
  rim.depth = (dip - (peak - lumenLevel)) / contrastOfBest;
  if (darkest + 1 >= wall.size() || !(rim.depth > 0.1))
    return rim;
  // The edge from lumen to dark line, 10 to 90 %.
  std::vector<std::array<double, 2>> edge(inside.rbegin(), inside.rend());
  for (auto& point : edge)
    point[0] = -point[0];
  edge.insert(edge.end(), wall.begin(), wall.end());
  const double low = wall[darkest][1];
  const auto top = crossing(edge, 0, low + 0.9 * (lumenLevel - low));
  const auto foot = crossing(edge, 0, low + 0.1 * (lumenLevel - low));
  // Or as its steepest place tells: a slow fall beyond the edge, towards a dark middle lamella, is no blur.
  double steepest = 0;
  for (std::size_t k = 0; k + 1 < edge.size(); ++k)
    steepest = std::max(steepest, (edge[k][1] - edge[k + 1][1]) / (edge[k + 1][0] - edge[k][0]));
  const double straight = 1.02 * (lumenLevel - low) / std::max(1e-9, steepest);
  const double blur = std::max(1.0, std::min(straight, top && foot ? std::abs(*foot - *top) : straight));
  rim.shift = darkest == 0 ? wall[0][0] : vertex(wall[darkest - 1], wall[darkest], wall[darkest + 1]);
  const double bottom = low + 0.2 * dip;
  const auto begin = crossing(edge, 0, bottom);
  const auto end = crossing(wall, darkest, bottom);
  rim.found = rim.shift <= 1.5 * blur && begin && end && *end - *begin <= 1.2 * blur;
  return rim;
}

} // namespace

EdgeDistance edgeDistance(const cv::Mat& mask, const cv::Mat& bright, double threshold)
{
  EdgeDistance result;
  const Pieces pieces = piecesOf(mask, false);
  result.away = cv::Mat(mask.size(), CV_32F, cv::Scalar(std::numeric_limits<float>::max()));
  result.piece = pieces.labels.clone();
  cv::distanceTransform(mask, result.depth, cv::DIST_L2, cv::DIST_MASK_5);
  if (cv::countNonZero(mask) == 0)
    return result;
  cv::Mat distance;
  cv::Mat nearest;
  cv::distanceTransform(255 - mask, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  // Which pixel of the mask a label stands for; only those at its edge are ever nearest.
  std::vector<cv::Point> place(mask.total() + 1);
  for (int row = 0; row < mask.rows; ++row)
  {
    const auto* inside = mask.ptr<std::uint8_t>(row);
    const auto* label = nearest.ptr<int>(row);
    for (int x = 0; x < mask.cols; ++x)
      if (inside[x] > 0)
        place[static_cast<std::size_t>(label[x])] = { x, row };
  }
  for (int row = 0; row < mask.rows; ++row)
  {
    const auto* inside = mask.ptr<std::uint8_t>(row);
    const auto* label = nearest.ptr<int>(row);
    auto* away = result.away.ptr<float>(row);
    auto* piece = result.piece.ptr<int>(row);
    for (int x = 0; x < mask.cols; ++x)
    {
      if (inside[x] > 0)
      {
        away[x] = 0;
        continue;
      }
      const cv::Point from = place[static_cast<std::size_t>(label[x])];
      const float straight = std::hypot(static_cast<float>(x - from.x), static_cast<float>(row - from.y));
      away[x] = std::max(0.0F, straight - beyond(mask, bright, threshold, from.y, from.x));
      piece[x] = pieces.labels.at<int>(from);
    }
  }
  return result;
}

Rim findRim(const Picture& picture, const cv::Mat& lumen, const EdgeDistance& edge, bool brightLumen, double reach,
  const cv::Mat& ignored)
{
  static constexpr std::array names{ "red", "green", "blue", "grey" };
  const std::size_t channels = picture.colour.empty() ? 1 : 3;
  const std::uint16_t* const values = picture.colour.empty() ? picture.grey.data() : picture.colour.data();
  const auto bins = static_cast<std::size_t>(std::ceil(reach / Profile::bin));
  std::vector<Profile> inside(channels, Profile(bins));
  std::vector<Profile> wall(channels, Profile(bins));
  for (int row = 0; row < lumen.rows; ++row)
  {
    const auto* deep = edge.depth.ptr<float>(row);
    const auto* away = edge.away.ptr<float>(row);
    const auto* skip = ignored.empty() ? nullptr : ignored.ptr<std::uint8_t>(row);
    for (int x = 0; x < lumen.cols; ++x)
    {
      const double distance = deep[x] > 0 ? deep[x] - 0.5 : away[x];
      if (!(distance < reach) || (skip != nullptr && skip[x] > 0))
        continue;
      const std::size_t node =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(lumen.cols) + static_cast<std::size_t>(x);
      for (std::size_t c = 0; c < channels; ++c)
      {
        const double value =
          brightLumen ? values[node * channels + c] : -static_cast<double>(values[node * channels + c]);
        (deep[x] > 0 ? inside : wall)[c].add(distance, value);
      }
    }
  }
  double contrast = 0;
  for (std::size_t c = 0; c < channels; ++c)
  {
    const auto in = inside[c].curve();
    const auto out = wall[c].curve();
    if (!in.empty() && !out.empty())
      contrast = std::max(contrast, in.back()[1] - out.back()[1]);
  }
  Rim best;
  for (std::size_t c = 0; c < channels && contrast > 0; ++c)
  {
    Rim rim = rimOf(inside[c].curve(), wall[c].curve(), contrast);
    if (rim.found && (!best.found || rim.depth > best.depth))
    {
      best = rim;
      best.channel = names[channels == 1 ? 3 : c];
    }
  }
  return best;
}

void moveOutwards(cv::Mat& mask, const EdgeDistance& edge, double shift)
{
  const cv::Mat before = mask.clone();
  for (int row = 0; row < mask.rows; ++row)
  {
    auto* value = mask.ptr<std::uint8_t>(row);
    const auto* away = edge.away.ptr<float>(row);
    for (int x = 0; x < mask.cols; ++x)
      value[x] = away[x] < shift ? 255 : value[x];
  }
  keepApart(mask, before, edge);
}

void keepApart(cv::Mat& mask, const cv::Mat& before, const EdgeDistance& edge)
{
  const cv::Mat grown = mask.clone();
  for (int row = 0; row < mask.rows; ++row)
  {
    for (int x = 0; x < mask.cols; ++x)
    {
      if (grown.at<std::uint8_t>(row, x) == 0 || before.at<std::uint8_t>(row, x) > 0)
        continue;
      const int own = edge.piece.at<int>(row, x);
      for (int r = std::max(0, row - 1); r <= std::min(mask.rows - 1, row + 1); ++r)
      {
        for (int c = std::max(0, x - 1); c <= std::min(mask.cols - 1, x + 1); ++c)
          if (grown.at<std::uint8_t>(r, c) > 0 && edge.piece.at<int>(r, c) != own)
            mask.at<std::uint8_t>(row, x) = 0;
      }
    }
  }
}

} // namespace lamella::micrograph
