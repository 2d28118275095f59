#include "segmentation/Stain.h"

#include "core/Error.h"
#include "segmentation/Flatten.h"
#include "segmentation/Otsu.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace lamella::micrograph
{
namespace
{

constexpr std::array channels{ "red", "green", "blue", "grey" };

constexpr double plenty = 4e5; // pixels to choose a channel by

/// Weights and offset of the discriminant between the pixels above and below a limit in one channel.
struct Discriminant
{
  cv::Vec3d weights;
  double offset = 0;
  bool found = false;
};

Discriminant discriminant(const std::array<cv::Mat, 3>& colour, const cv::Mat& bright)
{
  std::array<cv::Vec3d, 2> sum{};
  std::array<cv::Matx33d, 2> square{};
  std::array<double, 2> count{};
  for (int row = 0; row < bright.rows; ++row)
  {
    const auto* side = bright.ptr<std::uint8_t>(row);
    const std::array<const float*, 3> value{ colour[0].ptr<float>(row), colour[1].ptr<float>(row),
      colour[2].ptr<float>(row) };
    for (int x = 0; x < bright.cols; ++x)
    {
      const std::size_t which = side[x] > 0 ? 1 : 0;
      const cv::Vec3d v(value[0][x], value[1][x], value[2][x]);
      sum[which] += v;
      square[which] += v * v.t();
      count[which] += 1;
    }
  }
  Discriminant result;
  if (count[0] < 3 || count[1] < 3)
    return result;
  cv::Matx33d within = cv::Matx33d::zeros();
  for (std::size_t which = 0; which < 2; ++which)
  {
    sum[which] *= 1 / count[which];
    within += square[which] - count[which] * (sum[which] * sum[which].t());
  }
  // One grey of scatter keeps a picture of two clean colours regular.
  within = within * (1 / (count[0] + count[1])) + cv::Matx33d::eye();
  const cv::Vec3d apart = sum[1] - sum[0];
  const cv::Vec3d direction = within.inv() * apart;
  const double span = direction.dot(apart);
  if (!(span > 0))
    return result;
  result.weights = direction * (128 / span);
  result.offset = 64 - result.weights.dot(sum[0]);
  result.found = true;
  return result;
}

cv::Mat combined(const std::array<cv::Mat, 3>& colour, const Discriminant& by)
{
  cv::Mat grey(colour[0].size(), CV_32F);
  const auto [red, green, blue] = std::array{ static_cast<float>(by.weights[0]), static_cast<float>(by.weights[1]),
    static_cast<float>(by.weights[2]) };
  const auto offset = static_cast<float>(by.offset);
  for (int row = 0; row < grey.rows; ++row)
  {
    const auto* r = colour[0].ptr<float>(row);
    const auto* g = colour[1].ptr<float>(row);
    const auto* b = colour[2].ptr<float>(row);
    auto* to = grey.ptr<float>(row);
    for (int x = 0; x < grey.cols; ++x)
      to[x] = std::clamp(offset + red * r[x] + green * g[x] + blue * b[x], 0.0F, 255.0F);
  }
  return grey;
}

} // namespace

cv::Mat channelOf(const Picture& picture, int which)
{
  const auto width = static_cast<int>(picture.lattice.size[0]);
  const auto height = static_cast<int>(picture.lattice.size[1]);
  const bool colour = which < 3;
  const std::uint16_t* from = colour ? picture.colour.data() + which : picture.grey.data();
  const std::size_t step = colour ? 3 : 1;
  // 16-bit cameras seldom use all 16 bits: scale by the brightest value.
  float top = 255;
  if (picture.bits == 16)
    top = std::max<float>(1, *std::max_element(picture.grey.begin(), picture.grey.end()));
  cv::Mat result(height, width, CV_32F);
  for (int row = 0; row < height; ++row)
  {
    auto* to = result.ptr<float>(row);
    for (int x = 0; x < width; ++x, from += step)
      to[x] = std::min(255.0F, static_cast<float>(*from) * (255.0F / top));
  }
  return result;
}

StainGrey stainGrey(const Picture& picture, Channel asked)
{
  StainGrey result;
  if (picture.colour.empty() || asked == Channel::Grey)
  {
    if (asked != Channel::Auto && asked != Channel::Grey)
    {
      throw ParameterError("a colour channel was asked of a grey picture",
        "leave the channel out, or give the picture "
        "in colour");
    }
    result.grey = channelOf(picture, 3);
    result.name = channels[3];
    result.separability = otsu(thinned(result.grey, plenty)).separability;
    return result;
  }
  const std::array<cv::Mat, 3> colour{ channelOf(picture, 0), channelOf(picture, 1), channelOf(picture, 2) };
  const std::array<cv::Mat, 3> few{ thinned(colour[0], plenty), thinned(colour[1], plenty),
    thinned(colour[2], plenty) };
  std::size_t best = 0;
  Otsu split;
  for (std::size_t which = 0; which < 3; ++which)
  {
    const Otsu found = otsu(few[which]);
    if (found.separability > split.separability)
    {
      best = which;
      split = found;
    }
  }
  const bool single = asked == Channel::Red || asked == Channel::Green || asked == Channel::Blue;
  if (single)
  {
    best = asked == Channel::Red ? 0 : asked == Channel::Green ? 1 : 2;
    split = otsu(few[best]);
  }
  result.grey = colour[best];
  result.name = channels[best];
  result.weights[best] = 1;
  result.separability = split.separability;
  if (single || !(split.separability > 0))
    return result;
  // The classes of a noisy channel are mixed; those of their own discriminant are less so.
  Discriminant by;
  cv::Mat bright = few[best] >= split.threshold;
  double separability = 0;
  for (int round = 0; round < 3; ++round)
  {
    const Discriminant next = discriminant(few, bright);
    if (!next.found)
      break;
    by = next;
    const cv::Mat mixed = combined(few, by);
    const Otsu parted = otsu(mixed);
    separability = parted.separability;
    bright = mixed >= parted.threshold;
  }
  if (!by.found)
    return result;
  constexpr double worthIt = 0.9;
  if (asked == Channel::Stain || 1 - separability <= worthIt * (1 - split.separability))
  {
    result.grey = combined(colour, by);
    result.name = "stain";
    result.weights = { by.weights[0], by.weights[1], by.weights[2] };
    result.separability = separability;
  }
  return result;
}

} // namespace lamella::micrograph
