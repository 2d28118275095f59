#include "generators/LookParts.h"

#include "generators/CellGeometry.h"

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::generators
{
namespace
{

std::int64_t countOf(const Random& random, RandomUse use, double perSquareMillimetre, double area)
{
  return static_cast<std::int64_t>(perSquareMillimetre * area * 1e6 + random.uniform(use, -1));
}

} // namespace

double decay(double x) noexcept
{
  if (x > 100)
    return 0;
  const double s = x / 256;
  double value = 1 - s * (1 - s / 2 * (1 - s / 3 * (1 - s / 4 * (1 - s / 5))));
  for (int i = 0; i < 8; ++i)
    value *= value;
  return value;
}

double smoothField(const Random& random, RandomUse use, std::int64_t field, double x, double y) noexcept
{
  auto row = static_cast<std::int64_t>(y);
  row -= static_cast<double>(row) > y;
  const double part = y - static_cast<double>(row);
  const double blend = part * part * (3 - 2 * part);
  const std::int64_t line = field * 1000003 + row;
  return mix(random.smooth(use, line, x), random.smooth(use, line + 1, x), blend);
}

std::vector<std::int32_t> labelled(const std::vector<std::uint8_t>& marked, std::int64_t nx, std::int64_t ny)
{
  std::vector<std::int32_t> label(marked.size(), 0);
  std::vector<std::int64_t> stack;
  std::int32_t count = 0;
  for (std::int64_t start = 0; start < nx * ny; ++start)
  {
    if (marked[static_cast<std::size_t>(start)] == 0 || label[static_cast<std::size_t>(start)] != 0)
      continue;
    label[static_cast<std::size_t>(start)] = ++count;
    stack.push_back(start);
    while (!stack.empty())
    {
      const std::int64_t node = stack.back();
      stack.pop_back();
      const std::int64_t x = node % nx;
      const auto visit = [&](bool inside, std::int64_t to)
      {
        if (inside && marked[static_cast<std::size_t>(to)] != 0 && label[static_cast<std::size_t>(to)] == 0)
        {
          label[static_cast<std::size_t>(to)] = count;
          stack.push_back(to);
        }
      };
      visit(x > 0, node - 1);
      visit(x + 1 < nx, node + 1);
      visit(node >= nx, node - nx);
      visit(node + nx < nx * ny, node + nx);
    }
  }
  return label;
}

void tear(std::vector<float>& stain, std::int64_t nx, std::int64_t ny, double spacing, const LookOptions& o)
{
  const Random random(o.seed);
  const double area = static_cast<double>(nx) * static_cast<double>(ny) * spacing * spacing;
  for (std::int64_t k = 0; k < countOf(random, RandomUse::Tear, o.tears, area); ++k)
  {
    // A crooked line of short steps, open by some two micrometres in its middle.
    double x = static_cast<double>(nx) * random.uniform(RandomUse::Tear, k, 0);
    double y = static_cast<double>(ny) * random.uniform(RandomUse::Tear, k, 1);
    double turns = random.uniform(RandomUse::Tear, k, 2);
    const double length = mix(15e-6, 50e-6, random.uniform(RandomUse::Tear, k, 3)) / spacing;
    const double open = mix(0.8e-6, 2e-6, random.uniform(RandomUse::Tear, k, 4)) / spacing;
    const double step = std::max(0.5, 0.3e-6 / spacing);
    for (double along = 0; along < length; along += step)
    {
      const auto i = static_cast<std::int64_t>(along / step);
      turns += 0.012 * random.normal(RandomUse::Tear, k, 10 + i);
      const auto [c, s] = onCircle(turns);
      x += step * c;
      y += step * s;
      const double part = along / length;
      const double radius = open * 4 * part * (1 - part);
      const auto reach = static_cast<std::int64_t>(radius) + 1;
      for (std::int64_t v = static_cast<std::int64_t>(y) - reach; v <= static_cast<std::int64_t>(y) + reach; ++v)
      {
        for (std::int64_t u = static_cast<std::int64_t>(x) - reach; u <= static_cast<std::int64_t>(x) + reach; ++u)
        {
          const double dx = static_cast<double>(u) + 0.5 - x;
          const double dy = static_cast<double>(v) + 0.5 - y;
          if (u >= 0 && v >= 0 && u < nx && v < ny && dx * dx + dy * dy < radius * radius)
            stain[static_cast<std::size_t>(u + nx * v)] = static_cast<float>(o.tint);
        }
      }
    }
  }
}

void addDirt(LookCanvas& canvas, const LookOptions& o)
{
  const Random random(o.seed);
  const double area =
    static_cast<double>(canvas.width) * static_cast<double>(canvas.height) * canvas.pixel * canvas.pixel;
  const std::int64_t count = countOf(random, RandomUse::Grime, o.dirt, area);
  for (std::int64_t k = 0; k < count; ++k)
  {
    // A blob of three lobes; dark in transmitted light, bright in an ESEM; some out of focus.
    const double x = static_cast<double>(canvas.width) * random.uniform(RandomUse::Grime, k, 0);
    const double y = static_cast<double>(canvas.height) * random.uniform(RandomUse::Grime, k, 1);
    const double radius = mix(1.5e-6, 6e-6, random.uniform(RandomUse::Grime, k, 2)) / canvas.pixel;
    const double soft = mix(0.3, 1.2, random.uniform(RandomUse::Grime, k, 3));
    const double opacity = mix(0.45, 0.9, random.uniform(RandomUse::Grime, k, 4));
    const std::array<double, 3> colour{ 0.35, 0.25, 0.18 };
    const auto reach = static_cast<std::int64_t>(radius * (1.6 + soft)) + 2;
    const auto cx = static_cast<std::int64_t>(x);
    const auto cy = static_cast<std::int64_t>(y);
    for (std::int64_t v = std::max<std::int64_t>(0, cy - reach); v < std::min(canvas.height, cy + reach + 1); ++v)
    {
      for (std::int64_t u = std::max<std::int64_t>(0, cx - reach); u < std::min(canvas.width, cx + reach + 1); ++u)
      {
        double cover = 0;
        for (int lobe = 0; lobe < 3; ++lobe)
        {
          const auto [c, s] = onCircle(random.uniform(RandomUse::Grime, k, 5 + lobe));
          const double dx = (static_cast<double>(u) + 0.5 - x) / radius - 0.5 * c;
          const double dy = (static_cast<double>(v) + 0.5 - y) / radius - 0.5 * s;
          const double d = std::sqrt(dx * dx + dy * dy);
          const double t = std::clamp((1 + soft / 2 - d) / soft, 0.0, 1.0);
          cover = std::max(cover, t * t * (3 - 2 * t));
        }
        for (int c = 0; c < canvas.channels; ++c)
        {
          float& light = canvas.light[static_cast<std::size_t>((u + canvas.width * v) * canvas.channels + c)];
          const double goal = canvas.channels == 1 ? 0.85 : colour[static_cast<std::size_t>(c)];
          light = static_cast<float>(mix(light, goal, opacity * cover));
        }
      }
    }
  }
}

void blur(LookCanvas& canvas, double sigma)
{
  if (sigma <= 0)
    return;
  const auto reach = static_cast<std::int64_t>(4 * sigma) + 1;
  std::vector<double> weight(static_cast<std::size_t>(reach + 1));
  double sum = 0;
  for (std::int64_t i = 0; i <= reach; ++i)
  {
    weight[static_cast<std::size_t>(i)] = decay(static_cast<double>(i * i) / (2 * sigma * sigma));
    sum += weight[static_cast<std::size_t>(i)] * (i == 0 ? 1 : 2);
  }
  // Along x the values of a channel are `channels` apart; along y whole rows are summed.
  std::vector<float> other(canvas.light.size());
  const std::int64_t row = canvas.width * canvas.channels;
  const auto weightOf = [&](std::int64_t k) { return weight[static_cast<std::size_t>(k < 0 ? -k : k)] / sum; };
  for (std::int64_t y = 0; y < canvas.height; ++y)
  {
    const float* const from = canvas.light.data() + y * row;
    for (std::int64_t i = 0; i < row; ++i)
    {
      double value = 0;
      for (std::int64_t k = -reach; k <= reach; ++k)
      {
        std::int64_t at = i + k * canvas.channels;
        at = at < 0 ? i % canvas.channels : at >= row ? row - canvas.channels + i % canvas.channels : at;
        value += weightOf(k) * from[at];
      }
      other[static_cast<std::size_t>(y * row + i)] = static_cast<float>(value);
    }
  }
  std::vector<double> line(static_cast<std::size_t>(row));
  for (std::int64_t y = 0; y < canvas.height; ++y)
  {
    std::fill(line.begin(), line.end(), 0.0);
    for (std::int64_t k = -reach; k <= reach; ++k)
    {
      const float* const from = other.data() + std::clamp<std::int64_t>(y + k, 0, canvas.height - 1) * row;
      const double w = weightOf(k);
      for (std::int64_t i = 0; i < row; ++i)
        line[static_cast<std::size_t>(i)] += w * from[i];
    }
    std::transform(
      line.begin(), line.end(), canvas.light.begin() + y * row, [](double v) { return static_cast<float>(v); });
  }
}

void addUnevenLight(LookCanvas& canvas, const LookOptions& o)
{
  if (o.unevenLight <= 0)
    return;
  // Brightest at a place of chance near the middle, falling off with the square of the distance; the far corner gets
  // 1 − unevenLight. A little slow noise on top.
  const Random random(o.seed);
  const auto w = static_cast<double>(canvas.width);
  const auto h = static_cast<double>(canvas.height);
  const double x0 = w * mix(0.25, 0.75, random.uniform(RandomUse::Light, 0));
  const double y0 = h * mix(0.25, 0.75, random.uniform(RandomUse::Light, 1));
  const double farX = std::max(x0, w - x0);
  const double farY = std::max(y0, h - y0);
  const double farthest = farX * farX + farY * farY;
  const double scale = 2.5 / std::max(w, h);
  for (std::int64_t y = 0; y < canvas.height; ++y)
  {
    for (std::int64_t x = 0; x < canvas.width; ++x)
    {
      const double dx = static_cast<double>(x) - x0;
      const double dy = static_cast<double>(y) - y0;
      const double slow =
        smoothField(random, RandomUse::Light, 7, static_cast<double>(x) * scale, static_cast<double>(y) * scale);
      const double fall = (dx * dx + dy * dy) / farthest + 0.12 * slow;
      const double factor = 1 - o.unevenLight * std::clamp(fall, 0.0, 1.0);
      for (int c = 0; c < canvas.channels; ++c)
      {
        canvas.light[static_cast<std::size_t>((x + canvas.width * y) * canvas.channels + c)] *=
          static_cast<float>(factor);
      }
    }
  }
}

void addNoise(LookCanvas& canvas, const LookOptions& o)
{
  if (o.noise <= 0)
    return;
  const Random random(o.seed);
  for (std::size_t i = 0; i < canvas.light.size(); ++i)
  {
    // Variances add: half is shot noise, which goes with the light, half is the camera's.
    const double light = canvas.light[i];
    const double deviation = o.noise * std::sqrt(0.5 * std::max(0.0, light) + 0.5);
    canvas.light[i] =
      static_cast<float>(light + deviation * random.normal(RandomUse::Noise, static_cast<std::int64_t>(i)));
  }
}

void drawScaleBar(std::vector<std::uint16_t>& values, const LookCanvas& canvas, const LookOptions& o)
{
  if (o.scaleBar <= 0)
    return;
  // Black on transmitted light, white on an ESEM picture.
  const std::uint16_t ink = canvas.channels == 1 ? 255 : 0;
  const auto width = static_cast<int>(canvas.width);
  const auto height = static_cast<int>(canvas.height);
  cv::Mat drawn = cv::Mat::zeros(height, width, CV_8UC1);
  const auto length = std::max<int>(1, static_cast<int>(std::lround(o.scaleBar / canvas.pixel)));
  const double size = std::max(0.4, height / 900.0);
  const int thickness = std::max(2, height / 150);
  const int margin = height / 25 + 4;
  const cv::Point right(width - margin, height - margin);
  cv::rectangle(drawn, right - cv::Point(length - 1, thickness - 1), right, cv::Scalar(255), cv::FILLED);
  const std::string text = fmt::format("{:g} um", o.scaleBar * 1e6);
  int baseline = 0;
  const cv::Size box = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, std::max(1, thickness / 2), &baseline);
  cv::putText(drawn, text,
    cv::Point(
      std::max(2, std::min(right.x - box.width, right.x - (length + box.width) / 2)), right.y - 2 * thickness - 2),
    cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar(255), std::max(1, thickness / 2), cv::LINE_8);
  for (int y = 0; y < height; ++y)
  {
    for (int x = 0; x < width; ++x)
    {
      if (drawn.at<std::uint8_t>(height - 1 - y, x) != 0)
        for (int c = 0; c < canvas.channels; ++c)
          values[static_cast<std::size_t>((x + canvas.width * y) * canvas.channels + c)] = ink;
    }
  }
}

} // namespace lamella::generators
