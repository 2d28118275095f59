#include "segmentation/HalfHeight.h"

#include "segmentation/EdgeProfile.h"

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

// A Gaussian edge has 5 % of its height to fall 1.645 deviations before its middle, and 1 % 2.33 before.
constexpr double foot = 0.05;
constexpr double deviations = 1.645;
constexpr double reaches = 2.33;

/// Where a falling curve first passes a value.
std::optional<double> crossing(const std::vector<std::array<double, 2>>& curve, double value)
{
  for (std::size_t i = 0; i + 1 < curve.size(); ++i)
  {
    if (curve[i][1] > value && curve[i + 1][1] <= value)
    {
      const double part = (curve[i][1] - value) / (curve[i][1] - curve[i + 1][1]);
      return curve[i][0] + part * (curve[i + 1][0] - curve[i][0]);
    }
  }
  return std::nullopt;
}

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
      (depth[x] > 0 ? inside : wall).add(std::abs(fromOutline(depth[x], away[x])), value[x]);
  }
  const auto in = inside.curve();
  const auto out = wall.curve();
  if (in.size() < 3 || out.size() < 2)
    return std::nullopt;
  std::vector<std::array<double, 2>> across(in.rbegin(), in.rend());
  for (auto& point : across)
    point[0] = -point[0];
  across.insert(across.end(), out.begin(), out.end());
  const auto place = [&](double grey) { return crossing(across, grey); };
  const auto grey = [&](double distance)
  {
    const auto next =
      std::find_if(across.begin() + 1, across.end() - 1, [&](const auto& point) { return point[0] >= distance; });
    const auto& [x0, y0] = *(next - 1);
    const auto& [x1, y1] = *next;
    return y0 + (y1 - y0) * std::clamp((distance - x0) / (x1 - x0), 0.0, 1.0);
  };
  MeanEdge mean;
  mean.lumen = across.front()[1];
  mean.wall =
    (*std::min_element(across.begin(), across.end(), [](const auto& a, const auto& b) { return a[1] < b[1]; }))[1];
  // The wall's grey and where the edge ends depend on each other: what goes on falling further out than the blur
  // reaches, as the lumen's side tells it, is a darker middle lamella.
  for (int round = 0; round < 4; ++round)
  {
    const double contrast = mean.lumen - mean.wall;
    const auto begin = place(mean.lumen - foot * contrast);
    const auto middle = place(mean.lumen - contrast / 2);
    if (!(contrast > 0) || !begin || !middle)
      return std::nullopt;
    mean.blur = (*middle - *begin) / deviations;
    mean.inwards = reaches * mean.blur - *middle;
    mean.outwards = reaches * mean.blur + *middle;
    mean.wall = grey(mean.outwards);
  }
  return mean;
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

double edgeBlur(const EdgeDistance& edge, const cv::Mat& bright, double reach)
{
  const std::optional<MeanEdge> mean = meanEdge(edge, bright, reach);
  return mean ? mean->blur : 0;
}

HalfHeight toHalfHeight(cv::Mat& lumen, const EdgeDistance& edge, const cv::Mat& bright, double reach)
{
  const std::optional<MeanEdge> mean = meanEdge(edge, bright, reach);
  if (!mean)
    return {};
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
      if (std::max(depth[x], away[x]) <= farthest)
        mask[x] = value[x] >= level[static_cast<std::size_t>(piece[x])] ? 255 : 0;
  }
  keepApart(lumen, before, edge);
  double perimeter = 0;
  for (const Own& own : all)
    perimeter += own.edgeNodes;
  return { (cv::countNonZero(lumen) - cv::countNonZero(before)) / std::max(1.0, perimeter), mean->blur };
}

} // namespace lamella::micrograph
