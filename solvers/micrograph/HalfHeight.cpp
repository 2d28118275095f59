#include "micrograph/HalfHeight.h"

#include "micrograph/EdgeProfile.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

namespace lamella::micrograph
{
namespace
{

/// The mean edge: how wide it is on both sides of the outline, and between which greys.
struct MeanEdge
{
  double inwards = 0;  ///< [pixels]
  double outwards = 0; ///< [pixels]
  double lumen = 0;    ///< grey where it begins
  double wall = 0;     ///< grey where it ends
  double blur = 0;     ///< standard deviation of the Gaussian that makes a step so steep [pixels]
};

/// Distance of a pixel's centre from the outline, negative inside.
double fromOutline(float depth, float away)
{
  return depth > 0 ? 0.5 - depth : away;
}

std::optional<MeanEdge> meanEdge(const EdgeDistance& edge, const cv::Mat& bright, double reach)
{
  const auto bins = static_cast<std::size_t>(std::ceil(reach / Profile::bin));
  Profile inside(bins);
  Profile wall(bins);
  for (int row = 0; row < bright.rows; ++row)
  {
    const auto* depth = edge.depth.ptr<float>(row);
    const auto* away = edge.away.ptr<float>(row);
    const auto* value = bright.ptr<float>(row);
    for (int x = 0; x < bright.cols; ++x)
    {
      (depth[x] > 0 ? inside : wall).add(std::abs(fromOutline(depth[x], away[x])), value[x]);
    }
  }
  const auto in = inside.curve();
  const auto out = wall.curve();
  if (in.size() < 3 || out.size() < 2)
  {
    return std::nullopt;
  }
  std::vector<std::array<double, 2>> across(in.rbegin(), in.rend());
  for (auto& point : across)
  {
    point[0] = -point[0];
  }
  across.insert(across.end(), out.begin(), out.end());
  const auto slope = [&](std::size_t i)
  { return (across[i][1] - across[i + 1][1]) / (across[i + 1][0] - across[i][0]); };
  std::size_t steepest = 0;
  for (std::size_t i = 0; i + 1 < across.size(); ++i)
  {
    steepest = slope(i) > slope(steepest) ? i : steepest;
  }
  if (!(slope(steepest) > 0))
  {
    return std::nullopt;
  }
  constexpr double flat = 0.05;
  std::size_t end = steepest + 1;
  while (end + 1 < across.size() && slope(end) > flat * slope(steepest))
  {
    ++end;
  }
  std::size_t begin = steepest;
  while (begin > 0 && slope(begin - 1) > flat * slope(steepest))
  {
    --begin;
  }
  const double contrast = across[begin][1] - across[end][1];
  return MeanEdge{ -across[begin][0], across[end][0], across[begin][1], across[end][1],
    contrast / slope(steepest) / std::sqrt(2 * std::numbers::pi) };
}

/// What is known of one lumen and its wall.
struct Own
{
  double lumen = 0, lumenNodes = 0;
  double wall = 0, wallNodes = 0;
  double edgeNodes = 0;
  bool cut = false; ///< by the picture's border
};

std::vector<Own> ownGreys(const EdgeDistance& edge, const cv::Mat& bright, const MeanEdge& mean)
{
  constexpr double band = 0.75;
  double pieces = 0;
  cv::minMaxLoc(edge.piece, nullptr, &pieces);
  std::vector<Own> all(static_cast<std::size_t>(pieces) + 1);
  for (int row = 0; row < bright.rows; ++row)
  {
    const auto* depth = edge.depth.ptr<float>(row);
    const auto* away = edge.away.ptr<float>(row);
    const auto* piece = edge.piece.ptr<int>(row);
    const auto* value = bright.ptr<float>(row);
    for (int x = 0; x < bright.cols; ++x)
    {
      Own& own = all[static_cast<std::size_t>(piece[x])];
      const double distance = fromOutline(depth[x], away[x]);
      if (distance <= -mean.inwards && depth[x] > 0)
      {
        own.lumen += value[x];
        own.lumenNodes += 1;
      }
      else if (depth[x] <= 0 && std::abs(distance - mean.outwards) <= band)
      {
        own.wall += value[x];
        own.wallNodes += 1;
      }
      // Pixels with a face on the outline lie 1 from it by the 5 × 5 mask.
      own.edgeNodes += depth[x] > 0 && depth[x] < 1.2F;
      own.cut = own.cut || (depth[x] > 0 && (x == 0 || row == 0 || x + 1 == bright.cols || row + 1 == bright.rows));
    }
  }
  return all;
}

/// The grey at the true edge of a lumen.
double levelOf(const Own& own, const MeanEdge& mean)
{
  constexpr double faith = 10; // pixels that the mean over all lumens counts for
  const double lumen = (own.lumen + faith * mean.lumen) / (own.lumenNodes + faith);
  const double wall = (own.wall + faith * mean.wall) / (own.wallNodes + faith);
  // A closed outline turns by 2π; one cut by the border by half of that, more or less.
  const double curvature = (own.cut ? 1 : 2) * std::numbers::pi / std::max(8.0, own.edgeNodes);
  return (lumen + wall) / 2 - (lumen - wall) * mean.blur * curvature / (2 * std::sqrt(2 * std::numbers::pi));
}

} // namespace

double toHalfHeight(cv::Mat& lumen, const EdgeDistance& edge, const cv::Mat& bright, double reach)
{
  const std::optional<MeanEdge> mean = meanEdge(edge, bright, reach);
  if (!mean)
  {
    return 0;
  }
  const std::vector<Own> all = ownGreys(edge, bright, *mean);
  std::vector<double> level(all.size());
  std::transform(all.begin(), all.end(), level.begin(), [&](const Own& own) { return levelOf(own, *mean); });

  constexpr double farthest = 1.5; // [pixels]
  const cv::Mat before = lumen.clone();
  for (int row = 0; row < lumen.rows; ++row)
  {
    const auto* depth = edge.depth.ptr<float>(row);
    const auto* away = edge.away.ptr<float>(row);
    const auto* piece = edge.piece.ptr<int>(row);
    const auto* value = bright.ptr<float>(row);
    auto* mask = lumen.ptr<std::uint8_t>(row);
    for (int x = 0; x < lumen.cols; ++x)
    {
      if (std::max(depth[x], away[x]) <= farthest)
      {
        mask[x] = value[x] >= level[static_cast<std::size_t>(piece[x])] ? 255 : 0;
      }
    }
  }
  keepApart(lumen, before, edge);
  double perimeter = 0;
  for (const Own& own : all)
  {
    perimeter += own.edgeNodes;
  }
  return (cv::countNonZero(lumen) - cv::countNonZero(before)) / std::max(1.0, perimeter);
}

} // namespace lamella::micrograph
