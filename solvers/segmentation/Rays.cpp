#include "segmentation/Rays.h"

#include "core/Median.h"
#include "segmentation/LumenShapes.h"
#include "segmentation/Pieces.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

/// Mean values in a lumen and in the tissue beside it.
struct Beside
{
  std::array<double, 3> lumen{};
  std::array<double, 3> tissue{};
  double lumenNodes = 0;
  double tissueNodes = 0;

  [[nodiscard]] bool known() const { return lumenNodes > 0 && tissueNodes > 0; }
  [[nodiscard]] double transmission(std::size_t channel) const
  {
    return tissue[channel] / tissueNodes / std::max(1.0, lumen[channel] / lumenNodes);
  }
};

std::vector<Beside> besideLumens(const Picture& picture, const EdgeDistance& edge, int lumens, double near, double far)
{
  const std::size_t channels = picture.colour.empty() ? 1 : 3;
  const std::uint16_t* value = picture.colour.empty() ? picture.grey.data() : picture.colour.data();
  std::vector<Beside> result(static_cast<std::size_t>(lumens));
  for (int row = 0; row < edge.away.rows; ++row)
  {
    const auto* away = edge.away.ptr<float>(row);
    const auto* piece = edge.piece.ptr<int>(row);
    for (int x = 0; x < edge.away.cols; ++x, value += channels)
    {
      Beside& own = result[static_cast<std::size_t>(piece[x])];
      if (away[x] == 0)
        own.lumenNodes += 1;
      else if (away[x] > near && away[x] <= far)
        own.tissueNodes += 1;
      else
        continue;
      for (std::size_t c = 0; c < channels; ++c)
        (away[x] == 0 ? own.lumen : own.tissue)[c] += value[c];
    }
  }
  return result;
}

/// The transmission below which tissue is dark, by channel.
std::array<double, 3> darkBelow(const std::vector<Beside>& beside, std::size_t channels)
{
  std::array<double, 3> limits{};
  for (std::size_t c = 0; c < channels; ++c)
  {
    std::vector<double> all;
    for (const Beside& one : beside)
      if (one.known())
        all.push_back(one.transmission(c));
    const double usual = median(all);
    for (double& one : all)
      one = std::abs(one - usual);
    limits[c] = usual - std::max(1.28 * 1.4826 * median(all), 0.1 * (1 - usual));
  }
  return limits;
}

bool isDark(const Beside& beside, const std::array<double, 3>& limits, std::size_t channels)
{
  bool dark = false;
  for (std::size_t c = 0; c < channels && beside.known(); ++c)
    dark = dark || beside.transmission(c) < limits[c];
  return dark;
}

/// How likely it is that so many out of n are dark, or more, where each is with a probability p.
double tail(std::size_t dark, std::size_t n, double p)
{
  double sum = 0;
  double ways = 0; // logarithm of n over k
  for (std::size_t k = 0; k <= n; ++k)
  {
    const auto of = static_cast<double>(k);
    const auto left = static_cast<double>(n - k);
    ways += k > 0 ? std::log((left + 1) / of) : 0.0;
    sum += k >= dark ? std::exp(ways + of * std::log(p) + left * std::log1p(-p)) : 0.0;
  }
  return sum;
}

/// The share of lumens in dark tissue, by the rule of succession: neither none nor all, however few there are.
double darkShare(const std::vector<Beside>& beside, const std::array<double, 3>& limits, std::size_t channels)
{
  double known = 0;
  double dark = 0;
  for (const Beside& one : beside)
  {
    known += one.known();
    dark += isDark(one, limits, channels);
  }
  return (dark + 1) / (known + 2);
}

} // namespace

RayGaps dropRayGaps(
  cv::Mat& lumen, const Picture& picture, const EdgeDistance& edge, double near, double far, double slender)
{
  RayGaps result;
  const Pieces pieces = piecesOf(lumen, false);
  const auto count = static_cast<int>(pieces.area.size());
  const std::vector<LumenShape> shapes = lumenShapes(pieces.labels, count);
  std::vector<int> gaps = slenderAmongBroad(pieces.labels, shapes, slender);
  if (gaps.empty())
    return result;
  double pieceCount = 0;
  cv::minMaxLoc(edge.piece, nullptr, &pieceCount);
  const std::vector<Beside> beside = besideLumens(picture, edge, static_cast<int>(pieceCount) + 1, near, far);
  const std::size_t channels = picture.colour.empty() ? 1 : 3;
  const std::array<double, 3> limits = darkBelow(beside, channels);
  // Which piece a lumen was before.
  std::vector<int> before(pieces.area.size(), 0);
  for (int row = 0; row < lumen.rows; ++row)
  {
    const auto* label = pieces.labels.ptr<int>(row);
    const auto* piece = edge.piece.ptr<int>(row);
    const auto* away = edge.away.ptr<float>(row);
    for (int x = 0; x < lumen.cols; ++x)
      if (label[x] > 0 && away[x] == 0)
        before[static_cast<std::size_t>(label[x])] = piece[x];
  }
  const std::size_t slenderOnes = gaps.size();
  const auto besideOf = [&](int gap) -> const Beside&
  { return beside[static_cast<std::size_t>(before[static_cast<std::size_t>(gap)])]; };
  std::vector<Beside> others = beside;
  for (const int gap : gaps)
    others[static_cast<std::size_t>(before[static_cast<std::size_t>(gap)])] = {};
  std::erase_if(gaps, [&](int gap) { return !isDark(besideOf(gap), limits, channels); });
  constexpr double chance = 0.02;
  if (gaps.empty() || 2 * gaps.size() < slenderOnes || 10 * gaps.size() > pieces.area.size() - 1 ||
    tail(gaps.size(), slenderOnes, darkShare(others, limits, channels)) > chance)
    return result;
  std::vector<int> which(pieces.area.size(), -1);
  for (std::size_t i = 0; i < gaps.size(); ++i)
  {
    which[static_cast<std::size_t>(gaps[i])] = static_cast<int>(i);
    result.marks.push_back({ Mark::Kind::Ray, lumen.cols, lumen.rows, 0, 0 });
  }
  for (int row = 0; row < lumen.rows && !gaps.empty(); ++row)
  {
    auto* value = lumen.ptr<std::uint8_t>(row);
    const auto* label = pieces.labels.ptr<int>(row);
    for (int x = 0; x < lumen.cols; ++x)
    {
      const int gap = which[static_cast<std::size_t>(label[x])];
      if (gap >= 0)
      {
        value[x] = 0;
        ++result.nodes;
        Mark& box = result.marks[static_cast<std::size_t>(gap)];
        box = { Mark::Kind::Ray, std::min(box.x0, x), std::min(box.y0, row), std::max(box.x1, x + 1),
          std::max(box.y1, row + 1) };
      }
    }
  }
  return result;
}

} // namespace lamella::micrograph
